# Every deck of input/: from each of its checkpoints, with another number of servers each time, to the same bytes as without.
# Here the decks are small and short; RESTARTS=whole takes them as they are, with four checkpoints each, in some minutes.
# labels: e2e bits
# timeout: 7200
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
whole=${RESTARTS:-}

# small DECK: what makes it small.
small()
{
    case $1 in
    granular-shear) echo '-D solid=0.6' ;;
    lj-lattice) echo '-D n=400' ;;
    timing) echo '-D n=400' ;;
    esac
}

decks=0 restarts=0
for deck in "$DM2_SRC"/input/*.dm2; do
    name=$(basename "$deck" .dm2)
    if [ "$whole" = whole ]; then
        options=
        expect_status 0 "$client" "$deck" -n 1 --check
        steps=$(sed -n 's/^ *steps *\([0-9]*\) .*/\1/p' out)
        every=$((steps / 5))
    else
        options=$(small "$name")
        steps=13 every=6
    fi
    rm -rf straight
    # shellcheck disable=SC2086 # the words of the options
    expect_status 0 "$seq" "$deck" $options --steps "$steps" -q -o straight
    at=$every n=2
    while [ "$at" -lt "$steps" ]; do
        rm -rf run
        # The checkpoint of step `at`, left by one program, taken up by the other.
        expect_status 0 "$client" "$deck" $options -q -n "$n" -o run --steps $((at + 1)) --checkpoint-every "$every"
        n=$((n % 5 + 1))
        if [ "$n" -eq 1 ]; then
            expect_status 0 "$seq" "$deck" $options -q --steps "$steps" --restart run/checkpoint.dm2
        else
            expect_status 0 "$client" "$deck" $options -q -n "$n" --steps "$steps" --restart run/checkpoint.dm2
        fi
        for file in straight/final.dm2 straight/*.csv; do
            [ "$file" = straight/timing.csv ] || same_bytes "$file" "run/${file##*/}"
        done
        restarts=$((restarts + 1)) at=$((at + every))
    done
    decks=$((decks + 1))
done
echo "$decks decks, $restarts restarts"
[ "$decks" -ge 10 ] && [ "$restarts" -ge $((2 * decks)) ] || fail 'too few'
