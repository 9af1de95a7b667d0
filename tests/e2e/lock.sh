# One run at a time in a run directory: the second is told which process has it; the lock ends with the
# process.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
deck=$DM2_SRC/tests/decks/good/scatter.dm2
expect_status 0 "$seq" "$deck" -q -o good
[ ! -e good/.lock ] || fail 'the lock is left in the results'

# begin: a run that waits for a reader of its hashes.
begin()
{
    rm -f hashes
    mkfifo hashes
    "$seq" "$deck" -q -o run --overwrite --checkpoint-every 20 --hash-every 1 >hashes 2>err.first &
    pid=$!
    exec 4<hashes
    count=0
    while [ $count -lt 50 ] && IFS= read -r line <&4; do
        count=$((count + 1))
    done
    kill -STOP $pid
}
begin
for line in "host: $(uname -n)" "process: $pid" 'start: 20' "command: $seq "; do
    expect_text run/.lock "$line"
done
for command in "$seq --overwrite -o run" "$client -n 1 --overwrite -o run" \
    "$seq --restart run/checkpoint.dm2" "$seq --restart auto -o run" "$seq -o run"; do
    # shellcheck disable=SC2086
    expect_status 2 $command -q "$deck"
    expect_text err "$(uname -n), process $pid, writes to run since "
done
kill -CONT $pid
cat <&4 >rest
exec 4<&-
got=0
wait $pid || got=$?
[ "$got" -eq 0 ] || { cat err.first; fail "the first run ended with $got"; }
same_bytes good/history.csv run/history.csv
same_bytes good/final.dm2 run/final.dm2
[ ! -e run/.lock ] || fail 'the lock is left in the results'

# A killed run leaves the file, and the directory is free.
begin
kill -KILL $pid
exec 4<&-
wait $pid 2>/dev/null
[ -e run/.lock ] || fail 'no lock file was there'
expect_status 0 "$seq" -q --restart auto -o run "$deck"
same_bytes good/history.csv run/history.csv
same_bytes good/final.dm2 run/final.dm2
mkdir empty
: >empty/.lock
expect_status 0 "$seq" -q -o empty "$deck"
[ ! -e empty/.lock ] || fail 'the lock of a killed run is left'

# Of several processes that start at once one runs; the others are refused, or find all done.
for k in 1 2 3 4; do
    "$seq" -q "$deck" -o many --restart auto 2>many.$k &
    eval "pid_$k=$!"
done
ended=0
for k in 1 2 3 4; do
    got=0
    eval "wait \$pid_$k" || got=$?
    case $got in
    0) ended=$((ended + 1)) ;;
    2) expect_text many.$k ', writes to many since ' ;;
    *) cat many.$k; fail "process $k of four ended with $got" ;;
    esac
done
[ $ended -ge 1 ] || fail 'none of four processes ran'
same_bytes good/history.csv many/history.csv
same_bytes good/final.dm2 many/final.dm2
[ "$(grep -c '^program: ' many/run.log)" -eq 1 ] || fail 'two processes wrote'

# A file of the name that no run wrote stays as it is.
mkdir own
echo mine >own/.lock
expect_status 2 "$seq" -q -o own "$deck"
expect_text err 'own/.lock: is not the lock of a run'
[ "$(cat own/.lock)" = mine ] || fail 'a file of somebody else is gone'

# A lock behind a link is refused; a file system without locks is a warning.
mkdir odd
ln -s "$PWD/elsewhere" odd/.lock
expect_status 2 "$seq" -q -o odd "$deck"
[ ! -e elsewhere ] || fail 'a link in place of the lock was followed'
expect_status 0 env DM2_FAIL=lock:1 "$DM2_BUILD/failing/dm2-seq" -q -o nolock "$deck"
expect_text err 'warning'
expect_text err 'cannot be locked'
same_bytes good/final.dm2 nolock/final.dm2

# The limit of processor time writes a checkpoint, as TERM does, also where the signal is repeated.
"$seq" "$deck" -q -o limit --hash-every 1 >hashes 2>err &
pid=$!
exec 4<hashes
count=0
while [ $count -lt 30 ] && IFS= read -r line <&4; do
    count=$((count + 1))
done
kill -STOP $pid
kill -XCPU $pid
kill -CONT $pid
kill -XCPU $pid 2>/dev/null
cat <&4 >rest
exec 4<&-
got=0
wait $pid || got=$?
[ "$got" -eq 4 ] || { cat err; fail "exit status $got at the limit of processor time"; }
expect_text err 'to continue'
expect_status 0 "$seq" -q --restart limit/checkpoint.dm2 "$deck"
same_bytes good/final.dm2 limit/final.dm2
same_bytes good/history.csv limit/history.csv
exit 0
