# As failing_calls.sh, for dm2-client, dm2-server, dm2-model and dm2-plot, with the calls of sockets and
# processes too: the Nth one fails, and the program succeeds with the right result (a lost server is made
# good) or says what is wrong; it does not crash, does not hang and leaves nothing half-written. Every 17th N
# here; FAILING_EVERY=1 takes all of them, in some minutes.
# labels: e2e
# timeout: 1200
. "$DM2_SRC/tests/lib.sh"

every=${FAILING_EVERY:-17}
failing=$DM2_BUILD/failing
sed -e 's/spacing = 0.04/spacing = 0.2/' -e 's/r_c = 0.1/r_c = 0.3/' -e 's/delta_r = 0.01/delta_r = 0.05/' \
    "$DM2_SRC/tests/decks/good/minimal.dm2" >small.dm2
expect_status 0 "$DM2_BIN/dm2-seq" small.dm2 -q -o good --steps 3
expect_status 0 "$DM2_BUILD/tools/fake_snapshot" 5 4 state.vtp
sed "s/^host,,host,/host,,$(uname -n),/" "$DM2_SRC/tests/fuzz/corpus/calibration/paper" >constants
mkdir mixed # the client finds its servers beside itself
ln -s "$failing/dm2-client" "$DM2_BIN/dm2-server" mixed/

# Each function runs one program with DM2_FAIL in its environment and sets `got`, its exit status; `err` has
# its standard error.
of_client()
{
    got=0
    mixed/dm2-client small.dm2 -q -n 2 -o run --steps 3 --reconnect 0.1 --timeout 10 >out 2>err </dev/null \
        || got=$?
    check_run
}
# A server, and a sound client: its answer is right or absent.
of_server()
{
    "$failing/dm2-server" --port 0 --once --timeout 2 >fifo 2>err </dev/null &
    pid=$!
    line=
    IFS= read -r line <fifo
    client=0
    [ -z "$line" ] || (unset DM2_FAIL DM2_FAIL_MARK && exec "$DM2_BIN/dm2-client" small.dm2 -q --no-recover \
        --timeout 10 -o run \
        --steps 3 --server "${line##* }") >out 2>err-client </dev/null || client=$?
    got=0
    wait "$pid" || got=$?
    [ "$client" -le 3 ] || { cat err-client; fail "$what: the client's exit status is $client"; }
    [ "$client" -eq 0 ] || [ -s err-client ] || fail "$what: exit status $client of the client without a word"
    [ -z "$line" ] || [ "$client" -ne 0 ] || same_bytes good/final.dm2 run/final.dm2
}
of_model()
{
    got=0
    "$failing/dm2-model" predict --n 1000,4000 --general --preset constants >out 2>err </dev/null || got=$?
    [ "$got" -ne 0 ] || cmp -s out prediction || fail "$what: another prediction"
}
of_plot()
{
    got=0
    "$failing/dm2-plot" snapshot state.vtp -o picture.svg --links >out 2>err </dev/null || got=$?
    [ ! -e picture.svg ] || same_bytes good.svg picture.svg
    [ "$got" -ne 0 ] || [ -e picture.svg ] || fail "$what: no picture"
    rm -f picture.svg
}
check_run()
{
    [ ! -e run/final.dm2 ] || same_bytes good/final.dm2 run/final.dm2
    [ ! -e run/history.csv ] || same_bytes good/history.csv run/history.csv
    [ "$got" -ne 0 ] || [ -e run/final.dm2 ] || fail "$what: no result"
    [ -e run/checkpoint.dm2 ] || [ -z "$(find run -name '*.part' 2>/dev/null)" ] ||
        fail "$what: $(find run -name '*.part')"
}

# sweep PROGRAM CLASS...
sweep()
{
    program=$1
    shift
    for class in "$@"; do
        n=1 runs=0 failed=0
        while :; do # until the run has no Nth call
            rm -rf mark run
            what="$program, $class $n"
            DM2_FAIL=$class:$n DM2_FAIL_MARK=$PWD/mark
            export DM2_FAIL DM2_FAIL_MARK
            "of_$program"
            unset DM2_FAIL DM2_FAIL_MARK
            [ -f mark ] || break
            [ "$got" -le 3 ] || { cat err; fail "$what: exit status $got"; }
            [ "$got" -eq 0 ] || [ -s err ] || fail "$what: exit status $got without a word"
            runs=$((runs + 1)) n=$((n + every))
            [ "$got" -eq 0 ] || failed=$((failed + 1))
        done
        echo "$program: $class: $runs calls, $failed failed cleanly, the others changed nothing"
        [ "$runs" -gt 0 ] || fail "$program has no $class: is the wrapping there?"
    done
}

mkfifo fifo
expect_status 0 "$DM2_BIN/dm2-plot" snapshot state.vtp -o good.svg --links
expect_status 0 "$DM2_BIN/dm2-model" predict --n 1000,4000 --general --preset constants
cp out prediction
sweep client memory open write fsync rename read writev poll socket
sweep server memory read writev poll socket
sweep model memory open
sweep plot memory open write fsync rename
