# Numbers that go wrong end a run of either program, with step, element and place, and with the command that
# continues from the last checkpoint; no step is repeated.
. "$DM2_SRC/tests/lib.sh"
deck=$DM2_SRC/tests/decks/run/scatter.dm2
place='at ([0-9.e+-]*, [0-9.e+-]*) cm'

# breaks REGEX OPTION...: the run ends with status 1 and one line of standard error matches.
breaks()
{
    said=$1
    shift
    for program in "$DM2_BIN/dm2-seq" "$DM2_BIN/dm2-client -n 1" "$DM2_BIN/dm2-client -n 3"; do
        rm -rf run
        # shellcheck disable=SC2086 # the words of the program
        expect_status 1 $program "$@" -q -o run --checkpoint-every 2
        grep -q "$said" err || { cat err; fail "$program $*: nothing says '$said'"; }
        grep -q 'the last checkpoint is of step [0-9]*; to continue: ' err ||
            { cat err; fail "$program $*: no advice"; }
        [ -f run/checkpoint.dm2 ] || fail "$program $*: no checkpoint"
        [ ! -f run/final.dm2 ] && [ ! -f run/history.csv ] || fail "$program $*: results"
    done
}

# Too fast: gravity makes elements cross a cell in one step, some steps later.
sed 's/^domain {/&\n  gravity = 0 -5/' "$deck" >falling.dm2
breaks "step 64: element [0-9]* $place would move further than a cell edge in one step" falling.dm2
# Too strong: two atoms fly at each other and stand in one place after ten steps.
breaks 'step 10: the force between elements [01] and [01], near (15, 10) cm, is out of range' \
    "$DM2_SRC/tests/decks/run/meeting.dm2"

# A server that counts an element more than it owns, from step 5 on.
mkdir losing
ln -s "$DM2_BUILD/failing/losing-server" losing/dm2-server
ln -s "$DM2_BIN/dm2-client" losing/dm2-client
expect_status 1 losing/dm2-client "$deck" -q -n 2 -o lost --checkpoint-every 2 --copy-every 0
grep -E -q 'step 5: the servers hold [0-9]+ elements together instead of [0-9]+$' err ||
    { cat err; fail 'nobody counts'; }
expect_text err 'the last checkpoint is of step 4; to continue: '
[ ! -f lost/final.dm2 ] || fail 'a result'

# A server whose updates have an impossible position or velocity does not count as lost.
mkdir spoiling
ln -s "$DM2_BUILD/failing/spoiling-server" spoiling/dm2-server
ln -s "$DM2_BIN/dm2-client" spoiling/dm2-client
for spoil in '0 nan' '1 inf' '2 -inf' '3 nan' '0 1e300' '1 -9'; do
    case $spoil in
    *n*) what='is not finite' ;;
    *) what='puts it further than a cell edge away' ;;
    esac
    rm -rf spoiled
    expect_status 1 env DM2_SPOIL="$spoil" spoiling/dm2-client "$deck" -q -n 2 -o spoiled --checkpoint-every 2
    grep -q "step [0-9]*: the update of element [0-9]* from server [01], last $place, $what" err ||
        { cat err; fail "$spoil: nobody sees it"; }
    grep -q 'the last checkpoint is of step [46]; to continue: ' err || { cat err; fail "$spoil: no advice"; }
    [ ! -f spoiled/final.dm2 ] && [ ! -f spoiled/history.csv ] || fail "$spoil: results"
done

# Nor does a server that gets a parcel with an element that cannot be, whoever sent the parcel.
mkdir forging
ln -s "$DM2_BUILD/failing/forging-server" forging/dm2-server
ln -s "$DM2_BIN/dm2-client" forging/dm2-client
for forge in mass twice; do
    rm -rf forged
    expect_status 1 env DM2_FORGE=$forge \
        forging/dm2-client "$deck" -q -n 2 -o forged --checkpoint-every 2
    case $forge in
    mass) why='got a parcel from rank . with a value that cannot be: element [0-9]* has mass .*expected' ;;
    *) why='element [0-9]* came twice to server [01]' ;;
    esac
    grep -q "server [01] of 2, step [0-9]*: .*$why" err || { cat err; fail "$forge: nobody sees it"; }
    ! grep -q 'going on' err || { cat err; fail "$forge: the server counts as lost"; }
    expect_text err 'the last checkpoint is of step '
done

# Two runs part where an element reaches a side that is open in one run only.
sed 's/boundary = periodic periodic/boundary = free free/' "$deck" >open.dm2
expect_status 0 "$DM2_BIN/dm2-client" open.dm2 -n 2 -q --steps 120 --hash-every 10 -o open
mv out open.txt
expect_status 0 "$DM2_BIN/dm2-seq" "$deck" -q --steps 120 --hash-every 10 -o closed
mv out closed.txt
expect_status 1 sh "$DM2_SRC/scripts/dm2-first-difference" open.txt closed.txt
expect_text out 'step 100 differs: '
expect_text out 'step 90 is the last that is alike'
expect_status 0 "$DM2_BIN/dm2-client" "$deck" -n 3 -q --steps 120 --hash-every 10 -o again
mv out again.txt
expect_status 0 sh "$DM2_SRC/scripts/dm2-first-difference" again.txt closed.txt
expect_text out '13 steps are alike, the last is 120'
