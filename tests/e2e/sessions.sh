# A server keeps no descriptor and no memory over a hundred sessions in a row, good and bad.
. "$DM2_SRC/tests/lib.sh"

[ -r /proc/self/status ] && [ -d /proc/self/fd ] || skip \
    "this system has no /proc to read descriptors and memory from"
deck=$DM2_SRC/tests/decks/run/scatter.dm2

# Linux shows the descriptors of a process without a core to root alone; test_strangers counts them for all.
descriptors()
{
    if [ -r "/proc/$SERVER_PID/fd" ]; then ls "/proc/$SERVER_PID/fd" | wc -l; else echo unknown; fi
}
memory() # resident, kB
{
    sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$SERVER_PID/status"
}
session() # OPTION...
{
    expect_status 0 "$DM2_BIN/dm2-client" "$deck" -q --server "$SERVER_ADDR" -o run --overwrite --steps 4 "$@"
}

start_server --deck-dir "$DM2_SRC/tests/decks/run"
for k in 1 2 3 4 5 6 7 8 9 10; do # until the allocator has what it needs
    session --send-deck
done
fds=$(descriptors)
before=$(memory)
count=0
while [ "$count" -lt 100 ]; do
    count=$((count + 1))
    case $((count % 4)) in
    0) session --send-deck ;;
    1) session ;;
    2) session --hash-every 1 ;;
    3) printf 'GET / HTTP/1.0\r\n\r\n' | "$DM2_BUILD/tools/tcp" send "$SERVER_PORT" >reply ;;
    esac
done
session # the one before it is over for certain
[ "$(descriptors)" = "$fds" ] || fail "$(descriptors) descriptors, $fds before"
after=$(memory)
[ "$FLAVOUR" = asan ] || [ "$after" -le $((before + 1024)) ] || fail "$after kB, $before kB before"
[ "$(grep -c ' done: ' "$SERVER_LOG")" -ge 85 ] || fail "not every session is in the log"
