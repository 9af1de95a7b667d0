#!/bin/sh
# Mutates the physics, one place at a time, and lists the mutants that no unit test of the physics notices.
#
#     sh scripts/mutate.sh [-l] [-e N] [-s N] [-t SECONDS] [-T "TEST..."] [FILE...]
#
# FILE: default the files of the laws. A mutant is a number (times 1.02; 0 becomes 0.001), a comparison (turned round; its
# right side times 1.02), or a sum, difference, product or quotient (its opposite). In a copy of the tree under
# build/mutate, at -O1, the objects of each test that the mutant reaches are compiled, before the test is linked; the
# first test that fails kills the mutant, and comes first for the next. A mutant that does not compile or uses more than
# 10 s of the processor is dead, too; where the compiler makes the same code, the mutant is none.
#
#     -l  lists the mutants, builds none     -e N  every N-th mutant only     -s N  begins behind the N-th
#     -t  begins no mutant after so many seconds      -T  the unit tests, in this order, without `test_`
#
# Not a part of `make test`: a second per mutant, some of a header. docs/mutants.md explains those that live. Exit
# status 1: some live.
set -u

list=0 every=1 skip=0 seconds=3600
tests='constants laws stability kinds mixtures pair_law restitution law strain stiffness walls mechanics lattice reaction thermo'
while getopts le:s:t:T: option; do
    case $option in
    l) list=1 ;;
    e) every=$OPTARG ;;
    s) skip=$OPTARG ;;
    t) seconds=$OPTARG ;;
    T) tests=$OPTARG ;;
    *) sed -n '4,17s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
    esac
done
shift $((OPTIND - 1))
[ $# -gt 0 ] || set -- src/deck/lattice.c src/engine/law.c src/engine/laws.c src/engine/stability.c src/engine/phase.c \
    src/engine/reaction.c src/engine/kinds.c src/engine/law.h src/engine/particles.h # headers last: they build long
work=build/mutate
mkdir -p "$work"

# find_mutants FILE...: lines `FILE LINE COLUMN LENGTH REPLACEMENT`. Comments, strings, directives, messages and heads
# of loops have none.
find_mutants()
{
    awk '
        function emit(at, n, to) { print FILENAME, FNR, at, n, to }
        FNR == 1 { comment = 0 }
        {
            line = $0; clean = ""
            for (i = 1; i <= length(line); i++) {     # blanks in place of comments and strings
                two = substr(line, i, 2); c = substr(line, i, 1)
                if (comment) { if (two == "*/") { comment = 0; clean = clean " "; i++ } clean = clean " "; continue }
                if (two == "/*") { comment = 1; clean = clean "  "; i++; continue }
                if (c == "\"") quoted = !quoted
                clean = clean (quoted || c == "\"" ? " " : c)
            }
            quoted = 0
            if (clean ~ /^#/ || clean ~ /for \(/ || clean ~ /dm2_fail|_Static_assert|CHECK/) next
            rest = clean; before = 0
            while (match(rest, /0x[0-9a-f]+(\.[0-9a-f]+)?p[-+]?[0-9]+|[0-9]+\.[0-9]*(e[-+]?[0-9]+)?/)) {
                number = substr(rest, RSTART, RLENGTH)
                if (number ~ /^0\.0*$/) emit(before + RSTART, RLENGTH, "1e-3")
                else emit(before + RSTART, RLENGTH, "(1.02*" number ")")
                before += RSTART + RLENGTH - 1; rest = substr(rest, RSTART + RLENGTH)
            }
            rest = clean; before = 0
            while (match(rest, / (<|>|<=|>=|==|!=|\+|-|\*|\/|\+=|-=|\*=|\/=) /)) {
                op = substr(rest, RSTART + 1, RLENGTH - 2); at = before + RSTART + 1; n = RLENGTH - 2
                if (op ~ /^[<>]/) {
                    emit(at, n, op ~ /</ ? ">" : "<")
                    if (substr(rest, RSTART + RLENGTH) !~ /^(0\.0|0|INFINITY|NULL)[^.0-9]/) emit(at, n, op "_1.02_*")
                }
                else
                    emit(at, n, op == "==" ? "!=" : op == "!=" ? "==" : op == "+" ? "-" : op == "-" ? "+" : op == "*" ? "/" : op == "/" ? "*" : op == "+=" ? "-=" : op == "-=" ? "+=" : op == "*=" ? "/=" : "*=")
                before += RSTART + RLENGTH - 2; rest = substr(rest, RSTART + RLENGTH - 1)
            }
        }' "$@"
}

# mutate LINE COLUMN LENGTH REPLACEMENT <FILE: `_` in the replacement is a blank.
mutate()
{
    awk -v at="$1" -v column="$2" -v n="$3" -v to="$4" '
        NR == at { gsub(/_/, " ", to); $0 = substr($0, 1, column - 1) to substr($0, column + n) } { print }'
}

chosen() { find_mutants "$@" | awk -v every="$every" -v skip="$skip" 'NR > skip && (NR - skip - 1) % every == 0'; }
if [ $list = 1 ]; then
    chosen "$@"
    exit 0
fi
chosen "$@" >"$work/mutants"
count=$(wc -l <"$work/mutants")

# The copy; files that have not changed since the last run keep their objects.
mkdir -p "$work/tree"
find Makefile src include input tests/unit tests/decks -type f | while read -r file; do
    cmp -s "$file" "$work/tree/$file" || { mkdir -p "$work/tree/$(dirname "$file")" && cp "$file" "$work/tree/$file"; }
done
home=$PWD
cd "$work/tree" || exit 2
built=build/mutant
: >build.log
# shellcheck disable=SC2046 # one word per test
make -j1 BUILD=$built BIN=$built/bin CFLAGS='-O1 -DCHECK_FIRST' WARN= $(printf "$built/tests/test_%s " $tests) >build.log 2>&1 ||
    { echo "mutate.sh: the tests do not build" >&2; tail -n 20 build.log; exit 2; }
compile=$(cat $built/flags)
for test in $tests; do # the sources of each test
    {
        echo "tests/unit/test_$test.c"
        ${compile%% *} -Wl,-M -o /dev/null "$built/tests/unit/test_$test.o" $built/libdm2.a -lm |
            sed -n 's/^[^ ]*libdm2\.a(\([a-z0-9_]*\)\.o).*/\1.c/p' | sort -u | while read -r name; do echo src/*/"$name"; done
    } >"members-$test"
    (DM2_SRC=$PWD $built/tests/test_"$test" >test.log 2>&1) ||
        { echo "mutate.sh: test_$test fails without a mutant" >&2; tail -n 20 test.log; exit 2; }
done

# names_at FILE LINE: the function of a header around this line, and the functions of headers that call it, as a regular
# expression; empty outside functions.
names_at()
{
    names=$(awk -v at="$2" 'FNR > at { exit } /^(static|DM2_INLINE).*\(/ { split($0, part, "("); name = part[1] }
        /^}/ && FNR < at { name = "" } END { sub(/.*[ *]/, "", name); print name }' "$1")
    before=
    while [ "$names" != "$before" ] && [ -n "$names" ]; do
        before=$names
        names=$({ printf '%s\n' "$before" | tr '|' '\n'; awk -v names="$before" '
            /^(static|DM2_INLINE).*\(/ { split($0, part, "("); name = part[1]; sub(/.*[ *]/, "", name) }
            name != "" && $0 ~ "(^|[^a-z0-9_])(" names ")\\(" { print name }
            /^}/ { name = "" }' src/*/*.h; } | sort -u | paste -sd '|' -)
    done
    printf '%s' "$names"
}

# reached FILE LINE: the sources whose objects a mutant there reaches.
reached()
{
    case $1 in *.c) echo "$1"; return ;; esac
    names=$(names_at "$1" "$2")
    find $built -name '*.d' -exec grep -l -F "${1#src/}" {} + | sed "s#^$built/##; s#\.d\$#.c#" | while read -r source; do
        [ -n "$names" ] && ! grep -q -E "(^|[^a-z0-9_])($names)\\(" "$source" || echo "$source"
    done
}

# killed: builds and runs the tests in turn; names the first that does not build or fails, or says that no code changed.
killed()
{
    rm -rf objects
    changed=0
    for test in $tests; do
        grep -q -x -F -f reached "members-$test" || continue
        objects=
        for source in $(grep -x -F -f reached "members-$test"); do
            object=objects/${source%.c}.o
            if [ ! -f "$object" ]; then
                mkdir -p "${object%/*}"
                $compile -Isrc -Itests/unit -MF objects/d -c -o "$object" "$source" >build.log 2>&1 || { echo build; return; }
                cmp -s "$object" "$built/${source%.c}.o" || changed=1
            fi
            case $source in tests/*) ;; *) objects="$objects $object" ;; esac
        done
        main=objects/tests/unit/test_$test.o
        [ -f "$main" ] || main=$built/tests/unit/test_$test.o
        ${compile%% *} -o objects/test "$main" $objects $built/libdm2.a -lm >build.log 2>&1 || { echo build; return; }
        (ulimit -t 10 && DM2_SRC=$PWD objects/test >test.log 2>&1) 2>/dev/null || { echo "$test"; return; }
    done
    [ $changed = 1 ] || echo same
}

begin=$(date +%s) tried=0 alive=0 same=0
while read -r file line column length to; do
    [ $(($(date +%s) - begin)) -lt "$seconds" ] || break
    tried=$((tried + 1))
    mutate "$line" "$column" "$length" "$to" <"$home/$file" >"$file"
    reached "$file" "$line" >reached
    by=$(killed)
    case $by in
    '') alive=$((alive + 1))
        echo "$file:$line:$column: $(printf %s "$to" | tr _ ' ')   $(sed -n "${line}s/^ *//p" "$file")" ;;
    same) same=$((same + 1)) ;;
    build) ;;
    *) tests="$by $(printf '%s\n' $tests | grep -v -x "$by" | paste -sd ' ' -)" ;;
    esac
    cp -p "$home/$file" "$file"
done <"$home/$work/mutants"
echo "$tried of $((count)) mutants tried, $same make no other code, $alive live"
[ $alive = 0 ]
