# The quantum of heat follows from what passes in a step: an element that could hold much heat, far away,
# changes nothing. A phase whose latent heat is more than its material holds is refused: the temperature would
# fall below 0 K.
. "$DM2_SRC/tests/lib.sh"

cat >quantum.dm2 <<'END'
let d = 1e-4 cm
let cp = 500 J/kg/K          # of the far element
domain { size = 60*d, 60*d; r_c = 2*d; delta_r = 0.2*d }
time { dt = 1e-5 us; steps = 100 }
material A { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K; kappa = 100 W/m/K }
material Big { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5; cp = cp }
interaction { linked = yes }
body hot { shape = rectangle 10*d, 10*d, 20*d, 15*d; lattice = square; spacing = 0.999*d; radius = d/2
    origin = 10.5*d, 10.5*d; material = A; motion = fixed; temperature = 301 }
body cold { shape = rectangle 20*d, 10*d, 30*d, 15*d; lattice = square; spacing = 0.999*d; radius = d/2
    origin = 10.5*d, 10.5*d; material = A; motion = fixed; temperature = 300 }
body far { shape = rectangle 50*d, 50*d, 50.5*d, 50.5*d; spacing = d; origin = 50.1*d, 50.1*d; material = Big
    motion = fixed }
profile x { axis = x; bins = 4; range = 10*d, 30*d; every = 100 }
output { history_every = 10 }
END

# The means of the two middle quarters, to 12 digits.
middle()
{
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, "temperature") == 1) at = i }
        { t[NR] = $at } END { printf "%.9f %.9f\n", t[NR - 2], t[NR - 1] }' "$1/profile-x.csv"
}

for cp in 500 1e6 1e9 1e12 1e15; do
    expect_status 0 "$DM2_BIN/dm2-seq" quantum.dm2 -D "cp=$cp J/kg/K" -q -o run --overwrite
    [ "$(middle run)" = '300.996733697 300.003266303' ] || fail \
        "cp = $cp: the middle quarters have $(middle run) K"
done
for n in 1 2 3; do
    expect_status 0 "$DM2_BIN/dm2-client" quantum.dm2 -n $n -D 'cp=1e15 J/kg/K' -q -o many --overwrite
    same_bytes run/final.dm2 many/final.dm2
    same_bytes run/history.csv many/history.csv
done

# The same of forces and of the masses that react: a stiff material without elements, and a heavy one that
# does not react.
cat quantum.dm2 - >unused.dm2 <<'END'
material Unused { rho0 = 8 g/cm3; c0 = 4e6 km/s; s = 1.5 }
interaction A Unused { k = 1e12 }
END
expect_status 0 "$DM2_BIN/dm2-seq" quantum.dm2 -q -o run --overwrite
expect_status 0 "$DM2_BIN/dm2-seq" unused.dm2 -q -o many --overwrite
same_bytes run/history.csv many/history.csv
same_bytes run/profile-x.csv many/profile-x.csv

cat >cool.dm2 <<'END'
let d = 0.02 cm
let latent = 300 J/g
domain { size = 1 cm, 1 cm; r_c = 1.5*d; delta_r = 0.2*d }
time { dt = 0.001 us; steps = 4 }
material M { rho0 = 8 g/cm3; c0 = 4 km/s; s=1.5; cp = 500 J/kg/K }
phase M liquid { transition = temperature; t_line = 301; dt_dp = 1000; latent = latent; reversible = yes }
body strip { shape = rectangle 0.2 cm, 0.2 cm, 0.6 cm, 0.4 cm; spacing = 1.01*d; radius = d/2
    origin = 0.205 cm, 0.205 cm; material = M; motion = fixed }
output { history_every = 1 }
END
sed 's/reversible = yes/reversible = no/' cool.dm2 >once.dm2

# refused DECK OPTION...
refused()
{
    expect_status 2 "$DM2_BIN/dm2-seq" "$@" --check
    expect_text err "latent heat of 'liquid'"
    expect_text err 'below 0 K'
}
refused cool.dm2
refused once.dm2
refused cool.dm2 -D 'latent=151 J/g'
refused cool.dm2 -D 'latent=-151 J/g' # taken up when it goes back
expect_status 0 "$DM2_BIN/dm2-seq" once.dm2 -D 'latent=-151 J/g' --check
expect_status 0 "$DM2_BIN/dm2-seq" cool.dm2 -D 'latent=150 J/g' --check
expect_status 0 "$DM2_BIN/dm2-seq" cool.dm2 -D 'latent=150 J/g' -q -o run --overwrite
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, "temperature_max") == 1) at = i; next }
    $at < 0 { exit 1 }' run/history.csv || fail "a temperature is below 0 K"
exit 0
