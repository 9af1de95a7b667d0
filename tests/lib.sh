# Functions for end-to-end tests. A test begins with
#
#     . "$DM2_SRC/tests/lib.sh"
#
# tests/run.sh gives it an empty directory as working directory and TMPDIR, and in the environment DM2_SRC
# (the source tree), DM2_BIN (the programs), DM2_BUILD (the flavour's build directory) and FLAVOUR. A test
# passes when it exits 0, is skipped when it exits 77, and fails otherwise. It may name its labels and its
# time limit in its opening comment: `# labels: e2e slow` (the default is e2e) and `# timeout: 120` (seconds,
# default 60).
#
# `fail` and `skip` exit: call them from the test itself, not from within $(...) or a pipe. The processes that
# start_server starts are ended, by their ids, when the test exits.
set -u

lib_servers= # ids of the servers that stop_all has to end
lib_count=0  # servers started so far

trap 'lib_status=$?; stop_all; exit $lib_status' EXIT
trap 'exit 129' HUP
trap 'exit 130' INT
trap 'exit 143' TERM

# fail TEXT...: ends the test as failed.
fail()
{
    printf 'FAILED: %s\n' "$*"
    exit 1
}

# skip REASON...: ends the test as skipped.
skip()
{
    printf 'skipped: %s\n' "$*"
    exit 77
}

# start_server [OPTION...]: starts dm2-server on a free port and returns once it listens. Sets SERVER_PID,
# SERVER_ADDR (host:port), SERVER_PORT, SERVER_OUT and SERVER_LOG (files with its standard output and standard
# error).
start_server()
{
    lib_count=$((lib_count + 1))
    SERVER_OUT=$PWD/server-$lib_count.out
    SERVER_LOG=$PWD/server-$lib_count.err
    # The server writes into one fifo. Its reader hands the first line on through the other, then keeps the
    # first open for the server's whole life, so that no later line meets a closed pipe.
    mkfifo "server-$lib_count.fifo" "server-$lib_count.ready" || fail "mkfifo failed"
    {
        IFS= read -r lib_line || lib_line=
        printf '%s\n' "$lib_line" >"server-$lib_count.ready"
        printf '%s\n' "$lib_line" >"$SERVER_OUT"
        exec cat >>"$SERVER_OUT"
    } <"server-$lib_count.fifo" &
    "$DM2_BIN/dm2-server" --port 0 "$@" >"server-$lib_count.fifo" 2>"$SERVER_LOG" </dev/null &
    SERVER_PID=$!
    lib_servers="$lib_servers $SERVER_PID"
    IFS= read -r lib_line <"server-$lib_count.ready" || lib_line=
    rm -f "server-$lib_count.fifo" "server-$lib_count.ready"
    case $lib_line in
    'dm2-server: listening on '*:*)
        SERVER_ADDR=${lib_line##* }
        SERVER_PORT=${SERVER_ADDR##*:}
        ;;
    *)
        cat "$SERVER_LOG"
        fail "dm2-server $* did not say where it listens; its first line is '$lib_line'"
        ;;
    esac
}

# stop_server PID: ends one server by TERM and waits. Sets SERVER_STATUS to its exit status.
stop_server()
{
    kill -TERM "$1" 2>/dev/null
    kill -CONT "$1" 2>/dev/null
    SERVER_STATUS=0
    wait "$1" 2>/dev/null || SERVER_STATUS=$?
    lib_rest=
    for lib_pid in $lib_servers; do
        [ "$lib_pid" = "$1" ] || lib_rest="$lib_rest $lib_pid"
    done
    lib_servers=$lib_rest
}

# stop_all: ends every server that start_server started and that still runs.
stop_all()
{
    for lib_each in $lib_servers; do
        stop_server "$lib_each"
    done
}

# expect_status CODE COMMAND...: runs COMMAND, with its standard output in the file `out` and its standard
# error in `err`, and fails the test unless COMMAND exits with CODE.
expect_status()
{
    lib_want=$1
    shift
    lib_got=0
    "$@" >out 2>err </dev/null || lib_got=$?
    if [ "$lib_got" -ne "$lib_want" ]; then
        printf -- '--- standard output\n'
        tail -n 40 out
        printf -- '--- standard error\n'
        tail -n 40 err
        fail "exit status $lib_got, expected $lib_want, of: $*"
    fi
}

# expect_text FILE TEXT: the file has a line that contains TEXT.
expect_text()
{
    if ! grep -F -q -e "$2" "$1"; then
        printf -- '--- %s\n' "$1"
        tail -n 40 "$1"
        fail "$1 does not contain '$2'"
    fi
}

# same_bytes A B: two files are byte-identical.
same_bytes()
{
    [ -f "$1" ] || fail "$1 is not there"
    [ -f "$2" ] || fail "$2 is not there"
    cmp "$1" "$2" || fail "$1 and $2 differ"
}
