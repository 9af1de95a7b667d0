# A link that breaks makes no energy: the total of a sheet that tears, without damping, yield or strength, is
# off by an amount that falls with the square of the step, and two elements flung apart keep their energy as
# their link breaks.
. "$DM2_SRC/tests/lib.sh"

cat >sheet.dm2 <<'DECK'
let dt = 0.4
let v = 0.05
domain { size = 60 60; r_c = 1.6; delta_r = 0.3 }
time { dt = dt; steps = round(300/dt) }
material A { mass = 1 }
interaction { potential = morse; k = 1; shape = 4; link_break = 1.05 }
interface body { linked = yes }
body left { shape = rectangle 10 10 30 30.3; spacing = 1; origin = 10.1 10.1; material = A; velocity = -v 0 }
body right { shape = rectangle 30 10 50 30.3; spacing = 1; origin = 10.1 10.1; material = A; velocity = v 0 }
output { history_every = round(2/dt) }
DECK
cat >two.dm2 <<'DECK'
let dt = 0.01
let kt = 0
let w = 0
domain { size = 20 20; r_c = 1.6; delta_r = 0.3 }
time { dt = dt; steps = round(3/dt) }
material A { mass = 1 }
interaction { potential = morse; k = 1; shape = 4; link_break = 1.05; kt_ratio = kt }
interface body { linked = yes }
body left { shape = rectangle 9.9 10 10.1 10.1; spacing = 1; origin = 10 10; material = A
    velocity = -0.045 -w }
body right { shape = rectangle 10.9 10 11.1 10.1; spacing = 1; origin = 10 10; material = A
    velocity = 0.045 w }
output { history_every = 1 }
DECK

# drift DECK OPTION...: the largest difference of the total from the total of the first row, as a share of it.
drift()
{
    expect_status 0 "$DM2_BIN/dm2-seq" "$@" -q --progress never -o run --overwrite
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { split($i, a, " "); at[a[1]] = i } }
        NR == 2 { total = $at["total"]; links = $at["links"] }
        NR > 2 { d = $at["total"]/total - 1; d = d < 0 ? -d : d; worst = d > worst ? d : worst }
        END { print worst, links - $at["links"] }' run/history.csv >drift.txt
    read -r off broken <drift.txt
}

# below VALUE LIMIT WHAT
below()
{
    awk -v a="$1" -v b="$2" 'BEGIN { exit !(a < b) }' || fail "$3: $1, expected less than $2"
}

last=0.008
for dt in 0.4 0.2 0.1; do
    drift sheet.dm2 -D "dt=$dt"
    [ "$broken" = 49 ] || fail "$broken links broke, expected 49"
    below "$off" "$(awk -v l="$last" 'BEGIN { print 0.3*l }')" \
        "share of the total that a torn sheet makes at dt = $dt"
    last=$off
done
cp -r run seq
for n in 2 3; do # of a deck without damping or springs
    expect_status 0 "$DM2_BIN/dm2-client" sheet.dm2 -D dt=0.1 -q -n $n -o run --overwrite
    same_bytes seq/final.dm2 run/final.dm2
    same_bytes seq/history.csv run/history.csv
done

for spring in 'kt=0' 'kt=0.3'; do
    for dt in 0.02 0.01 0.005; do
        drift two.dm2 -D "dt=$dt" -D "$spring" -D w=0.01
        [ "$broken" = 1 ] || fail "the link of two elements did not break"
        below "$off" "$(awk -v dt="$dt" 'BEGIN { print 0.4*dt*dt }')" \
            "share that one link makes, $spring, dt = $dt"
    done
done
