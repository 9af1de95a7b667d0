# A few steps of dm2-seq, and of a server and a client, under valgrind: no error, nothing leaked.
# labels: check slow
# timeout: 180
. "$DM2_SRC/tests/lib.sh"

[ "$FLAVOUR" = release ] || skip "the $FLAVOUR flavour does not run under valgrind"
command -v valgrind >/dev/null || skip "there is no valgrind on this system"

# Programs of the same names that run the real ones under valgrind.
memcheck='valgrind -q --leak-check=full --show-leak-kinds=all --errors-for-leak-kinds=all --error-exitcode=99'
mkdir checked
for program in dm2-seq dm2-server dm2-client; do
    printf '#!/bin/sh\nexec %s "%s/%s" "$@"\n' "$memcheck" "$DM2_BIN" "$program" >"checked/$program"
    chmod +x "checked/$program"
done
DM2_BIN=$PWD/checked

deck=$DM2_SRC/input/plate-impact.dm2
expect_status 0 checked/dm2-seq "$deck" -q -D scale=0.5 --steps 12 -o seq
start_server
first=$SERVER_PID first_addr=$SERVER_ADDR first_log=$SERVER_LOG
start_server
expect_status 0 checked/dm2-client "$deck" -q -D scale=0.5 --steps 12 -o dist --server "$first_addr" \
    --server "$SERVER_ADDR"
same_bytes seq/final.dm2 dist/final.dm2

for pair in "$first:$first_log" "$SERVER_PID:$SERVER_LOG"; do
    stop_server "${pair%%:*}"
    [ "$SERVER_STATUS" -eq 0 ] || { cat "${pair#*:}"; fail \
        "a server under valgrind exits with $SERVER_STATUS"; }
done

# A deck that does not read, and an absent server: all memory is freed.
printf 'domain { size = 1 cm\n' >bad.dm2
expect_status 2 checked/dm2-seq bad.dm2
expect_status 3 checked/dm2-client "$deck" -q --server "$first_addr" -o absent
