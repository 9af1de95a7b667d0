# One server that a hosts file names twice is told at once. Clients that want the same servers at the same
# time wait for each other and all end well, whatever their hosts files call the servers and in which order.
# labels: e2e
# timeout: 120
. "$DM2_SRC/tests/lib.sh"

client=$DM2_BIN/dm2-client
cat >discs.dm2 <<'DECK'
let d = 0.04 cm
domain { size = 2 cm, 1 cm; r_c = 2.5*d; delta_r = 0.25*d }
time { dt = 0.01 us; steps = 20 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
body left { shape = disc 0.5 cm, 0.5 cm, 0.3 cm; spacing = d; material = Cu; velocity = 0.03, 0
    jitter = 0.001 }
body right { shape = disc 1.5 cm, 0.5 cm, 0.3 cm; spacing = d; origin = 1.5 cm, 0.5 cm; material = Cu
    velocity = 0.03, 0 }
DECK
"$DM2_BIN/dm2-seq" -q -o reference discs.dm2 || fail "the reference run failed"

# Equal lines, equal options, slots that overlap the next line's, a spare that is a server already: exit
# status 2.
start_server
printf '# one server\n%s\n%s\n' "$SERVER_ADDR" "$SERVER_ADDR" >twice
expect_status 2 "$client" -q -o run --hosts twice discs.dm2
expect_text err "twice:3: $SERVER_ADDR is named before, in line 2; slots=K stands for K servers"
printf 'Ws1:4702 slots=2\nws1:4703 spare\n' >twice
expect_status 2 "$client" -q -o run --hosts twice discs.dm2
expect_text err "twice:2: ws1:4703 is named before, in line 1"
expect_status 2 "$client" -q -o run --server "$SERVER_ADDR" --server "$SERVER_ADDR" discs.dm2
expect_text err "server '$SERVER_ADDR' is named before"

# The same server by another name says so itself: exit status 3, without waiting for --timeout.
printf '# two names\n%s\n\nlocalhost:%s\n' "$SERVER_ADDR" "$SERVER_PORT" >names
expect_status 3 "$client" -q -o run --hosts names --timeout 100 discs.dm2
expect_text err "it is the same server as $SERVER_ADDR"
expect_text err ', under another name (lines 2 and 4 of the hosts file): name each server once'
expect_status 3 "$client" -q -o run --server "$SERVER_ADDR" --server "localhost:$SERVER_PORT" discs.dm2
expect_text err ', under another name: name each server once'
[ ! -e run/final.dm2 ] || fail "a refused run left results"

# Who waits for a server longer than --timeout is told whom the server serves.
mkfifo hold held
"$DM2_BUILD/tools/tcp" hold "$SERVER_PORT" <hold >held &
exec 3>hold
IFS= read -r line <held
expect_status 3 "$client" -q -o run --server "$SERVER_ADDR" --timeout 1 discs.dm2
expect_text err "it serves 127.0.0.1:"
exec 3>&-
stop_server "$SERVER_PID"

# Two clients, then three, at once with the servers in opposite order and under different names.
: >forward
for k in 1 2 3 4; do
    start_server
    echo "$SERVER_ADDR" >>forward
    echo "localhost:$SERVER_PORT" >>other
done
sed '1!G;h;$!d' other >backward
round=0
while [ $round -lt 8 ]; do
    round=$((round + 1))
    pids=
    for hosts in forward backward other; do
        [ $hosts != other ] || [ $((round % 4)) = 0 ] || continue
        "$client" -q --overwrite -o "run-$hosts" --hosts $hosts --timeout 20 discs.dm2 2>"err-$hosts" \
            </dev/null &
        pids="$pids $!"
    done
    for pid in $pids; do
        wait "$pid" || { cat err-*; fail "a client failed in round $round"; }
    done
done
for hosts in forward backward other; do
    same_bytes reference/final.dm2 "run-$hosts/final.dm2"
    same_bytes reference/history.csv "run-$hosts/history.csv"
done
