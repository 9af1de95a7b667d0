# The programs need the C library and its libm, and nothing else.
# labels: check
. "$DM2_SRC/tests/lib.sh"

[ "$FLAVOUR" = release ] || skip "the $FLAVOUR flavour links its own run-time library"
command -v ldd >/dev/null || skip "there is no ldd on this system"
for program in "$DM2_BIN"/dm2-*; do
    [ -x "$program" ] || fail "no programs in $DM2_BIN"
    ldd "$program" >needs 2>&1 || { cat needs; skip "ldd does not read $program"; }
    # What remains: the kernel's own page, the loader, libc, libm (and libSystem where that is both).
    grep -v -E 'linux-vdso|linux-gate|ld-linux|ld-musl|/ld[-.]|libc\.|libm\.|libSystem|not a dynamic|statically linked|:$' needs >more
    [ ! -s more ] || { cat more; fail "${program##*/} needs more than libc and libm"; }
done
