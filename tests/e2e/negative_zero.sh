# An element alone and the inner elements of a sheared strip have a pressure of 0, some by -0 + -0 and some by
# xx = -yy: the history has the same bytes for every number of servers, and no file has a -0.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
cat >shear.dm2 <<'DECK'
# Lengths are whole numbers of u: no rounding. (d - a) a = (d + b) b, so that P of the strip is exactly 0.
let u = 1 cm / 2^17
let d = 4901*u
let x = 4851*u
let y = 4950*u
domain { size = 48*x, 1.2 cm; boundary = periodic free; r_c = 2.5*d; delta_r = 0.25*d }
time { dt = 0.001 us; steps = 2 }
material M { rho0 = 8 g/cm3; c0 = 4 km/s }
interaction { potential = quadratic }
body alone { shape = rectangle 46.9*x, 0, 47.9*x, d; spacing = d; origin = 47.5*x, d/2; material = M
    velocity = -0, 0 }
body strip {
    shape = rectangle 0, 4.5*y, 48*x, 16.5*y
    lattice = square; spacing = x; row_spacing = y; radius = d/2; origin = x/2, y
    material = M
}
output { history_every = 1; snapshot_every = 1; format = vtp xyz }
DECK
expect_status 0 "$DM2_BIN/dm2-seq" -q -o seq --checkpoint-every 1 shear.dm2
for n in 1 2 3 5; do
    expect_status 0 "$DM2_BIN/dm2-client" -n $n -q --progress never -o "c$n" shear.dm2
    for file in history.csv final.dm2 snapshots/state-000000002.vtp snapshots/state-000000002.xyz; do
        same_bytes seq/$file "c$n/$file"
    done
done
for file in seq/history.csv seq/snapshots/*.xyz; do
    if grep -n -E '(^|[ ,])-0([ ,]|$)' "$file" >minus; then
        head -n 3 minus
        fail "$file has a -0"
    fi
done
pressure=$(awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k ~ /^pressure_min/) at = k } NR == 2 {
    print $at }' seq/history.csv)
[ "$pressure" = 0 ] || fail "pressure_min is $pressure"
