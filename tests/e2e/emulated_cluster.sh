# The emulated cluster: a run through it gives the same bits, and nothing is left behind, whatever happens.
. "$DM2_SRC/tests/lib.sh"
script=$DM2_SRC/scripts/emulated-cluster
export DM2_BIN

expect_status 2 sh "$script" 10baset
expect_status 2 sh "$script" token-ring 2 true
expect_status 2 sh "$script" fast 0 true

status=0
sh "$script" fast 1 true >out 2>err || status=$?
[ "$status" -ne 77 ] || skip "$(sed -e 's/^skipped: //' out)"
[ "$status" -eq 0 ] || { cat out err; fail "exit status $status"; }

deck=$DM2_SRC/tests/decks/run/scatter.dm2
expect_status 0 sh "$script" unlimited 2 sh -c "\"$DM2_BIN/dm2-client\" \"$deck\" -q -o far --steps 10 --hosts \"\$HOSTS\" --key \"\$KEY\""
expect_status 0 "$DM2_BIN/dm2-seq" "$deck" -q -o here --steps 10
same_bytes far/final.dm2 here/final.dm2

# left PID: nothing of the script with this id is there.
left()
{
    ! ip netns list | grep -q "^dm2e$1-" || { ip netns list; fail "namespaces are left"; }
}
sh "$script" fast 2 false >out 2>err &
pid=$!
status=0
wait "$pid" || status=$?
[ "$status" -eq 1 ] || fail "the command's exit status is lost: $status"
left "$pid"

mkfifo started
sh "$script" fast 2 sh -c 'echo up >started; exec sleep 50' >out 2>err &
pid=$!
read -r line <started
[ "$line" = up ] || fail "the command did not start"
kill -TERM "$pid"
status=0
wait "$pid" || status=$?
[ "$status" -eq 143 ] || fail "exit status $status after a signal"
left "$pid"
