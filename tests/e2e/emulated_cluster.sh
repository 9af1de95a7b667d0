# The emulated cluster: a run through it gives the same bits, and nothing is left behind, whatever happens.
# timeout: 120
. "$DM2_SRC/tests/lib.sh"
script=$DM2_SRC/scripts/emulated-cluster
export DM2_BIN

expect_status 2 sh "$script" 10baset
expect_status 2 sh "$script" token-ring 2 true
expect_status 2 sh "$script" fast 0 true

status=0
sh "$script" fast 1 true >out 2>err || status=$?
[ "$status" -ne 77 ] || skip "$(sed -e 's/^skipped: //' out)"
[ "$status" -eq 0 ] || { cat out err; fail "exit status $status"; }

deck=$DM2_SRC/tests/decks/run/scatter.dm2
expect_status 0 sh "$script" unlimited 2 sh -c \
    "\"$DM2_BIN/dm2-client\" \"$deck\" -q -o far --steps 10 --hosts \"\$HOSTS\" --key \"\$KEY\""
expect_status 0 "$DM2_BIN/dm2-seq" "$deck" -q -o here --steps 10
same_bytes far/final.dm2 here/final.dm2

# A run through a slow link takes longer than constants without a network predict, because the run waits.
printf '%s\n' quantity,servers,value,unit format,,2, "host,,$(uname -n)," \
    "version,,$("$DM2_BIN/dm2-client" --version | cut -d ' ' -f 2)," d_x,,0.04,cm d_y,,0.03464,cm \
        L_x,,0.121,cm L_y,,0.121,cm \
    g,,40,byte k,,1e-08,s k_spread,,0,s sizes,,0, networks,,1, m,2,0,s/byte b,2,0,s residual,2,0,s >here.csv
expect_status 0 sh "$script" 10baset 2 sh -c "\"$DM2_BIN/dm2-client\" \"$DM2_SRC/input/timing.dm2\" \
    -D n=4000 --steps 6 -o slow \
    --calibration here.csv --hosts \"\$HOSTS\" --key \"\$KEY\""
expect_text out 'largest cause of the difference: waiting, +'

# nothing_left PID: no namespace, process, link, control file or directory of the script with this id is
# there.
mkdir -m 777 temporary
nothing_left()
{
    ! ip netns list | grep -q "^dm2e$1-" || { ip netns list; fail "namespaces are left"; }
    ! ip -o link show | grep -q "dm2e$1-" || fail "links are left"
    [ -z "$(ls temporary)" ] || fail "a temporary directory is left: $(ls temporary)"
    for process in $watched; do
        case $(ps -o stat= -p "$process") in
        '' | Z*) ;; # gone, or waits for its new parent to notice
        *) fail "process $process is left: $(ps -o args= -p "$process")" ;;
        esac
    done
    watched=
}

# in_front PRESET N COMMAND...: starts the script as a terminal does; $pid is it and its process group.
programs=$DM2_BIN
in_front()
{
    TMPDIR=$PWD/temporary DM2_BIN=$programs "$DM2_BUILD/tools/foreground" sh "$script" "$@" >out 2>err &
    pid=$!
}

# ended STATUS
ended()
{
    status=0
    wait "$pid" || status=$?
    [ "$status" -eq "$1" ] || { cat out err; fail "exit status $status, expected $1"; }
    nothing_left "$pid"
}

# A command that fails, a command that cannot be started, a server that cannot be started.
watched=
in_front fast 2 false
ended 1
in_front fast 2 ./missing
ended 1
expect_text err ./missing
mkdir broken
printf '#!/bin/sh\n[ "$1" != --new-key ] || exec "%s/dm2-server" "$@"\nexit 1\n' "$DM2_BIN" >broken/dm2-server
chmod +x broken/dm2-server
programs=$PWD/broken
in_front fast 2 true
ended 1
expect_text err 'did not start'
programs=$DM2_BIN

# Signals, while the command has a process of its own, which ignores them the first time: Ctrl-C goes to the
# whole group, the other signals to the script alone.
mkfifo started
cat >parent <<'END'
(trap '' $1; exec sleep 50) &
echo "$$ $! up" >started
wait
END
ignored='INT TERM HUP'
for how in INT:-:130 TERM::143 HUP::129; do
    in_front fast 2 sh ./parent "$ignored"
    ignored=INT
    read -r shell sleeper line <started
    [ "$line" = up ] || fail "the command did not start"
    watched="$shell $sleeper $(cat /proc/"$pid"/task/"$pid"/children)"
    signal=${how%%:*} status=${how##*:} group=${how#*:}
    kill -s "$signal" -- "${group%:*}$pid"
    ended "$status"
done

# Without the rights nothing is made, and the reason is said.
chmod 777 .
setpriv --reuid 65534 --regid 65534 --clear-groups true 2>/dev/null || exit 0
reached=$(setpriv --reuid 65534 --regid 65534 --clear-groups sh -c \
    "[ -r '$script' ] && [ -w temporary ] && echo yes" 2>/dev/null)
[ "$reached" = yes ] || exit 0
expect_status 77 setpriv --reuid 65534 --regid 65534 --clear-groups env TMPDIR="$PWD/temporary" sh "$script" \
    fast 2 true
expect_text out 'skipped: network namespaces cannot be made (this takes root and the ip program): '
[ -z "$(ls temporary)" ] || fail "a temporary directory is left after a skip"
