# Two things that nothing moves, fixed or driven bodies, exert no force on each other, hold no energy, do not
# rub; they touch, conduct, link by distance, react, melt. Within one body bonds stay.
. "$DM2_SRC/tests/lib.sh"

# column NAME: of the last row of history.csv.
column()
{
    awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/ .*/, "", $i); if ($i == name) at = i } }
        END { print $at }' run/history.csv
}

# nothing WHAT: no energy but the motion of the drive, no pressure, no heat.
nothing()
{
    for name in potential elastic thermal phase work pressure_min pressure_max; do
        [ "$(column $name)" = 0 ] || fail "$1: $name is $(column $name), expected 0"
    done
    [ "$(column temperature_max)" = 300 ] || fail \
        "$1: temperature_max is $(column temperature_max), expected 300"
    [ "$(column contacts)" -gt "${2:-0}" ] || fail "$1: only $(column contacts) contacts"
}

# run DECK OPTION...: one process; then the same bytes from 1, 2, 3 servers.
run()
{
    expect_status 0 "$DM2_BIN/dm2-seq" "$@" -q -o run --overwrite
    for n in 1 2 3; do
        expect_status 0 "$DM2_BIN/dm2-client" "$@" -n $n -q -o many --overwrite
        same_bytes run/final.dm2 many/final.dm2
        same_bytes run/history.csv many/history.csv
    done
}

cat >corner.dm2 <<'END'
let d = 0.05 cm
domain { size = 2 cm, 2 cm; r_c = 2*d; delta_r = 0.2*d }
time { dt = 0.01 us; steps = 20 }
material S { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K }
body floor { shape = rectangle 0.5 cm, 0.5 cm, 1.5 cm, 0.54 cm; spacing = d; origin = 0.51 cm, 0.51 cm
    material = S; motion = fixed }
body left { shape = rectangle 0.5 cm, 0.54 cm, 0.54 cm, 1.4 cm; lattice = square; spacing = d
    origin = 0.525 cm, 0.545 cm; material = S; motion = fixed }
body disc { shape = disc 1 cm, 1 cm, 0.06 cm; spacing = d; origin = 1 cm, 1 cm; material = S }
output { history_every = 5 }
END
run corner.dm2
nothing corner 20
cat corner.dm2 - >joined.dm2 <<'END'
interface body { linked = yes }
END
run joined.dm2
nothing "joined corner" 20
cat corner.dm2 - >all.dm2 <<'END'
interface body { potential = lennard-jones; scope = all; cutoff = 2*d }
END
run all.dm2
nothing "corner of a potential of scope all" -1

cat >driven.dm2 <<'END'
let d = 0.05 cm
domain { size = 3 cm, 2 cm; r_c = 2*d; delta_r = 0.2*d }
time { dt = 0.01 us; steps = 400 }
material S { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K }
interaction { mu = 0.3; zeta = 0.2 }
body wall { shape = rectangle 0.5 cm, 0.5 cm, 2.5 cm, 0.54 cm; spacing = d; origin = 0.51 cm, 0.51 cm
    material = S; motion = fixed }
body piston { shape = rectangle 0.6 cm, 0.54 cm, 0.64 cm, 1 cm; lattice = square; spacing = d
    origin = 0.62 cm, 0.51 cm + 0.9*d; material = S; motion = driven; velocity = 0.05, 0 }
output { history_every = 100 }
END
run driven.dm2
nothing driven
sed 's/^interaction.*/&\ninterface body { linked = yes; link_form = 0.95; link_break = 1.1 }/' driven.dm2 \
    >torn.dm2
run torn.dm2 # links form and break all along
nothing torn

# A hot wall warms another wall that overlaps it, whose elements then become a stiffer phase: bonds between
# the two hold no energy that the change could move.
cat >melting.dm2 <<'END'
let d = 0.05 cm
domain { size = 3 cm, 2 cm; r_c = 2*d; delta_r = 0.2*d }
time { dt = 0.01 us; steps = 400 }
material S { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K; kappa = 4e6 W/m/K }
phase S stiff { transition = temperature; t_line = 310; c0 = 5 km/s; hysteresis_t = 1 }
material H { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K; kappa = 4e6 W/m/K }
body wall { shape = rectangle 0.5 cm, 0.5 cm, 2.5 cm, 0.54 cm; spacing = d; origin = 0.51 cm, 0.51 cm
    material = S; motion = fixed }
body hot { shape = rectangle 0.5 cm, 0.55 cm, 2.5 cm, 0.6 cm; spacing = d; origin = 0.51 cm, 0.51 cm + 0.9*d
    material = H; motion = fixed; temperature = 400 }
output { history_every = 100 }
END
run melting.dm2
for name in potential elastic phase work pressure_max; do
    [ "$(column $name)" = 0 ] || fail "two walls of which one melts: $name is $(column $name), expected 0"
done
awk -v t="$(column temperature_max)" 'BEGIN { exit !(t < 399 && t >= 350) }' || # both end at 350 K
    fail "the walls do not conduct: temperature_max is $(column temperature_max)"

# Within one body bonds stay: a compressed crystal that is held has pressure.
sed 's/shape = rectangle 0.5 cm, 0.5 cm, 1.5 cm, 0.54 cm; spacing = d/& \* 0.98; radius = d\/2/' corner.dm2 \
    >strained.dm2
expect_status 0 "$DM2_BIN/dm2-seq" strained.dm2 -q -o run --overwrite
awk -v p="$(column pressure_max)" 'BEGIN { exit !(p > 0.001) }' ||
    fail "a strained fixed body has no pressure: $(column pressure_max)"
exit 0
