# The README is true: its commands run, its options exist, its links lead somewhere.
. "$DM2_SRC/tests/lib.sh"

readme=$DM2_SRC/README.md
ln -s "$DM2_BIN" bin
ln -s "$DM2_SRC/input" input

# block N: the commands of its Nth block of sh.
block()
{
    awk -v want="$1" '/^```sh$/ { n++; inside = 1; next } /^```/ { inside = 0 } inside && n == want' "$readme"
}

[ "$(block 1 | sed -e 's/ .*//')" = "make
make" ] || fail "the README does not begin with its two commands"
block 2 | grep -v '^make ' >commands
grep -q '^cmp ' commands || fail "the second block is not the one about running"
expect_status 0 sh -ex commands

# The last block draws files of make demo.
mkdir build
ln -s "$PWD/demo.run" build/demo.run
expect_status 0 bin/dm2-seq input/plate-impact.dm2 -q -o demo.run
block 4 >commands
grep -q dm2-plot commands || fail "the fourth block is not the one about drawing"
expect_status 0 sh -ex commands
[ -s vy.svg ] && [ -s surface.svg ] || fail "dm2-plot left no pictures"

# Options: each word that looks like an option is known to a program.
for program in dm2-client dm2-server dm2-seq 'dm2-plot snapshot' 'dm2-plot chart' 'dm2-model calibrate'; do
    # shellcheck disable=SC2086  # a program and its command
    bin/$program --help >>help || fail "$program --help"
done
grep -o -E -e '(^|[ `|])--[a-z][a-z-]*' "$readme" | tr -d ' `|' | LC_ALL=C sort -u >options
[ "$(wc -l <options)" -gt 10 ] || fail "the README names no options"
while IFS= read -r option; do
    grep -q -E -e "(^|[ ,])$option([ ,=]|\$)" help || fail "the README has $option, no --help does"
done <options

# Links within the source tree, of the README and of the pages below docs/.
for page in "$readme" "$DM2_SRC"/docs/*.md; do
    grep -o -E '\]\([^)#]+' "$page" | sed -e 's/^](//' | while IFS= read -r link; do
        case $link in
        *://*) ;;
        *) [ -e "$(dirname "$page")/$link" ] || echo "${page##*/} links to $link, which is not there" ;;
        esac
    done
done >broken
[ ! -s broken ] || { cat broken; fail "broken links"; }

# Functions, tests and keywords that docs/physics.md names exist.
grep -o -E '`[a-z0-9]+(_[a-z0-9]+)+`' "$DM2_SRC/docs/physics.md" | tr -d '`' | LC_ALL=C sort -u >names
[ "$(wc -l <names)" -gt 40 ] || fail "docs/physics.md names no functions"
while IFS= read -r name; do
    [ -e "$DM2_SRC/tests/unit/$name.c" ] || [ -e "$DM2_SRC/tests/e2e/$name.sh" ] ||
        grep -r -q -w -e "$name" "$DM2_SRC/src" "$DM2_SRC/include" ||
            fail "docs/physics.md has $name, the sources do not"
done <names
