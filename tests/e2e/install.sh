# A build outside the source tree, `make install` below DESTDIR, and `make uninstall`.
# labels: e2e slow
# timeout: 120
. "$DM2_SRC/tests/lib.sh"

[ "$FLAVOUR" = release ] || skip "builds by itself, once for all flavours"
unset MAKEFLAGS MAKELEVEL MFLAGS CFLAGS CPPFLAGS LDFLAGS DESTDIR PREFIX
cc=${CC:-gcc}
run_make()
{
    expect_status 0 make -C "$DM2_SRC" FLAVOUR=release BUILD="$PWD/build" BIN="$PWD/bin" CC="$cc" CFLAGS=-O0 \
        DESTDIR="$PWD/root" PREFIX=/opt/dm2 "$@"
}

run_make install
for source in "$DM2_SRC"/src/app/dm2-*.c; do
    program=$(basename "$source" .c)
    [ -x "root/opt/dm2/bin/$program" ] || fail "$program is not installed"
    expect_status 0 "root/opt/dm2/bin/$program" --version
    expect_text out "$program"
    expect_status 0 "root/opt/dm2/bin/$program" --help
done
for deck in "$DM2_SRC"/input/*.dm2 "$DM2_SRC"/input/*/*.dm2; do
    same_bytes "$deck" "root/opt/dm2/share/dm2/input/${deck#"$DM2_SRC/input/"}"
done

# Nothing is rebuilt for nothing, everything is for other flags.
run_make all
if grep -q ' CC ' out; then fail "a second make compiles again"; fi
run_make -n all CPPFLAGS=-DANOTHER
grep -q ' CC ' out || fail "other flags do not rebuild"

run_make uninstall
find root -type f >left
[ ! -s left ] || { cat left; fail "make uninstall leaves files behind"; }
