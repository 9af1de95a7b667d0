# A set-up that takes long ends soon after a signal to the client or to the server, and after the client's
# end.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"

# On the slow server, every row of the lattice takes half a second: minutes in all.
bin=$DM2_BIN
mkdir slow
ln -s "$DM2_BUILD/failing/slow-server" slow/dm2-server
DM2_BIN=$PWD/slow
DM2_SLOW=500
export DM2_SLOW
cat >rows.dm2 <<'DECK'
domain { size = 1, 10; r_c = 0.1; delta_r = 0.02 }
time { dt = 0.005 us; steps = 3 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
body b { shape = rectangle 0, 0, 1, 10; spacing = 0.04; material = Cu }
DECK

# run_client: starts a client and returns once the server sets its session up. Sets client_pid.
run_client()
{
    "$bin/dm2-client" rows.dm2 -q --overwrite -o run --server "$SERVER_ADDR" </dev/null 2>client.err &
    client_pid=$!
    busy=
    while [ -z "$busy" ]; do
        busy=$("$bin/dm2-client" --status --server "$SERVER_ADDR" | grep 'busy with')
    done
    sleep 1
}

# The client is asked to end: both ends are free, each with a word.
start_server
run_client
kill -TERM "$client_pid"
wait "$client_pid"
[ $? = 4 ] || fail "the client ended with another status than 4: $(cat client.err)"
expect_text client.err 'interrupted by a signal'
while ! grep -q 'closed the connection\|ended the session' "$SERVER_LOG"; do sleep 0.1; done

# The client is killed.
run_client
kill -KILL "$client_pid"
wait "$client_pid" 2>/dev/null
while [ "$(grep -c 'closed the connection\|ended the session' "$SERVER_LOG")" -lt 2 ]; do sleep 0.1; done

# The server is asked to end.
run_client
stop_server "$SERVER_PID"
[ "$SERVER_STATUS" = 0 ] || fail "the server ended with status $SERVER_STATUS"
wait "$client_pid"
[ $? = 3 ] || fail "the client of a server that ended: $(cat client.err)"
expect_text client.err "$SERVER_ADDR: ended the session: asked to end by a signal"

# A program that sets itself up is asked to end.
cat >many.dm2 <<'DECK'
domain { size = 10, 10; r_c = 0.01; delta_r = 0.002 }
time { dt = 0.0005 us; steps = 3 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
body b { shape = rectangle 0, 0, 10, 10; spacing = 0.004; material = Cu }
DECK
"$bin/dm2-seq" many.dm2 -q --overwrite -o many </dev/null 2>seq.err &
seq_pid=$!
sleep 0.1
kill -TERM "$seq_pid"
status=0
wait "$seq_pid" || status=$?
case $status in
4) expect_text seq.err 'interrupted before the first step' ;;
143) ;; # before the program caught signals
*) fail "dm2-seq ended with status $status: $(cat seq.err)" ;;
esac
