# A lid that follows a table from a file, a drum that turns, a block that is heated and accelerated, across
# periodic sides: the same bytes from 1, 2, 3 and 5 servers, from a checkpoint on other servers, after the
# loss of a server. A table counts as the deck does: a state goes on with the table that made it alone.
# labels: e2e bits
# timeout: 120
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
mkdir tables
cat >deck.dm2 <<'END'
domain { size = 4 2; origin = -1 -1; r_c = 0.16; delta_r = 0.02; boundary = periodic free }
time { dt = 0.004 us; steps = 600 }
material cu { rho0 = 8.93; c0 = 0.394; s = 1.489; shear = 0.48; cp = 3.8e-6; kappa = 4e-12 }
interaction { mu = 0.3; zeta = 0.1 }
body base { shape = rectangle -1 -0.9 3 0; spacing = 0.1; material = cu; jitter = 0.01 }
body lid { shape = rectangle 2.2 0.05 3.4 0.4; spacing = 0.1; material = cu; motion = driven }
body drum { shape = disc 0.5 0.45 0.4; spacing = 0.1; material = cu; motion = driven; spin = 1.5 }
load push { body = lid; file = "tables/push.csv"; repeat = yes }
load heat { body = base; temperature = 0 300, 2 400; acceleration_x = 0 0, 2 0.02 }
output { history_every = 50; snapshot_every = 200; checkpoint_every = 250 }
END
printf 'time [us],velocity_x [km/s],velocity_y [km/s],spin [1/us]\n0,10,0,0\n0.5,9,-1,1\n1,10,0,0\n' \
    >tables/push.csv

expect_status 0 "$seq" deck.dm2 -q -o whole
for n in 1 2 3 5; do
    expect_status 0 "$client" deck.dm2 -n $n -q -o many --overwrite
    for file in final.dm2 history.csv snapshots/state-00000400.vtp; do
        [ -f "whole/$file" ] || file=$(cd whole && ls snapshots/*400*)
        same_bytes "whole/$file" "many/$file"
    done
done
[ "$(sed -n 's/^migrants: //p' many/run.log)" -gt 50 ] || fail "few migrants: $(cat many/run.log)"

# From the checkpoint of step 500, on 3 servers and in one process.
for programs in "$client -n 3" "$seq"; do
    rm -rf half
    cp -R many half
    rm half/final.dm2
    # shellcheck disable=SC2086 # a program and its options
    expect_status 0 $programs deck.dm2 -q -o half --restart half/checkpoint.dm2
    same_bytes whole/final.dm2 half/final.dm2
    same_bytes whole/history.csv half/history.csv
done

# Another table is another deck.
rm half/final.dm2
cp tables/push.csv push.csv
sed 's/^0.5,9/0.5,8/' push.csv >tables/push.csv
if "$seq" deck.dm2 -q -o half --restart half/checkpoint.dm2 >out 2>err; then
    fail 'a state went on with another table'
fi
expect_text err '`velocity_x` of load push was 0 1 0.5 0.9'
[ ! -f half/final.dm2 ] || fail 'a refused restart wrote a state'
cp push.csv tables/push.csv

# A server is lost behind step 60; its elements have their homes from the copy. The client waits while the
# server is looked for.
mkfifo hashes
"$client" deck.dm2 -n 3 -o lost --hash-every 1 --copy-every 50 >hashes 2>err </dev/null &
pid=$!
exec 4<hashes
count=0
while [ $count -le 60 ] && IFS= read -r line <&4; do
    count=$((count + 1))
done
kill -STOP $pid
victim=$(ps -o pid= -o ppid= -A | awk -v p="$pid" '$2 == p { print $1; exit }')
[ -n "$victim" ] || fail "no local server is found"
kill -KILL "$victim"
kill -CONT $pid
cat <&4 >rest
exec 4<&-
got=0
wait $pid || got=$?
[ $got -eq 0 ] || fail "status $got: $(cat err)"
expect_text err 'servers started anew'
same_bytes whole/final.dm2 lost/final.dm2
same_bytes whole/history.csv lost/history.csv
exit 0
