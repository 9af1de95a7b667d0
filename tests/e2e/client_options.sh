# dm2-client and dm2-server besides a run: help, version, --check, hosts files, progress, the choice of
# servers, the wait for a busy server, and the address that a server may listen on.
. "$DM2_SRC/tests/lib.sh"

client=$DM2_BIN/dm2-client
server=$DM2_BIN/dm2-server
deck=$DM2_SRC/tests/decks/run/impact.dm2

for program in "$client" "$server"; do
    expect_status 0 "$program" --help
    expect_text out 'usage: dm2-'
    expect_text out '--version'
    [ ! -s err ] || fail "help on standard error"
    expect_status 0 "$program" --version
    grep -q -E '^dm2-(client|server) [0-9]+\.[0-9]+\.[0-9]+$' out || fail "no version"
done

# --check: elements, cells, time step, subdomains, memory; and nothing is made.
expect_status 0 "$client" "$deck" -n 4 --check
expect_text out 'particles 1760'
expect_text out 'cells 171 = 19 x 9'
expect_text out 'stable time step'
expect_text out 'server 3: particles'
line='^server [0-3]: particles [0-9]*, mirrored [0-9]*, cells [0-9]* = .*, interface [0-9]* cells = '
[ "$(grep -c "$line" out)" -eq 4 ] ||
    fail "not four servers"
[ "$(sed -n 's/^server .: particles \([0-9]*\),.*/\1/p' out | awk '{ n += $1 } END { print n }')" -eq 1760 ] \
    ||
    fail "the servers' elements are not all"
expect_text out 'memory '
[ ! -e impact.run ] || fail "--check made the run directory"
printf 'one:5000 slots=2 # two\ntwo\n' >hosts
expect_status 0 "$client" "$deck" --hosts hosts --check
expect_text out 'server 1 one:5001: particles'
expect_text out 'server 2 two:4702: particles'

# The default: one local server per core, in a directory named after the deck.
expect_status 0 "$client" "$deck" --steps 2
expect_text err 'on this machine, one per core'
expect_text out 'results in impact.run'
grep -q -E '^speed: [0-9.e+]+ element-steps/s$' impact.run/run.log || fail "no speed in run.log"
grep -q -E '^g: [0-9]+ bytes per boundary element' impact.run/run.log || fail "no g in run.log"
expect_text impact.run/timing.csv 'server,host,cells,elements,'

# Progress where it is wanted, and silence.
expect_status 0 "$client" "$deck" -n 2 --steps 2 --overwrite --progress always
expect_text err 'step 2 of 2, 100.0 %'
expect_status 0 "$client" "$deck" -n 2 --steps 2 --overwrite -q
[ ! -s out ] && [ ! -s err ] || fail "--quiet says something"

# Hosts files with servers that are up; a second client waits for a busy server and is told so.
start_server
first=$SERVER_PORT first_pid=$SERVER_PID
start_server
printf '127.0.0.1:%s\nlocalhost:%s # the other\n' "$first" "$SERVER_PORT" >hosts
expect_status 0 "$client" "$deck" --hosts hosts -q --steps 3 --overwrite
mkfifo hold held notes
"$DM2_BUILD/tools/tcp" hold "$first" <hold >held &
exec 3>hold
IFS= read -r line <held
"$client" "$deck" --hosts hosts --steps 3 --overwrite >out 2>notes 3>&- &
waiting=$!
IFS= read -r line <notes
case $line in
*"waiting for 127.0.0.1:$first, which may be serving another client"*) ;;
*) fail "the waiting client says '$line'" ;;
esac
exec 3>&-
wait "$waiting" || fail "the waiting client failed"
kill -0 "$first_pid" || fail "the server is gone"

# A server that other machines could reach without a key is refused.
expect_status 2 "$server" --listen 0.0.0.0 --port 0
expect_text err 'needs a key: dm2-server --new-key FILE'
expect_status 2 "$server" --listen :: --port 0
expect_status 2 "$server" --port 70000
expect_status 2 "$server" extra
expect_status 3 "$server" --port "$first"
expect_text err "cannot listen on 127.0.0.1 port $first"

# --once: one session; without a client it ends by itself.
expect_status 3 "$server" --port 0 --once --timeout 0.2
expect_text err 'no client came within 0.2 s'
