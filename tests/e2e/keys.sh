# Keys: a client with the key is served, off loopback too, with the same results; a client without it learns
# nothing.
. "$DM2_SRC/tests/lib.sh"

client=$DM2_BIN/dm2-client
server=$DM2_BIN/dm2-server
deck=$DM2_SRC/tests/decks/run/scatter.dm2

# A new key: readable by its owner alone, never the same, never over another file.
umask 0
expect_status 0 "$server" --new-key key
[ "$(ls -l key | cut -c 1-10)" = -rw------- ] || fail "the mode: $(ls -l key)"
grep -E -q -x 'dm2-key-1 [0-9a-f]{64}' key || fail "the key's form"
cp key copy
expect_status 2 "$server" --new-key key
expect_text err 'not overwritten'
same_bytes key copy
expect_status 0 "$server" --new-key other
! cmp -s key other || fail "the same key twice"
umask 022

# A key that others can read, or a file that is no key, is not used; off loopback a key is required.
cp key open
chmod 640 open
head -c 50 key >short
tr 0-9 g-p <key >odd
chmod 600 short odd
expect_status 2 "$server" --port 0 --key open
expect_text err 'mode 0640'
expect_status 2 "$client" "$deck" --server 127.0.0.1:1 --key open
expect_text err 'chmod 600'
for wrong in short odd . missing /dev/null; do
    expect_status 2 "$server" --port 0 --key "$wrong"
    expect_status 2 "$client" "$deck" --server 127.0.0.1:1 --key "$wrong"
    expect_text err '--new-key'
done
expect_status 2 "$server" --port 0 --listen 0.0.0.0
expect_text err 'needs a key'
expect_status 2 "$client" "$deck" -n 2 --key key
expect_status 2 "$server" --port 0 --allow 10.0.0.1/8
expect_status 2 "$server" --port 0 --allow ten

# With the key: the bytes of the sequential run.
start_server --listen 0.0.0.0 --key key
one=127.0.0.1:$SERVER_PORT one_log=$SERVER_LOG
start_server --key key --allow 10.0.0.0/8 --allow 127.0.0.0/8
two=$SERVER_ADDR
expect_status 0 "$DM2_BIN/dm2-seq" "$deck" -q -o seq --steps 40
expect_status 0 "$client" "$deck" -q --key key --server "$one" --server "$two" -o run --steps 40
same_bytes seq/final.dm2 run/final.dm2
same_bytes seq/history.csv run/history.csv

# Without the key, or with another: refused without a reason; the server's log has the reason.
expect_status 3 "$client" "$deck" --server "$one" -o none
expect_text err 'refuses the connection: it wants a key (--key FILE), or does not admit this machine'
expect_status 3 "$client" "$deck" --key other --server "$one" -o none
expect_text err 'refuses the connection: it has another key, or does not admit this machine'
expect_status 0 "$client" "$deck" -q --key key --server "$one" -o again --steps 2
expect_text "$one_log" 'the client sent HELLO where KNOCK is due'
expect_text "$one_log" 'the client has another key'

# A client with a key does not trust a server without the key.
start_server
expect_status 3 "$client" "$deck" --key key --server "$SERVER_ADDR" -o none
expect_text err 'the client sent KNOCK where HELLO is due'

# An address that is not allowed is not served.
start_server --allow 10.0.0.0/8 --allow fd00::/8
expect_status 3 "$client" "$deck" --server "$SERVER_ADDR" -o none
expect_text "$SERVER_LOG" 'not among those of --allow'
[ ! -e none/final.dm2 ] || fail "a refused run has results"

# Limits of a server.
start_server --max-steps 10 --max-elements 100
expect_status 2 "$client" "$deck" --server "$SERVER_ADDR" -o none --steps 11
expect_text err 'the deck has 11 time steps, this server takes at most 10'
expect_status 2 "$client" "$deck" --server "$SERVER_ADDR" -o none --steps 10
expect_text err 'this server takes at most 100: dm2-server --max-elements N'
grep -q 'the deck makes [0-9][0-9]* elements, ' err || fail 'the elements were not counted'
# A deck far beyond the limit is refused before its elements are counted.
sed -e 's/spacing = 0.07/spacing = 0.005/; s/radius = 0.02/radius = 0.002/; s/dt = 0.02 us/dt = 0.001 us/' \
    "$deck" >many.dm2
expect_status 2 "$client" many.dm2 --server "$SERVER_ADDR" -o none --steps 10
expect_text err 'the deck makes about 1.92e+05 elements'
