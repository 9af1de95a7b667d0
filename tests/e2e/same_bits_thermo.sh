# Decks with phases and with a reaction give the same bytes on any number of servers.
# timeout: 120
. "$DM2_SRC/tests/lib.sh"

case $FLAVOUR in
release) counts='2 4 7' front=250 band=900 ;;
*) counts='3' front=60 band=60 ;; # slower by far
esac

for deck in phase-front shear-band heat-rod; do
    case $deck in
    phase-front) steps=$front ;;
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

# Something happened: elements changed their phase, melted, reacted.
column()
{
    awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ "^" name " ") at = i }
        NR == 2 { first = $at } END { print (first == $at) ? "same" : "changed" }' "$2"
}
[ "$(column phase seq-phase-front/history.csv)" = changed ] || fail "no element changed its phase"
[ "$(column phase seq-shear-band/history.csv)" = changed ] || fail "nothing melted"
[ "$(column chemical seq-shear-band/history.csv)" = changed ] || fail "nothing reacted"
[ "$(column thermal seq-heat-rod/history.csv)" = same ] || fail "heat was lost"
