# Constants that the model cannot follow are told, with the value that holds: shear moduli below and above
# those of a lattice, `shear` and `yield` without an effect, strengths beyond the potential; and the pressure
# of a phase line is half the sum of the stresses in the plane, as the manual says.
# labels: e2e physics
# timeout: 120
. "$DM2_SRC/tests/lib.sh"

# material CONSTANTS INTERACTION: a deck of a lattice between a fixed row and a driven one, which shears it,
# with a material M of these constants.
material()
{
    cat >deck.dm2 <<END
let d = 0.02 cm
let row = d*sqrt(3)/2
domain { size = 24*d, 0.5 cm; boundary = periodic free; r_c = 1.5*d; delta_r = 0.2*d }
time { dt = 0.005 us; steps = 300 }
material M { $1 }
interaction { zeta = 0.3; $2 }
interface body { linked = yes }
body floor { shape = rectangle 0, 0.1 cm - row/2, 24*d, 0.1 cm + 1.5*row; spacing = d; origin = d/4, 0.1 cm
    material = M; motion = fixed }
body sheet { shape = rectangle 0, 0.1 cm + 1.5*row, 24*d, 0.1 cm + 5.5*row; spacing = d; origin = d/4, 0.1 cm
    material = M }
body lid { shape = rectangle 0, 0.1 cm + 5.5*row, 24*d, 0.1 cm + 7.5*row; spacing = d; origin = d/4, 0.1 cm
    material = M; motion = driven; velocity = 0.002, 0 }
output { history_every = 50 }
END
}

# run DIRECTORY OPTION...; silent: the deck that ran has no warning.
run()
{
    to=$1
    shift
    expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 "$@" --progress never -o "$to" --overwrite
}
silent()
{
    ! grep -q 'deck.dm2:.*warning' err || { cat err; fail "a warning of a deck that holds what it says: $1"; }
}

copper='rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489'
hmx='rho0 = 1.891 g/cm3; c0 = 3.07 km/s; s = 1.79; yield = 0.26 GPa'

# With `bulk` the central forces of copper's lattice alone have 69 GPa. The warning is true: nothing depends
# on `yield`.
for yield in 0.0001 10; do
    material "$copper; shear = 47.7 GPa; yield = $yield GPa" 'calibration = bulk'
    run "$yield"
    expect_text err "warning: the lattice of 'M' has a shear modulus of 0.6931 Mbar by its central forces"
    expect_text err "(calibration = bulk): 'shear' = 0.477 Mbar has no effect, nor has 'yield'"
done
same_bytes 0.0001/history.csv 10/history.csv
material "$copper; shear = 47.7 GPa; yield = 0.12 GPa" ''
run uniaxial
silent 'copper, uniaxial'

# HMX: 12 and 40 GPa are one modulus, 8.9 GPa; 8 GPa is another.
for shear in 12 40 8; do
    material "$hmx; shear = $shear GPa" ''
    run "$shear"
    case $shear in
    12) given=0.12 ;;
    40) given=0.4 ;;
    *) continue ;;
    esac
    expect_text err "warning: the lattice of 'M' can have a shear modulus of 0.08911 Mbar at most"
    expect_text err "which holds in place of 'shear' = $given Mbar"
done
silent 'HMX, 8 GPa'
same_bytes 12/history.csv 40/history.csv
! cmp -s 12/history.csv 8/history.csv || fail 'a modulus within the bounds has no effect'
for deck in "$DM2_SRC"/input/*.dm2; do
    expect_status 0 "$DM2_BIN/dm2-client" "$deck" -n 1 --check
    ! grep -e "'shear'" -e "'tensile'" -e 'has no meaning' err ||
        fail "$deck asks for what the model cannot follow"
done

# A strength above the strongest pull of the potential; of a phase, too; of a pair of scope `all`.
material "$copper; tensile = 20 GPa" ''
run strong
expect_text err "warning: 'tensile' = 0.2 Mbar is not below 0.07397 Mbar, the strongest pull of the potential"
expect_text err "between 'M' and 'M' up to link_break = 1.05: their bonds do not flow, they only break there"
material "$copper; tensile = 7 GPa; cp = 383 J/kg/K }
phase M hard { transition = pressure; p_line = 1; t_line = 300 K; tensile = 18 GPa" ''
run strong
expect_text err "'tensile' = 0.18 Mbar is not below 0.07397 Mbar, the strongest pull of the potential"
expect_text err "between 'M/hard' and 'M/hard'"
[ "$(grep -c 'deck.dm2:.*warning' err)" = 1 ] || fail 'the first phase has a warning as well'

# Constants that the interaction replaces, and what they mean.
material "$copper" 'shape = 2'
run replaced
expect_text err "'shape' of the interaction means s = 0.9375, in place of the s = 1.489 that 'M' gives"
material "$copper" 'k = 1'
run replaced
expect_text err "'k' of the interaction means c0 = 0.3814 cm/us, in place of the c0 = 0.394 cm/us"

# Keywords without a meaning.
material "$copper" 'cutoff = 0.025; a_t = 0.001/K'
run meaning
expect_text err "'cutoff' has no meaning for the scope linked"
[ "$(grep -c 'deck.dm2:.*warning' err)" = 1 ] || fail 'a_t beside zeta has a warning'
material "$copper" 'k = 1.07; shape = 2.98; calibration = bulk'
run meaning
expect_text err "'calibration' has no meaning for a pair whose constants do not follow from Hugoniot data"

# The phase line: half the sum of the stresses, which is 0.70 of the axial stress in iron.
cat >iron.dm2 <<'END'
let d = 0.02 cm
let squeeze = 0.06           # 1 - height over height at rest
let line = 13 GPa
domain { size = 24*d, 1 cm; boundary = periodic free; r_c = 1.5*d; delta_r = 0.2*d }
time { dt = 0.001 us; steps = 2 }
material Fe { rho0 = 7.87 g/cm3; c0 = 4.60 km/s; s = 1.5; shear = 82 GPa; yield = 0.34 GPa; cp = 449 J/kg/K }
phase Fe epsilon { transition = pressure; p_line = line; t_line = 300 K }
body block {
    shape = rectangle 0, 0.3 cm, 24*d, 0.6 cm
    spacing = d; row_spacing = d*sqrt(3)/2*(1 - squeeze); radius = d/2; origin = d/4, 0.31 cm
    material = Fe; motion = fixed
}
profile y { axis = y; bins = 1; range = 0.4 cm, 0.5 cm; every = 1 }
output { history_every = 1; snapshot_at = 2; format = xyz }
END
# changed SQUEEZE LINE: prints axial stress, P over axial stress, and how many elements changed.
changed()
{
    "$DM2_BIN/dm2-seq" iron.dm2 -D squeeze="$1" -D line="$2" -q -o iron --overwrite 2>err || exit 1
    awk -F, -v n="$(grep -c '^Fe/epsilon ' iron/snapshots/state-000000002.xyz)" \
        'NR > 1 { x = $8; y = $9 } END { printf "%.3f %.2f %d\n", -y, (x + y) / 2 / y, n }' iron/profile-y.csv
}
for want in '0.086,13 GPa,0.184 0.70 0' '0.087,13 GPa,0.187 0.70 408' '0.064,9 GPa,0.129 0.69 0' \
    '0.066,9 GPa,0.134 0.69 384'; do
    squeeze=${want%%,*} line=${want#*,}
    got=$(changed "$squeeze" "${line%,*}")
    [ "$got" = "${want##*,}" ] || fail \
        "iron squeezed by $squeeze, line at ${line%,*}: $got, expected ${want##*,}"
done
for file in docs/deck.md docs/physics.md input/phase-front.dm2; do
    expect_text "$DM2_SRC/$file" 'axial stress'
done
exit 0
