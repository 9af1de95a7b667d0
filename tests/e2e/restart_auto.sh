# --restart auto: begins, goes on, gives tables their names, extends, or finds all done, as the run directory
# has it; what is refused stays untouched. A run that TERM ends at random moments, with --restart auto
# between, gives the bytes of the uninterrupted run: TERMS=100 takes a hundred moments, by hand.
# labels: e2e bits
# timeout: 900
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
cat >deck.dm2 <<'END'
# Two copper discs; a piston of speed `push` follows.
let push = 0.01
let d = 0.04 cm
domain { size = 3 cm, 1 cm; r_c = 2.5*d; delta_r = 0.25*d; boundary = periodic free }
time { dt = 0.02 us; steps = 400 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489; tensile = 3 kbar }
body piston {
    shape = rectangle 0.1 cm, 0.2 cm, 0.2 cm, 0.8 cm; spacing = d
    material = Cu; motion = driven; velocity = push, 0
}
body left { shape = disc 0.7 cm, 0.5 cm, 0.2 cm; spacing = d; material = Cu; velocity = 0.02, 0 }
body right { shape = disc 1.5 cm, 0.5 cm, 0.2 cm; spacing = d; origin = 1.5 cm, 0.5 cm; material = Cu }
profile x { axis = x; bins = 4; every = 6 }
output { history_every = 7; snapshot_every = 110; snapshot_at = 37 }
END
sed 's/; every = 6//; s/history_every = 7; //' deck.dm2 >plain.dm2 # with default intervals

results='final.dm2 history.csv profile-x.csv fragments.csv schedule.csv snapshots/series.pvd'
# same_run A B: every result is the same, and nothing is left.
same_run()
{
    for file in $results; do
        same_bytes "$1/$file" "$2/$file"
    done
    [ -z "$(find "$2" -name '*.part' -o -name .lock)" ] || fail "$(find "$2") was left"
}
# print_of DIR: every name below it with content and time.
print_of()
{
    find "$1" -type f -exec cksum {} + | sort -k 3
    find "$1" -type f -exec ls -l {} +
}
expect_status 0 "$seq" deck.dm2 -q -o whole
expect_status 0 "$seq" deck.dm2 -q -o half --steps 200 --checkpoint-every 90
[ -f half/checkpoint.prev.dm2 ] || fail 'no two checkpoints'
same_bytes deck.dm2 whole/deck.dm2

# --- begins ---
expect_status 0 "$seq" deck.dm2 -q -o absent --restart auto
same_run whole absent
mkdir empty
expect_status 0 "$client" -n 2 deck.dm2 -q -o empty --restart auto
same_run whole empty
mkdir -p killed/snapshots
cp half/deck.dm2 half/run.log half/schedule.csv killed
cp half/checkpoint.dm2 killed/checkpoint.next.dm2
cp half/history.csv killed/history.csv.part
cp half/snapshots/* killed/snapshots
echo '<?' >killed/snapshots/state-000000123.vtp.part
printf 'dm2 writes in this directory\nprocess: 1\n' >killed/.lock
expect_status 0 "$seq" deck.dm2 -o killed --restart auto
expect_text err 'killed: has tables of a run that ended before its first checkpoint: begun anew'
same_run whole killed

# --- goes on ---
# leave DIR: the directory as TERM or a crash leaves it at step 180.
leave()
{
    rm -rf "$1"
    cp -R half "$1"
    rm "$1/final.dm2" "$1/timing.csv"
    for table in history profile-x fragments; do
        mv "$1/$table.csv" "$1/$table.csv.part"
    done
}
leave on
expect_status 0 "$client" -n 3 deck.dm2 -o on --restart auto
expect_text err 'on/checkpoint.dm2: going on from step 180'
same_run whole on
[ "$(grep -c '^program: ' on/run.log)" -eq 2 ] || fail "$(cat on/run.log)"
expect_text on/run.log 'from: step 180, on/checkpoint.dm2, SHA-256 '
[ "$(grep -c '^ended: done$' on/run.log)" -eq 2 ] || fail "$(cat on/run.log)"
leave on
printf '\377' | dd of=on/checkpoint.dm2 bs=1 seek=4000 conv=notrunc 2>dd.log
expect_status 0 "$seq" deck.dm2 -o on --restart auto
expect_text err 'on/checkpoint.dm2: is damaged'
expect_text err 'going on from step 90, on/checkpoint.prev.dm2'
same_run whole on
leave on
rm on/checkpoint.dm2 # a crash between the two renames of a checkpoint
expect_status 0 "$seq" deck.dm2 -q -o on --restart auto
same_run whole on

# --- is complete, or lacks the names of its tables ---
print_of whole >before
expect_status 0 "$seq" deck.dm2 -o whole --restart auto
expect_text out 'complete: whole has the results of all 400 steps'
expect_status 0 "$client" -n 2 deck.dm2 -o whole --restart auto
expect_text out 'complete: whole'
print_of whole >after
cmp before after || fail 'a complete run was touched'
for tables in 'history.csv' 'history.csv profile-x.csv fragments.csv'; do
    for program in "$seq" "$client -n 2"; do
        rm -rf unnamed
        cp -R whole unnamed
        for table in $tables; do
            sed '/^400,/d' "unnamed/$table" >"unnamed/$table.part"
            rm "unnamed/$table"
        done
        # shellcheck disable=SC2086 # a program and its option
        expect_status 0 $program deck.dm2 -q -o unnamed --restart auto
        same_run whole unnamed
    done
done

# --- extends ---
for program in "$seq" "$client -n 2"; do
    rm -rf longer
    cp -R half longer
    # shellcheck disable=SC2086
    expect_status 0 $program deck.dm2 -q -o longer --restart auto
    same_run whole longer
    same_bytes whole/deck.dm2 longer/deck.dm2
done
rm -rf longer
cp -R half longer
mv longer/final.dm2 longer/checkpoint.dm2 # a crash before the tables lost their names
expect_status 0 "$seq" deck.dm2 -q -o longer --restart auto
same_run whole longer
# Default intervals follow from the steps: the rows before the step stay as they were.
expect_status 0 "$seq" plain.dm2 -q -o plain --steps 40
cp -R plain rows
expect_status 0 "$seq" plain.dm2 -q -o rows --restart auto
awk 'BEGIN { for (s = 0; s <= 400; s += s < 40 ? 2 : 20) print s }' >steps
cut -d , -f 1 rows/profile-x.csv | sed 1d | uniq | cmp - steps || fail 'other rows than expected'
expect_text rows/schedule.csv '0,profile-x.csv,2,'
expect_text rows/schedule.csv '40,profile-x.csv,20,'
sed '/^40,/,$d' plain/profile-x.csv >kept
head -n "$(wc -l <kept)" rows/profile-x.csv | cmp - kept || fail 'rows before the step changed'
# An interruption behind the change of the schedule.
cp -R plain cut
expect_status 0 "$seq" plain.dm2 -q -o cut --restart auto --checkpoint-every 150
rm cut/final.dm2
expect_status 0 "$seq" plain.dm2 -q -o cut --restart auto
same_run rows cut

# --- another text of the same meaning, another schedule ---
leave on
sed 's/^# Two copper.*/# Two discs of copper/; s/$/\r/' deck.dm2 >crlf.dm2
expect_status 0 "$seq" crlf.dm2 -q -o on --restart auto
same_run whole on
leave on
sed 's/history_every = 7/history_every = 5/; s/snapshot_at = 37/snapshot_at = 37, 205/' deck.dm2 >looks.dm2
expect_status 0 "$seq" looks.dm2 -q -o on --restart auto
awk 'BEGIN { for (s = 0; s <= 400; s += s < 175 ? 7 : 5) print s }' >steps
cut -d , -f 1 on/history.csv | sed 1d | cmp - steps ||
    fail 'the schedule of history.csv did not change at 180'
[ "$(cut -d , -f 1 on/fragments.csv | tr '\n' ' ')" = 'step 0 37 110 205 220 330 ' ] ||
    fail "$(cat on/fragments.csv)"
expect_text on/schedule.csv '180,history.csv,5,'
expect_text on/schedule.csv '180,fragments.csv,110,37 205'
same_bytes whole/final.dm2 on/final.dm2
# Snapshots of the old schedule that the new one has not: gone, with their lines in the series.
leave on
cp whole/snapshots/* on/snapshots
sed 's/snapshot_every = 110; //; s/snapshot_at = 37/snapshot_at = 37, 205/' deck.dm2 >fewer.dm2
expect_status 0 "$seq" fewer.dm2 -q -o on --restart auto
[ "$(cd on/snapshots && echo *)" = 'series.pvd state-000000000.vtp state-000000037.vtp state-000000110.vtp'\
' state-000000205.vtp' ] || fail "$(ls on/snapshots)"
[ "$(grep -c '<DataSet ' on/snapshots/series.pvd)" -eq 4 ] || fail "$(cat on/snapshots/series.pvd)"

# --- deck.dm2 gives the same bytes anywhere ---
mkdir -p parts/sub elsewhere
grep '^material' deck.dm2 >parts/sub/copper.dm2
sed 's/^material.*/include "sub\/copper.dm2"/' deck.dm2 >parts/main.dm2
expect_status 0 "$seq" parts/main.dm2 -q -o first -D push=0.02 -D 'd=0.05 cm' --steps 100
mv first/deck.dm2 elsewhere/other.dm2
expect_status 0 "$client" -n 2 elsewhere/other.dm2 -q -o second
same_run first second
same_bytes elsewhere/other.dm2 second/deck.dm2
expect_text elsewhere/other.dm2 'let push = 0.02 # -D, was 0.01'
expect_text elsewhere/other.dm2 '# end "sub/copper.dm2"'

# --- a block stop has ended the run ---
(cat deck.dm2 && echo 'stop { kinetic = 1e9; after = 1 us }') >stop.dm2
expect_status 0 "$seq" stop.dm2 -q -o stopped
expect_text stopped/schedule.csv '59,stop,0,'
print_of stopped >before
expect_status 0 "$seq" stop.dm2 -o stopped --restart auto
expect_text out 'complete: stopped has the results of all 59 steps'
print_of stopped >after
cmp before after || fail 'a stopped run was touched'
expect_status 0 "$seq" deck.dm2 -q -o stopped --restart auto # without the block, the run goes on
same_run whole stopped

# --- refuses, and touches nothing ---
# refused STATUS TEXT DIR OPTION...
refused()
{
    want=$1 text=$2 directory=$3
    shift 3
    print_of "$directory" >before
    expect_status "$want" "$seq" deck.dm2 -o "$directory" --restart auto "$@"
    expect_text err "$text"
    print_of "$directory" >after
    cmp before after || fail "$directory was touched: $text"
}
refused 2 'whole/final.dm2: is of step 400, the deck ends at 200' whole --steps 200
other='belongs to another deck: `velocity` of body piston was 0.01 0, is 0.02 0 cm/us'
refused 2 "half/final.dm2: $other" half -D push=0.02
leave bad
for state in checkpoint checkpoint.prev; do
    printf '\377' | dd of=bad/$state.dm2 bs=1 seek=4000 conv=notrunc 2>dd.log
done
refused 1 'bad/checkpoint.dm2: is damaged' bad
expect_text err 'bad/checkpoint.prev.dm2: is damaged'
leave bad
sed '20d' bad/history.csv.part >row && mv row bad/history.csv.part
refused 3 'history.csv.part: the row of step 126 is missing' bad
leave bad
sed 's/,0\.375,/,0.3751,/' bad/profile-x.csv.part >row && mv row bad/profile-x.csv.part
refused 2 'its bins are others than those of the profile' bad
mkdir other
echo mine >other/notes
refused 1 'other: the run directory is not empty; name another one' other
expect_status 1 "$seq" deck.dm2 -o half
expect_text err 'go on from its state with --restart auto, name another one with -o DIR, or give --overwrite'
expect_status 2 "$seq" deck.dm2 -o half --restart auto --overwrite
expect_text err '--overwrite removes it: give one of the two'
[ ! -e half/.lock ] || fail 'the lock is left'

# --- TERM at random moments ---
# The requeue loop of docs/reliability.md, and its scheduler.
sed -n '/^until dm2-client/,/^done/p' "$DM2_SRC/docs/reliability.md" >loop
[ -s loop ] || fail 'docs/reliability.md has no requeue loop'
expect_status 0 env PATH="$DM2_BIN:$PATH" sh loop
same_run whole r.run

sed 's/steps = 400/steps = 4000/; s/snapshot_every = 110/snapshot_every = 1100/' deck.dm2 >long.dm2
expect_status 0 "$seq" long.dm2 -q -o straight
want=${TERMS:-10} terms=0 early=0 rounds=0
# moment N: seconds until the Nth signal; a whole run takes some 0.2 s.
moment()
{
    awk -v n="$1" 'BEGIN { srand(n * 7919); rand(); printf "%.3f", 0.1 * rand() }'
}
while [ $terms -lt "$want" ]; do
    rm -rf cut
    rounds=$((rounds + 1))
    [ $rounds -le $((20 + want)) ] || fail "$terms signals in $rounds runs: the run is too short"
    got=4
    while [ $got -eq 4 ]; do
        case $((terms % 3)) in
        0) set -- "$client" -n 2 ;;
        *) set -- "$seq" ;;
        esac
        "$@" long.dm2 -q -o cut --restart auto 2>err &
        pid=$!
        sleep "$(moment $((terms + early + rounds)))"
        kill -TERM $pid 2>kill.err
        got=0
        wait $pid || got=$?
        if [ $got -eq 143 ] && [ ! -s err ]; then # before main
            early=$((early + 1)) got=4
        elif [ $got -eq 4 ]; then
            terms=$((terms + 1))
            expect_text err 'the same command with --restart auto goes on'
        elif [ $got -ne 0 ]; then
            cat err
            fail "status $got after $terms signals"
        fi
    done
    same_run straight cut
done
echo "$terms signals in $rounds runs, $early more before main"
