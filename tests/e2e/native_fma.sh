# Turned lattices have the same bytes where the compiler may fuse a product and a sum. Builds whose arithmetic
# is not IEEE 754's do not compile, or refuse to run.
# labels: e2e
# timeout: 200
. "$DM2_SRC/tests/lib.sh"

[ "$FLAVOUR" = release ] || skip "compares with the release build, this is $FLAVOUR"
unset MAKEFLAGS MAKELEVEL MFLAGS CFLAGS CPPFLAGS LDFLAGS
cc=${CC:-gcc}

cat >turned.dm2 <<'DECK'
let d = 0.04 cm
domain { size = 3 cm, 2 cm; r_c = 2.5*d; delta_r = 0.25*d }
time { dt = 0.025 us; steps = 10 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
body left { shape = disc 0.95 cm, 1 cm, 0.5 cm; spacing = d; angle = 17 deg; material = Cu
    velocity = 0.02, 0 }
body right {
    shape = disc 2.05 cm, 1 cm, 0.5 cm; spacing = d; angle = 31 deg; origin = 3 cm, 0.01 cm; material = Cu
    velocity = -0.02, 0
}
DECK

# Where the vectorizers are on, gcc fuses pairs of a minus and a plus in spite of -ffp-contract=off.
native='-O3 -ftree-slp-vectorize -march=native'
if echo | "$cc" $native -dM -E -x c - 2>/dev/null | grep -q -E '__FMA__|__ARM_FEATURE_FMA'; then
    expect_status 0 make -j2 -C "$DM2_SRC" FLAVOUR=release BUILD="$PWD/native" BIN="$PWD/native/bin" \
        CC="$cc" \
        CFLAGS="$native" "$PWD/native/bin/dm2-seq"
    for steps in 0 10; do
        expect_status 0 "$DM2_BIN/dm2-seq" -q --steps $steps -o portable-$steps turned.dm2
        expect_status 0 native/bin/dm2-seq -q --steps $steps -o native-$steps turned.dm2
        same_bytes portable-$steps/final.dm2 native-$steps/final.dm2
        same_bytes portable-$steps/history.csv native-$steps/history.csv
    done
else
    echo "this processor cannot fuse a product and a sum: left out -march=native"
fi

# refuse_flags FLAG...: a source does not compile with them.
refuse_flags()
{
    for flag in "$@"; do
        expect_status 2 make -C "$DM2_SRC" FLAVOUR=release BUILD="$PWD/refused" CC="$cc" CFLAGS="-O2 $flag" \
            "$PWD/refused/src/base/real.o"
        expect_text err "dm2 computes as IEEE 754 says"
    done
}

refuse_flags -Ofast -ffast-math -ffinite-math-only
case $("$cc" --version) in
*clang*) ;;
*) refuse_flags -funsafe-math-optimizations -freciprocal-math -fno-signed-zeros \
    '-ffast-math -fno-finite-math-only' ;;
esac

# Linked with -ffast-math, a program flushes subnormals to zero: no compiler tells that by a macro.
for program in dm2-seq dm2-server dm2-model dm2-plot; do
    expect_status 0 "$cc" -ffast-math -o "fast-$program" "$DM2_BUILD/src/app/$program.o" \
        "$DM2_BUILD/libdm2.a" -lm
done
case $(uname -sm) in
'Linux x86_64')
    expect_status 3 ./fast-dm2-seq -q -o fast turned.dm2
    expect_text err "this build does not compute as IEEE 754 says: its fingerprint is "
    [ ! -e fast ] || fail "a refused program made its run directory"
    expect_status 3 ./fast-dm2-server --port 0 --once
    expect_status 3 ./fast-dm2-model predict
    expect_status 3 ./fast-dm2-plot snapshot x
    expect_status 0 ./fast-dm2-seq --version
    ;;
esac
