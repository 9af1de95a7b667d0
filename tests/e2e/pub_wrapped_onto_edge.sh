# A crystal whose first column stands on the lower edge of a periodic side moves by less than a rounding
# across this edge: the elements stay in the half-open domain, so that the bins of a profile over the domain
# hold every element.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
cat >deck.dm2 <<'DECK'
let d = 0.04 cm
let n = 200
let w = n*d
domain { size = w, 1.2 cm; boundary = periodic free; r_c = 2.5*d; delta_r = 0.25*d }
time { dt = 20 ns; steps = 100 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
interaction { zeta = 0.1 }
body plate { shape = rectangle 0, 0.2 cm, w, 0.6 cm; spacing = d; origin = 0, 0.2 cm; material = Cu }
body flyer { shape = rectangle 0, 0.61 cm, w, 0.8 cm; spacing = d; origin = 0, 0.63 cm; material = Cu
    velocity = 0, -200 m/s }
profile across { axis = x; bins = 12; every = 10 }
output { history_every = 10; snapshot_every = 10; format = xyz }
DECK
expect_status 0 "$DM2_BIN/dm2-seq" -q -o run deck.dm2
awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) { if ($k == "step") step = k; if ($k == "elements") at = k }
    next }
    { sum[$step] += $at }
    END { for (s in sum) { rows++; if (sum[s] != 3400) { bad = 1; print "step " s ": " sum[s] " elements" } }
          if (rows != 11) { print rows " rows"; bad = 1 }
          exit bad }' run/profile-across.csv >sums ||
    { sort sums; fail 'the bins of the profile lack elements'; }
awk 'FNR > 2 && !($2 >= 0 && $2 < 8) { print FILENAME ": x = " $2; bad = 1 } END { exit bad }' \
    run/snapshots/*.xyz >places ||
    { head -n 5 places; fail 'an element is outside [0, 8)'; }
expect_status 0 "$DM2_BIN/dm2-client" -n 3 -q --progress never -o three deck.dm2
for file in final.dm2 history.csv profile-across.csv; do
    same_bytes run/$file three/$file
done
