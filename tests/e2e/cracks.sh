# cracks.csv has a row for each link that breaks, the same bytes for any number of servers, over the loss of a
# server, over a restart in place or elsewhere; a run without a crack has no such table.
# labels: e2e bits
. "$DM2_SRC/tests/lib.sh"

cat >tear.dm2 <<'END'
let v = 0.03
let j = 0.08
domain { size = 60 60; r_c = 1.6; delta_r = 0.3 }
time { dt = 0.2; steps = 300 }
material A { mass = 1; tensile = 0.03 }
material B { mass = 1 }
interaction { potential = morse; k = 1; shape = 4; kt_ratio = 0.3; link_break = 1.05; zeta = 0.1 }
interface body { linked = yes }
body left { shape = rectangle 10 10 30 30.3; spacing = 1; origin = 10.1 10.1; material = A
    velocity = -v v }
body right { shape = rectangle 30 10 50 30.3; spacing = 1; origin = 10.1 10.1; material = B; velocity = v 0
    jitter = j }
output { history_every = 10 }
END
expect_status 0 "$DM2_BIN/dm2-seq" tear.dm2 -q -o whole
for n in 1 2 3 5; do
    expect_status 0 "$DM2_BIN/dm2-client" tear.dm2 -n $n -q -o run --overwrite
    same_bytes whole/cracks.csv run/cracks.csv
    same_bytes whole/final.dm2 run/final.dm2
done

# A row per link that is lost; steps and ids ascend; each pair once; every mode, one grain and two.
heading='step,time [us],x [cm],y [cm],id_a,id_b,grains,mode,energy [g cm2/us2]'
[ "$(head -n 1 whole/cracks.csv)" = "$heading" ] || fail "the heading is $(head -n 1 whole/cracks.csv)"
lost=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "links") at = i }
    NR == 2 { first = $at } END { print first - $at }' whole/history.csv)
awk -F, -v lost="$lost" 'NR == 1 { next }
    { key = $1*1e12 + $5*1e6 + $6
      if (key <= last || $5 >= $6 || seen[$5 " " $6]++) { print "row", NR; exit bad = 1 }
      last = key; mode[$8]++; grains[$7]++
      if ($2 - 0.2*$1 > 1e-9 || $2 - 0.2*$1 < -1e-9 || $3 < 0 || $3 > 60 || $4 < 0 || $4 > 60) exit bad = 1 }
    END { for (m in mode) printf "%s %d, ", m, mode[m]; print NR - 1, "of", lost
          exit bad || NR - 1 != lost || lost < 50 || !mode["pulled"] || !mode["yielded"] ||
              !mode["sheared"] || !grains[1] || !grains[2] }' whole/cracks.csv ||
    fail "the rows are not those of the links that broke"

# A checkpoint in the middle of the cracks, and one behind them; in place, and in another directory.
for every in 160 250; do
    expect_status 0 "$DM2_BIN/dm2-client" tear.dm2 -n 2 -q -o cut --overwrite --checkpoint-every $every
    expect_status 0 "$DM2_BIN/dm2-seq" tear.dm2 -q --restart cut/checkpoint.dm2 -o there --overwrite
    same_bytes whole/cracks.csv there/cracks.csv
    expect_status 0 "$DM2_BIN/dm2-client" tear.dm2 -n 3 -q --restart cut/checkpoint.dm2
    same_bytes whole/cracks.csv cut/cracks.csv
done

# A table that lacks rows is noticed before any file is touched.
rm cut/final.dm2
cp -R cut gone
rm gone/cracks.csv
cp -R cut short
sed 2d cut/cracks.csv >short/cracks.csv
for directory in gone short; do
    (cd $directory && cksum * 2>/dev/null) >before
    expect_status 3 "$DM2_BIN/dm2-seq" tear.dm2 -q -o $directory --restart auto
    expect_text err "$directory/cracks.csv: "
    expect_text err ' links broke after step 0 and before step 250, as history.csv and the state say'
    (cd $directory && cksum * 2>/dev/null) | cmp - before || fail "$directory was touched"
done
for links in 1e+300 -1 nan; do
    rm -rf short
    cp -R cut short
    awk -F, -v OFS=, -v n=$links 'NR == 1 { for (k = 1; k <= NF; k++) if ($k == "links") at = k }
        NR == 2 { $at = n } { print }' cut/history.csv >short/history.csv
    expect_status 3 "$DM2_BIN/dm2-seq" tear.dm2 -q -o short --restart auto
    expect_text err "short/history.csv: its first row has $links links"
done
expect_status 0 "$DM2_BIN/dm2-seq" tear.dm2 -D v=0 -D j=0 -q -o cut --overwrite
[ ! -e cut/cracks.csv ] || fail "a run without a crack has the table: $(cat cut/cracks.csv)"

# A local server is killed: the client goes back to a copy, and no row is doubled. The hashes of 3000 steps
# are more than a fifo holds, so that the run waits for its reader.
expect_status 0 "$DM2_BIN/dm2-seq" tear.dm2 -q -o far --steps 3000
mkfifo hashes
"$DM2_BIN/dm2-client" tear.dm2 -n 3 -o lost --steps 3000 --hash-every 1 --copy-every 25 \
    >hashes 2>err </dev/null &
client_pid=$!
exec 4<hashes
count=0
while [ $count -le 90 ] && IFS= read -r line <&4; do
    count=$((count + 1))
done
victim=$(ps -o pid= -o ppid= -A | awk -v p="$client_pid" '$2 == p { print $1; exit }')
[ -n "$victim" ] || fail "no local server is found"
kill -KILL "$victim"
cat <&4 >rest
exec 4<&-
wait $client_pid || fail "the client failed: $(cat err)"
expect_text err 'servers started anew'
same_bytes far/cracks.csv lost/cracks.csv
same_bytes far/final.dm2 lost/final.dm2
exit 0
