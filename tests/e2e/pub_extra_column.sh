# A width in decimals that is a whole number of spacings has that number of columns, free or periodic.
. "$DM2_SRC/tests/lib.sh"

cat >deck.dm2 <<'D'
let d = 0.06 cm
let n = 30
let w = 1.8 cm
domain { size = w, 1 cm; boundary = periodic free; r_c = 1.3*d; delta_r = 0.2*d }
time { dt = 0.01; steps = 2 }
material A { mass = 1 }
interaction { potential = quadratic; k = 1 }
body slab { shape = rectangle 0, 0.2 cm, w, 0.5 cm; spacing = d; lattice = square; origin = 0, 0.2 cm
    material = A }
output { history_every = 1 }
D
sed 's/periodic free/free free/' deck.dm2 >free.dm2

# count DECK D W N: the deck has N columns of rows of spacing D in a width of W.
count()
{
    expect_status 0 "$DM2_BIN/dm2-seq" "$1" -D "d=$2" -D "w=$3" -q --progress never --overwrite -o run
    awk -F, -v n="$4" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
                       NR == 2 { exit $at["elements"] % n != 0 ||
                           $at["elements"] / n > 400 }' run/history.csv ||
        fail "$1, width $3 of spacings $2: $(sed -n 2p run/history.csv), expected $4 columns"
}

for deck in deck.dm2 free.dm2; do
    count $deck 0.06 1.8 30
    count $deck 0.03 0.33 11
    count $deck 0.03 0.45 15
    count $deck 0.06 0.66 11
    count $deck 0.06 0.9 15
    count $deck 0.06 1.32 22
    count $deck 0.06 1.62 27
    count $deck 0.05 1.75 35
    count $deck 0.05 35*0.05 35
done
expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 -q --progress never --overwrite -o one
sed -n 2p one/history.csv | grep -q ',150,270,' || fail \
    "150 elements, 270 links expected: $(sed -n 2p one/history.csv)"

# Grains go round a periodic side, and two bodies share a border, whatever the rounding of the two decimals.
cat >border.dm2 <<'D'
let d = 0.06 cm
domain { origin = 0.1, 0; size = 1.8 cm, 1 cm; boundary = periodic free; r_c = 1.3*d; delta_r = 0.2*d }
time { dt = 0.01; steps = 0 }
material A { mass = 1 }
interaction { potential = quadratic; k = 1 }
body left { shape = rectangle 0.1, 0, 0.1 + 0.9, 0.5; spacing = d; lattice = square; origin = 0.1, 0
    material = A }
body right { shape = rectangle 0.1 cm + 15*d, 0, 1.9, 0.5; spacing = d; lattice = square; origin = 0.1, 0
    material = A }
D
expect_status 0 "$DM2_BIN/dm2-seq" border.dm2 -q --progress never --overwrite -o border
[ ! -s err ] || fail "a warning about bodies that share a border: $(cat err)"
sed -n 2p border/history.csv | grep -q ',270,' || fail \
    "270 elements expected: $(sed -n 2p border/history.csv)"
