# Bonds of a material that melts but has no strength to lose, with a material that has one: who of a pair
# comes first in the lists decides nothing, so that searches and servers give the same bytes.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
cat >melt.dm2 <<'DECK'
let d = 0.04 cm
domain { size = 0.8, 0.8; r_c = 2*d; delta_r = 0.25*d; search = cells+lists }
time { dt = 0.01; steps = 12 }
material A { rho0 = 2.7; c0 = 0.39; s = 1.5; shear = 0.1; tm = 300.01; cp = 1e-6 }
material B { rho0 = 2.7; c0 = 0.39; s = 1.5; shear = 0.1; yield = 1e-6; tensile = 1e-5; cp = 1e-6 }
interaction { zeta = 0.3; kt_ratio = 0.3 }
body a { shape = rectangle 0 0 0.8 0.8; spacing = d; mix = A 0.5, B 0.5; jitter = 0.02 }
output { history_every = 4 }
DECK
sed 's/cells+lists/cells/' melt.dm2 >cells.dm2
expect_status 0 "$seq" melt.dm2 -q -o whole --hash-every 3
cp out whole.hashes
expect_status 0 "$seq" cells.dm2 -q -o cells --hash-every 3
same_bytes whole.hashes out
same_bytes whole/history.csv cells/history.csv
for n in 2 3 5; do
    expect_status 0 "$client" melt.dm2 -n $n -q -o servers --overwrite --hash-every 3
    same_bytes whole.hashes out
    same_bytes whole/final.dm2 servers/final.dm2
done
