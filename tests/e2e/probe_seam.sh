# A disc drifts twice round a periodic domain while nothing acts on the disc: its probe moves at the disc's
# speed through the seam, the angular momentum stays, states and snapshots count the turns, a restart across
# the seam goes on with them.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
cat >drift.dm2 <<'DECK'
let d = 0.05 cm
domain { size = 2 cm, 1 cm; boundary = periodic free; r_c = 2.5*d; delta_r = 0.25*d }
time { dt = 0.01 us; steps = 1200 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
body disc { shape = disc 1.5 cm, 0.5 cm, 0.2 cm; spacing = d; origin = 1.5 cm, 0.5 cm; material = Cu
    velocity = 0.1, 0.01 }
probe whole { region = 0, 0, 2 cm, 1 cm }
output { history_every = 100; snapshot_every = 600; format = vtp xyz }
DECK
expect_status 0 "$DM2_BIN/dm2-seq" -q -o run --checkpoint-every 500 drift.dm2

# whole_x = 1.5 + 0.1 t within 1e-12; the angular momentum within 1e-12 of itself.
awk -F, 'function off(a, b) { return a > b ? a - b : b - a }
    NR == 1 { for (k = 1; k <= NF; k++) { split($k, name, " "); at[name[1]] = k } next }
    { t = $at["time"]; x = $at["whole_x"]; l = $at["angular_momentum"] }
    NR == 2 { first = l; start = x }
    off(x, start + 0.1*t) > 1e-12 { print "t = " t ": whole_x = " x; bad = 1 }
    off(l, first) > 1e-12*off(first, 0) { print "t = " t ": angular momentum " l ", at the start " first;
        bad = 1 }
    END { exit bad || NR != 14 || off(start,
        1.5) > 1e-12 }' run/history.csv >wrong || { cat wrong; fail 'history.csv'; }

# In a snapshot x + 2 image is the place without turns.
head -n 2 run/snapshots/state-000001200.xyz | grep -q ':image:I:2' || fail 'the .xyz has no image'
grep -q 'type="Int32" Name="image" NumberOfComponents="2"' run/snapshots/state-000001200.vtp ||
    fail 'the .vtp has no image'
for step in 0 600 1200; do
    awk -v step=$step 'FNR == 2 { n = split($0, part, ":"); for (k = 1; k < n; k++) if (part[k + 1] == "I" ||
        part[k + 1] == "R" || part[k + 1] == "S") { if (part[k] == "image") at = column + 1;
        column += part[k + 2] } }
        FNR > 2 { sum += $2 + 2*$at; n_all++ }
        END { mean = sum/n_all; want = 1.5 + 0.001*step; exit !(mean - want < 1e-9 && want - mean < 1e-9) }' \
        run/snapshots/state-"$(printf %09d $step)".xyz || fail "unwrapped places at step $step"
done

# Servers and a restart: the same bytes, and with a cut of the domain that the disc crosses.
for n in 1 2 3; do
    expect_status 0 "$DM2_BIN/dm2-client" -n $n -q --progress never -o "c$n" drift.dm2
    same_bytes run/final.dm2 "c$n/final.dm2"
    same_bytes run/history.csv "c$n/history.csv"
    same_bytes run/snapshots/state-000001200.vtp "c$n/snapshots/state-000001200.vtp"
done
cp -R run again
rm again/final.dm2
expect_status 0 "$DM2_BIN/dm2-client" -n 2 -q --progress never --restart again/checkpoint.prev.dm2 drift.dm2
same_bytes run/final.dm2 again/final.dm2
same_bytes run/history.csv again/history.csv

# Counts hold 2^30 turns either way, the sums of the history a million; more end the run, which says so.
sed 's/history_every = 100; snapshot_every = 600/history_every = 5000/
    s/disc 1.5 cm/disc 1 cm/' drift.dm2 >far.dm2
sed 's/velocity = 0.1,/velocity = -0.1,/' far.dm2 >back.dm2
# turned DECK TURNS STATUS: the run through the seam of an element that has gone round TURNS times before.
turned()
{
    for way in dm2-seq 'dm2-client -n 2'; do
        rm -rf turned
        cp -R "${1%.dm2}" turned
        expect_status 0 "$DM2_BUILD/tools/patch_state" turned/final.dm2 turned/final.dm2 7 image "$2"
        # shellcheck disable=SC2086 # the words of the program
        expect_status "$3" "$DM2_BIN/"$way -q "$1" --steps 1300 --restart turned/final.dm2
    done
}
for deck in far.dm2 back.dm2; do
    expect_status 0 "$DM2_BIN/dm2-seq" -q --steps 100 $deck -o "${deck%.dm2}"
    sign=
    [ $deck = far.dm2 ] || sign=-
    turned $deck ${sign}1000000 0
    turned $deck ${sign}1073741824 1
    expect_text err 'element 7 has gone round the periodic domain more than 2^30 times'
    turned $deck ${sign}1073741823 1
    expect_text err "step 1300: element 7 has gone round the periodic domain ${sign}1073741824 times, and"
done
