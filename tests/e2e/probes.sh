# What bodies feel: the force columns are, to the last bit, the sums of the forces in a snapshot, and sum to 0
# over all bodies; probes, snapshots and profiles have the same bytes from any number of servers; `fields`
# and `bodies` choose what snapshots have.
# labels: e2e bits measures
. "$DM2_SRC/tests/lib.sh"
cat >deck.dm2 <<'END'
domain { size = 0.8 0.6; r_c = 0.1; delta_r = 0.02; boundary = periodic free; gravity = 1e-5 -1e-5 }
time { dt = 0.01; steps = 60 }
material heavy { rho0 = 8; c0 = 0.4; s = 1.4; cp = 4e-6; yield = 2e-3; tensile = 4e-3; shear = 0.2 }
material light { rho0 = 2; c0 = 0.5; s = 1.3; cp = 9e-6; shear = 0.1 }
interaction { zeta = 0.1; mu = 0.3; linked = no }
interface grain heavy heavy { linked = yes }
body low { shape = rectangle 0 0.01 0.8 0.21; spacing = 0.04; origin = 0.01 0.02
  material = heavy; velocity = 0.01 0.04; jitter = 0.01 }
body mid { shape = rectangle 0 0.21 0.8 0.31; spacing = 0.04; origin = 0.01 0.02
  material = heavy; motion = driven; velocity = 0.001 0.01 }
body high { shape = rectangle 0 0.31 0.8 0.4; spacing = 0.04; origin = 0.01 0.02
  mix = light 0.5, heavy 0.5; velocity = 0 -0.03; temperature = 400 }
probe low { body = low; report = position, velocity, force, torque, spin, stress, temperature, kinetic }
probe mid { body = mid }
probe high { body = high; report = force }
probe part { region = 0.5 0.1 1.0 0.25; report = porosity, force }
profile up { axis = y; bins = 6; every = 20 }
END
echo 'output { history_every = 1; snapshot_every = 20; format = vtp, xyz }' | cat deck.dm2 - >all.dm2
echo 'output { history_every = 1; snapshot_every = 20; format = vtp, xyz
fields = pairs, id, body, velocity; bodies = mid }' | cat deck.dm2 - >some.dm2

expect_status 0 "$DM2_BIN/dm2-seq" all.dm2 -q -o all
expect_status 0 "$DM2_BIN/dm2-seq" some.dm2 -q -o some
for run in '1 all' '2 all' '3 all' '5 all' '3 some'; do
    deck=${run#* }
    expect_status 0 "$DM2_BIN/dm2-client" "$deck.dm2" -n "${run% *}" -q -o many --overwrite
    for file in history.csv profile-up.csv final.dm2 snapshots/state-000000000.vtp \
        snapshots/state-000000040.vtp snapshots/state-000000060.vtp snapshots/state-000000060.xyz; do
        same_bytes "$deck/$file" "many/$file"
    done
done

# columns NAME STEP: the force of a body at a step, as fx,fy.
columns()
{
    awk -F, -v name="$1" -v step="$2" '
    NR == 1 { for (k = 1; k <= NF; k++) { sub(/ .*/, "", $k); at[$k] = k } }
    $1 == step && NR > 1 { print $at[name "_fx"] "," $at[name "_fy"] }' all/history.csv
}
moving=0
for step in 0 20 40 60; do
    number=0
    for body in low mid high; do
        want=$(columns $body $step)
        file=$(printf 'snapshots/state-%09d.vtp' $step)
        got=$("$DM2_BUILD/tools/body_force" all/"$file" $number) || fail "body_force: $got"
        [ "$got" = "$want" ] || fail "step $step, body $body: pairs sum to $got, the columns are $want"
        [ "$want" = 0,0 ] || moving=$((moving + 1))
        number=$((number + 1))
    done
    got=$("$DM2_BUILD/tools/body_force" some/"$file" 1) || fail "body_force: $got"
    [ "$got" = "$(columns mid $step)" ] || fail "step $step: the pairs of body mid sum to $got"
done
[ $moving -ge 8 ] || fail "only $moving of 12 forces are not 0"

# The columns of all bodies sum to 0, in doubles.
awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) { sub(/ .*/, "", $k); at[$k] = k } next }
{ x = $at["low_fx"] + $at["mid_fx"] + $at["high_fx"]; y = $at["low_fy"] + $at["mid_fy"] + $at["high_fy"]
  if (x != 0 || y != 0) { print "step " $1 ": forces sum to " x ", " y; exit 1 } }' all/history.csv >sums ||
    fail "$(cat sums)"

# Only the driven body, only what was asked for.
head -n 2 some/snapshots/state-000000060.xyz >head
expect_text head 'Properties=species:S:1:pos:R:3:id:I:1:body:I:1:velo:R:3 Time='
[ "$(head -n 1 head)" -eq 60 ] || fail "the .xyz has $(head -n 1 head) elements, the body 60"
awk 'NR > 2 && $6 != 1 { exit 1 }' some/snapshots/state-000000060.xyz || fail "an element of another body"
grep -q 'Name="radius"' some/snapshots/state-000000060.vtp && fail "a field that was not asked for"
expect_status 0 "$DM2_BIN/dm2-plot" chart all/history.csv --x time --y low_fy,unbalanced -o chart.svg
expect_status 0 "$DM2_BIN/dm2-plot" snapshot all/snapshots/state-000000060.vtp --links -o picture.svg
exit 0
