# scripts/dm2-servers from end to end, with a stand-in for ssh that runs the command on this machine.
. "$DM2_SRC/tests/lib.sh"

script=$DM2_SRC/scripts/dm2-servers
deck=$DM2_SRC/tests/decks/run/impact.dm2
cat >ssh <<'END'
#!/bin/sh
echo "$1" >>hosts-called
HOME=$PWD/home exec sh -c "$2"
END
chmod +x ssh
mkdir home
DM2_SSH=$PWD/ssh DM2_SERVER=$DM2_BIN/dm2-server
export DM2_SSH DM2_SERVER

# Two free ports: the ports of servers that have just ended.
start_server
first=$SERVER_PORT
start_server
second=$SERVER_PORT
stop_all
printf '# two machines\nlocalhost:%s slots=1 # one\n\n127.0.0.1:%s\n' "$first" "$second" >hosts
trap 'sh "$script" stop hosts >/dev/null; stop_all' EXIT

expect_status 1 sh "$script" status hosts
[ "$(grep -c 'does not run' out)" -eq 2 ] || fail "the status before"
expect_status 0 sh "$script" start hosts --timeout 5
expect_text out "localhost:$first: dm2-server: listening on 127.0.0.1:$first, process "
[ "$(cat hosts-called | sort -u | tr '\n' ' ')" = '127.0.0.1 localhost ' ] ||
    fail "called: $(cat hosts-called)"
expect_status 0 sh "$script" start hosts
[ "$(grep -c 'runs already' out)" -eq 2 ] || fail "started twice"
expect_status 0 "$DM2_BIN/dm2-client" "$deck" -q --hosts hosts -o run --steps 3
expect_status 0 sh "$script" status hosts
expect_text out ' done: '
expect_status 0 sh "$script" stop hosts
[ "$(grep -c 'ended process' out)" -eq 2 ] || fail "not stopped"

# With a key in the directory where the servers run; options may hold blanks and quotes.
mkdir "home/.dm2/it's here"
expect_status 0 "$DM2_SERVER" --new-key "home/.dm2/it's here/key"
expect_status 0 sh "$script" start hosts --key "it's here/key" --allow 127.0.0.0/8
expect_status 0 "$DM2_BIN/dm2-client" --status --hosts hosts --key "home/.dm2/it's here/key"
[ "$(grep -c ': free; ' out)" -eq 2 ] || fail "the servers are not free: $(cat out)"
expect_status 3 "$DM2_BIN/dm2-client" --status --hosts hosts
expect_status 0 "$DM2_BIN/dm2-client" "$deck" -q --hosts hosts --key "home/.dm2/it's here/key" -o keyed \
    --steps 3
same_bytes run/final.dm2 keyed/final.dm2
expect_status 3 "$DM2_BIN/dm2-client" "$deck" -q --hosts hosts -o strange --steps 3
expect_status 0 sh "$script" stop hosts
[ "$(grep -c 'ended process' out)" -eq 2 ] || fail "not stopped"

# A taken port, and wrong files: no server is started before the whole file is read.
start_server
printf '127.0.0.1:%s\n' "$SERVER_PORT" >taken
expect_status 1 sh "$script" start taken
expect_text out 'did not start: '
rm hosts-called
printf 'localhost\nlocalhost:x\n' >bad
expect_status 2 sh "$script" start bad
expect_text err "bad:2: the port 'x'"
printf 'localhost slot=2\n' >bad
expect_status 2 sh "$script" stop bad
printf 'a;b\n' >bad
expect_status 2 sh "$script" stop bad
expect_status 2 sh "$script" restart hosts
expect_status 2 sh "$script" start missing
[ ! -e hosts-called ] || fail "something was done"
