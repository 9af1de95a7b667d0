# Walls that move by stresses, forces, tables of velocity, spin, temperature: the same bytes for any number of
# servers, from a restart, after the loss of a server.
# labels: e2e bits
. "$DM2_SRC/tests/lib.sh"

cat >deck.dm2 <<'END'
let d = 0.02
let width = 24 * d
let top = 12 * d
domain { size = width, top + 4*d; boundary = periodic free; r_c = 1.3*d; delta_r = 0.3*d }
time { dt = 0.006 us; steps = 500 }
material al { rho0 = 2.7; c0 = 0.534; s = 1.34; cp = 9e-6; kappa = 2.37e-11 }
interaction { zeta = 0.2; ct_ratio = 0.05; mu = 0.5; linked = no }
body grains { shape = rectangle 0, 2*d, width, top; structure = discs; grain_size = 1.001*d
              solid_fraction = 0.75; spacing = d; material = al; seed = 2; jitter = 0.005 }
void hole { shape = disc 16*d, 7*d, 2*d }
wall floor { line = 0, 1.4*d, 9*d, 1.2*d, width, 1.4*d; material = al }
wall lid { line = 0, top + 0.6*d, width, top + 0.6*d; rigid = yes; velocity = 0.002 0 }
wall paddle { line = 15*d, 7*d, 17*d, 7*d; material = al }
load press { body = lid; stress_yy = 0 us -0.0005 Mbar, 3 us -0.001 Mbar; max_velocity = 0.003 }
load drag { body = floor; force_x = 0 us 0, 2 us 1e-4, 4 us 0; force_y = 0 us 1e-4, 1 us 2e-4
            temperature = 0 us 300, 2 us 400 }
load stir { body = paddle; spin = 0 us 0, 1 us 0.1; velocity_y = 0 us 0, 2 us 0.002 }
output { history_every = 50; snapshot_at = 0, 300, 500 }
END

same_run()
{
    for file in final.dm2 history.csv snapshots/state-000000300.vtp snapshots/state-000000500.vtp; do
        same_bytes "whole/$file" "$1/$file"
    done
}
expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 -q -o whole
for n in 1 2 3 5; do
    expect_status 0 "$DM2_BIN/dm2-client" deck.dm2 -n $n -q -o "servers-$n"
    same_run "servers-$n"
done

# --- from a state ---
expect_status 0 "$DM2_BIN/dm2-client" deck.dm2 -n 3 -q -o half --steps 251
expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 -q -o rest --restart half/final.dm2
same_bytes whole/final.dm2 rest/final.dm2
expect_status 0 "$DM2_BIN/dm2-client" deck.dm2 -n 2 -q -o rest2 --restart half/final.dm2
same_bytes whole/final.dm2 rest2/final.dm2

# --- a server is lost; the run goes on from a copy, whose totals are the client's ---
start_server
one=$SERVER_ADDR
start_server
two=$SERVER_ADDR two_pid=$SERVER_PID
mkfifo hashes
"$DM2_BIN/dm2-client" deck.dm2 --reconnect 0.1 --server "$one" --server "$two" -o lost --hash-every 1 \
    --copy-every 25 >hashes 2>err </dev/null &
client_pid=$!
exec 4<hashes
count=0
while [ $count -le 190 ] && IFS= read -r line <&4; do
    count=$((count + 1))
done
kill -KILL "$two_pid"
cat <&4 >rest.hashes
exec 4<&-
wait $client_pid || fail "the client did not go on: $(cat err)"
same_run lost
expect_text lost/run.log 'servers lost and made good: 2'

# --- what is said ---
expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 --check
expect_text out "load 'press' moves 'lid' along y: mass"
expect_text out "load 'drag' moves 'floor' along x: mass"
sed 's/stress_yy = 0 us -0.0005/stress_yy = 0 us 0.5/; s/max_velocity = 0.003/max_velocity = 0.5/
    s/steps = 500/steps = 4000/' deck.dm2 >away.dm2
expect_status 1 "$DM2_BIN/dm2-seq" away.dm2 -o away
expect_text err "load 'press' has moved 'lid' by 0."
expect_text err "further beyond the domain than the domain is long"

# One more than can move by forces.
(cat deck.dm2 && for k in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17; do
    echo "wall w$k { line = 0.1 0.1, 0.2 0.1; rigid = yes }"
    echo "load l$k { body = w$k; force_x = 0 1e-4, 1 1e-4 }"
done) >many.dm2
expect_status 2 "$DM2_BIN/dm2-seq" many.dm2 --check
expect_text err 'at most 16 bodies and walls move by forces or stresses'
