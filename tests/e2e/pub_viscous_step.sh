# A mode with damping and no stiffness limits the time step: a sheet with tangential viscosity and no shear
# stiffness is refused above dt = 2/gamma, gamma = 24 c_t/m of the rotation, and stays at rest below.
# labels: e2e input
. "$DM2_SRC/tests/lib.sh"
cat >deck.dm2 <<'END'
let c = 0.3
let dt = 0.3
domain { size = 30 30; r_c = 1.6; delta_r = 0.3 }
time { dt = dt; steps = 200 }
material A { mass = 1 }
interaction { potential = quadratic; k = 1; ct_ratio = c; link_break = 1.3 }
body sheet { shape = rectangle 5 5 25 25; spacing = 1; origin = 5.1 5.1; material = A; jitter = 1e-4
    seed = 4 }
output { history_every = 10 }
END

# 2/gamma = 2/(24 * 2 c sqrt(1/2)) = 0.058926/c us
for try in '0.3 0.3 0.196419' '0.5 0.2 0.117851' '0.2 0.5 0.294628' '0.3 0.197 0.196419'; do
    set -- $try
    for program in dm2-seq dm2-client; do
        expect_status 2 "$DM2_BIN/$program" deck.dm2 -q -D "c=$1" -D "dt=$2" -o refused
        expect_text err "is not below the stable one, $3 us (limit: damping of the rotation, 'A' with 'A')"
        [ ! -e refused ] || fail "$program: a refused deck has a run directory"
    done
done
expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 --check -D dt=0.195
expect_text out 'stable time step 0.196419 us (damping of the rotation), chosen 0.195 us = 0.993 of it'

# Below the limit the thermal motion dies away; each element keeps its place.
for try in '0.3 0.19' '0.2 0.29' '0.5 0.11'; do
    set -- $try
    expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 -q -D "c=$1" -D "dt=$2" -o run --overwrite
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /^kinetic/) at = i }
        NR > 1 && $at + 0 > most { most = $at + 0 } END { exit !(most > 0 &&
            most < 1e-4) }' run/history.csv ||
        fail "c = $1, dt = $2: the elements spin up"
done
exit 0
