# A run that continues from a checkpoint, by either program, with any number of servers, gives the bytes of
# the uninterrupted run; a damaged checkpoint, or one of another deck, is refused, and the checkpoint before
# it offered.
# labels: e2e bits
# timeout: 120
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
sed 's/output {/output { snapshot_every = 70; checkpoint_every = 90; strain = yes;/
    s/boundary = free free/boundary = periodic periodic/' "$DM2_SRC/tests/decks/good/scatter.dm2" >deck.dm2
echo 'profile across { axis = x; bins = 4; every = 30 }' >>deck.dm2

# same_run A B: every result but times and checkpoints is the same.
same_run()
{
    for file in final.dm2 history.csv fragments.csv profile-across.csv; do
        same_bytes "$1/$file" "$2/$file"
    done
    [ -z "$(find "$2" -name '*.part')" ] || fail "$(find "$2") was left"
}

expect_status 0 "$seq" deck.dm2 -q -o whole
expect_status 0 "$client" deck.dm2 -n 3 -q -o three
same_run whole three
same_bytes whole/checkpoint.dm2 three/checkpoint.dm2
same_bytes whole/checkpoint.prev.dm2 three/checkpoint.prev.dm2
for n in 1 2 5; do
    expect_status 0 "$client" deck.dm2 -n $n -q --restart whole/checkpoint.prev.dm2 -o on-$n
    same_run whole on-$n
done
expect_status 0 "$seq" deck.dm2 -q --restart three/checkpoint.dm2 # in its own directory
same_run whole three
same_bytes whole/snapshots/series.pvd three/snapshots/series.pvd

# A run that is asked to end leaves a checkpoint and says how to go on; the checkpoint leads to the same end.
# interrupted PROGRAM OPTION...
interrupted()
{
    rm -rf cut hashes
    mkfifo hashes
    "$@" deck.dm2 -o cut --hash-every 1 >hashes 2>err &
    pid=$!
    count=0
    exec 4<hashes
    while [ $count -lt 57 ] && IFS= read -r line <&4; do
        count=$((count + 1))
    done
    kill -TERM $pid
    cat <&4 >/dev/null
    exec 4<&-
    got=0
    wait $pid || got=$?
    [ $got -eq 4 ] || fail "status $got: $(cat err)"
    expect_text err 'interrupted by a signal at step'
    expect_text err 'to continue: '
    sed -n 's/.*to continue: //p' err >again.sh # a command for the shell
    expect_text again.sh ' --restart auto '
    expect_text err 'the same command with --restart auto goes on'
    [ -f cut/history.csv.part ] || fail "no history is left"
    [ ! -f cut/history.csv ] || fail "half a history has the final name"
}
interrupted "$seq"
cp -R cut ended
expect_status 0 "$client" deck.dm2 -n 2 -q --restart cut/checkpoint.dm2
same_run whole cut
interrupted "$client" -n 2
cp -R cut copied
expect_status 0 "$seq" deck.dm2 -q --restart cut/checkpoint.dm2
same_run whole cut
rm -rf cut
mv copied cut
expect_text again.sh ' -n 2'
expect_status 0 sh again.sh
expect_text out ' on 2 servers in '
same_run whole cut
same_bytes whole/snapshots/series.pvd cut/snapshots/series.pvd

# ended_in DIR: a run that goes on from DIR/checkpoint.dm2 without -o is asked to end.
ended_in()
{
    cp -R ended "$1"
    rm -f hashes
    mkfifo hashes
    "$seq" deck.dm2 -q --steps 100000 --restart "$1/checkpoint.dm2" --hash-every 1 >hashes 2>err &
    pid=$!
    exec 4<hashes
    IFS= read -r line <&4
    kill -TERM $pid
    cat <&4 >/dev/null
    exec 4<&-
    got=0
    wait $pid || got=$?
    [ $got -eq 4 ] || fail "status $got: $(cat err)"
}
long=$(printf '%0120d' 0)
ended_in "$long"
expect_text err "the same command with --restart auto -o $long goes on"
ended_in 'my runs'
expect_text err "the same command with --restart auto -o 'my runs' goes on"
mkdir -p "$long.1/$long.2/$long.3/$long.4/$long.5"
ended_in "$long.1/$long.2/$long.3/$long.4/$long.5/run"
expect_text err 'the same command with --restart auto, and -o with the directory of the state, goes on'

# Checkpoints that cannot be used.
cp -r whole bad
dd if=whole/checkpoint.dm2 of=bad/checkpoint.dm2 bs=1000 count=5 2>dd.log
expect_status 3 "$client" deck.dm2 -n 2 -q --restart bad/checkpoint.dm2
expect_text err 'bad/checkpoint.dm2: is cut short'
expect_text err 'of step 270: --restart bad/checkpoint.prev.dm2'
cp whole/checkpoint.dm2 bad/checkpoint.dm2
printf '\377' | dd of=bad/checkpoint.dm2 bs=1 seek=40000 conv=notrunc 2>dd.log
cmp -s whole/checkpoint.dm2 bad/checkpoint.dm2 && fail 'nothing was flipped'
expect_status 3 "$seq" deck.dm2 -q --restart bad/checkpoint.dm2
expect_text err 'is damaged'
expect_text err 'of step 270: --restart bad/checkpoint.prev.dm2'
expect_status 3 "$seq" deck.dm2 -q -D speed=1 --restart whole/checkpoint.dm2
expect_text err 'belongs to another deck'
expect_status 3 "$seq" deck.dm2 -q --steps 300 --restart whole/checkpoint.dm2
expect_text err 'is of step 360, the run has 300'
sed '5d' whole/history.csv >bad/history.csv
expect_status 3 "$seq" deck.dm2 -q --restart bad/checkpoint.prev.dm2
expect_text err 'bad/history.csv: the row of step 60 is missing'

# The previous checkpoint continues and becomes the last; the damaged one is not kept in its place.
cp -r whole prev
dd if=whole/checkpoint.dm2 of=prev/checkpoint.dm2 bs=1000 count=5 2>dd.log
expect_status 0 "$seq" deck.dm2 -q --steps 300 --restart prev/checkpoint.prev.dm2
same_bytes whole/checkpoint.prev.dm2 prev/checkpoint.dm2
[ ! -f prev/checkpoint.prev.dm2 ] || fail 'the previous checkpoint is there twice'
expect_status 0 "$seq" deck.dm2 -q --restart prev/checkpoint.dm2
same_run whole prev

# The first step at which two runs differ.
first=$DM2_SRC/scripts/dm2-first-difference
printf 'step 0 hash a\nstep 10 hash b\nstep 20 hash c\n' >one
printf 'noise\nstep 10 hash b\nstep 15 hash x\nstep 20 hash d\nstep 30 hash e\n' >two
expect_status 0 "$first" one one
expect_text out '3 steps are alike, the last is 20'
expect_status 1 "$first" one two
expect_text out 'step 20 differs: c and d; step 10 is the last that is alike'
: >none
expect_status 2 "$first" one none
exit 0
