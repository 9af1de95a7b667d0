# With `balance = particles` a restart cuts the domain by where the elements are, not by where they started:
# of a gas that has flown from the left half to the right half each of two servers owns half.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"

cat >flight.dm2 <<'END'
domain { size = 4 1; boundary = free periodic; r_c = 0.1; delta_r = 0.02; balance = particles }
time { dt = 0.02; steps = 300 }
material Ni { rho0 = 8.874 g/cm3; c0 = 4.602 km/s; s = 1.437 }
body gas { shape = rectangle 0.2 0.1 1.2 0.9; spacing = 0.07; radius = 0.02; material = Ni
    velocity = 0.4 0; jitter = 0.02 }
END
expect_status 0 "$DM2_BIN/dm2-seq" flight.dm2 -q -o whole
expect_status 0 "$DM2_BIN/dm2-client" flight.dm2 -q -n 2 -o first --steps 280
expect_status 0 "$DM2_BIN/dm2-client" flight.dm2 -q -n 2 -o rest --restart first/final.dm2
same_bytes whole/final.dm2 rest/final.dm2
awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == "elements") column = k; next }
    NR == 2 || NR == 3 { n[NR] = $column }
    END { if (n[2] + n[3] < 100 || n[2] < 0.8 * n[3] || n[3] < 0.8 * n[2]) { print n[2], n[3]; exit 1 } }' \
    rest/timing.csv || fail 'the servers do not own half of the elements each'
