# How the deck gets to the servers: a server reads its own copy, or the client sends the texts.
. "$DM2_SRC/tests/lib.sh"

client=$DM2_BIN/dm2-client
mkdir here there outside
cp "$DM2_SRC/tests/decks/run/scatter.dm2" here/deck.dm2
cp here/deck.dm2 there/deck.dm2

# The server has the deck.
start_server --deck-dir there
cd here || exit 1
expect_status 0 "$client" deck.dm2 -q --server "$SERVER_ADDR" -o ../own --steps 3
cd .. || exit 1

# The server has the deck with another comment, which means the same.
echo '# a change' >>there/deck.dm2
cd here || exit 1
expect_status 0 "$client" deck.dm2 -q --server "$SERVER_ADDR" -o ../comment --steps 3
cd .. || exit 1
same_bytes own/final.dm2 comment/final.dm2

# The server has another deck, if only in how it is computed: both digests are named, nothing runs, until the
# client sends its texts.
sed 's/delta_r = /delta_r = 1.01*/' here/deck.dm2 >there/deck.dm2
! cmp -s here/deck.dm2 there/deck.dm2 || fail "the deck did not change"
cd here || exit 1
expect_status 3 "$client" deck.dm2 --server "$SERVER_ADDR" -o ../differs --steps 3
expect_text err "the deck 'deck.dm2' differs: digest "
[ "$(grep -c -E 'digest [0-9a-f]{64} on the client, [0-9a-f]{64} on the server' err)" -eq 1 ] ||
    fail "no two digests"
expect_text err '--send-deck'
expect_status 0 "$client" deck.dm2 -q --server "$SERVER_ADDR" -o ../sent --steps 3 --send-deck
cd .. || exit 1
same_bytes own/final.dm2 sent/final.dm2

# The server has no deck, or a deck that it must not reach: the texts are sent.
mv there/deck.dm2 outside/secret.dm2
ln -s ../outside/secret.dm2 there/secret.dm2
ln -s ../outside there/link
cp here/deck.dm2 here/secret.dm2
mkdir here/link
cp here/deck.dm2 here/link/secret.dm2
cd here || exit 1
for name in deck.dm2 ./deck.dm2 ../here/deck.dm2 "$PWD/deck.dm2" secret.dm2 link/secret.dm2; do
    expect_status 0 "$client" "$name" -q --server "$SERVER_ADDR" -o ../none --overwrite --steps 3
    same_bytes ../own/final.dm2 ../none/final.dm2
done

# A deck that includes a file outside is not even read, so the digests are not compared.
cd ..
sed '/^material/,/^}/d' here/deck.dm2 >here/split.dm2
sed -n '/^material/,/^}/p' here/deck.dm2 >here/part.dm2
echo 'include "part.dm2"' >>here/split.dm2
cp here/split.dm2 there/
echo '# a secret' >outside/part.dm2
ln -s ../outside/part.dm2 there/part.dm2
cd here || exit 1
expect_status 0 "$client" split.dm2 -q --server "$SERVER_ADDR" -o ../split --steps 3

# The changes of the command line hold for both ways.
cp deck.dm2 ../there/
expect_status 0 "$client" deck.dm2 -q --server "$SERVER_ADDR" -o ../defined --steps 3 -D reach=0.11
expect_status 0 "$client" deck.dm2 -q --server "$SERVER_ADDR" -o ../defined-sent --steps 3 -D reach=0.11 \
    --send-deck
same_bytes ../defined/final.dm2 ../defined-sent/final.dm2
! cmp -s ../own/final.dm2 ../defined/final.dm2 || fail "the definition changed nothing"
