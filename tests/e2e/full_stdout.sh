# Standard output that is full, or a pipe that nobody reads: what was asked for is lost, so no program ends
# with 0. The closing lines of a run are no failure of the run.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"

[ -c /dev/full ] || skip 'there is no /dev/full'
deck=$DM2_SRC/tests/decks/good/minimal.dm2
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
expect_status 0 "$seq" "$deck" -q -o good

# A pipe without a reader, as descriptor 6.
mkfifo pipe
exec 5<>pipe 6>pipe 5<&-

# lost COMMAND...: exit status 1 with a line on standard error, on a full device as on a closed pipe.
lost()
{
    for where in full pipe; do
        got=0
        if [ $where = full ]; then
            "$@" >/dev/full 2>err </dev/null 6>&- || got=$?
        else
            "$@" >&6 2>err </dev/null 6>&- || got=$?
        fi
        [ "$got" -eq 1 ] || { cat err; fail "exit status $got ($where) of: $*"; }
        expect_text err 'cannot write to standard output'
    done
}

lost "$seq" --check "$deck"
lost "$client" --check -n 2 "$deck"
lost "$seq" -q --overwrite -o hashed "$deck" --hash-every 10
same_bytes good/final.dm2 hashed/final.dm2
lost "$client" -q -n 2 --overwrite -o hashed "$deck" --hash-every 10
same_bytes good/final.dm2 hashed/final.dm2
start_server
lost "$client" --status --server "$SERVER_ADDR"
for program in dm2-seq dm2-client dm2-server dm2-plot dm2-model; do
    lost "$DM2_BIN/$program" --help
    lost "$DM2_BIN/$program" --version
done
lost "$DM2_BIN/dm2-model" predict --help
lost "$DM2_BIN/dm2-model" predict --preset paper --n 1000
lost "$DM2_BIN/dm2-plot" chart --help
lost "$DM2_BIN/dm2-plot" chart good/history.csv --x step --y kinetic -o plot.svg

# The run itself is whole.
got=0
"$seq" "$deck" -o closing >/dev/full 2>err </dev/null || got=$?
[ "$got" -eq 0 ] || { cat err; fail "exit status $got of a run whose closing lines are lost"; }
same_bytes good/history.csv closing/history.csv
got=0
"$client" "$deck" -n 2 -o closing.2 >&6 2>err </dev/null 6>&- || got=$?
[ "$got" -eq 0 ] || { cat err; fail "exit status $got of a client's run whose closing lines are lost"; }
same_bytes good/history.csv closing.2/history.csv
exit 0
