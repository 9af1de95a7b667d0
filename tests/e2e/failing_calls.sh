# The Nth allocation, open, write, fsync or rename fails, for every N of a small run: the program succeeds
# with the right result or says what is wrong, and leaves nothing half-written.
# timeout: 120
. "$DM2_SRC/tests/lib.sh"

sed -e 's/spacing = 0.04/spacing = 0.2/' -e 's/r_c = 0.1/r_c = 0.3/' -e 's/delta_r = 0.01/delta_r = 0.05/' \
    "$DM2_SRC/tests/decks/good/minimal.dm2" >small.dm2
expect_status 0 "$DM2_BIN/dm2-seq" small.dm2 -q -o good --steps 3
directory=
for class in memory open write fsync rename; do
    n=0 failed=0
    : >mark
    while [ -f mark ]; do # until the run has no Nth call
        n=$((n + 1))
        rm -f mark
        got=0
        DM2_FAIL=$class:$n DM2_FAIL_MARK=mark "$DM2_BUILD/failing/dm2-seq" small.dm2 -q -o run --steps 3 \
            >out 2>err || got=$?
        [ "$got" -le 3 ] || { cat err; fail "$class $n: exit status $got"; }
        if [ "$got" -eq 0 ]; then
            same_bytes good/final.dm2 run/final.dm2
        else
            failed=$((failed + 1))
            [ -s err ] || fail "$class $n: exit status $got without a word"
            if grep -q "cannot bring the new directory to disk" err; then
                directory=$class:$n
                [ ! -e run ] || fail "$class $n: the directory that is not on disk was left"
            fi
            [ ! -f run/final.dm2 ] || same_bytes good/final.dm2 run/final.dm2
        fi
        [ -z "$(find run -name '*.part' 2>/dev/null)" ] || fail "$class $n: $(find run -name '*.part')"
        rm -rf run
    done
    echo "$class: $((n - 1)) calls, $failed failed cleanly"
    [ "$failed" -gt 0 ] || fail "no $class failed: is the wrapping there?"
    # Two texts of places for errors that do not come, and the program's own place, may be missing. The checks
    # of the debug and asan flavours (force.c) are left out without memory.
    [ "$class" != memory ] || [ "$FLAVOUR" != release ] || [ $((n - 1 - failed)) -le 11 ] ||
        fail "$((n - 1 - failed)) runs went on without an allocation"
done
[ "$directory" = fsync:1 ] || fail \
    "the new run directory is brought to disk by '$directory', not by the first fsync"
