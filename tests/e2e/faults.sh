# Faults between the client and its servers: the kinds of tests/tools/faults.c, a server that
# echoes every message, and a server that miscounts its elements. `make soak` runs more seeds.
# labels: e2e bits
# timeout: 150
. "$DM2_SRC/tests/lib.sh"
proxy=$DM2_BUILD/tools/proxy
client=$DM2_BIN/dm2-client

sh "$DM2_SRC/tests/soak.sh" -s 135 -n 16 >soak.out || {
    cat soak.out
    fail 'a run through faults did not end as it should'
}
tail -n 16 soak.out
while read -r kind injected rest; do
    [ "$injected" != 0 ] || fail "no fault of the kind $kind happened"
done <soak.out

# tool NAME COMMAND...: starts a program that prints a line first. Sets TOOL_PID and TOOL_LINE; descriptor 5
# is its input, 6 its output.
tool()
{
    mkfifo "$1.in" "$1.out"
    name=$1
    shift
    "$@" <"$name.in" >"$name.out" &
    TOOL_PID=$!
    exec 5>"$name.in" 6<"$name.out"
    IFS= read -r TOOL_LINE <&6
}

# The client gets its own bytes back, without and with a key.
"$DM2_BIN/dm2-server" --new-key key >/dev/null || fail 'no key'
for key in '' '--key key'; do
    tool "mirror${key:+2}" "$DM2_BUILD/tools/tcp" mirror
    expect_status 3 "$client" "$DM2_SRC/tests/decks/good/scatter.dm2" -o reflected --timeout 5 $key \
        --server "127.0.0.1:$TOOL_LINE"
    wait "$TOOL_PID" || fail 'the mirror had no connection'
    case $key in
    '') expect_text err 'it sent HELLO where PLACE is due' ;;
    *) expect_text err 'it sent KNOCK where GRANT is due' ;;
    esac
    [ ! -e reflected/final.dm2 ] || fail 'a reflected run has a result'
    exec 5>&- 6<&-
done

# An element too many: no server is lost, but the count is wrong and the run stops.
start_server
one=$SERVER_PORT
start_server
tool proxy "$proxy" --fault miscount,1,down,0,0,0 "$one" "$SERVER_PORT"
expect_status 1 "$client" "$DM2_SRC/tests/decks/good/scatter.dm2" -o miscounted --copy-every 5 \
    --server "127.0.0.1:${TOOL_LINE% *}" --server "127.0.0.1:${TOOL_LINE#* }"
exec 5>&-
IFS= read -r line <&6
wait "$TOOL_PID"
case $line in
'injected miscount: server 1, down, type 7'*) ;;
*) fail "the proxy says '$line'" ;;
esac
expect_text err 'step 1: the servers hold'
expect_text err 'elements together instead of'
[ ! -e miscounted/final.dm2 ] || fail 'a miscounted run has a result'
exit 0
