# Steps and a set-up that take longer than the timeout of client and servers: a computing server sends ALIVE,
# and the run goes on to the same bytes. A silent server is given up.
# labels: e2e bits
. "$DM2_SRC/tests/lib.sh"

sed -e 's/spacing = 0.04/spacing = 0.2/' -e 's/r_c = 0.1/r_c = 0.3/' -e 's/delta_r = 0.01/delta_r = 0.05/' \
    -e 's/rectangle 0 0 1 1/rectangle 0 0.3 1 0.6/'     "$DM2_SRC/tests/decks/good/minimal.dm2" >small.dm2
expect_status 0 "$DM2_BIN/dm2-seq" small.dm2 -q -o whole --steps 1
start_server --timeout 1
quick=$SERVER_ADDR
mkdir slow
ln -s "$DM2_BUILD/failing/slow-server" slow/dm2-server
DM2_SLOW=350
export DM2_SLOW
bin=$DM2_BIN
DM2_BIN=$PWD/slow
start_server --timeout 1
slow=$SERVER_ADDR slow_pid=$SERVER_PID

expect_status 0 "$bin/dm2-client" small.dm2 -q --steps 1 -o long --timeout 1 --server "$quick" --server \
    "$slow"
same_bytes whole/final.dm2 long/final.dm2
same_bytes whole/history.csv long/history.csv
! grep -q 'lost and made good' long/run.log || fail "$(cat long/run.log)"
# Every step took longer than a silent peer is waited for, twice the client's second.
sed -n 's/.* steps, \([0-9]*\)\.[0-9]* ms per step$/\1/p' long/run.log >ms
[ "$(cat ms)" -gt 2000 ] || fail "a step took $(cat ms) ms: nobody had to wait"
stop_server "$slow_pid"

# A status request is answered in the middle of a step that takes longer than the request waits.
DM2_SLOW=500
start_server --timeout 10
mkfifo hashes
"$bin/dm2-client" small.dm2 -q --steps 1 -o asked --hash-every 1 --timeout 2 --server "$SERVER_ADDR" >hashes \
    2>&1 &
running=$!
exec 3<hashes
IFS= read -r text <&3
case $text in
'step 0 hash '*) ;;
*) fail "the client says '$text'" ;;
esac
expect_status 0 "$bin/dm2-client" --status --server "$SERVER_ADDR" --timeout 2
expect_text out 'busy with'
expect_text out 'step 0;'
exec 3<&-
kill -KILL "$running" "$SERVER_PID"
wait "$running"
DM2_SLOW=350

DM2_MUTE=1
export DM2_MUTE
start_server --timeout 1
expect_status 3 "$bin/dm2-client" small.dm2 -q --steps 1 -o mute --timeout 1 --no-recover --server "$quick" \
    --server "$SERVER_ADDR"
expect_text err "$SERVER_ADDR: no answer for 1 s"
kill -KILL "$SERVER_PID"
exit 0
