# Voids, flaws and regions of probes go round a periodic side, and a lattice turned onto itself keeps its
# sites.
. "$DM2_SRC/tests/lib.sh"

head='let d = 0.05 cm
time { dt = 0.01 us; steps = 0 }
material M { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5 }'
round="$head
domain { size = 2 cm, 2 cm; boundary = periodic free; r_c = 2*d; delta_r = 0.2*d }
body block { shape = rectangle 0, 0.5 cm, 40*d, 1.5 cm; lattice = square; spacing = d
    origin = d/2, 0.5 cm + d/2
             material = M }"
printf '%s\n' "$round" 'let c = 0' 'void hole { shape = disc c, 1 cm, 0.31 cm }' >void.dm2
printf '%s\n' "$round" 'let a = 0' 'flaw crack { line = a - 0.3, 1, a + 0.3, 1 }' >flaw.dm2
printf '%s\n' "$round" 'let a = 0' 'probe edge { region = a - 0.2, 0.5 cm, a + 0.2, 1.5 cm }' >probe.dm2
printf '%s\n' "$round" 'let y = 1 cm' 'let e = 0.3 cm' 'flaw crack { line = 1 cm - e, y, 1 cm + e, y }' \
    >on.dm2
printf '%s\n' "$head" 'let turn = 60 deg' 'domain { size = 3 cm, 3 cm; r_c = 2*d; delta_r = 0.2*d }' \
    'body block { shape = rectangle 1, 1, 2, 2; spacing = d; origin = 1, 1; angle = turn; material = M }' \
        >turned.dm2
printf '%s\n' "$head" 'let x = 1' 'domain { size = 3 cm, 3 cm; r_c = 2*d; delta_r = 0.2*d }' \
    'body block { shape = disc x, x, 5*d; spacing = d; origin = x, x; angle = 60 deg; material = M }' \
        >disc.dm2

# counts DECK NAME=VALUE: elements and links of the first row of the history.
counts()
{
    expect_status 0 "$DM2_BIN/dm2-seq" "$1" -D "$2" -q --progress never --overwrite -o run
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
             NR == 2 { print $at["elements"], $at["links"] }' run/history.csv >counted
}

# expect_counts DECK NAME=VALUE COUNTS
expect_counts()
{
    counts "$1" "$2"
    [ "$(cat counted)" = "$3" ] || fail "$1 with $2 has elements and links $(cat counted), expected $3"
}

for c in -6 -1 0 0.5 1 1.3 2 3; do
    expect_counts void.dm2 "c=$c" '680 1296'
done
for a in -8 -1 0 0.1 0.5 1 1.8 2 3; do
    expect_counts flaw.dm2 "a=$a" '800 1548'
done
for turn in 0 60 120 180 240 300 360; do
    expect_counts turned.dm2 "turn=$turn deg" '480 1353'
done
for x in 1 1.1 1.2 1.7; do # 91 sites within 5 spacings, with the tips of the six corners
    expect_counts disc.dm2 "x=$x" '91 240'
done

# A line through a row of centres, and a line that ends in the middle of links, whatever the rounding.
for y in '1.025 cm' 'd/2 + 20*d' '0.5 cm + 10.5*d' '1.35 cm - 6.5*d'; do
    expect_counts on.dm2 "y=$y" '800 1548'
done
# Centres at both ends of the line: one of the two is on it.
for e in '0.325 cm' '6.5*d' '1.3 cm/4' '0.025 cm + 6*d'; do
    expect_counts on.dm2 "e=$e" '800 1547'
done

# A region of 8 columns of 20 elements round the seam, at one place seen from three.
for a in 0 2 -2; do
    expect_status 0 "$DM2_BIN/dm2-seq" probe.dm2 -D "a=$a" -q --progress never --overwrite -o "probe$a"
    expect_status 0 "$DM2_BIN/dm2-client" probe.dm2 -D "a=$a" -n 3 -q --progress never --overwrite -o \
        "probe$a-3"
    same_bytes "probe$a/final.dm2" "probe$a-3/final.dm2"
    same_bytes "probe$a/history.csv" "probe$a-3/history.csv"
done
same_bytes probe0/history.csv probe2/history.csv
same_bytes probe0/history.csv probe-2/history.csv

expect_status 0 "$DM2_BIN/dm2-client" flaw.dm2 -D a=0.1 -n 3 -q --progress never --overwrite -o many
expect_status 0 "$DM2_BIN/dm2-seq" flaw.dm2 -D a=0.1 -q --progress never --overwrite -o one
same_bytes one/final.dm2 many/final.dm2
