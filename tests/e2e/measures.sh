# Profiles, strain, fragments and damage have the same bytes from any number of servers; a deck that is torn
# apart has fragments; interrupted runs leave no half table.
# labels: e2e bits measures
. "$DM2_SRC/tests/lib.sh"
sed -e 's/^let steps = 400/let steps = 120/' -e '/^output {/d' "$DM2_SRC/tests/decks/good/scatter.dm2" \
    >deck.dm2
cat >>deck.dm2 <<'END'
profile across { axis = x; bins = 26 }
profile up { axis = y; bins = 9; range = 0.4 cm, 1.4 cm; every = 50 }
output { history_every = 20; snapshot_every = 60; format = vtp, xyz; strain = yes }
END
files='history.csv fragments.csv profile-across.csv profile-up.csv final.dm2 snapshots/state-000000060.vtp
snapshots/state-000000120.vtp snapshots/state-000000120.xyz'

expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 -q -o one
for n in 2 5; do
    expect_status 0 "$DM2_BIN/dm2-client" deck.dm2 -n $n -q -o many --overwrite
    for file in $files; do
        same_bytes one/"$file" many/"$file"
    done
done

# 26 bins at 0, 6, 12 ... 120; 9 bins at 0, 50, 100 and 120.
[ "$(wc -l <one/profile-across.csv)" -eq $((1 + 26 * 21)) ] ||
    fail "profile-across.csv has $(wc -l <one/profile-across.csv) lines"
[ "$(wc -l <one/profile-up.csv)" -eq $((1 + 9 * 4)) ] || fail \
    "profile-up.csv has $(wc -l <one/profile-up.csv) lines"
expect_text one/fragments.csv 'step,time [us],fragments,single,largest'
[ "$(wc -l <one/fragments.csv)" -eq 4 ] || fail "fragments.csv has no three rows: $(cat one/fragments.csv)"
first=$(sed -n 2p one/fragments.csv | cut -d, -f3-) last=$(sed -n 4p one/fragments.csv | cut -d, -f3-)
[ "$last" != "$first" ] || fail "nothing broke or joined: $(cat one/fragments.csv)"
ls many | grep part && fail "something half-written is left"

# Each array of a snapshot can be drawn.
for colour in temperature pressure damage fragment strain strain-xy grain material bonds; do
    expect_status 0 "$DM2_BIN/dm2-plot" snapshot one/snapshots/state-000000120.vtp --colour $colour -o \
        picture.svg
done
expect_status 0 "$DM2_BIN/dm2-plot" chart one/profile-across.csv --x x --y vx --by time -o chart.svg
exit 0
