# The programs need the C library and its libm, and nothing else. No object that computes results has an
# instruction that fuses a product and a sum, whatever the processor can.
# labels: check
# timeout: 200
. "$DM2_SRC/tests/lib.sh"

[ "$FLAVOUR" = release ] || skip "the $FLAVOUR flavour links its own run-time library"
command -v ldd >/dev/null || skip "there is no ldd on this system"
for program in "$DM2_BIN"/dm2-*; do
    [ -x "$program" ] || fail "no programs in $DM2_BIN"
    ldd "$program" >needs 2>&1 || { cat needs; skip "ldd does not read $program"; }
    # What remains: the kernel's own page, the loader, libc, libm (and libSystem where that is both).
    known='linux-vdso|linux-gate|ld-linux|ld-musl|/ld[-.]|libc\.|libm\.|libSystem'
    known="$known|not a dynamic|statically linked"
    grep -v -E "$known|:\$" needs >more
    [ ! -s more ] || { cat more; fail "${program##*/} needs more than libc and libm"; }
done

command -v objdump >/dev/null || skip "there is no objdump on this system: instructions are not looked at"
case $(uname -m) in
x86_64)
    march=x86-64-v4
    fused='[[:space:]]vfn?m(add|sub)'
    ;;
aarch64)
    march=armv8.3-a
    fused='[[:space:]](fn?m(add|sub)|fml[as]|fcmla)[[:space:]]'
    ;;
*) skip "which instructions of this processor fuse is not known here" ;;
esac
unset MAKEFLAGS MAKELEVEL MFLAGS CFLAGS CPPFLAGS LDFLAGS
for cc in gcc clang; do
    echo 'int x;' | "$cc" -march=$march -x c -c -o x.o - 2>/dev/null ||
        { echo "no $cc for $march: left out"; continue; }
    objects=$(ls "$DM2_SRC"/src/base/*.c "$DM2_SRC"/src/deck/*.c "$DM2_SRC"/src/engine/*.c \
        "$DM2_SRC"/src/output/*.c |
        sed -e 's/c$/o/' -e "s,^.*/src/,$PWD/$cc/src/,")
    expect_status 0 make -j2 -C "$DM2_SRC" FLAVOUR=release BUILD="$PWD/$cc" CC="$cc" \
        CFLAGS="-O3 -march=$march" $objects
    objdump -d --no-show-raw-insn $objects >instructions || fail "objdump does not read the objects of $cc"
    [ "$(grep -c 'file format' instructions)" -ge 70 ] || fail "too few objects of $cc"
    ! grep -E "$fused" instructions || fail "$cc fuses a product and a sum"
done
