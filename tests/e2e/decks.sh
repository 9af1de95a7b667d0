# The decks of the applications: the energy book of the whole run closes within 1 % of the energy put in, and
# the run shows what the deck's comment promises. Then the same decks, smaller by one `let` but with all of
# their steps: 1, 2, 4 and 7 servers leave the same bytes as one process. (scripts/validate-decks.sh does that
# at full size.)
# labels: e2e physics bits
# timeout: 300
. "$DM2_SRC/tests/lib.sh"

# last COLUMN, largest COLUMN, late COLUMN (the mean over the last quarter of the rows): of history.csv of the
# run, by the start of the column's name.
last()
{
    awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, name) == 1) at = i }
        { value = $at } END { print value }' run/history.csv
}
largest()
{
    awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, name) == 1) at = i }
        NR == 2 || (NR > 2 && $at + 0 > value + 0) { value = $at } END { print value }' run/history.csv
}

late()
{
    awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, name) == 1) at = i }
        NR > 1 { value[NR] = $at } END { for (i = NR - int(NR/4); i <= NR; i++) { sum += value[i]; n++ };
            print sum/n }' run/history.csv
}

# within VALUE LOW HIGH WHAT
within()
{
    awk -v v="$1" -v low="$2" -v high="$3" 'BEGIN { exit !(v + 0 >= low && v + 0 <= high) }' ||
        fail "$4 is $1, expected $2 to $3"
}

# reaches COLUMN VALUE: time of the first row where the column is above the value, us.
reaches()
{
    awk -F, -v name="$1" -v value="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i,
        name " ") == 1) at = i; if (!at) exit; next }
        $at + 0 > value + 0 { print $2; exit }' run/history.csv
}

# book DECK [SHARE]: in at least 100 rows the total stays within this share of the largest kinetic energy or
# work (1 %).
book()
{
    awk -F, -v share="${2:-0.01}" 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/ .*/, "", $i); at[$i] = i };
        next }
        NR == 2 { first = $at["total"] }
        { d = $at["total"] - first; if (d < 0) d = -d; if (d > off) off = d
          if ($at["kinetic"] > most) most = $at["kinetic"]; if ($at["work"] > most) most = $at["work"] }
        END { printf "%d rows, off by %.2g of %.3g\n", NR - 1, off, most
              exit !(NR > 100 && most > 0 && off <= share * most) }' run/history.csv ||
        fail "$1: the energy book does not close, or has fewer than 100 rows"
}

case $FLAVOUR in
release) counts='1 2 4 7' ;;
*) counts='4' ;; # slower by far
esac

# check DECK SMALLER: the whole run in one process takes less than a minute, and its book closes; then the
# smaller piece with servers.
check()
{
    deck=$DM2_SRC/input/$1.dm2
    echo "$1 $2"
    begin=$(date +%s)
    expect_status 0 "$DM2_BIN/dm2-seq" "$deck" -q -o run --overwrite
    took=$(($(date +%s) - begin))
    [ "$FLAVOUR" != release ] || [ $took -lt 60 ] || fail "$1 took $took s"
    book "$1"
    expect_status 0 "$DM2_BIN/dm2-seq" "$deck" -D "$2" -q -o one --overwrite
    for n in $counts; do
        expect_status 0 "$DM2_BIN/dm2-client" "$deck" -D "$2" -n $n -q -o several --overwrite
        same_bytes one/final.dm2 several/final.dm2
        same_bytes one/history.csv several/history.csv
    done
}

check sliding-block columns=12
within "$(last block_vx)" -3e-5 3e-5 "the block's velocity at the end"
within "$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, "block_x ") == 1) at = i }
    NR == 2 { first = $at } { now = $at } END { print now - first }' run/history.csv)" \
    0.02475 0.02525 "the way it slid"

# Pull-back: half of rho0 c0 times the fall of the free surface's velocity is the tensile strength, 0.012
# Mbar.
check spall scale=0.5
within "$(largest surface_vy)" 0.0395 0.0405 "the free surface's velocity"
within "$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if (index($i, "surface_vy") == 1) at = i; next }
    $at > high { high = $at; low = $at } $at < low && !turned { low = $at } $at > low + 0.005 {
        turned = high > 0.03 }
    END { print 0.5 * 2.703 * 0.535 * (high - low) }' run/history.csv)" 0.0108 0.0132 "the spall strength"
[ "$(last links)" -lt "$(largest links)" ] || fail "nothing spalled"

check cu-polycrystal scale=0.5
within "$(largest middle_vy)" 0.029 0.033 "the velocity behind the shock"
within "$(reaches surface_vy 0.015)" 1.7 1.9 "the time when the shock is at the free surface"
within "$(largest temperature_max)" 650 850 "the hottest element"

check hmx-powder scale=0.5
within "$(last first_vy)" 0.02 0.04 "the velocity of the first layer"
# From 0.4 to 0.6 of the height, 0.1 cm ahead of the piston on average. The last layer, 0.18 cm ahead, has a
# third of the piston's speed at most: the wave needs 2.1 us at 0.086 cm/us.
within "$(reaches second_vy 0.015)" 1.25 1.5 "the time when the wave is in the middle of the powder"
within "$(largest third_vy)" 0 0.012 "the velocity of the last layer"
within "$(largest temperature_max)" 500 700 "the hottest spot"

check granular-shear scale=0.3
# About 0.03, 0.06, 0.17, 0.34 and 0.74 of the wall's 0.01 cm/us. The paths of grains are chaotic, so that the
# last bit of a law is another packing: over four seeds and two time steps the means of the last quarter were
# 0.14 to 0.54, 0.34 to 1.30, 1.56 to 2.28, 3.17 to 4.27, 7.04 to 7.71 in 0.001 cm/us.
within "$(late layer1_vx)" 0.0001 0.0008 "the velocity of the lowest layer"
within "$(late layer2_vx)" 0.0002 0.0018 "the velocity of the second layer"
within "$(late layer3_vx)" 0.0013 0.0030 "the velocity of the third layer"
within "$(late layer4_vx)" 0.0028 0.0050 "the velocity of the fourth layer"
within "$(late layer5_vx)" 0.0065 0.0085 "the velocity of the uppermost layer"

# Melting first, then the reaction, which frees two fifths of the elements' chemical energy.
check shear-band scale=0.5
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/ .*/, "", $i); at[$i] = i }; next }
    NR == 2 { whole = $at["chemical"] }
    $at["phase"] > 1e-5 && !melts { melts = $at["time"] }
    $at["chemical"] < 0.99 * whole && !reacts { reacts = $at["time"] }
    END { printf "melts from %g us, reacts from %g us, %.2f of it\n", melts, reacts,
        1 - $at["chemical"] / whole
          exit !(melts > 3 && melts < 5 && reacts > 8 && reacts < 12 &&
              $at["chemical"] < 0.7 * whole) }' run/history.csv ||
    fail "the shear band does not melt and react as its comment says"

check plate-impact scale=0.5
[ "$(last links)" -lt "$(largest links)" ] || fail "the plate impact tore nothing"

check phase-front rows=8
book phase-front 0.003
within "$(largest temperature_max)" 310 600 "the hottest element"

# The same run with its states as text: the dense phase grows behind the shock, and in the end much of it is
# alpha again.
cp -R "$DM2_SRC/input/materials" . || fail "no materials"
sed 's/^    snapshot_every = 100/&; format = xyz/' "$DM2_SRC/input/phase-front.dm2" >front.dm2
expect_status 0 "$DM2_BIN/dm2-seq" front.dm2 -q -o run --overwrite
dense()
{
    grep -c '^Fe/epsilon ' "run/snapshots/state-000000$1.xyz"
}
within "$(dense 200)" 280 340 "how many elements are dense at 1 us"
within "$(dense 500)" 640 740 "how many elements are dense at 2.5 us"
within "$(dense 700)" 300 390 "how many elements are dense at 3.5 us"

# Nothing moves: the heat stays, and the ends have the temperatures of the series.
echo heat-rod
expect_status 0 "$DM2_BIN/dm2-seq" "$DM2_SRC/input/heat-rod.dm2" -q -o run --overwrite
within "$(last temperature_max)" 508 512 "the temperature of the left end"
within "$(awk -F, 'NR > 1 && $2 == 0.025 { right = $11 } END { print right }' run/profile-rod.csv)" 388 392 \
    "the temperature of the right end"
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/ .*/, "", $i); at[$i] = i }; next }
    NR == 2 { first = $at["thermal"] }
    { d = ($at["thermal"] - first) / first; if (d < 0) d = -d; if (d > off) off = d }
    END { printf "heat off by %.2g\n", off; exit !(first > 0 && off <= 1e-12) }' run/history.csv ||
    fail "the rod's heat does not stay"
