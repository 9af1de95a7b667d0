# Every deck of input/ continues from each of its checkpoints, with another number of servers each time, to
# the bytes of the straight run. The decks are small and short here; RESTARTS=whole takes whole decks, with
# four checkpoints each, in some minutes.
# labels: e2e bits
# timeout: 7200
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
whole=${RESTARTS:-}

# small DECK: the options that make the deck small.
small()
{
    case $1 in
    granular-shear) echo '-D solid=0.6' ;;
    biaxial) echo '-D columns=12' ;;
    lj-lattice) echo '-D n=400' ;;
    timing) echo '-D n=400' ;;
    esac
}

# run_with N OPTION...: on N servers; with 1, the sequential program.
run_with()
{
    servers=$1
    shift
    # shellcheck disable=SC2086 # the words of the options
    if [ "$servers" -eq 1 ]; then
        expect_status 0 "$seq" "$deck" $options -q "$@"
    else
        expect_status 0 "$client" "$deck" $options -q -n "$servers" "$@"
    fi
}

# Directories copy-1, copy-2, ... with a checkpoint each. A short run ends one step behind it.
leave_short()
{
    copies=0 at=$every
    while [ "$at" -lt "$steps" ]; do
        copies=$((copies + 1))
        run_with $((1 + (decks + copies) % 5)) -o copy-$copies --steps $((at + 1)) --checkpoint-every "$every"
        at=$((at + every))
    done
}
# The directory of a whole deck is copied while its client is stopped at any point, as after a crash.
leave_whole()
{
    copies=0
    mkfifo hashes
    # shellcheck disable=SC2086 # the words of the options
    "$client" "$deck" $options -q -n 2 -o run --checkpoint-every "$every" --hash-every $((every / 2)) \
        >hashes 2>err </dev/null &
    pid=$!
    exec 4<hashes
    while IFS= read -r line <&4; do
        kill -STOP $pid 2>kill.err
        if [ -f run/checkpoint.dm2 ] && { [ $copies -eq 0 ] ||
            ! cmp -s run/checkpoint.dm2 copy-$copies/checkpoint.dm2; }; then
            copies=$((copies + 1))
            cp -R run copy-$copies
        fi
        kill -CONT $pid 2>kill.err
    done
    exec 4<&-
    wait $pid || fail "$name: $(cat err)"
    rm -r hashes run
}

decks=0 restarts=0
for deck in "$DM2_SRC"/input/*.dm2; do
    name=$(basename "$deck" .dm2)
    if [ "$whole" = whole ]; then
        options=
        expect_status 0 "$client" "$deck" -n 1 --check
        steps=$(sed -n 's/^ *steps *\([0-9]*\) .*/\1/p' out)
        every=$((steps / 5))
        leave_whole
    else
        options=$(small "$name")
        steps=13 every=6
        leave_short
    fi
    run_with 1 --steps "$steps" -o straight
    k=0
    while [ $k -lt $copies ]; do
        k=$((k + 1))
        run_with $((1 + (decks + 2 * k) % 5)) --steps "$steps" --restart copy-$k/checkpoint.dm2
        for file in straight/final.dm2 straight/*.csv; do
            [ "$file" = straight/timing.csv ] || same_bytes "$file" "copy-$k/${file##*/}"
        done
        restarts=$((restarts + 1))
    done
    echo "$name: $steps steps, $copies checkpoints"
    rm -r straight copy-*
    decks=$((decks + 1))
done
echo "$decks decks, $restarts restarts"
[ "$decks" -ge 10 ] && [ "$restarts" -ge $((2 * decks)) ] || fail 'too few'
