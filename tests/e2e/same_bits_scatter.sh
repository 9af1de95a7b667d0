# Clouds and blocks that fly through each other: hundreds of elements change servers, with links, contacts,
# friction, springs, yield and heat, and the bytes stay the same; so they do where every side is periodic and
# every cut is met across the seam.
# labels: e2e bits
# timeout: 120
. "$DM2_SRC/tests/lib.sh"
cp "$DM2_SRC/tests/decks/good/scatter.dm2" free.dm2
sed 's/boundary = free free/boundary = periodic periodic/' free.dm2 >periodic.dm2
cmp -s free.dm2 periodic.dm2 && fail "the deck has changed: it has no boundary to make periodic"

# alike DECK REFERENCE N BALANCE LEAST: the same files from N servers, with at least LEAST migrants.
alike()
{
    expect_status 0 "$DM2_BIN/dm2-client" "$1" -n "$3" --balance "$4" -q -o many --overwrite
    same_bytes "$2/final.dm2" many/final.dm2
    same_bytes "$2/history.csv" many/history.csv
    migrants=$(sed -n 's/^migrants: //p' many/run.log)
    [ "${migrants:-0}" -ge "$5" ] || fail "$1 on $3 servers: '$migrants' migrants, expected at least $5"
    echo "$1, $3 servers, balance by $4: same bytes, $migrants migrants"
}

for deck in free periodic; do
    expect_status 0 "$DM2_BIN/dm2-seq" $deck.dm2 -q -o $deck --hash-every 100
    grep '^step' out >$deck.hashes
    [ "$(wc -l <$deck.hashes)" -ge 4 ] || fail "--hash-every 100 printed: $(cat out)"
    counts='1 2 3 4 5 7 8 9'
    [ $deck = free ] || counts='2 3 5 9'
    for n in $counts; do
        least=0
        [ $n -lt 4 ] || least=200
        alike $deck.dm2 $deck $n space $least
    done
    alike $deck.dm2 $deck 3 particles 100
    alike $deck.dm2 $deck 8 particles 200
    for search in lists cells; do
        sed "s/delta_r = 0.02 cm/&; search = $search/" $deck.dm2 >$search.dm2
        expect_status 0 "$DM2_BIN/dm2-seq" $search.dm2 -q -o $search --overwrite --hash-every 100
        grep '^step' out >$search.hashes
        same_bytes $deck.hashes $search.hashes
        same_bytes $deck/history.csv $search/history.csv
    done
done
cmp -s free/history.csv periodic/history.csv && fail "the periodic sides change nothing"
exit 0
