# Servers that are killed, stopped or asked to end in the middle of a run: the client goes on, with a server
# that came back, a spare, or the remaining servers, to the bytes of the run without the fault.
# labels: e2e bits
# timeout: 120
. "$DM2_SRC/tests/lib.sh"
client=$DM2_BIN/dm2-client
sed 's/output {/output { snapshot_every = 70;/; s/let steps = 400/let steps = 800/' \
    "$DM2_SRC/tests/decks/good/scatter.dm2" >deck.dm2
expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 -q -o whole --hash-every 1
cp out whole.hashes

# begin STEP OPTION...: starts the client and returns when the client has done STEP steps.
begin()
{
    steps=$1
    shift
    rm -rf run hashes
    mkfifo hashes
    "$client" deck.dm2 -o run --hash-every 1 --copy-every 25 "$@" >hashes 2>err </dev/null &
    client_pid=$!
    exec 4<hashes
    : >seen
    count=0
    until_step "$steps"
}
# until_step STEP: reads on.
until_step()
{
    while [ $count -le "$1" ] && IFS= read -r line <&4; do
        echo "$line" >>seen
        count=$((count + 1))
    done
}
# ends STATUS: waits for the client.
ends()
{
    cat <&4 >>seen
    exec 4<&-
    got=0
    wait $client_pid || got=$?
    [ $got -eq "$1" ] || fail "status $got, expected $1: $(cat err)"
}
same_run()
{
    ends 0
    same_bytes whole/final.dm2 run/final.dm2
    same_bytes whole/history.csv run/history.csv
    same_bytes whole/fragments.csv run/fragments.csv
    for file in whole/snapshots/*; do
        same_bytes "$file" "run/snapshots/${file##*/}"
    done
    grep '^step' seen >hashes.seen
    grep '^step' whole.hashes >hashes.whole
    same_bytes hashes.whole hashes.seen
    expect_text run/run.log "servers lost and made good: $1"
}

start_server
one=$SERVER_ADDR one_pid=$SERVER_PID
start_server
two=$SERVER_ADDR two_pid=$SERVER_PID
start_server
three=$SERVER_ADDR three_pid=$SERVER_PID

# A server is killed at a step before the first copy, the others go on; then another one, and the last has all
# cells.
begin 7 --reconnect 0.1 --server "$one" --server "$two" --server "$three"
kill -KILL "$two_pid"
until_step 90
kill -KILL "$three_pid"
same_run 4
expect_text err "server 1 of 3, step"
expect_text err "without $two, with 2 of the servers"
expect_text err "without $three, with 1 of the servers"
expect_text err "going on from step"

# A spare of the hosts file.
start_server
two=$SERVER_ADDR two_pid=$SERVER_PID
start_server
three=$SERVER_ADDR three_pid=$SERVER_PID
printf '%s\n%s spare\n%s\n' "$one" "$three" "$two" >hosts
begin 133 --reconnect 0.1 --hosts hosts
kill -KILL "$two_pid"
same_run 2
expect_text err "with the spare $three in place of $two"

# Silent past the deadline.
begin 211 --server "$one" --server "$three" --timeout 1
kill -STOP "$three_pid"
same_run 1
kill -CONT "$three_pid"
expect_text err 'no answer for 1 s'
expect_text err "without $three"

# A server that ends its session and can be reached again.
start_server
begin 50 --server "$one" --server "$SERVER_ADDR" --reconnect 0.1
kill -TERM "$SERVER_PID"
same_run 2

# No server is left: the copy becomes a checkpoint, which leads to the same end.
begin 160 --reconnect 0.1 --server "$one"
kill -KILL "$one_pid"
ends 3
expect_text err 'no server is left'
expect_text err '--restart auto'
expect_status 0 "$client" deck.dm2 -n 2 -q --restart run/checkpoint.dm2
same_bytes whole/final.dm2 run/final.dm2
same_bytes whole/history.csv run/history.csv

# Servers of this machine are started anew.
begin 101 -n 3
victim=$(ps -o pid= -o ppid= -A | awk -v p="$client_pid" '$2 == p { print $1; exit }')
[ -n "$victim" ] || fail "no local server is found"
kill -KILL "$victim"
same_run 1
expect_text err 'servers started anew'
exit 0
