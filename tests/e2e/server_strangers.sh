# Whatever a client sends, the server logs one line with its reason and serves the next client.
. "$DM2_SRC/tests/lib.sh"

tcp=$DM2_BUILD/tools/tcp
deck=$DM2_SRC/tests/decks/run/scatter.dm2
version=$(sed -n 's/.*PROTOCOL_VERSION = \([0-9]*\).*/\1/p' "$DM2_SRC/include/dm2/cluster/messages.h")
own=$(printf '\\%03o\\000' "$version") # as printf takes it
lines=0

# logged TEXT: the server's log has one line more, which contains TEXT. The server writes the line before it
# takes the next connection, so an exchange of bytes with the next connection is enough to wait for.
logged()
{
    lines=$((lines + 1))
    printf 'x' | "$tcp" send "$SERVER_PORT" >reply || fail "the server is gone"
    [ "$(sed -n "$lines{p;q;}" "$SERVER_LOG" | grep -c -F -e "$1")" -eq 1 ] || {
        cat "$SERVER_LOG"
        fail "line $lines of the log does not say '$1'"
    }
    lines=$((lines + 1)) # the one of the 'x' itself
}

start_server
# A header: magic, version, type, flags, length, checksum.
hello=$own'\001\000'
printf 'GET / HTTP/1.1\r\nHost: x\r\n\r\n' | "$tcp" send "$SERVER_PORT" >reply
logged "does not speak dm2's protocol: its message starts with 'GET '"
head -c 100000 /dev/zero | "$tcp" send "$SERVER_PORT" >reply
logged "does not speak dm2's protocol"
printf '' | "$tcp" send "$SERVER_PORT" >reply
logged 'closed the connection'
printf 'DM2' | "$tcp" send "$SERVER_PORT" >reply
logged 'in the middle of a message'
printf 'DM2\032\143\000\001\000\000\000\000\000\000\000\000\000' | "$tcp" send "$SERVER_PORT" >reply
logged 'speaks protocol version 99, this program version '"$version"
printf 'DM2\032'"$hello"'\000\000\000\377\000\000\000\000' | "$tcp" send "$SERVER_PORT" >reply
logged 'announces a message (type 1) of 4278190080 bytes where at most 1024'
printf 'DM2\032'"$hello"'\004\000\000\000\000\000\000\000abcd' | "$tcp" send "$SERVER_PORT" >reply
logged 'its checksum differs'
printf 'DM2\032'"$own"'\007\000\000\000\000\000\000\000\000\000' | "$tcp" send "$SERVER_PORT" >reply
logged 'its checksum differs'
expect_text "$SERVER_LOG" "127.0.0.1:"

# The server still computes.
expect_status 0 "$DM2_BIN/dm2-client" "$deck" -q --server "$SERVER_ADDR" -o run --steps 5
expect_status 0 "$DM2_BIN/dm2-seq" "$deck" -q -o seq --steps 5
same_bytes seq/final.dm2 run/final.dm2

# The name of a deck does nothing to the terminal that shows the log.
odd=$(printf 'odd\033[1m\177.dm2')
cp "$deck" "$odd"
expect_status 0 "$DM2_BIN/dm2-client" "$odd" -q --server "$SERVER_ADDR" -o odd --steps 3 --send-deck
expect_text "$SERVER_LOG" 'done: odd?[1m?.dm2, rank 0 of 1'

# A server ends on TERM, also while a silent client holds its session.
stop_server "$SERVER_PID"
[ "$SERVER_STATUS" -eq 0 ] || fail "a server that was asked to end exits with $SERVER_STATUS"
start_server
mkfifo hold held
"$tcp" hold "$SERVER_PORT" <hold >held &
holder=$!
exec 3>hold
IFS= read -r line <held
[ "$line" = connected ] || fail "no connection"
stop_server "$SERVER_PID" # while it waits for the silent client
[ "$SERVER_STATUS" -eq 0 ] || fail "a server that was asked to end during a session exits with $SERVER_STATUS"
exec 3>&-
wait "$holder"
