# docs/study.md: its commands run, in their order; the lid has the asked stress at rest and, on average, while
# it shears; the loop leaves the same bytes after a signal.
# labels: e2e physics bits
# timeout: 120
. "$DM2_SRC/tests/lib.sh"
page=$DM2_SRC/docs/study.md
ln -s "$DM2_BIN" bin
ln -s "$DM2_SRC/input" input

awk '/^```sh$/ { inside = 1; next } /^```/ { inside = 0 } inside' "$page" >commands
[ "$(grep -c dm2- commands)" -ge 6 ] || fail 'docs/study.md has lost its commands'
expect_status 0 sh -ex commands
for picture in force.svg pressed.svg; do
    [ -s $picture ] || fail "the page's commands left no $picture"
done
cat friction.txt next.txt >printed
cmp printed - <<'TEXT' || { cat printed; fail 'docs/study.md prints other stresses or frictions'; }
stress 0.000998 Mbar, friction 0.211
stress 0.001999 Mbar, friction 0.353
TEXT

# --- the stress of the lid, over the asked one ---
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { split($i, heading, " "); at[heading[1]] = i }; next }
    { f = $at["lid_fy"] / (0.001 * 0.48); off = f < 1 ? 1 - f : f - 1 }
    $at["time"] < 60 && f > most { most = f }
    $at["time"] > 50 && $at["time"] < 60 { rest++; if (off > worst) worst = off }
    $at["lid_x"] > 0.235 + 0.02*0.24 && $at["lid_vx"] > 0 { n++; sum += f }
    END { printf "peak %.4f, at rest off by %.4f, mean in shear %.4f (%d rows)\n", most, worst, sum/n, n
          mean = sum/n
          exit !(rest > 20 && most <= 1.05 && worst <= 0.005 && n > 100 && mean > 0.995 && mean < 1.005) }' \
    shear.run/history.csv || fail 'the lid has not the asked stress'

# --- the loop, whose first program TERM ends ---
mkdir ended
cat >ended/dm2-seq <<'TEXT'
#!/bin/sh
"$DM2_BIN/dm2-seq" "$@" &
pid=$!
if [ ! -f ended/once ]; then
    : >ended/once
    while kill -0 $pid && [ ! -s cut.run/history.csv.part ]; do sleep 0.05; done
    sleep 0.2
    kill -TERM $pid
fi
wait $pid
TEXT
chmod +x ended/dm2-seq
awk '/^until dm2-seq/,/^done/' "$page" | sed 's/shear\.run/cut.run/' >loop
expect_status 0 env PATH="$PWD/ended:$PATH" sh loop
[ -f ended/once ] || fail 'the loop did not run the program of this test'
for file in final.dm2 history.csv; do
    same_bytes shear.run/$file cut.run/$file
done
