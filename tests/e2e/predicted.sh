# Predicted beside measured: every run of dm2-client says what the model predicted and names the largest cause
# of the difference, with a calibration file or without.
# timeout: 120
. "$DM2_SRC/tests/lib.sh"
client=$DM2_BIN/dm2-client
deck=$DM2_SRC/tests/decks/run/scatter.dm2
host=$(uname -n)
version=$("$client" --version | cut -d ' ' -f 2)

# said FILE: FILE has both lines, with numbers, and a known cause.
said()
{
    grep -E -q '^predicted: [0-9.e+-]+ ms per step = [0-9.e+-]+ computing \+ [0-9.e+-]+ communication \(' \
        "$1" ||
        { cat "$1"; fail "$1 has no prediction"; }
    grep -E -q '^measured: [0-9.e+-]+ ms per step, [+-][0-9.e+]+ %;
        largest cause of the difference: (computing|imbalance|migration|relay|waiting), [+-]' \
        "$1" || { cat "$1"; fail "$1 does not put the measurement beside it"; }
    grep -E -q '^speedup: [0-9.e+-]+, efficiency [0-9.e+-]+, against T_seq ' "$1" || fail "$1 has no speedup"
}

expect_status 0 "$client" "$deck" -n 2 -o plain
said out
said plain/run.log
expect_text out "estimated from this run's own"
expect_status 0 "$client" "$deck" -n 2 -o quiet -q
[ ! -s out ] || fail "--quiet prints the prediction"
said quiet/run.log
cmp plain/final.dm2 quiet/final.dm2 || fail "the echo at the start changes results"

calibration() # HOST VERSION
{
    printf '%s\n' quantity,servers,value,unit format,,2, "host,,$1," "version,,$2," d_x,,0.04,cm \
        d_y,,0.03464,cm \
        L_x,,0.121,cm L_y,,0.121,cm g,,40,byte k,,1e-07,s k_spread,,0,s sizes,,0, networks,,1, \
            m,2,1e-09,s/byte \
        b,2,1e-05,s residual,2,0,s
}
calibration "$host" "$version" >here.csv
calibration elsewhere "$version" >there.csv
expect_status 0 "$client" "$deck" -n 2 -o with --calibration here.csv
expect_text out '(calibrated: here.csv'
said with/run.log
expect_status 0 env DM2_CALIBRATION=here.csv "$client" "$deck" -n 3 -o environment
expect_text out 'm and b inferred from other numbers of servers'

# A calibration of another machine is not used, and the run says so; with --calibration it is an error.
cp there.csv dm2-calibration.csv
expect_status 0 "$client" "$deck" -n 2 -o stale
expect_text err "on the host 'elsewhere'"
expect_text out "estimated from this run's own"
expect_status 2 "$client" "$deck" -n 2 -o refused --calibration there.csv
expect_text err "on the host 'elsewhere'"
[ ! -e refused ] || fail "a run directory was made although the calibration is refused"
expect_status 1 "$client" "$deck" -n 2 -o missing --calibration missing.csv
expect_text err missing.csv

# A run without steps has nothing to compare.
expect_status 0 "$client" "$deck" -n 2 -o none --steps 0
! grep -q '^predicted' out || fail "a prediction for no step"

# On named servers: the same lines, with a calibration and without; each server counts as a machine.
start_server
echo "$SERVER_ADDR" >hosts
start_server
echo "$SERVER_ADDR" >>hosts
rm -f dm2-calibration.csv
expect_status 0 "$client" "$deck" --hosts hosts -o named
said out
said named/run.log
expect_text out "estimated from this run's own"
expect_status 0 "$client" "$deck" --hosts hosts -o named --overwrite --calibration here.csv
said out
expect_text out '(calibrated: here.csv)'

# One of four servers is slow because it sleeps, so that the load of this machine does not matter, and with
# these constants nothing takes time: of a difference that is all of the time, that server's work beyond the
# average is three quarters of the computing.
sed -e 's/^k,.*/k,,1e-25,s/; s/^m,2.*/m,2,0,s\/byte/; s/^b,2.*/b,2,0,s/' here.csv >nothing.csv
start_server
echo "$SERVER_ADDR" >>hosts
mkdir slow
ln -s "$DM2_BUILD/failing/slow-server" slow/dm2-server
DM2_SLOW=20
export DM2_SLOW
DM2_BIN=$PWD/slow
start_server
echo "$SERVER_ADDR" >>hosts
expect_status 0 "$client" "$deck" --hosts hosts --steps 3 -o lopsided --calibration nothing.csv
said out
expect_text out 'largest cause of the difference: imbalance, +'
