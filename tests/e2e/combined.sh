# One deck with all that a study may have at once, across a periodic side: a lid under a stress, a floor that
# follows a table that repeats, held temperatures, walls that move and turn, local damping, links that break,
# probes, profiles, snapshots, a block `stop`. The same files from any number of servers, for every way to
# find pairs, over interruptions, from deck.dm2, where a stopped run goes on without its stop.
# labels: e2e bits
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client

cat >deck.dm2 <<'END'
let calm = 1.1
domain { size = 1 1; origin = -0.3 0; r_c = 0.12; delta_r = 0.02; boundary = periodic free; damping = 0.3
    gravity = 0 -0.01; search = cells+lists; rebuild_every = 0 }
time { dt = 0.004; steps = 240 }
material a { rho0 = 2.7; c0 = 0.5; s = 1.3; cp = 9e-6; kappa = 1e-12 }
interaction { zeta = 0.1; mu = 0.3; link_break = 1.002 }
body floor { shape = rectangle 0.2 0.05 0.6 0.1; spacing = 0.05; origin = 0.2 0.06; material = a
    motion = driven }
body sample { shape = rectangle 0.15 0.12 0.9 0.4; spacing = 0.05; origin = 0.2 0.125; material = a
    jitter = 0.02; velocity = 0.05 -0.02 }
body lid { shape = rectangle 0.1 0.42 0.85 0.46; spacing = 0.05; origin = 0.1 0.43; material = a
    motion = driven }
load press { body = lid; stress_yy = 0 -1e-3, 1 -2e-3; max_velocity = 0.05; velocity_x = 0 0, 0.5 0.02 }
load shake { body = floor; velocity_x = 0 0.1 0.1 -0.1 0.2 0.1; repeat = yes
    temperature = 0 300 0.1 500 0.2 300 }
load heat { body = sample; acceleration_x = 0 0, 0.5 0.1, 1 0 }
wall ground { line = -0.3 0.02 0.2 0.025 0.7 0.02; material = a; velocity = 0.01 0 }
wall wheel { circle = 0.7 0.62 0.1; material = a; spin = 0.5; temperature = 400 }
probe floor { body = floor; report = position velocity force torque spin stress temperature kinetic }
probe lid { body = lid; report = position velocity force torque spin stress temperature kinetic }
probe part { region = 0.2 0.1 0.5 0.3; report = position velocity force stress temperature kinetic porosity }
profile x { axis = x; bins = 3; every = 7 }
stop { unbalanced = calm; after = 0.1 }
output { history_every = 5; snapshot_every = 100; checkpoint_every = 30; strain = yes; format = vtp xyz }
END

# same_run DIR [FILE]: every result is that of `whole`, but for FILE.
same_run()
{
    (cd whole && find . -type f ! -name run.log ! -name timing.csv ! -name 'checkpoint*') >names
    while IFS= read -r name; do
        [ "$name" = "./${2-}" ] || same_bytes "whole/$name" "$1/$name"
    done <names
}

expect_status 0 "$seq" deck.dm2 -q -o whole
last=$(tail -n 1 whole/history.csv | cut -d, -f1)
[ "$last" -gt 100 ] && [ "$last" -lt 240 ] || fail "the run ends at step $last"
[ "$(wc -l <whole/cracks.csv)" -gt 50 ] || fail "cracks.csv has $(wc -l <whole/cracks.csv) lines"
for n in 1 2 3 5; do
    expect_status 0 "$client" deck.dm2 -n $n -q -o "servers-$n"
    same_run "servers-$n"
done
for ways in 'search = cells; rebuild_every = 0' 'search = lists; rebuild_every = 7'; do
    sed "s/search = cells+lists; rebuild_every = 0/$ways/" deck.dm2 >ways.dm2
    expect_status 0 "$seq" ways.dm2 -q -o ways --overwrite
    same_run ways deck.dm2
done

# Cut at steps before and behind rows, checkpoints, the row of the stop; other programs go on.
for step in 1 37 100 $((last - 2)) $((last - 1)); do
    expect_status 0 "$client" deck.dm2 -n 3 -q -o cut --steps "$step" --overwrite
    expect_status 0 "$seq" deck.dm2 -q -o cut --restart auto
    same_run cut schedule.csv
done

# deck.dm2 is the run's deck; without the stop the run goes on to the last step of the deck.
expect_status 0 "$client" whole/deck.dm2 -n 2 -q -o again
same_run again
sed 's/^stop.*//' deck.dm2 >endless.dm2
expect_status 0 "$seq" endless.dm2 -q -o endless
expect_status 0 "$client" endless.dm2 -n 2 -q -o again --restart auto
for file in final.dm2 history.csv cracks.csv profile-x.csv; do
    same_bytes endless/$file again/$file
done
