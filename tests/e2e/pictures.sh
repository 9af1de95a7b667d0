# No picture of README and gallery is stale: scripts/pictures.sh draws the bytes that docs/ has, draws every
# picture that lies there, and each is shown somewhere.
# labels: e2e
# timeout: 240
. "$DM2_SRC/tests/lib.sh"

case $FLAVOUR in
release) decks= ;;
*) decks='heat-rod plate-impact' ;; # slower by far
esac
here=$PWD
(cd "$DM2_SRC" && sh scripts/pictures.sh -o "$here/drawn" $decks) >out 2>err || {
    cat err
    fail 'scripts/pictures.sh failed'
}
n=0
for picture in drawn/*.svg drawn/gallery/*.svg; do
    name=${picture#drawn/}
    cmp "$picture" "$DM2_SRC/docs/$name" || fail \
        "docs/$name is stale: run scripts/pictures.sh, and read the text beside it"
    n=$((n + 1))
done
echo "$n pictures are those of the decks"
cd "$DM2_SRC" || exit 1
for picture in docs/plate-impact*.svg docs/gallery/*.svg; do
    name=${picture#docs/}
    [ -n "$decks" ] || [ -e "$here/drawn/$name" ] || fail "scripts/pictures.sh does not draw $picture"
    grep -q -F "$name)" README.md docs/*.md || fail "nothing shows $picture"
done
exit 0
