# Which neighbours touch does not depend on rounding: in an unstrained crystal that reacts or conducts,
# wherever it lies and whatever its neighbours' distances lack or exceed by a billionth, all neighbours touch.
. "$DM2_SRC/tests/lib.sh"

# The places of the crystal: along both axes, in cm.
places='0 0.01 0.0123 0.03 0.05 0.0777 0.1'

cat >common.txt <<'DECK'
let d = 0.02 cm
let row = d*sqrt(3)/2
let x0 = 0.01 cm
let stretch = 0              # spacing/d - 1
material A { rho0 = 5 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K; kappa = 100 W/m/K }
material B { rho0 = 5 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K; kappa = 100 W/m/K }
material C { rho0 = 5 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K; kappa = 100 W/m/K }
body lower {
    shape = rectangle x0 + d/4, x0 - row/2, x0 + 20.25*d, x0 + 9.5*row
    spacing = d*(1 + stretch); radius = d/2; origin = x0 + d/2, x0
    material = A; motion = fixed; temperature = 600
}
body upper {
    shape = rectangle x0 + d/4, x0 + 9.5*row, x0 + 20.25*d, x0 + 19.5*row
    spacing = d*(1 + stretch); radius = d/2; origin = x0 + d/2, x0
    material = B; motion = fixed; temperature = 300
}
output { history_every = 1 }
DECK
cat common.txt - >reaction.dm2 <<'DECK'
domain { size = 0.6 cm, 0.6 cm; r_c = 2*d; delta_r = 0.2*d }
time { dt = 0.001 us; steps = 1 }
reaction burn { reactants = A B; product = C; kind = non-stoichiometric; k0 = 1; ea = 0; heat = 1 kJ/g }
interaction { linked = yes }
DECK
cat common.txt - >heat.dm2 <<'DECK'
domain { size = 0.6 cm, 0.6 cm; r_c = 2*d; delta_r = 0.2*d }
time { dt = 0.5 us; steps = 200 }
profile rows { axis = y; bins = 2; range = x0 - row/2, x0 + 19.5*row; every = 200 }
DECK
cat >mix.dm2 <<'DECK'
let d = 0.02 cm
let x0 = 0.01 cm
domain { size = 1 cm, 1 cm; r_c = 2*d; delta_r = 0.2*d }
time { dt = 0.01 us; steps = 20 }
material A { rho0 = 5 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K }
material B { rho0 = 5 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K }
material C { rho0 = 5 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K }
reaction burn { reactants = A B; product = C; kind = non-stoichiometric; k0 = 0.01; ea = 0; heat = 1 kJ/g }
interaction { linked = yes }
body one {
    shape = rectangle x0, x0, x0 + 40*d, x0 + 40*d
    spacing = d; origin = x0 + d/4, x0 + d/4
    mix = A 0.5, B 0.5; motion = fixed
}
output { history_every = 1 }
DECK
# A lattice all round the domain, unlinked and compressed by nothing, whose lowest corner lies `n` periods
# from 0.
cat >moved.dm2 <<'DECK'
let d = 0.03 cm
let w = 20*d
let h = 20*sqrt(3)/2*d
let n = 0
domain { origin = n*w, n*h; size = w, h; boundary = periodic periodic; r_c = 2*d; delta_r = 0.2*d }
time { dt = 0.005 us; steps = 100 }
material M { rho0 = 8.93; c0 = 0.394; s = 1.489; shear = 0.477 }
interaction { linked = no; mu = 0.3 }
body all {
    shape = rectangle n*w, n*h, n*w + w, n*h + h
    spacing = d; origin = n*w + d/4, n*h + d/3
    material = M; velocity = 0.001, 0
}
output { history_every = 100 }
DECK

# Two unlinked lattices, damped, that run into each other from contact distance.
cat >pressed.dm2 <<'DECK'
let d = 0.05 cm
let row = d*sqrt(3)/2
let x0 = 0.01 cm
let stretch = 0
domain { size = 1.5 cm, 1 cm; r_c = 2*d; delta_r = 0.2*d }
time { dt = 0.005 us; steps = 60 }
material M { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.4 }
interaction { linked = no; mu = 0.2; zeta = 0.1 }
body left {
    shape = rectangle x0, x0, x0 + 10*d, x0 + 10*row
    spacing = d*(1 + stretch); radius = d/2; origin = x0 + d/3, x0 + row/3
    material = M; velocity = 0.01, 0
}
body right {
    shape = rectangle x0 + 10*d, x0, x0 + 20*d, x0 + 10*row
    spacing = d*(1 + stretch); radius = d/2; origin = x0 + d/3, x0 + row/3
    material = M; velocity = -0.01, 0
}
output { history_every = 60 }
DECK

# run DECK OPTION...: a run in `run`.
run()
{
    expect_status 0 "$DM2_BIN/dm2-seq" "$@" -q --progress never -o run --overwrite
}

# cell NAME ROW: the value of the column NAME in row ROW of the history.
cell()
{
    awk -F, -v name="$1" -v row="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if (split($i, a, " ") &&
        a[1] == name) at = i }
        NR == row + 1 { print $at }' run/history.csv
}

# reacting: how many pairs react in step 0, each of which frees heat k0 (d/sqrt(3)) dt/2.
reacting()
{
    awk -v a="$(cell chemical 1)" -v b="$(cell chemical 2)" \
        'BEGIN { printf "%.6f", (a - b)/(0.01*0.02/sqrt(3)*0.001/2) }'
}

# equals GOT WANT WHAT
equals()
{
    [ "$1" = "$2" ] || fail "$3: $1, expected $2"
}

# Two rows of 20, shifted by d/2, have 39 pairs across the middle; the crystal has 20*19 + 19*39 pairs.
for x in $places; do
    run reaction.dm2 -D "x0=$x cm"
    equals "$(reacting)" 39.000000 "reacting pairs at x0 = $x"
    equals "$(cell contacts 1)" 1121 "contacts at x0 = $x"
    run mix.dm2 -D "x0=$x cm"
    share=$(awk -v a="$(cell chemical 1)" -v b="$(cell chemical 21)" 'BEGIN { printf "%.9f", 1 - b/a }')
    [ -n "${first_share:-}" ] || first_share=$share
    equals "$share" "$first_share" "share that burnt at x0 = $x"
    run heat.dm2 -D "x0=$x cm"
    equals "$(awk -F, 'END { printf "%.9f", $11 }' run/profile-rows.csv)" 303.441899113 "cold half at x0 = $x"
done
for stretch in 1e-9 -1e-9; do
    run reaction.dm2 -D "stretch=$stretch"
    equals "$(reacting)" 39.000000 "reacting pairs, stretched by $stretch"
    equals "$(cell contacts 1)" 1121 "contacts, stretched by $stretch"
    run heat.dm2 -D "stretch=$stretch"
    equals "$(awk -F, 'END { printf "%.6f", $11 }' run/profile-rows.csv)" 303.441899 \
        "cold half, stretched by $stretch"
done
# A linked pair reacts stretched, too; an unlinked pair up to 1.5e-8 beyond the contact distance.
run reaction.dm2 -D stretch=0.01
equals "$(reacting)" 39.000000 "reacting pairs of links stretched by 1 %"
equals "$(cell contacts 1)" 0 "contacts of a stretched crystal"
sed 's/^interaction.*/&\ninterface body { linked = no }/' reaction.dm2 >apart.dm2
run apart.dm2 -D stretch=1e-8
equals "$(reacting)" 39.000000 "reacting pairs of two bodies 1e-8 apart"
run apart.dm2 -D stretch=2e-8
equals "$(reacting)" 0.000000 "reacting pairs of two bodies 2e-8 apart"

for n in 0 1 7 1000; do
    run moved.dm2 -D "n=$n"
    equals "$(cell contacts 1)" 1200 "contacts, moved by $n periods"
    kinetic=$(awk -v e="$(cell kinetic 2)" 'BEGIN { printf "%.9e", e }')
    [ -n "${first_kinetic:-}" ] || first_kinetic=$kinetic
    equals "$kinetic" "$first_kinetic" "kinetic energy, moved by $n periods"
done

# Damping sees no rounding, either: who stood at the contact distance did touch before.
for x in $places; do
    run pressed.dm2 -D "x0=$x cm"
    kinetic=$(awk -v e="$(cell kinetic 2)" 'BEGIN { printf "%.9e", e }')
    [ -n "${pressed_kinetic:-}" ] || pressed_kinetic=$kinetic
    equals "$kinetic" "$pressed_kinetic" "kinetic energy of lattices that collide at x0 = $x"
done
for stretch in 1e-9 -1e-9; do
    run pressed.dm2 -D "stretch=$stretch"
    ratio=$(awk -v e="$(cell kinetic 2)" -v want="$pressed_kinetic" 'BEGIN { printf "%.6f", e/want }')
    equals "$ratio" 1.000000 "kinetic energy of colliding lattices, relative, stretched by $stretch"
done

# The same bytes from every number of servers.
run mix.dm2
mv run seq
for n in 1 2 3; do
    expect_status 0 "$DM2_BIN/dm2-client" mix.dm2 -q -n $n -o run --overwrite
    same_bytes seq/final.dm2 run/final.dm2
    same_bytes seq/history.csv run/history.csv
done
