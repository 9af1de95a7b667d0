# Any number of servers, either balance and any moment of rebuilds give the bits of the sequential program.
# timeout: 120
. "$DM2_SRC/tests/lib.sh"

decks=$DM2_SRC/tests/decks/run
case $FLAVOUR in
release) counts='1 2 3 4 5 7 8 9' steps=150 few=1000 ;;
*) counts='1 3 8' steps=50 few=10 ;; # slower by far
esac

# same_run DIR DIR: compares all files that must not depend on the servers.
same_run()
{
    same_bytes "$1/final.dm2" "$2/final.dm2"
    same_bytes "$1/history.csv" "$2/history.csv"
    for file in "$1"/snapshots/*; do
        same_bytes "$file" "$2/snapshots/${file##*/}"
    done
}

migrants=0
for deck in impact scatter; do
    expect_status 0 "$DM2_BIN/dm2-seq" "$decks/$deck.dm2" -q -o "seq-$deck" --hash-every 40 --steps "$steps"
    mv out "hashes-$deck"
    [ "$(wc -l <"hashes-$deck")" -ge 3 ] || fail "no hashes"
    [ -f "seq-$deck/snapshots/series.pvd" ] || fail "no snapshots to compare"
    for n in $counts; do
        for balance in space particles; do
            expect_status 0 "$DM2_BIN/dm2-client" "$decks/$deck.dm2" -q -n "$n" --balance "$balance" -o run \
                --overwrite \
                --hash-every 40 --steps "$steps"
            same_run "seq-$deck" run
            same_bytes "hashes-$deck" out
            migrants=$((migrants + $(sed -n 's/^migrants: //p' run/run.log)))
        done
    done
done
[ "$migrants" -ge "$few" ] || fail "only $migrants elements changed their owner in all runs"

# An early or late rebuild changes nothing: a first step that outruns its margin (asked for again as a
# rebuild), a rebuild every step, and every third one.
expect_status 0 "$DM2_BIN/dm2-seq" "$decks/scatter.dm2" -q -o seq-narrow -D reach=0.0421 -D delta=0.001 \
    --steps 40
expect_status 0 "$DM2_BIN/dm2-client" "$decks/scatter.dm2" -q -n 4 -o narrow -D reach=0.0421 -D delta=0.001 \
    --steps 40
same_run seq-narrow narrow
expect_text narrow/run.log 'rebuilds: 40, of them 1 with a second round trip'
for change in 'search = cells' 'rebuild_every = 3' 'search = lists'; do
    sed "s/^  delta_r = delta/&\\
  $change/" "$decks/scatter.dm2" >changed.dm2
    expect_status 0 "$DM2_BIN/dm2-client" changed.dm2 -q -n 3 -o changed --overwrite --steps "$steps"
    same_bytes seq-scatter/history.csv changed/history.csv
    for file in seq-scatter/snapshots/*; do
        same_bytes "$file" "changed/snapshots/${file##*/}"
    done
done
