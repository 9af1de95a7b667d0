# The solid fraction of a powder is by mass; what cannot be packed is refused with the fraction that can.
# labels: e2e physics
# timeout: 120
. "$DM2_SRC/tests/lib.sh"

cat >powder.dm2 <<'D'
let solid = 0.65
let grain = 0.02 cm
let d = 0.002 cm
let size = 0.2 cm
domain { size = 0.2 cm, 0.2 cm; boundary = periodic periodic; r_c = 1.5*d; delta_r = 0.4*d }
time { dt = 0.0001 us; steps = 0 }
material HMX { rho0 = 1.891 g/cm3; c0 = 3.07 km/s; s = 1.79 }
body powder {
    shape = rectangle 0, 0, size, size; structure = discs
    grain_size = grain; grain_spread = 0.4; solid_fraction = solid
    spacing = d; material = HMX; seed = 7
}
profile all { axis = x; bins = 1 }
D
sed 's/discs/polygons/' powder.dm2 >polygons.dm2
sed 's/0.4; solid/0; solid/; s/spacing = d;/spacing = d; lattice = square;/' powder.dm2 >equal.dm2

# fraction DECK OPTION...: the mass in the shape over rho0 times its area, into the file `fraction`.
fraction()
{
    expect_status 0 "$DM2_BIN/dm2-seq" "$@" -q --progress never --overwrite -o run
    awk -F, 'NR == 2 { printf "%.5f\n", $5 / 1.891 }' run/profile-all.csv >fraction
}

# expect_fraction WANT TOLERANCE DECK OPTION...
expect_fraction()
{
    want=$1 tolerance=$2
    shift 2
    fraction "$@"
    awk -v want="$want" -v most="$tolerance" '{ exit !($1 > want * (1 - most) && $1 < want * (1 + most)) }' \
        fraction ||
        fail "the solid fraction is $(cat fraction), expected $want, of: $*"
}

for solid in 0.3 0.5 0.65; do
    expect_fraction $solid 0.0025 powder.dm2 -D solid=$solid
    expect_fraction $solid 0.0025 powder.dm2 -D solid=$solid -D d=0.001
    expect_fraction $solid 0.005 powder.dm2 -D solid=$solid -D d=0.004
done
expect_fraction 0.7 0.0025 powder.dm2 -D solid=0.7 -D d=0.001
expect_fraction 0.3 0.0025 polygons.dm2 -D solid=0.3
expect_fraction 0.55 0.0025 polygons.dm2 -D solid=0.55
# Grains of one element have the cell of a lattice each.
expect_fraction 0.8 0.0025 equal.dm2 -D solid=0.8 -D grain=1.001*d

# refuse DECK OPTION...: refused, and the fraction in the message can be packed.
refuse()
{
    expect_status 2 "$DM2_BIN/dm2-seq" "$@" -q --progress never --overwrite -o run
    expect_text err 'solid_fraction = solid'
    expect_text err 'cannot be packed to a solid fraction of'
    reached=$(sed -n 's/.*grains of this size reach about \([0-9.]*\): choose less.*/\1/p' err)
    [ -n "$reached" ] || fail "the message does not say which fraction can be reached: $(cat err)"
    expect_fraction "$reached" 0.005 "$@" -D "solid=$reached"
}

refuse powder.dm2 -D solid=0.76
refuse powder.dm2 -D solid=0.95
refuse powder.dm2 -D solid=0.75 -D d=0.004
refuse polygons.dm2 -D solid=0.7

expect_status 0 "$DM2_BIN/dm2-seq" polygons.dm2 -D solid=0.5 -q --progress never --overwrite -o one
expect_status 0 "$DM2_BIN/dm2-client" polygons.dm2 -D solid=0.5 -n 2 -q --progress never --overwrite -o two
same_bytes one/final.dm2 two/final.dm2
