# The biaxial test in two stages, of 130 grains and faster than the decks say: pressed to the same stress on
# all sides, then sheared; the angle of friction and the dilation. Stage two gives the same bytes on three
# servers. (docs/gallery.md has the figures of the whole decks.)
# labels: e2e physics bits
# timeout: 180
. "$DM2_SRC/tests/lib.sh"
shear=$DM2_SRC/input/stages/biaxial-shear.dm2

expect_status 0 "$DM2_BIN/dm2-seq" "$DM2_SRC/input/biaxial.dm2" -D columns=12 -q -o pressed
expect_text pressed/run.log 'stop: unbalanced below 0.001 with lid_fy above'
expect_status 0 "$DM2_BIN/dm2-seq" "$shear" -D columns=12 -D inertial=5e-4 --start pressed/final.dm2 -q -o run
expect_status 0 "$DM2_BIN/dm2-seq" "$shear" -D columns=12 --start pressed/final.dm2 --steps 200 -q -o one
expect_status 0 "$DM2_BIN/dm2-client" "$shear" -D columns=12 --start pressed/final.dm2 --steps 200 -q -n 3 \
    -o three
same_bytes one/final.dm2 three/final.dm2
same_bytes one/history.csv three/history.csv

# measure DIR: per row the height, the width, the stress across and the lateral one.
measure()
{
    awk -F, -v f="$(awk 'BEGIN { print 0.02 / 4.07 }')" '
        NR == 1 { for (i = 1; i <= NF; i++) { split($i, heading, " "); at[heading[1]] = i }; next }
        { high = $at["lid_y"] - $at["floor_y"] - f; wide = $at["right_x"] - $at["left_x"] - f
          print high, wide, ($at["lid_fy"] - $at["floor_fy"]) / 2 / wide,
              ($at["right_fx"] - $at["left_fx"]) / 2 / high }' "$1/history.csv"
}

# Lid and sides have the asked stress at rest.
awk -F, -v f="$(awk 'BEGIN { print 0.02 / 4.07 }')" '
    NR == 1 { for (i = 1; i <= NF; i++) { split($i, heading, " "); at[heading[1]] = i }; next }
    { high = $at["lid_y"] - $at["floor_y"] - f; wide = $at["right_x"] - $at["left_x"] - f
      lid = $at["lid_fy"] / wide / 0.001; left = -$at["left_fx"] / high / 0.001
      right = $at["right_fx"] / high / 0.001 }
    function near(x) { return x > 0.995 && x < 1.005 }
    END { printf "pressed: lid %.4f, sides %.4f and %.4f of the asked stress\n", lid, left, right
          exit !(near(lid) && near(left) && near(right)) }' pressed/history.csv ||
    fail 'the grains are not pressed to the asked stress'

# Means over strain from 0.01 on, as those of a held stress are.
measure run | awk 'NR == 1 { h = $1; w = $2 }
    { strain = log(h / $1); volume = log($1 / h * $2 / w) }
    volume < least { least = volume }
    strain > 0.01 { n++; across += $3; lateral += $4; last = volume }
    END { s = (across - lateral) / (across + lateral); angle = atan2(s, sqrt(1 - s * s)) * 45 / atan2(1, 1)
          lateral = lateral / n
          printf "%d rows to a strain of %.3f: friction angle %.1f, ", n, strain, angle
          printf "lateral stress %.5f, volume %.4f then %.4f\n", lateral, least, last
          exit !(strain > 0.05 && angle > 14 && angle < 25 && lateral > 0.0009 && lateral < 0.0011 &&
              least < 0 && last > least + 0.005) }' ||
    fail 'the sheared grains have another friction or volume'
