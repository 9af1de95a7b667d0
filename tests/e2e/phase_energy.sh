# A change of phase that lowers the strength or the size of stretched bonds loses no energy: what a bond loses
# at its length becomes heat, or is in the column `phase`.
. "$DM2_SRC/tests/lib.sh"

# A strip held stretched by 1 %, which melts in the first step; the melt has the tensile strength t.
cat >melt.dm2 <<'DECK'
let d = 0.02 cm
let t = 0
domain { size = 1 cm, 1 cm; r_c = 1.5*d; delta_r = 0.2*d }
time { dt = 0.001 us; steps = 4 }
material M { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K; tensile = 0.1 }
phase M liquid { transition = temperature; t_line = 601; dt_dp = 1000; tensile = t }
interaction { potential = quadratic; k = 0.5 }
body strip {
    shape = rectangle 0.2 cm, 0.2 cm, 0.6 cm, 0.4 cm
    spacing = 1.01*d; radius = d/2; origin = 0.205 cm, 0.205 cm
    material = M; motion = fixed; temperature = 600
}
output { history_every = 1 }
DECK
# The same, stretched by 0.5 %, turns into a phase that is 6 % denser.
dense='phase M dense { transition = temperature; t_line = 601; dt_dp = 1000; rho0 = 8.48 }'
sed "s/tensile = 0.1/tensile = 0.01/; s/^phase.*/$dense/
    s/1.01\*d/1.005*d/" melt.dm2 >denser.dm2
# A strip is pulled apart and melts behind the waves, at its tension (P < 0); it has springs, yields and
# breaks.
cat >moving.dm2 <<'DECK'
let dt = 0.002
let d = 0.02 cm
domain { size = 1 cm, 1 cm; r_c = 1.5*d; delta_r = 0.2*d }
time { dt = dt; steps = round(0.8/dt) }
material M { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5; shear = 0.3; cp = 500 J/kg/K; tensile = 0.02
    yield = 0.002 }
phase M liquid { transition = temperature; t_line = 601; dt_dp = 1000; tensile = 0.004; yield = 0; shear = 0
    rho0 = 7.8; latent = 1e-5 }
interface body { linked = yes }
body left {
    shape = rectangle 0.2 cm, 0.2 cm, 0.4 cm, 0.5 cm; spacing = d; origin = 0.205 cm, 0.205 cm
    material = M; velocity = -0.006, 0.002; temperature = 600
}
body right {
    shape = rectangle 0.4 cm, 0.2 cm, 0.6 cm, 0.5 cm; spacing = d; origin = 0.205 cm, 0.205 cm
    material = M; velocity = 0.006, -0.002; temperature = 600
}
output { history_every = 1 }
DECK

# run DECK OPTION...: a run in `run`; with the columns of its history by name in the program that follows.
run()
{
    expect_status 0 "$DM2_BIN/dm2-seq" "$@" -q --progress never -o run --overwrite
}

# check WHAT PROGRAM: PROGRAM, in awk, with the first and last row in first[] and last[], prints nothing.
check()
{
    said=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { split($i, a, " "); name[i] = a[1] } }
        NR > 1 { for (i = 1; i <= NF; i++) { if (NR == 2) first[name[i]] = $i; last[name[i]] = $i } }
        function off(a, b, tolerance) { return a - b > tolerance || b - a > tolerance }
        END { '"$2"' }' run/history.csv)
    [ -z "$said" ] || fail "$1: $said"
}

closes='if (off(last["total"], first["total"], 1e-15)) print "total from", first["total"], "to", last["total"]
    if (off(last["thermal"] - first["thermal"], heat, 1e-9)) print "heat", last["thermal"] - first["thermal"],
        "for", heat'

# 657 bonds; the heat is the loss of k (x - r0)^2/2 each, and for `denser` what the smaller r0 adds before
# that.
run melt.dm2
check melt "heat = 657*0.25*0.0002^2; $closes"
run melt.dm2 -D t=0.005
check 'melt of some strength' "heat = 657*0.25*(0.0002^2 - (0.005*0.02/sqrt(3)/0.5)^2); $closes"
run denser.dm2
check 'denser phase' "r0 = 0.02*sqrt(8/8.48)
heat = 657*0.25*((0.0201 - r0)^2 - (0.01*r0/sqrt(3)/0.5)^2); $closes"

# In motion, the error falls with the square of the step.
for dt in 0.004 0.002 0.001; do
    run moving.dm2 -D "dt=$dt"
    check "moving at $dt" 'if (!off(last["phase"], first["phase"], 1e-5)) print "nothing melted"
        if (!(last["links"] < first["links"])) print "nothing broke"'
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { split($i, a, " "); at[a[1]] = i } }
        NR == 2 { total = $at["total"]; moved = $at["kinetic"] }
        NR > 2 { d = $at["total"] - total; d = d < 0 ? -d : d; worst = d > worst ? d : worst }
        END { print worst/moved }' run/history.csv >>drift.txt
done
awk '{ d[NR] = $1 } END { exit !(d[1] < 0.001 && d[2] < 0.35*d[1] && d[3] < 0.35*d[2]) }' drift.txt ||
    fail "shares of the kinetic energy by which the total is off at dt, dt/2, dt/4: $(tr '\n' ' ' <drift.txt)"
cp -r run seq
for n in 2 3; do
    expect_status 0 "$DM2_BIN/dm2-client" moving.dm2 -D dt=0.001 -q -n $n -o run --overwrite
    same_bytes seq/final.dm2 run/final.dm2
    same_bytes seq/history.csv run/history.csv
done
