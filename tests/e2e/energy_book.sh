# A run tells by how much its energy book is off: a closing line, the same in run.log, a column `drift` that one process,
# servers and a continued run write alike; a warning beyond 1 %, an end beyond 50 %.
# labels: e2e physics
. "$DM2_SRC/tests/lib.sh"

# Two pieces of copper run into each other; f: dt over the stable step of the lattice.
cat >limit.dm2 <<'END'
let f = 0.99
let d = 0.04 cm
let v = 0.02
domain { size = 40 cm, 40 cm; r_c = 10 cm; delta_r = 1 cm }
time { dt = f*0.0879214 us; steps = 300 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
interaction { link_break = 1.05; zeta = 0 }
body left { shape = rectangle 18 cm, 20 cm, 18.4 cm, 20.4 cm; spacing = d; material = Cu; velocity = v, 0 }
body right { shape = rectangle 18.4 cm, 20 cm, 18.8 cm, 20.4 cm; spacing = d; material = Cu; velocity = -v, 0 }
output { history_every = 10 }
END

# An unstable run ends, with no final state and no history.
for program in dm2-seq 'dm2-client -n 2'; do
    for try in 'f=0.99 v=0.02' 'f=0.8 v=0.05'; do
        set -- $try
        expect_status 1 "$DM2_BIN"/$program limit.dm2 -q -D "$1" -D "$2" -o ended
        expect_text err 'the energy book is off by'
        [ ! -e ended/final.dm2 ] && [ ! -e ended/history.csv ] || fail "$program: an unstable run left results"
        rm -rf ended
    done
done

# Off by 10 %: a warning.
expect_status 0 "$DM2_BIN/dm2-seq" limit.dm2 -D f=0.6 -D v=0.05 -o off
expect_text err 'dm2-seq: warning: the energy book is off by 10.4 %'
expect_text off/run.log 'warning: the energy book is off by 10.4 %'
expect_text out 'energy: total drifted by 10.4 % of what moved (0.00340 g cm2/us2; worst 10 % at step 290)'
[ "$(tail -n 1 out)" = "$(tail -n 1 off/run.log)" ] || fail "the closing lines differ"

# The column is D/S of the numbers in the table; servers and a continued run write the same bytes and say the same.
expect_status 0 "$DM2_BIN/dm2-client" limit.dm2 -n 2 -D f=0.6 -D v=0.05 -o servers
same_bytes off/history.csv servers/history.csv
[ "$(tail -n 1 servers/run.log)" = "$(tail -n 1 off/run.log)" ] || fail "the closing lines of servers differ"
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/ .*/, "", $i); at[$i] = i; name[i] = $i }; next }
    function most(x) { if (x < 0) x = -x; if (x > moved) moved = x }
    NR == 2 { for (i = 1; i <= NF; i++) first[i] = $i }
    { most($at["kinetic"]); most($at["work"])
      n = split("potential elastic thermal chemical phase", a, " ")
      for (i = 1; i <= n; i++) most($at[a[i]] - first[at[a[i]]])
      d = ($at["total"] - first[at["total"]])/moved - $at["drift"]
      if (d > 1e-12 || d < -1e-12) { print NR, d; exit 1 } }
    END { exit NR != 32 }' off/history.csv || fail "the column drift is not D/S"
expect_status 0 "$DM2_BIN/dm2-seq" limit.dm2 -q -D f=0.6 -D v=0.05 --checkpoint-every 150 -o cut
expect_status 0 "$DM2_BIN/dm2-seq" limit.dm2 -q -D f=0.6 -D v=0.05 --restart cut/checkpoint.dm2 -o continued
same_bytes off/history.csv continued/history.csv
[ "$(tail -n 1 continued/run.log)" = "$(tail -n 1 off/run.log)" ] || fail "the closing lines of a continued run differ"
exit 0
