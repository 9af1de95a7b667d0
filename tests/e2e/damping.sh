# Local damping: colliding bodies come to rest, `damped` has what was taken, the book closes; the same bytes
# for any number of servers and over a restart; a deck without damping has the column 0.
# labels: e2e bits physics
. "$DM2_SRC/tests/lib.sh"

cat >collide.dm2 <<'END'
let alpha = 0.2
domain { size = 40 40; r_c = 1.6; delta_r = 0.3; boundary = periodic free; gravity = 0 -1e-6
    damping = alpha }
time { dt = 0.2; steps = 600 }
material A { mass = 1 }
interaction { potential = morse; k = 1; shape = 4; kt_ratio = 0.3; mu = 0.3 }
body left { shape = rectangle 10 10 20 20.3; spacing = 1; origin = 10.1 10.1; material = A
    velocity = 0.02 0 }
body right { shape = rectangle 20 13 30 24.3; spacing = 1; origin = 10.4 10.1; material = A
    velocity = -0.02 0 }
output { history_every = 50 }
END
expect_status 0 "$DM2_BIN/dm2-seq" collide.dm2 -q -o one
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/ .*/, "", $i); at[$i] = i }; next }
    NR == 2 { total = $at["total"]; kinetic = $at["kinetic"] }
    { d = $at["total"] - total; if (d < 0) d = -d; if (d > off) off = d
      made = $at["kinetic"] + $at["potential"] + $at["elastic"] + $at["thermal"] + $at["chemical"]
      made += $at["phase"] + $at["damped"] - $at["work"] - $at["total"]
      if (made > 1e-15 || made < -1e-15) exit bad = 1 }
    END { printf "damped %g of %g, off by %g\n", $at["damped"], kinetic, off
          exit bad || $at["damped"] < 0.5*kinetic || off > 0.005*kinetic }' one/history.csv ||
    fail "the book with damping does not close"
for n in 1 2 5; do
    expect_status 0 "$DM2_BIN/dm2-client" collide.dm2 -n $n -q -o several --overwrite --checkpoint-every 350
    same_bytes one/final.dm2 several/final.dm2
    same_bytes one/history.csv several/history.csv
done
expect_status 0 "$DM2_BIN/dm2-seq" collide.dm2 -q --restart several/checkpoint.dm2 -o on
same_bytes one/final.dm2 on/final.dm2
same_bytes one/history.csv on/history.csv

expect_status 0 "$DM2_BIN/dm2-seq" collide.dm2 -D alpha=0 -q -o none
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, "damped ") == 1) at = i; next }
    $at != "0" { exit 1 }' none/history.csv || fail "a deck without damping has damped energy"
for alpha in 1 -0.1; do
    expect_status 2 "$DM2_BIN/dm2-seq" collide.dm2 -D "alpha=$alpha" --check
    expect_text err "'damping' must be at least 0 and below 1, but is $alpha"
done
exit 0
