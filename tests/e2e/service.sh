# A server as a service: the unit of docs/security.md is valid, its command line works, and a server leaves no
# file and no core on its machine; its log has time and peer.
. "$DM2_SRC/tests/lib.sh"

awk '/^```ini/ { on = 1; next } /^```/ { on = 0 } on' "$DM2_SRC/docs/security.md" >dm2-server.service
grep -q '^ExecStart=/usr/local/bin/dm2-server ' dm2-server.service || fail 'no unit in docs/security.md'
# With a path and a user that exist.
sed "s|/usr/local/bin|$DM2_BIN|; s/^User=.*/User=daemon/" dm2-server.service >here.service
if command -v systemd-analyze >/dev/null; then
    systemd-analyze verify "$PWD/here.service" 2>said || { cat said; fail 'systemd does not take the unit'; }
    echo 'checked by systemd-analyze'
else
    echo 'systemd-analyze is not there: only the command line is checked'
fi

# The options of the unit, with this test's files.
mkdir decks empty
"$DM2_BIN/dm2-server" --new-key key || fail 'no key'
options=$(sed -n "s|^ExecStart=/usr/local/bin/dm2-server ||p" dm2-server.service |
    sed -e "s|/etc/dm2/key|$PWD/key|; s|/srv/dm2|$PWD/decks|; s|192.168.7.0/24|127.0.0.0/8|" \
        -e 's|--listen 0.0.0.0|--listen 127.0.0.1|')
cp "$DM2_SRC/tests/decks/run/scatter.dm2" .
cd empty || exit 1
# shellcheck disable=SC2086 # the words of the options
start_server $options
find . >../before
for send in '' --send-deck; do
    # shellcheck disable=SC2086 # a word or none
    expect_status 0 "$DM2_BIN/dm2-client" ../scatter.dm2 -q --server "127.0.0.1:$SERVER_PORT" --key ../key \
        -o ../run --overwrite \
        --steps 3 $send
done
rm out err
find . >../after
same_bytes ../before ../after
[ -z "$(find ../decks -type f)" ] || fail 'the server wrote a deck'
! [ -r "/proc/$SERVER_PID/limits" ] || grep -q '^Max core file size *0 *0' "/proc/$SERVER_PID/limits" ||
    fail 'a core is allowed'
stop_server "$SERVER_PID"
[ "$SERVER_STATUS" -eq 0 ] || fail "TERM: exit status $SERVER_STATUS"
line='^20[0-9]{2}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}Z 127\.0\.0\.1:[0-9]+ done: '
[ "$(grep -c -E "$line" "$SERVER_LOG")" -eq 2 ] ||
    { cat "$SERVER_LOG"; fail 'the log'; }
