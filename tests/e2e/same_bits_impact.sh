# The plate impact has the same bytes from one process and from any number of servers, cut by space or by
# particles, whichever way pairs are searched for.
# labels: e2e bits
# timeout: 120
. "$DM2_SRC/tests/lib.sh"
deck=$DM2_SRC/input/plate-impact.dm2

# alike N BALANCE DECK REFERENCE: a distributed run leaves the same files as the reference.
alike()
{
    expect_status 0 "$DM2_BIN/dm2-client" "$3" -n "$1" --balance "$2" -q -o "run-$1-$2" --overwrite
    for file in final.dm2 history.csv snapshots/state-000000120.vtp; do
        same_bytes "$4/$file" "run-$1-$2/$file"
    done
    rm -r "run-$1-$2"
}

expect_status 0 "$DM2_BIN/dm2-seq" "$deck" -q -o one
for n in 1 2 3 4 5 7 8 9; do
    alike $n space "$deck" one
done
for n in 2 3 5 8 9; do
    alike $n particles "$deck" one
done

# The search methods: the text of the deck is in final.dm2, so across them the histories and the states'
# hashes are compared.
cp -r "$DM2_SRC/input/materials" . || fail "cannot copy the materials"
expect_status 0 "$DM2_BIN/dm2-seq" "$deck" --hash-every 50 --progress never -o hashed
grep '^step' out >hashes
[ "$(wc -l <hashes)" -eq 5 ] || fail "--hash-every 50 printed: $(cat out)"
for search in lists cells; do
    sed "s/delta_r = 0.01 cm/&; search = $search/" "$deck" >$search.dm2
    grep -q "search = $search" $search.dm2 || fail "the deck has changed: no delta_r to put the search behind"
    expect_status 0 "$DM2_BIN/dm2-seq" $search.dm2 --hash-every 50 --progress never -o $search
    grep '^step' out >$search.hashes
    same_bytes hashes $search.hashes
    same_bytes one/history.csv $search/history.csv
    alike 4 space $search.dm2 $search
    alike 9 particles $search.dm2 $search
done
