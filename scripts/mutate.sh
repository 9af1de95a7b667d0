#!/bin/sh
# Mutates the physics, one place at a time, and lists the mutants that no unit test of the physics notices.
#
#     sh scripts/mutate.sh [-l] [-e N] [-s N] [-t SECONDS] [-T "TEST..."] [FILE...]
#
# FILE: default the files of the laws. A mutant is a number (times 1.02; 0 becomes 0.001), a comparison (turned round; its
# right side times 1.02), or a sum, difference, product or quotient (its opposite). Each is built in a copy of the tree
# under build/mutate; the first test that fails kills it. A mutant that does not compile or uses more than 30 s of
# the processor is dead, too.
#
#     -l  lists the mutants, builds none     -e N  every N-th mutant only     -s N  begins behind the N-th
#     -t  begins no mutant after so many seconds      -T  the unit tests, in this order, without `test_`
#
# Not a part of `make test`: some seconds per mutant of a .c, half a minute of a header. docs/mutants.md explains those that live. Exit status 1: some live.
set -u

list=0 every=1 skip=0 seconds=3600
tests='constants mixtures law mechanics thermo lattice strain reaction'
while getopts le:s:t:T: option; do
    case $option in
    l) list=1 ;;
    e) every=$OPTARG ;;
    s) skip=$OPTARG ;;
    t) seconds=$OPTARG ;;
    T) tests=$OPTARG ;;
    *) sed -n '4,15s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
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
build() { make -j2 BUILD=build/mutant BIN=build/mutant/bin CFLAGS=-O1 WARN= "build/mutant/tests/test_$1" >build.log 2>&1; }

# killed: builds and runs the tests in turn; names the first that does not build or fails.
killed()
{
    for test in $tests; do
        build "$test" && (ulimit -t 30 && DM2_SRC=$PWD build/mutant/tests/test_"$test" >test.log 2>&1) 2>/dev/null ||
            { echo "$test"; return; }
    done
}
first=$(killed)
[ -z "$first" ] || { echo "mutate.sh: test_$first fails without a mutant" >&2; tail -n 20 build.log test.log; exit 2; }

begin=$(date +%s) tried=0 alive=0
while read -r file line column length to; do
    [ $(($(date +%s) - begin)) -lt "$seconds" ] || break
    tried=$((tried + 1))
    mutate "$line" "$column" "$length" "$to" <"$home/$file" >"$file"
    if [ -z "$(killed)" ]; then
        alive=$((alive + 1))
        echo "$file:$line:$column: $(printf %s "$to" | tr _ ' ')   $(sed -n "${line}s/^ *//p" "$file")"
    fi
    cp "$home/$file" "$file"
done <"$home/$work/mutants"
echo "$tried of $((count)) mutants tried, $alive live"
[ $alive = 0 ]
