# dm2-client --status: the state of each server, also of a busy one; with a key only for clients with the key.
. "$DM2_SRC/tests/lib.sh"

client=$DM2_BIN/dm2-client
tcp=$DM2_BUILD/tools/tcp
deck=$DM2_SRC/tests/decks/run/scatter.dm2
load='dm2 [0-9.]*; load [a-z0-9.]* on [0-9]* cores*$'

# line N REGEX: the Nth line of the status.
line()
{
    sed -n "$1p" out | grep -q "$2" || fail "line $1 is not '$2': $(cat out)"
}

# A free server, and an absent one: the port of an ended server might be given to the next.
gone=127.0.0.1:1
start_server -v
one=$SERVER_ADDR one_port=$SERVER_PORT one_log=$SERVER_LOG
printf '%s\n%s spare\n' "$one" "$gone" >hosts
expect_status 3 "$client" --status --hosts hosts
line 1 "^$one: free; $load"
line 2 "^$gone (spare): not usable: Connection refused"
expect_text err '1 of 2 servers cannot be used'
expect_status 0 "$client" --status --server "$one"
expect_text "$one_log" ' asked for the status'

# A server in session, for which another client waits.
mkfifo hold held notes
"$tcp" hold "$one_port" <hold >held &
holder=$!
exec 3>hold
IFS= read -r text <held
expect_status 0 "$client" --status --server "$one"
line 1 "^$one: busy with 127.0.0.1:[0-9]* since 20[0-9-]*T[0-9:]*Z; $load"
"$client" "$deck" --server "$one" --steps 3 -o run >log 2>notes 3>&- &
waiting=$!
IFS= read -r text <notes
expect_status 0 "$client" --status --server "$one"
line 1 "^$one: busy with 127.0.0.1:[0-9]* since [^;]*; 1 waiting; $load"
exec 3>&-
wait "$holder"
wait "$waiting" || fail 'the waiting client failed'

# A server in the middle of a run, whose client's output fills the pipe. The deck's name is one line of text
# and does nothing to a terminal.
mkfifo hashes
odd=$(printf 'odd\033]0;\n\302\233.dm2')
cp "$deck" "$odd"
"$client" "$odd" --server "$one" -q --steps 100000 --hash-every 1 -o long >hashes 2>err-long &
running=$!
exec 4<hashes
IFS= read -r text <&4
IFS= read -r text <&4
expect_status 0 "$client" --status --server "$one"
line 1 "^$one: busy with .*: rank 0 of 1 of odd?\]0; ??.dm2, step [1-9][0-9]*; $load"
kill -TERM "$running"
exec 4<&-
wait "$running"

# A silent connection does not hold a server, nor does one that sends half a message.
"$tcp" silent "$one_port" <hold >held &
silent=$!
exec 3>hold
IFS= read -r text <held
expect_status 0 "$client" "$deck" -q --server "$one" --steps 3 -o run --overwrite
exec 3>&-
wait "$silent"

# With a key, for clients with the key only.
"$DM2_BIN/dm2-server" --new-key key
"$DM2_BIN/dm2-server" --new-key other
start_server --key key
expect_status 0 "$client" --status --server "$SERVER_ADDR" --key key
line 1 "^$SERVER_ADDR: free; $load"
expect_status 3 "$client" --status --server "$SERVER_ADDR"
line 1 "^$SERVER_ADDR: not usable: it wants a key (--key FILE)\$"
expect_status 3 "$client" --status --server "$SERVER_ADDR" --key other
line 1 "^$SERVER_ADDR: not usable: it has another key, or does not admit this machine\$"
expect_text "$SERVER_LOG" 'who asks for the status has another key'
expect_status 3 "$client" --status --server "$one" --key key
line 1 "^$one: not usable: it has no key"
start_server --allow 10.0.0.0/8
expect_status 3 "$client" --status --server "$SERVER_ADDR"
line 1 'does not admit this machine'

expect_status 2 "$client" --status
expect_text err '--hosts FILE or --server HOST'
expect_status 2 "$client" "$deck" --status --hosts hosts
expect_text err 'runs no deck'
