# `make demo`: the plate impact on 4 local servers, and its picture.
. "$DM2_SRC/tests/lib.sh"

work=$PWD
cd "$DM2_SRC" || fail "no source tree"
DM2_BUILD=$work/build sh scripts/demo.sh >"$work/out" 2>"$work/err" ||
    { cat "$work/out" "$work/err"; fail "scripts/demo.sh"; }
cd "$work" || fail "no $work"
expect_text out "$work/build/demo.run"
expect_text out "$work/build/demo.svg"
for file in final.dm2 history.csv timing.csv run.log; do
    [ -s "build/demo.run/$file" ] || fail "there is no $file"
done
expect_text build/demo.svg '</svg>'
expect_text build/demo.svg 'step 200, 1689 elements'

# A second demo takes the directory of the first.
(cd "$DM2_SRC" && DM2_BUILD=$work/build sh scripts/demo.sh >/dev/null) || fail "a second demonstration fails"
