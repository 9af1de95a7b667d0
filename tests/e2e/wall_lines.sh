# Lines and circles as walls: still, moving, turning, under loads, across a periodic side and all cuts. The
# same bytes for any number of servers, after a restart, and where a server is lost; what --check prints;
# how a wall that moves too fast is refused.
# labels: e2e bits
# timeout: 90
. "$DM2_SRC/tests/lib.sh"

cat >deck.dm2 <<'DECK'
domain { size = 12 12; origin = -6 -6; r_c = 0.45; delta_r = 0.05; boundary = periodic free
         gravity = 0 -4e-3 }
time { dt = 0.02; steps = 1200 }
material a { mass = 1e-2; cp = 1; kappa = 1e-4 }
interaction { potential = quadratic; k = 1; linked = no; zeta = 0.1; mu = 0.5; kt_ratio = 0.3 }
body b { shape = rectangle -6 -3.7 6 -2.5; spacing = 0.3; origin = 0.1 -3.7; radius = 0.145; material = a
         jitter = 0.02; velocity = 0.1 0; seed = 3 }
body c { shape = rectangle 1.25 2.85 2.75 4.1; spacing = 0.31; radius = 0.15; material = a
         jitter = 0.02; seed = 5 }
wall floor { line = -6 -4 -5 -3.95 0 -4.2 3 -4 6 -4; material = a; velocity = 0.03 0 }
wall stirrer { line = -1 -2.4 0 -2.4 0 -1.4 -1 -1.4 -1 -2.4; rigid = yes }
wall ring { circle = 2 3.5 1.2; material = a; spin = -0.2 }
load stir { body = stirrer; velocity_y = 0 0, 8 -0.04, 16 0.02, 24 0; spin = 0 0, 10 0.3, 24 -0.1 }
load heat { body = floor; temperature = 0 350, 24 400 }
probe floor { body = floor; report = force, heat, torque, temperature }
probe stirrer { body = stirrer; report = force, spin, position, velocity }
probe ring { body = ring; report = force }
probe b { body = b; report = force } probe c { body = c; report = force }
output { history_every = 100; snapshot_every = 600 }
DECK
seq=$DM2_BIN/dm2-seq client=$DM2_BIN/dm2-client
same_run()
{
    for file in final.dm2 history.csv snapshots/state-000000600.vtp; do
        same_bytes "whole/$file" "$1/$file"
    done
}

expect_status 0 "$seq" deck.dm2 --check
expect_text out "wall floor: closed line of 4 parts"
expect_text out "wall ring: circle of radius 1.2 cm"
expect_status 0 "$seq" deck.dm2 -q -o whole
for n in 2 3 5; do
    expect_status 0 "$client" deck.dm2 -n $n -q -o "run$n"
    same_run "run$n"
done

# The contacts of a snapshot sum to the columns, to the last bit, and the columns of all to 0.
columns()
{
    awk -F, -v name="$1" -v step="$2" '
    NR == 1 { for (k = 1; k <= NF; k++) { sub(/ .*/, "", $k); at[$k] = k } }
    $1 == step && NR > 1 { print $at[name "_fx"] "," $at[name "_fy"] }' whole/history.csv
}
for step in 600 1200; do
    for of in 'floor wall 0' 'stirrer wall 1' 'ring wall 2' 'b 0' 'c 1'; do
        want=$(columns ${of%% *} $step)
        got=$("$DM2_BUILD/tools/body_force" "$(printf 'whole/snapshots/state-%09d.vtp' $step)" ${of#* }) ||
            fail "body_force: $got"
        [ "$got" = "$want" ] || fail "step $step, $of: contacts sum to $got, the columns are $want"
    done
done
[ "$(columns floor 1200)" != 0,0 ] || fail 'no force on the floor'
[ "$(columns ring 1200)" != 0,0 ] || fail 'no force on the ring'
awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) { sub(/ .*/, "", $k); at[$k] = k } next }
{ for (a = 1; a <= 2; a++) {
      f = a == 1 ? "_fx" : "_fy"
      x = $at["floor" f] + $at["stirrer" f] + $at["ring" f] + $at["b" f] + $at["c" f]
      if (x != 0) { print "step " $1 ": " f " sums to " x; exit 1 } } }' whole/history.csv >sums ||
    fail "$(cat sums)"

# The picture has the walls, and the floor's images across the sides.
expect_status 0 "$DM2_BIN/dm2-plot" snapshot whole/snapshots/state-000000600.vtp -o walls.svg
[ "$(grep -c '^<path d="M[^"]*L[^"]*L' walls.svg)" = 9 ] ||
    fail 'the picture has not three walls and their images'

# A checkpoint in the middle has the springs of contacts.
expect_status 0 "$seq" deck.dm2 -q -o part --checkpoint-every 700
expect_status 0 "$client" deck.dm2 -n 3 -q --restart part/checkpoint.dm2 --overwrite
same_run part

# A server is lost after the copy of step 600.
start_server
one=$SERVER_ADDR
start_server
two=$SERVER_ADDR two_pid=$SERVER_PID
mkfifo hashes
"$client" deck.dm2 --server "$one" --server "$two" -o lost -q --hash-every 1 --copy-every 300 \
    >hashes 2>err </dev/null &
client_pid=$!
exec 4<hashes
count=0
while [ $count -le 700 ] && IFS= read -r line <&4; do
    count=$((count + 1))
done
kill -KILL "$two_pid"
cat <&4 >/dev/null
exec 4<&-
wait $client_pid || fail "the run with the lost server: $(cat err)"
grep -q 'servers lost and made good: [1-9]' lost/run.log || fail "no server was lost"
same_run lost

# Too fast: id, wall, place.
sed 's/velocity = 0.03 0 }/velocity = 0 8 }/; s/steps = 1200/steps = 50/' deck.dm2 >deep.dm2
expect_status 2 "$seq" deep.dm2 -q -o deep
expect_text err "in a step against the wall 'floor'"
