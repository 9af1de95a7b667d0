# A run tells by how much its energy book is off: a closing line, the same in run.log, a column `drift` that
# one process, servers and a continued run write alike; a warning beyond 1 %, an end beyond 50 %.
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
body right { shape = rectangle 18.4 cm, 20 cm, 18.8 cm, 20.4 cm; spacing = d; material = Cu
    velocity = -v, 0 }
output { history_every = 10 }
END

# An unstable run ends, with no final state and no history.
for program in dm2-seq 'dm2-client -n 2'; do
    for try in 'f=0.99 v=0.02' 'f=0.8 v=0.05'; do
        set -- $try
        expect_status 1 "$DM2_BIN"/$program limit.dm2 -q -D "$1" -D "$2" -o ended
        expect_text err 'the energy book is off by'
        [ ! -e ended/final.dm2 ] && [ ! -e ended/history.csv ] ||
            fail "$program: an unstable run left results"
        rm -rf ended
    done
done

# Off by more than 1 %: a warning.
expect_status 0 "$DM2_BIN/dm2-seq" limit.dm2 -D f=0.6 -D v=0.05 -o off
expect_text err 'dm2-seq: warning: the energy book is off by 1.4 %'
expect_text off/run.log 'warning: the energy book is off by 1.4 %'
expect_text out 'energy: total drifted by -1.39 % of what moved (0.00340 g cm2/us2; worst 1.4 % at step 10);
    dt at most 0.86 of the limit (step 20)'
[ "$(tail -n 1 out)" = "$(tail -n 1 off/run.log)" ] || fail "the closing lines differ"

# The column is D/S of the numbers in the table; servers and a continued run write the same bytes and say the
# same.
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
[ "$(tail -n 1 continued/run.log)" = "$(tail -n 1 off/run.log)" ] ||
    fail "the closing lines of a continued run differ"

# A light disc with 36 heavy neighbours: its limit counts them, for --check as for a run.
cat >light.dm2 <<'END'
let f = 0.5
let d = 0.03 cm
domain { size = 2 cm, 2 cm; r_c = 0.65 cm; delta_r = 0.01 cm }
time { dt = f*0.0645 us; steps = 150 }
material L { rho0 = 0.002 g/cm3 }
material H { rho0 = 20 g/cm3 }
interaction { potential = quadratic; k = 0.1; linked = yes }
interface body { linked = yes }
body light { shape = disc 1 cm, 1 cm, 0.1 cm; spacing = 0.6 cm; origin = 1 cm, 1 cm; material = L
    velocity = 1e-4, 0 }
body crystal { shape = rectangle 0.5 cm, 0.5 cm, 1.5 cm, 1.5 cm; spacing = d; origin = 1 cm, 1 cm
    material = H }
void hole { shape = disc 1 cm, 1 cm, 0.313 cm; body = crystal }
output { history_every = 150 }
END
for program in dm2-seq 'dm2-client -n 2'; do
    expect_status 0 "$DM2_BIN"/$program light.dm2 --check
    expect_text out 'stable time step 0.0339809 us (neighbours at the start), chosen 0.03225 us = 0.949 of it'
    expect_text out "elements of 'light' have room for 65 of 'crystal': then 0.0277 us"
    expect_status 2 "$DM2_BIN"/$program light.dm2 -D f=0.55 --check
    expect_text err 'dt = 0.035475 us is not below the stable one,
        0.0339809 us (limit: neighbours at the start'
    expect_status 2 "$DM2_BIN"/$program light.dm2 -D f=0.55 -q -o refused
    expect_text err 'dt = 0.035475 us is not below the stable one,
        0.0339809 us (limit: neighbours at the start'
    [ ! -e refused ] || fail "a refused run has a directory"
done

# From 0.9 of the limit that holds now on, a run warns at once and at its end.
for program in dm2-seq 'dm2-client -n 2'; do
    expect_status 0 "$DM2_BIN"/$program limit.dm2 -D f=0.85 -D v=0.01 -o near --overwrite
    expect_text err 'warning: step 10: dt is 0.9'
    expect_text err 'choose half of dt'
    tail -n 1 near/run.log | grep -q 'dt at most 0.9[0-9]* of the limit (step ' ||
        fail "no limit: $(tail -n 1 near/run.log)"
done
exit 0
