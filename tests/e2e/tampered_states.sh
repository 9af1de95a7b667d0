# A checkpoint with a sound checksum but an impossible number, or a number that does not fit the deck: both
# programs refuse the checkpoint before the first step, and name the file, the element, the number found and
# the number expected.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
patch=$DM2_BUILD/tools/patch_state
deck=$DM2_SRC/input/plate-impact.dm2 # 4 probes, 2 kinds, no reaction

expect_status 0 "$seq" "$deck" --steps 8 --checkpoint-every 3 -q -o run
[ -f run/checkpoint.prev.dm2 ] || fail 'there is one checkpoint only'

# The tool writes a state file as the programs do.
expect_status 0 "$patch" run/checkpoint.prev.dm2 same.dm2 17 share 0
same_bytes run/checkpoint.prev.dm2 same.dm2

# refused FIELD VALUE TEXT: of element 17.
refused()
{
    rm -rf bad
    mkdir bad
    expect_status 0 "$patch" run/checkpoint.prev.dm2 bad/state.dm2 17 "$1" "$2"
    for program in "$seq" "$client"; do
        expect_status 3 "$program" "$deck" --steps 8 -q --restart bad/state.dm2
        expect_text err ": bad/state.dm2: element 17 $3"
        [ "$(ls bad)" = state.dm2 ] || fail "$(ls bad) in the directory of a state that was refused"
    done
}
refused share 7 'has share 7, 0 to 1 is expected'
refused share -0.25 'has share -0.25, 0 to 1 is expected'
refused probes 16 'belongs to probe 4, counted from 0; the deck has 4'
refused probes 255 'belongs to probe 7, counted from 0; the deck has 4'
refused was 2 'is of a body or a kind that the deck does not have: was 2, counted from 0; the deck has 2'
refused kind 9 'is of a body or a kind that the deck does not have: kind 9, counted from 0; the deck has 2'
refused body 2 'is of a body or a kind that the deck does not have: body 2, counted from 0; the deck has 2'
refused mass 0 'has a radius or a mass that is not positive'
refused heat nan 'has a number that is not finite'
refused flags 2 'has a flag that this program does not know'

# Where the last checkpoint is refused, the checkpoint before it is offered, and leads to the bytes of the
# whole run.
cp -R run broken
rm broken/final.dm2
expect_status 0 "$patch" run/checkpoint.dm2 broken/checkpoint.dm2 3 share 7
expect_status 3 "$seq" "$deck" --steps 8 -q --restart broken/checkpoint.dm2
expect_text err 'broken/checkpoint.dm2: element 3 has share 7, 0 to 1 is expected;
    the one before it can be used, of step'
expect_status 0 "$seq" "$deck" --steps 8 -q --restart broken/checkpoint.prev.dm2
same_bytes run/final.dm2 broken/final.dm2
