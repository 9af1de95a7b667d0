# The second signal ends a run at once. No file of the run has a final name, and the last checkpoint leads to
# the end of the straight run.
# labels: e2e bits
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
deck=$DM2_SRC/tests/decks/good/scatter.dm2
expect_status 0 "$seq" "$deck" -q -o whole

# begin PROGRAM OPTION...: returns when a checkpoint has been written and the run goes on.
begin()
{
    rm -rf run hashes
    mkfifo hashes
    # a background process of a script ignores INT, and so would dm2
    "$DM2_BUILD/tools/foreground" "$@" "$deck" -o run --checkpoint-every 20 --hash-every 1 >hashes 2>err &
    pid=$!
    exec 4<hashes
    count=0
    while [ $count -lt 57 ] && IFS= read -r line <&4; do
        count=$((count + 1))
    done
}
# ends: by the signal, with no result.
ends()
{
    cat <&4 >rest
    exec 4<&-
    got=0
    wait "$pid" || got=$?
    [ "$got" -eq 130 ] || [ "$got" -eq 143 ] || { cat err; fail "status $got"; }
    ! grep -q 'interrupted by a signal' err || fail "it came to its own end: $(cat err)"
    [ ! -e run/final.dm2 ] && [ ! -e run/history.csv ] || fail "$(find run)"
    [ -f run/checkpoint.dm2 ] || fail 'no checkpoint'
}
same_run()
{
    same_bytes whole/final.dm2 run/final.dm2
    same_bytes whole/history.csv run/history.csv
}

# Both signals have come when the run looks at them.
begin "$seq"
kill -STOP "$pid"
kill -TERM "$pid"
kill -INT "$pid"
kill -CONT "$pid"
ends
expect_status 0 "$seq" "$deck" -q --restart run/checkpoint.dm2
same_run

# A client that waits for the STEP of a stopped server.
start_server
one=$SERVER_ADDR
start_server
begin "$client" --server "$one" --server "$SERVER_ADDR"
kill -STOP "$SERVER_PID"
kill -TERM "$pid"
kill -INT "$pid"
ends
kill -CONT "$SERVER_PID"
expect_status 0 "$client" "$deck" -q --restart run/checkpoint.dm2 --server "$one" --server "$SERVER_ADDR"
same_run
exit 0
