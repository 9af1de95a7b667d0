# Decks with phases and with a reaction give the same bytes on any number of servers.
# timeout: 120
. "$DM2_SRC/tests/lib.sh"

case $FLAVOUR in
release) counts='1 2 4 7' front=700 band=900 rod=2500 ;;
*) counts='3' front=60 band=60 rod=60 ;; # slower by far
esac

for deck in phase-front shear-band heat-rod; do
    case $deck in
    phase-front) steps=$front ;;
    heat-rod) steps=$rod ;;
    *) steps=$band ;;
    esac
    set -- "$DM2_SRC/input/$deck.dm2" -q --steps "$steps"
    [ "$deck" != shear-band ] || set -- "$@" -D 'start=900 K' # reacts from the start
    expect_status 0 "$DM2_BIN/dm2-seq" "$@" -o "seq-$deck"
    for n in $counts; do
        expect_status 0 "$DM2_BIN/dm2-client" "$@" -n "$n" -o run --overwrite
        same_bytes "seq-$deck/final.dm2" run/final.dm2
        same_bytes "seq-$deck/history.csv" run/history.csv
        for file in "seq-$deck"/snapshots/*; do
            same_bytes "$file" "run/snapshots/${file##*/}"
        done
    done
done

# dm2-plot draws the arrays of these decks.
expect_status 0 "$DM2_BIN/dm2-plot" snapshot seq-phase-front/snapshots/state-000000000.vtp -c phase -o \
    phase.svg
expect_status 0 "$DM2_BIN/dm2-plot" snapshot seq-shear-band/snapshots/state-000000000.vtp -c composition -o \
    composition.svg
expect_text composition.svg 'mass fraction of the product'
expect_text phase.svg 'phase 0'
expect_status 0 "$DM2_BIN/dm2-plot" chart seq-heat-rod/profile-rod.csv --x x --y temperature --by time -o \
    rod.svg
expect_status 0 "$DM2_BIN/dm2-plot" chart seq-shear-band/history.csv --x time --y thermal,chemical -o \
    energies.svg

# Something happened: elements changed their phase, melted, reacted.
column()
{
    awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ "^" name " ") at = i }
        NR == 2 { first = $at } END { print (first == $at) ? "same" : "changed" }' "$2"
}
[ "$(column phase seq-phase-front/history.csv)" = changed ] || fail "no element changed its phase"
[ "$FLAVOUR" != release ] || awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ "^phase ") at = i }
    END { exit !($at > 1e-4) }' seq-shear-band/history.csv || fail "nothing melted"
[ "$(column chemical seq-shear-band/history.csv)" = changed ] || fail "nothing reacted"
[ "$(column thermal seq-heat-rod/history.csv)" = same ] || fail "heat was lost"
