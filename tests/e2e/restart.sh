# A restart after a change that changes nothing of what is computed goes on: a comment, line ends, more rows
# of the history, more steps, from the final state as from a checkpoint. Another speed is named. A run that
# fails after a restart from final.dm2 advises a command that leads on.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq

cat >a.dm2 <<'END'
# Two copper discs; a piston of speed `push` follows.
let push = 0.01
let d = 0.04 cm
domain { size = 3 cm, 1 cm; r_c = 2.5*d; delta_r = 0.25*d }
time { dt = 0.02 us; steps = 40 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
body piston {
    shape = rectangle 0.1 cm, 0.2 cm, 0.2 cm, 0.8 cm; spacing = d
    material = Cu; motion = driven; velocity = push, 0
}
body left { shape = disc 0.7 cm, 0.5 cm, 0.3 cm; spacing = d; material = Cu; velocity = 0.02, 0 }
body right { shape = disc 1.5 cm, 0.5 cm, 0.3 cm; spacing = d; origin = 1.5 cm, 0.5 cm; material = Cu }
profile x { axis = x; bins = 4 }
END
expect_status 0 "$seq" a.dm2 -q -o a.run --checkpoint-every 20
sed 's/^# Two copper.*/# Two discs of copper/' a.dm2 >comment.dm2
awk '{ printf "%s\r\n", $0 }' a.dm2 >crlf.dm2
{ cat a.dm2; echo 'output { history_every = 5 }'; } >output.dm2
for change in comment crlf output; do
    expect_status 0 "$seq" $change.dm2 -q -o $change.run --restart a.run/checkpoint.dm2
    same_bytes a.run/final.dm2 $change.run/final.dm2
done
expect_status 3 "$seq" a.dm2 -q -o push.run --restart a.run/checkpoint.dm2 -D push=0.02
expect_text err '`velocity` of body piston was 0.01 0, is 0.02 0 cm/us'
expect_status 0 "$seq" a.dm2 -q -o long.run --steps 400
expect_status 0 "$seq" a.dm2 -q -o ended.run --restart a.run/final.dm2 --steps 400
same_bytes long.run/final.dm2 ended.run/final.dm2
expect_status 0 "$seq" a.dm2 -q -o half.run --restart a.run/checkpoint.dm2 --steps 400
same_bytes long.run/final.dm2 half.run/final.dm2

cat >fall.dm2 <<'END'
# A stone falls, faster and faster: its run ends by an error at some step above 100.
domain { size = 1 cm, 1 cm; r_c = 0.2 cm; delta_r = 0.02 cm; gravity = 0, -1 }
time { dt = 0.02 us; steps = 20 }
material M { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5 }
body stone {
    shape = rectangle 0.3 cm, 0.3 cm, 0.4 cm, 0.4 cm; spacing = 0.1 cm; origin = 0.3 cm, 0.3 cm; material = M
}
END
expect_status 0 "$seq" fall.dm2 -q -o fall.run
expect_status 1 "$seq" fall.dm2 -q --restart fall.run/final.dm2 --steps 100000
expect_text err 'the last checkpoint is of step 20; to continue: '
advice=$(sed -n 's/.*to continue: //p' err)
expect_status 0 sh -c "$(echo "$advice" | sed 's/--steps 100000/--steps 100/')"
expect_status 0 "$seq" fall.dm2 -q -o straight.run --steps 100
same_bytes straight.run/final.dm2 fall.run/final.dm2
