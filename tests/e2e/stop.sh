# A block `stop` ends a run three steps behind the row at which it holds: at the same step, with the same
# bytes, for any number of servers, over a restart before or behind that row, over the loss of a server.
# labels: e2e bits
. "$DM2_SRC/tests/lib.sh"

cat >settle.dm2 <<'END'
let k = 1e-3
let after = 20
let low = -1
domain { size = 60 60; r_c = 1.6; delta_r = 0.3; damping = 0.2 }
time { dt = 0.1; steps = 3000 }
material A { mass = 1 }
interaction { potential = morse; k = 1; shape = 4; kt_ratio = 0.3; mu = 0.3 }
body left { shape = rectangle 10 10 20 20.3; spacing = 1; origin = 10.1 10.1; material = A
    velocity = 0.02 0 }
body right { shape = rectangle 20 13 30 24.3; spacing = 1; origin = 10.4 10.1; material = A
    velocity = -0.02 0 }
probe p { region = 10 10 12 20 }
stop { kinetic = k; after = after }
stop { probe = p vx below low }
output { history_every = 50; snapshot_at = 450, 3000 }
END

# ended ROW: the run in directory `one` ended at the row's step and 3, as its tables and its log say.
ended()
{
    [ "$(tail -n 1 one/history.csv | cut -d, -f1)" = $(($1 + 3)) ] ||
        fail "the last row is of step $(tail -n 1 one/history.csv | cut -d, -f1)"
    expect_text one/run.log "steps: $(($1 + 3))"
}

# The first row from which on the kinetic energy has been below k for 20 us, 200 steps.
expect_status 0 "$DM2_BIN/dm2-seq" settle.dm2 -D k=1e-30 -D after=9999 -q -o free
row=$(awk -F, 'NR == 1 { next } !($3 < 1e-3) { since = ""; next } since == "" { since = $1 }
    $1 - since >= 200 { print $1; exit }' free/history.csv)
[ "$(tail -n 1 free/history.csv | cut -d, -f1)" = 3000 ] || fail "the run without a stop has not 3000 steps"
[ -n "$row" ] && [ "$row" -lt 2900 ] || fail "the deck does not settle: $row"
expect_status 0 "$DM2_BIN/dm2-seq" settle.dm2 -o one
ended "$row"
expect_text out "stop: kinetic below 0.001 for 20 us at row $row: the run ends at step $((row + 3))"
expect_text one/run.log "stop: kinetic below 0.001 for 20 us at row $row: the run ends at step $((row + 3))"
n=$(wc -l <one/history.csv)
head -n $((n - 1)) one/history.csv >rows
head -n $((n - 1)) free/history.csv | cmp - rows || fail "the rows are not those of the run without a stop"
for n in 1 2 5; do
    expect_status 0 "$DM2_BIN/dm2-client" settle.dm2 -n $n -o several --overwrite
    expect_text out "stop: kinetic below 0.001 for 20 us at row $row"
    same_bytes one/final.dm2 several/final.dm2
    same_bytes one/history.csv several/history.csv
done

# The state of the end is that of a run of so many steps.
expect_status 0 "$DM2_BIN/dm2-seq" settle.dm2 -D k=1e-30 -q --steps $((row + 3)) -o short
awk -F, 'NR > 1 { print $1, $3, $10 }' one/history.csv | tail -n 1 >last.one
awk -F, 'NR > 1 { print $1, $3, $10 }' short/history.csv | tail -n 1 >last.short
same_bytes last.one last.short

# A checkpoint of each of the three steps behind the row, of the row, and of one before.
for step in $((row + 3)) $((row + 2)) $((row + 1)) "$row" $((row - 60)); do
    expect_status 0 "$DM2_BIN/dm2-client" settle.dm2 -n 2 -q -o cut --overwrite --checkpoint-every "$step"
    checkpoint=cut/checkpoint.dm2
    [ "$step" -lt $((row + 3)) ] || checkpoint=cut/final.dm2
    expect_status 0 "$DM2_BIN/dm2-client" settle.dm2 -n 3 -q --restart "$checkpoint" -o on --overwrite
    same_bytes one/history.csv on/history.csv
    same_bytes one/final.dm2 on/final.dm2
    expect_text on/run.log "at row $row: the run ends at step $((row + 3))"
done

# A server is killed one step before the row, behind it, and in the last evaluation.
mkdir ending
ln -s "$DM2_BUILD/failing/ending-server" ending/dm2-server
ln -s "$DM2_BIN/dm2-client" ending/dm2-client
for step in $((row - 1)) $((row + 1)) $((row + 3)); do
    expect_status 0 env DM2_END_AT="$step" DM2_END_MARK="mark-$step" ending/dm2-client settle.dm2 -n 3 \
        --copy-every 25 -o several --overwrite
    expect_text err 'servers started anew'
    [ -e "mark-$step" ] || fail "no server was killed at step $step"
    same_bytes one/history.csv several/history.csv
    same_bytes one/final.dm2 several/final.dm2
done

# Another block, the first to hold, and a probe's column.
expect_status 0 "$DM2_BIN/dm2-seq" settle.dm2 -D low=-0.01 -q -o one --overwrite
row=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, "p_vx ") == 1) at = i; next }
    $at < -0.01 { print $1; exit }' free/history.csv)
ended "$row"
expect_text one/run.log "stop: p_vx below -0.01 at row $row: the run ends"
expect_status 0 "$DM2_BIN/dm2-client" settle.dm2 -D low=-0.01 -n 3 -q -o several --overwrite
same_bytes one/history.csv several/history.csv

# Bad conditions.
for bad in 'probe = q vx above 1:no probe .q.' 'probe = p vz above 1:no quantity .vz.' \
    'probe = p vx over 1:no side .over.' 'probe = p vx above 1 K:is a velocity' \
    'after = 1:lacks a condition' \
    'probe = p torque above 1:does not report .torque.' 'probe = p vx:found 2 values'; do
    { cat settle.dm2; echo "stop { ${bad%%:*} }"; } >bad.dm2
    expect_status 2 "$DM2_BIN/dm2-seq" bad.dm2 --check
    grep -q "^bad.dm2:16:.*${bad#*:}" err || fail "stop { ${bad%%:*} }: $(cat err)"
done

# A row less than three steps before the end ends nothing earlier.
expect_status 0 "$DM2_BIN/dm2-seq" settle.dm2 -D low=-0.01 --steps $((row + 1)) -q -o one --overwrite
[ "$(tail -n 1 one/history.csv | cut -d, -f1)" = $((row + 1)) ] || fail "the run has not its own last step"
expect_status 0 "$DM2_BIN/dm2-client" settle.dm2 -D low=-0.01 --steps $((row + 1)) -n 2 -q -o several \
    --overwrite
same_bytes one/history.csv several/history.csv
exit 0
