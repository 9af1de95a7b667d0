# The plate impact gives the same bytes from every compiler and level of optimization.
# labels: e2e slow
# timeout: 300
. "$DM2_SRC/tests/lib.sh"

[ "$FLAVOUR" = release ] || skip "compares with the release build, this is $FLAVOUR"
[ -x "$DM2_BIN/dm2-seq" ] || fail "$DM2_BIN/dm2-seq is not built"
unset MAKEFLAGS MAKELEVEL MFLAGS CFLAGS CPPFLAGS LDFLAGS

deck=$DM2_SRC/input/plate-impact.dm2
expect_status 0 "$DM2_BIN/dm2-seq" "$deck" -q -o reference
[ -s reference/final.dm2 ] && [ -s reference/history.csv ] || fail "the reference run left no results"

# compare NAME COMPILER FLAGS: builds dm2-seq with them in a directory of its own and compares what it
# computes.
compare()
{
    if ! command -v "$2" >/dev/null; then
        echo "no $2 here: left out $2 $3"
        return
    fi
    expect_status 0 make -C "$DM2_SRC" FLAVOUR=release BUILD="$PWD/$1" BIN="$PWD/$1/bin" CC="$2" CFLAGS="$3" \
        "$PWD/$1/bin/dm2-seq"
    expect_status 0 "$1/bin/dm2-seq" "$deck" -q -o "$1.run"
    same_bytes reference/final.dm2 "$1.run/final.dm2"
    same_bytes reference/history.csv "$1.run/history.csv"
    compared=$((compared + 1))
    echo "same bytes: $2 $3"
}

compared=0
compare gcc-O0 gcc -O0
compare gcc-O3-native gcc '-O3 -march=native'
compare clang-O2 clang -O2
[ "$compared" -gt 0 ] || skip "neither gcc nor clang is here"
