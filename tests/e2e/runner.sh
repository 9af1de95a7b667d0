# The tests' runner itself, on a made-up tree: tests that pass, fail, hang, skip, crash, leave processes
# behind or were never built are reported as such.
# labels: check
. "$DM2_SRC/tests/lib.sh"

mkdir -p tree/tests/unit tree/tests/e2e build/tests build/tools
cp "$DM2_BUILD/tools/supervise" build/tools/supervise

# A unit test program is a file in build/tests; its source only has to exist.
program()
{
    : >"tree/tests/unit/test_$1.c"
    { echo '#!/bin/sh'; cat; } >"build/tests/test_$1"
    chmod +x "build/tests/test_$1"
}
script()
{
    cat >"tree/tests/e2e/$1.sh"
}

# run STATUS OPTION...: the runner on the tree, its output in the file `out`.
run()
{
    run_want=$1
    shift
    expect_status "$run_want" env DM2_TESTS="$PWD/tree/tests" DM2_BUILD="$PWD/build" \
        DM2_BIN="$PWD/build/bin" \
        FLAVOUR=release sh "$DM2_SRC/tests/run.sh" "$@"
}
last_line_is()
{
    run_last=$(tail -n 1 out)
    [ "$run_last" = "$1" ] || fail "the last line is '$run_last', expected '$1'"
}
expect_line()
{
    grep -E -q -e "$1" out || { cat out; fail "no line matches '$1'"; }
}

program good <<'END'
[ -z "$(ls -A "$TMPDIR")" ] || { echo "its directory is not empty"; exit 1; }
[ "$PWD" = "$DM2_SRC" ] || { echo "it does not start at the top"; exit 1; }
echo something >"$TMPDIR/left-over"
END
script nice <<'END'
[ -n "$DM2_SRC" ] && [ -d "$DM2_SRC/tests/e2e" ] && [ "$FLAVOUR" = release ] || exit 1
[ -z "$(ls -A)" ] || { echo "its directory is not empty"; exit 1; }
[ "$PWD" = "$TMPDIR" ] || exit 1
pwd >"$DM2_BUILD/where"
echo something >left-over
END

# All is well.
run 0
expect_line '^ [12]/2 Test +#1: unit_good \.+    Passed +[0-9]+\.[0-9][0-9] sec$'
expect_line '^ [12]/2 Test +#2: e2e_nice \.+    Passed '
last_line_is '100% tests passed, 0 tests failed out of 2'
[ ! -e "$(cat build/where)" ] || fail "the directory of a passed test is still there"
[ -z "$(ls build/test-logs)" ] || fail "logs of passed tests were kept"

# A skip counts as passed and is listed with its reason.
program skipping <<'END'
echo "skipped: no moon tonight"
exit 77
END
run 0
expect_line 'unit_skipping \.+ \*\*\*Skipped .*no moon tonight'
expect_line 'unit_skipping: no moon tonight$'
last_line_is '100% tests passed, 0 tests failed out of 3'

# A failure.
program bad <<'END'
echo "two is 3, expected 2"
echo "$TMPDIR" >"$DM2_BUILD/bad-where"
exit 1
END
run 1
expect_line 'unit_bad \.+ \*\*\*Failed .*exit status 1'
expect_line '^	[0-9]+ - unit_bad '
last_line_is '75% tests passed, 1 tests failed out of 4'
grep -q 'two is 3' build/test-logs/unit_bad.log || fail "the log of the failure is not there"
[ -d "$(cat build/bad-where)" ] || fail "the directory of a failed test is gone"
if grep -q 'two is 3' out; then fail "the output of a failure is printed unasked"; fi
run 1 --output-on-failure
expect_text out 'two is 3'
rm -f build/tests/test_bad tree/tests/unit/test_bad.c

# A program that was not built is a failure, which its source alone shows.
: >tree/tests/unit/test_ghost.c
run 1
expect_line 'unit_ghost \.+ \*\*\*Not Run .*not built'
last_line_is '75% tests passed, 1 tests failed out of 4'
rm tree/tests/unit/test_ghost.c

# A crash, by its signal.
program crash <<'END'
kill -SEGV $$
END
run 1 -R crash
expect_line 'unit_crash \.+ \*\*\*Crashed .*SegFault'
last_line_is '0% tests passed, 1 tests failed out of 1'
rm build/tests/test_crash tree/tests/unit/test_crash.c

# A test that hangs, with a child that ignores TERM: both end, the test beside it is not touched.
script hang <<'END'
# labels: e2e slow
# timeout: 1
trap '' TERM
sh -c 'trap "" TERM; echo $$ >"$DM2_BUILD/child"; while :; do sleep 5; done' &
wait
END
script patient <<'END'
while [ ! -s "$DM2_BUILD/child" ]; do :; done
END
run 1 -j 2 -L e2e
expect_line 'e2e_hang \.+ \*\*\*Timeout .*not done after 1 s'
expect_line 'e2e_patient \.+    Passed'
expect_line '^ 3/3 Test .*e2e_hang' # lines come in the order of finishing
last_line_is '66% tests passed, 1 tests failed out of 3'
gone() # a process that is dead, or a zombie that nobody has collected
{
    ! kill -0 "$1" 2>/dev/null || ps -o stat= -p "$1" 2>/dev/null | grep -q '^Z'
}
gone "$(cat build/child)" || fail "the child of a test that hung still runs"
rm tree/tests/e2e/hang.sh tree/tests/e2e/patient.sh

# The leftover processes of a passed test are ended, too.
script leave <<'END'
sh -c 'echo $$ >"$DM2_BUILD/child"; exec sleep 1000' &
while [ ! -s "$DM2_BUILD/child" ]; do :; done
END
: >build/child
run 0 -R leave
gone "$(cat build/child)" || fail "a process that a passed test left behind still runs"
rm tree/tests/e2e/leave.sh

# A test that reached its time limit runs once more where the options ask for it, and only once.
script late <<'END'
# timeout: 1
[ -f "$DM2_BUILD/tried" ] && exit 0
: >"$DM2_BUILD/tried"
while :; do sleep 5; done
END
run 0 -R late --repeat after-timeout:2
expect_line 'e2e_late \.+ \*\*\*Timeout .*once more'
last_line_is '100% tests passed, 0 tests failed out of 1'
sed -i.bak 's/exit 0/:/' tree/tests/e2e/late.sh
run 1 -R late --repeat after-timeout:2
last_line_is '0% tests passed, 1 tests failed out of 1'
rm tree/tests/e2e/late.sh tree/tests/e2e/late.sh.bak build/tried

# A sanitizer's finding fails a test that exits 0.
program dirty <<'END'
echo "heap-use-after-free" >"${ASAN_OPTIONS##*log_path=}.1234"
END
run 1 -R dirty
expect_line 'unit_dirty \.+ \*\*\*Failed .*sanitizer'
grep -q heap-use build/test-logs/unit_dirty.log || fail "the sanitizer's text is not in the log"
rm build/tests/test_dirty tree/tests/unit/test_dirty.c

# Choosing.
script other <<'END'
# labels: check slow
END
rm -rf build/test-tmp
run 0 -N
expect_line '^Total Tests: 4$'
[ ! -d build/test-tmp ] || fail "-N ran something"
for choice in '-L unit:2' '-L e2e:1' '-L check:1' '-L slow:1' '-R good|other:2' '-E unit:2' \
    '-L unit -E good:1'; do
    # shellcheck disable=SC2086  # the options are words
    run 0 -N ${choice%:*}
    expect_line "^Total Tests: ${choice##*:}\$"
done
run 2 -R nothing-of-this-name
expect_text err 'no test matches'
run 2 --nonsense
expect_text err "unknown option '--nonsense'"
run 2 -j
expect_text err '-j needs a value'
run 2 -j 0
run 2 -j some

# An interrupted runner ends its tests and says so.
script forever <<'END'
echo $$ >"$DM2_BUILD/child"
exec sleep 1000
END
rm build/child
mkfifo build/child
DM2_TESTS=$PWD/tree/tests DM2_BUILD=$PWD/build DM2_BIN=$PWD/build/bin sh "$DM2_SRC/tests/run.sh" -R forever \
    >out 2>&1 &
runner=$!
read -r child <build/child
kill -TERM "$runner"
status=0
wait "$runner" || status=$?
[ "$status" -eq 143 ] || fail "an interrupted run exits with $status, expected 143"
expect_text out 'interrupted'
gone "$child" || fail "the test of an interrupted run still runs"
