# A wall of elements much smaller than those that press on it is harder and more lossy than one contact with a
# plane; `--check` says so, and names the bodies. A row of elements of their own size has the restitution of
# one contact.
. "$DM2_SRC/tests/lib.sh"

cat >deck.dm2 <<'END'
let d = 0.04 cm
let q = 20
let fine = d/q
let v = 100 m/s
let z = 0
let half = round(0.1 cm / fine)*fine + 0.5*fine
let top = fine/2 + 0.5*(d + fine) + 1e-6 cm
domain { size = 2*half + 4*d, 0.4 cm; r_c = 1.25*d; delta_r = 0.1*d }
time { dt = 1 ns; steps = 1200 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 0.375 }
interaction { potential = quadratic; zeta = z; linked = no }
body wall { shape = rectangle 0, 0, 2*half + 4*d, 0.9*fine; spacing = fine; origin = fine/2, fine/2
    material = Cu; motion = fixed }
body ball { shape = disc half, top, 0.1*fine; spacing = d; origin = half, top; material = Cu
    velocity = 0, -v }
probe ball { region = 0, fine, 2*half + 4*d, 0.4 cm }
output { history_every = 1 }
END

# check Q: the standard error of --check.
check()
{
    expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 -D q="$1" --check
}
for q in 2.1 5 20 160; do
    check $q
    expect_text err "the elements of the wall 'wall'"
    expect_text err "smaller than half of those of 'ball', 0.04 cm"
    expect_text err 'stiffness, damping and heat of these pairs add up'
done
for q in 1 2; do
    check $q
    ! grep -q 'smaller than half' err || fail \
        "q = $q: a wall of elements that are not smaller than half is told"
done

# restitution: of the ball, the speed after over the speed before, at zeta = 0.3.
restitution()
{
    expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 -D q="$1" -D z=0.3 -q -o run --overwrite
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, "ball_vy") == 1) at = i } { v = $at }
        END { printf "%.4f\n", v/0.01 }' run/history.csv
}
one=$(restitution 5) many=$(restitution 20)
echo "restitution $one and $many"
# At d/5 the ball touches one element of the wall, at d/20 several: docs/physics.md, section 11.
awk -v a="$one" -v b="$many" 'BEGIN { exit !(a > 0.449 && a < 0.453 && b > 0.28 && b < 0.31) }' ||
    fail "the restitution is $one and $many, expected 0.451 and 0.294"
exit 0
