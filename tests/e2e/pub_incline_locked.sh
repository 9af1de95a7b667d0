# A block without friction on an incline. Where the block's spacing is a whole number of spacings of the
# floor, the floor holds it by its shape up to the slope s/(2 (R + r)); `--check` says so, with a spacing that
# does not fit, on which the block slides freely. No deck of input/ has such a wall.
. "$DM2_SRC/tests/lib.sh"

cat >incline.dm2 <<'END'
let slope = 0.03
let pull = 1e-5 cm/us^2
let d = 0.04 cm
let fine = d/20
let columns = 12
let rows = 4
let width = 2 cm
let top = fine/2 + 0.5*(d + fine)
let norm = sqrt(1 + slope^2)
domain { size = width, (rows + 4)*d; r_c = 1.25*d; delta_r = 0.1*d; gravity = slope/norm*pull, -pull/norm }
time { dt = 0.02 us; steps = 6000 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489; shear = 47.7 GPa }
interaction { zeta = 0.5; ct_ratio = 0.02 }
interface body { mu = 0 }
body floor { shape = rectangle 0, 0, width, fine; spacing = fine; origin = fine/2, fine/2; material = Cu
    motion = fixed }
body block { shape = rectangle 2*d, fine, (columns + 2)*d, (rows + 2)*d; spacing = d; origin = 2*d, top
    material = Cu }
probe block { region = 0, fine, width, (rows + 4)*d }
output { history_every = 100 }
END

# way OPTION...: how far the block slides in 120 us; free: 0.5 g sin t^2 = 2.159e-3 cm.
way()
{
    expect_status 0 "$DM2_BIN/dm2-seq" incline.dm2 "$@" -q -o run --overwrite
    slid=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, "block_x ") == 1) at = i }
        NR == 2 { first = $at } { last = $at } END { print last - first }' run/history.csv)
    echo "$*: $slid cm"
}

expect_status 0 "$DM2_BIN/dm2-seq" incline.dm2 --check
expect_text err "the spacing of 'block' is 20 times that of the wall 'floor'"
expect_text err 's/(2 (R + r)) = 0.048'
expect_text err 'such as 0.001964 cm'
way # held, as the warning says
awk -v x="$slid" 'BEGIN { exit !(x < 1e-4) }' || fail \
    "a row that fits no longer holds a block: the warning is untrue"

for fine in '0.001964 cm' d/20.37; do
    expect_status 0 "$DM2_BIN/dm2-seq" incline.dm2 -D "fine=$fine" --check
    ! grep -q 'in dips' err || fail "$fine: a spacing that does not fit is told"
    way -D "fine=$fine"
    awk -v x="$slid" 'BEGIN { exit !(x > 2.1e-3 && x < 2.2e-3) }' ||
        fail "$fine: the block slid $slid cm, expected 2.159e-3"
done

for deck in "$DM2_SRC"/input/*.dm2; do
    expect_status 0 "$DM2_BIN/dm2-seq" "$deck" --check
    ! grep 'in dips' err || fail "$deck has a wall whose spacing fits that of a body"
done
exit 0
