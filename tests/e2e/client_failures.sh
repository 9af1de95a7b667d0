# A server that is absent, refuses, speaks something else, dies or stalls, and a disk that is full: the client
# names host:port, the step and the reason, exits with the right status, and leaves nothing half-written.
. "$DM2_SRC/tests/lib.sh"

tcp=$DM2_BUILD/tools/tcp
client=$DM2_BIN/dm2-client
deck=$DM2_SRC/tests/decks/run/scatter.dm2
version=$(sed -n 's/.*PROTOCOL_VERSION = \([0-9]*\).*/\1/p' "$DM2_SRC/include/dm2/cluster/messages.h")
own=$(printf '\\%03o\\000' "$version") # as printf takes it

# nothing_left DIR: no result, not even in part.
nothing_left()
{
    [ ! -e "$1" ] || [ -z "$(find "$1" -type f ! -path '*/snapshots/*')" ] || fail "$(find "$1") was left"
    [ ! -e "$1" ] || [ -z "$(find "$1" -name '*.part')" ] || fail "$(find "$1") was left"
}

# Wrong command lines: status 2, and what to do.
expect_status 2 "$client"
expect_text err 'no deck is named'
expect_status 2 "$client" "$deck" -n 0
expect_text err 'from 1 to'
expect_status 2 "$client" "$deck" -n 2 --server localhost
expect_status 2 "$client" "$deck" --sevrer localhost
expect_text err "did you mean 'server'?"
expect_status 2 "$client" "$deck" --progress often
expect_status 2 "$client" "$deck" --balance mass
expect_status 2 "$client" "$deck" "$deck"
expect_status 2 "$client" "$deck" --hosts missing
expect_text err 'missing'
printf 'localhost:70000\n' >hosts
expect_status 2 "$client" "$deck" --hosts hosts
expect_text err "hosts:1: 'localhost:70000'"
expect_status 2 "$client" missing.dm2 -n 1
expect_text err missing.dm2
expect_status 2 "$client" "$deck" -n 1000
expect_text err '1000 servers for a grid of 345 cells'

# No server listens: the port belonged to a server that has just ended.
start_server
stop_server "$SERVER_PID"
expect_status 3 "$client" "$deck" --server "$SERVER_ADDR" -o absent
expect_text err "server 0 of 1, before the first step: $SERVER_ADDR: Connection refused; no dm2-server"
nothing_left absent
expect_status 3 "$client" "$deck" --server no-such-host.invalid -o absent
expect_text err "the host 'no-such-host.invalid' is not known"
nothing_left absent

# answered_by BYTES TEXT: the client says TEXT of a server that answers with these bytes.
answered_by()
{
    rm -f port
    mkfifo port
    printf "$1" | "$tcp" answer >port &
    other=$!
    IFS= read -r number <port
    expect_status 3 "$client" "$deck" --server "127.0.0.1:$number" -o foreign --timeout 5
    expect_text err "127.0.0.1:$number"
    expect_text err 'before the first step'
    expect_text err "$2"
    wait "$other"
    nothing_left foreign
}
answered_by 'SSH-2.0-OpenSSH_9.9\r\n' "does not speak dm2's protocol: its message starts with 'SSH-'"
answered_by 'DM2\032\143\000\002\000\000\000\000\000\000\000\000\000' \
    'speaks protocol version 99, this program version '"$version"
answered_by 'DM2\032'"$own"'\002\000\377\377\377\000\000\000\000\000' 'announces a message'

# The server is killed, or stopped past the deadline, in the middle of a long run.
# run_long OPTION...: starts a client and waits until it says that it computes.
run_long()
{
    mkfifo progress
    "$client" "$deck" "$@" -o long --overwrite --steps 100000000 --progress always >out 2>progress &
    client_pid=$!
    exec 4<progress
    IFS= read -r line <&4
    case $line in
    'step '*' of 100000000, '*' %, '*' element-steps/s, '*' left, slowest '*) ;;
    *) fail "the progress says '$line'" ;;
    esac
}
# client_ends STATUS TEXT: the client ends with this status and says so.
client_ends()
{
    cat <&4 >err
    got=0
    wait "$client_pid" || got=$?
    exec 4<&-
    rm -f progress
    [ "$got" -eq "$1" ] || { cat err; fail "exit status $got, expected $1"; }
    expect_text err "$2"
    nothing_left long
}
start_server
one=$SERVER_PID one_addr=$SERVER_ADDR one_log=$SERVER_LOG
start_server
run_long --no-recover --server "$one_addr" --server "$SERVER_ADDR"
kill -KILL "$SERVER_PID"
client_ends 3 "server 1 of 2, step "
expect_text err "$SERVER_ADDR"
grep -q -E 'closed the connection|connection broke' err || fail "no reason"
stop_server "$SERVER_PID"
start_server
run_long --no-recover --server "$one_addr" --server "$SERVER_ADDR" --timeout 1
kill -STOP "$SERVER_PID"
client_ends 3 "$SERVER_ADDR"
expect_text err 'server 1 of 2, step '
expect_text err 'no answer for 1 s'
kill -CONT "$SERVER_PID"

# A server that is asked to end tells the client.
run_long --no-recover --server "$one_addr" --server "$SERVER_ADDR"
kill -TERM "$SERVER_PID"
client_ends 3 'asked to end by a signal'
expect_text err "$SERVER_ADDR"
stop_server "$SERVER_PID"

# The client is killed: the server notices, and serves the next one.
start_server
run_long --no-recover --server "$one_addr" --server "$SERVER_ADDR"
kill -KILL "$client_pid"
wait "$client_pid"
exec 4<&-
rm -f progress
rm -r long
expect_status 0 "$client" "$deck" -q --server "$one_addr" --server "$SERVER_ADDR" -o next --steps 3
[ "$(grep -c 'closed the connection\|connection broke' "$one_log")" -ge 1 ] || fail "no reason in the log"
kill -0 "$one" || fail "the first server is gone"

# An interrupted client ends its servers, leaves a checkpoint with the tables up to there, and says so.
run_long -n 2
kill -TERM "$client_pid"
cat <&4 >err
got=0
wait "$client_pid" || got=$?
exec 4<&-
rm -f progress
[ "$got" -eq 4 ] || { cat err; fail "exit status $got, expected 4"; }
expect_text err 'interrupted'
expect_text err '--restart auto'
[ -f long/checkpoint.dm2 ] && [ -f long/history.csv.part ] && [ ! -f long/history.csv ] ||
    fail "$(find long) was left"

# A killed client leaves no server behind: the next connection sees the server end, the one after finds none.
run_long -n 2
kill -KILL "$client_pid"
wait "$client_pid"
exec 4<&-
rm -f progress
port=${line##*slowest 127.0.0.1:}
port=${port%% *}
"$tcp" send "$port" </dev/null >reply 2>err
! "$tcp" send "$port" </dev/null >reply 2>err || fail "the local server on port $port lives on"
rm -r long

# A disk that is full: a limit on the size of files, in blocks of 512 bytes.
got=0
(ulimit -f 20 && exec "$client" "$deck" -n 2 -q -o full) >out 2>err || got=$?
[ "$got" -eq 1 ] || { cat err; fail "exit status $got on a full disk"; }
expect_text err 'full/'
nothing_left full

# A run directory that is not empty.
mkdir taken
: >taken/file
expect_status 1 "$client" "$deck" -n 1 -o taken --steps 1
expect_text err taken
[ -f taken/file ] || fail "a file of somebody else is gone"
expect_status 0 "$client" "$deck" -n 1 -q -o taken --steps 1 --overwrite
[ -f taken/file ] || fail "a file of somebody else is gone"
