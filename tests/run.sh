#!/bin/sh
# Runs the tests and reports on them the way ctest does. `make test` calls it; by hand:
#
#     DM2_BIN=$PWD/bin DM2_BUILD=$PWD/build/release sh tests/run.sh -R grid -V
#
# A test is a program built from tests/unit/test_NAME.c (called unit_NAME, label unit) or a script
# tests/e2e/NAME.sh (called e2e_NAME, label e2e unless a `# labels:` line of its opening comment says
# otherwise; its time limit is 60 s unless a `# timeout:` line says otherwise). Exit status 0 is passed, 77
# skipped, else failed.
# A script starts in an empty directory of its own, which is TMPDIR for either kind; a program at the source
# tree's top.
#
# One supervisor (tests/tools/supervise.c) per running test keeps its time and kills its leftover processes.
# The supervisors report through one fifo; each line that arrives starts the next test.
set -u

usage()
{
    cat <<'END'
usage: sh tests/run.sh [OPTION]...
  -L LABEL    only tests with this label: unit, e2e, check...
  -R REGEX    only tests whose name matches (as grep -E does)
  -E REGEX    not those whose name matches
  -j N        N tests at a time (default: the number of cores, at most 2)
  -N          list the tests, run none
  -V          print the output of every test;  --output-on-failure: of those that fail
  --memcheck  the unit tests alone, each under valgrind; errors and leaks fail it
  --repeat after-timeout:2  a test that reaches its time limit runs once more; the first try is printed, too
  --timeout S time limit of a test that does not name its own, seconds (default 60)
Environment: DM2_BIN, DM2_BUILD, FLAVOUR (make test sets them), DM2_TESTS (another tree of tests).
END
}

die()
{
    printf 'tests/run.sh: %s\n' "$*" >&2
    exit 2
}

label= match= exclude= jobs= list=0 show=none default_limit=60 memcheck=0 repeat=0
while [ $# -gt 0 ]; do
    case $1 in
    -L | -R | -E | -j | --timeout | --repeat)
        [ $# -ge 2 ] || die "$1 needs a value (see --help)"
        case $1 in
        -L) label=$2 ;;
        -R) match=$2 ;;
        -E) exclude=$2 ;;
        -j) jobs=$2 ;;
        --timeout) default_limit=$2 ;;
        --repeat)
            [ "$2" = after-timeout:2 ] || die "--repeat '$2': after-timeout:2 is expected"
            repeat=1
            ;;
        esac
        shift
        ;;
    -j[0-9]*) jobs=${1#-j} ;;
    -N) list=1 ;;
    -V) show=all ;;
    --memcheck) memcheck=1 label=unit ;;
    --output-on-failure) [ $show = all ] || show=failed ;;
    -h | --help)
        usage
        exit 0
        ;;
    *) die "unknown option '$1' (see --help)" ;;
    esac
    shift
done

tests=${DM2_TESTS:-$(dirname "$0")}
tests=$(cd "$tests" && pwd) || die "no tests at '$tests'"
: "${DM2_BUILD:?is not set: run the tests with make test}" \
    "${DM2_BIN:?is not set: run the tests with make test}"
: "${FLAVOUR:=release}"
DM2_SRC=$(dirname "$tests")
export DM2_SRC DM2_BIN DM2_BUILD FLAVOUR

if [ -z "$jobs" ]; then
    jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)
    [ "$jobs" -le 2 ] 2>/dev/null || jobs=2
fi
case $jobs$default_limit in
*[!0-9]*) die "-j and --timeout take whole numbers" ;;
esac
[ "$jobs" -ge 1 ] || die "-j takes a number of tests, at least 1"

# Sanitized programs are several times slower, and must not hide their findings behind an expected exit status
# 1: their reports go into files, which the runner looks for after each test.
scale=1
[ "$FLAVOUR" = release ] || scale=4
if [ $memcheck = 1 ]; then
    command -v valgrind >/dev/null || die "there is no valgrind on this machine"
    scale=10
fi

# --- which tests -----------------------------------------------------------------------------------------

# comment_value KEY FILE: the value of the line "# KEY: value" among the comments that open the file.
comment_value()
{
    sed -n -e '/^#/!q' -e "s/^# $1: *//p" "$2" | sed -e 1q
}

# One line per test: name, time limit, path, labels.
discover()
{
    for file in "$tests"/unit/test_*.c; do
        [ -f "$file" ] || continue
        name=${file##*/test_}
        name=${name%.c}
        printf '%s\t%s\t%s\t%s\n' "unit_$name" "$default_limit" "$DM2_BUILD/tests/test_$name" unit
    done
    for file in "$tests"/e2e/*.sh; do
        [ -f "$file" ] || continue
        name=${file##*/}
        labels=$(comment_value labels "$file")
        limit=$(comment_value timeout "$file")
        printf '%s\t%s\t%s\t%s\n' "e2e_${name%.sh}" "${limit:-$default_limit}" "$file" "${labels:-e2e}"
    done
}

chosen=$(
    discover | while IFS='	' read -r name limit path labels; do
        case " $labels " in
        *" ${label:-${labels%% *}} "*) ;;
        *) continue ;;
        esac
        if [ -n "$match" ] && ! printf '%s\n' "$name" | grep -E -q -e "$match"; then continue; fi
        if [ -n "$exclude" ] && printf '%s\n' "$name" | grep -E -q -e "$exclude"; then continue; fi
        printf '%s\t%s\t%s\t%s\n' "$name" "$limit" "$path" "$labels"
    done
)
total=0
[ -z "$chosen" ] || total=$(printf '%s\n' "$chosen" | wc -l | tr -d ' ')

if [ $list = 1 ]; then
    [ "$total" -eq 0 ] || printf '%s\n' "$chosen" | awk -F '\t' \
        '{ printf "  Test %3s: %-40s %s\n", "#" NR, $1, $4 }'
    printf '\nTotal Tests: %d\n' "$total"
    exit 0
fi
[ "$total" -gt 0 ] || die "no test matches"

# --- running ---------------------------------------------------------------------------------------------

supervise=$DM2_BUILD/tools/supervise
[ -x "$supervise" ] || die "$supervise is not built: run make tests"
logs=$DM2_BUILD/test-logs
scratch=$DM2_BUILD/test-tmp/$$
rm -rf "$logs" "$scratch"
mkdir -p "$logs" "$scratch" || die "cannot write below $DM2_BUILD"
# Scratch directories of earlier failed runs go; directories of runs in progress stay.
for old in "$DM2_BUILD"/test-tmp/*; do
    kill -0 "${old##*/}" 2>/dev/null || rm -rf "$old"
done
mkfifo "$scratch/results" || die "mkfifo failed in $scratch"
exec 3<>"$scratch/results"

supervisors=
stop()
{
    trap '' HUP INT TERM
    for pid in $supervisors; do
        kill -TERM "$pid" 2>/dev/null
    done
    wait
    rm -rf "$scratch"
    printf '\ntests/run.sh: interrupted\n'
    exit "$1"
}
trap 'stop 129' HUP
trap 'stop 130' INT
trap 'stop 143' TERM

# line_of INDEX: sets name, limit, path, labels of the test with this number.
line_of()
{
    IFS='	' read -r name limit path labels <<END
$(printf '%s\n' "$chosen" | sed -n -e "$1p")
END
}

# launch INDEX: starts the test, or reports at once that its program is missing.
launch()
{
    line_of "$1"
    if [ ! -f "$path" ]; then
        printf '%s: not built; the compiler said why above (make tests)\n' "$path" >"$logs/$name.log"
        printf '%s missing 0 0.00\n' "$1" >&3
        return
    fi
    mkdir "$scratch/$name"
    case $path in
    "$tests"/*)
        set -- "$1" sh "$path"
        here=$scratch/$name
        ;;
    *)
        set -- "$1" "$path"
        here=$DM2_SRC
        [ $memcheck = 0 ] || set -- "$1" valgrind -q --leak-check=full --error-exitcode=99 "$path"
        ;;
    esac
    index=$1
    shift
    (
        cd "$here" || exit 1
        TMPDIR=$scratch/$name
        ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}log_path=$logs/$name.sanitizer
        UBSAN_OPTIONS=${UBSAN_OPTIONS:+$UBSAN_OPTIONS:}print_stacktrace=1:log_path=$logs/$name.sanitizer
        TSAN_OPTIONS=${TSAN_OPTIONS:+$TSAN_OPTIONS:}log_path=$logs/$name.sanitizer
        export TMPDIR ASAN_OPTIONS UBSAN_OPTIONS TSAN_OPTIONS
        exec "$supervise" "$index" $((limit * scale)) "$logs/$name.log" "$@" >&3 3>&-
    ) &
    supervisors="$supervisors $!"
}

# The part of a line before the result: `  3/57 Test  #3: unit_grid ............`
number_width=${#total}
name_width=$(printf '%s\n' "$chosen" | awk -F '\t' 'length($1) > n { n = length($1) } END { print n + 5 }')
[ "$name_width" -ge 36 ] || name_width=36
dots=................................................................................
head_of()
{
    printf "%$((number_width + 1))d/%d Test %$((number_width + 1))s: %.${name_width}s" \
        "$done" "$total" "#$1" "$name $dots$dots"
}

# The signal's usual name for the common ways to crash.
crash_name()
{
    case $1 in
    4) echo "Illegal instruction" ;;
    6) echo "Abort" ;;
    8) echo "Arithmetic error" ;;
    11) echo "SegFault" ;;
    *) echo "signal $1" ;;
    esac
}

# report INDEX HOW CODE SECONDS: prints the line of a test that has ended and puts it into its list.
report()
{
    line_of "$1"
    log=$logs/$name.log
    for found in "$logs/$name.sanitizer".*; do
        [ -f "$found" ] || continue
        printf -- '--- a sanitizer wrote:\n' >>"$log"
        cat "$found" >>"$log"
        rm -f "$found"
        set -- "$1" sanitizer 0 "$4"
    done
    reason=
    case $2-$3 in
    exit-0) result='   Passed ' ;;
    exit-77)
        result='***Skipped'
        reason=$(sed -n -e 's/^skipped: *//p' "$log" | sed -e 1q)
        : "${reason:=it gave no reason}"
        ;;
    exit-*)
        result='***Failed '
        reason="exit status $3"
        ;;
    signal-*)
        result='***Crashed'
        reason=$(crash_name "$3")
        ;;
    timeout-*)
        result='***Timeout'
        reason="not done after $((limit * scale)) s"
        ;;
    missing-*)
        result='***Not Run'
        reason="its program is not built"
        ;;
    sanitizer-*)
        result='***Failed '
        reason="a sanitizer's finding"
        ;;
    *)
        result='***Not Run'
        reason="it could not be started: error $3"
        ;;
    esac
    printf '%s %s %7s sec%s\n' "$(head_of "$1")" "$result" "$4" "${reason:+  ($reason)}"
    state=failed
    case $result in
    *Passed*) state=passed ;;
    *Skipped*) state=skipped ;;
    esac
    if [ $show = all ] || { [ $show = failed ] && [ $state = failed ]; }; then
        sed -e 's/^/    | /' "$log"
    fi
    case $state in
    failed)
        failed=$((failed + 1))
        failures="$failures
	$1 - $name ($reason): $log"
        return
        ;;
    skipped)
        skips="$skips
	$1 - $name: $reason"
        ;;
    esac
    rm -rf "${scratch:?}/$name" "$log"
}

printf 'Test project %s (%s)\n' "$DM2_SRC" "$FLAVOUR"
begin=$(date +%s)
failed=0 failures= skips=
running=0 done=0 repeated=' '
# Long tests begin first, so that none of them is left to run alone at the end.
# shellcheck disable=SC2046  # the numbers are words
set -- $(printf '%s\n' "$chosen" | awk -F '\t' '$4 ~ /(^| )slow( |$)/ { print NR }') \
    $(printf '%s\n' "$chosen" | awk -F '\t' '$4 !~ /(^| )slow( |$)/ { print NR }')
while [ "$done" -lt "$total" ]; do
    while [ "$running" -lt "$jobs" ] && [ $# -gt 0 ]; do
        launch "$1"
        shift
        running=$((running + 1))
    done
    read -r index how code seconds <&3
    if [ $repeat = 1 ] && [ "$how" = timeout ] && [ "${repeated#* $index }" = "$repeated" ]; then
        repeated="$repeated$index "
        line_of "$index"
        printf '%s %s %7s sec  (once more)\n' "$(head_of "$index")" '***Timeout' "$seconds"
        sed -e 's/^/    | /' "$logs/$name.log"
        rm -rf "${scratch:?}/$name"
        launch "$index"
        continue
    fi
    running=$((running - 1))
    done=$((done + 1))
    report "$index" "$how" "$code" "$seconds"
done
wait
end=$(date +%s)

rm -f "$scratch/results"
rmdir "$scratch" 2>/dev/null && rmdir "$DM2_BUILD/test-tmp" 2>/dev/null
printf '\nTotal Test time (real) = %d sec\n' $((end - begin))
[ -z "$skips" ] || printf '\nThe following tests were skipped:%s\n' "$skips"
if [ -n "$failures" ]; then
    printf '\nThe following tests FAILED; their directories are below %s:%s\n' "$scratch" "$failures"
fi
printf '\n%d%% tests passed, %d tests failed out of %d\n' $(((total - failed) * 100 / total)) "$failed" \
    "$total"
[ "$failed" -eq 0 ]
