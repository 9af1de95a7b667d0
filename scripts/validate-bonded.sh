#!/bin/sh
# Three decks of bonded elements against theory: the bent cantilever, the split disc, the cracked plate. Writes
# the third part of docs/validation.md to standard output; takes some minutes. Exit status 1 where a figure is out
# of its bounds.
#
#     make && sh scripts/validate-bonded.sh          whole decks, discs of both directions, five cracks
#     sh scripts/validate-bonded.sh small            smaller pieces, in some seconds: tests/e2e/bonded.sh
set -eu
bin=${DM2_BIN:-bin}
stop()
{
    echo "validate-bonded.sh: $*" >&2
    exit 1
}
[ -x "$bin/dm2-seq" ] || stop "no $bin/dm2-seq: run make first, in the source directory"
case ${1:-whole} in
whole) beams='80:8 80:4 48:8' discs='48:0 32:0 24:0 48:90' cracks='3 5 8 12 20' ;;
small) beams='24:4' discs='24:0 24:90' cracks='3 6' ;;
*) echo "validate-bonded.sh: '$1' is not 'small'" >&2; exit 2 ;;
esac
work=$(mktemp -d "${TMPDIR:-/tmp}/dm2-bonded.XXXXXX")
trap 'rm -rf "$work"' EXIT

# run DECK OPTION...: into $work/run.
run()
{
    deck=$1
    shift
    "$bin/dm2-seq" "${DM2_SRC:-.}/input/$deck.dm2" -q -o "$work/run" --overwrite "$@"
}

# measure TEXT OPTION...: awk on history.csv, with TEXT for its rows; at["foot_fy"] is the number of a column.
measure()
{
    text=$1
    shift
    awk -F, "$@" "NR == 1 { for (i = 1; i <= NF; i++) { sub(/ .*/, \"\", \$i); at[\$i] = i }; next } $text" \
        "$work/run/history.csv"
}

# In all decks E = 0.7 Mbar, d = 0.1 cm, depth 1 cm.
cat <<'END_OF_TEXT'
## Beams, discs, cracks of bonded elements

`input/cantilever.dm2`: sag of the end under the load P (the force on the clamp) over the theory's, P L^3/(3 E I) +
P L/((5/6) G H h) with E = 2 k/(sqrt(3) h), G = 3/8 E, I = h H^3/12 (1 - 1/rows^2), within 3 %; *solid* is the same with
I = h H^3/12.

| columns | rows | sag/L | of theory | of theory, solid |
|---|---|---|---|---|
END_OF_TEXT
for beam in $beams; do
    columns=${beam%:*} rows=${beam#*:}
    run cantilever -D "columns=$columns" -D "rows=$rows"
    measure 'NR == 2 { first = $at["end_y"] } { sag = first - $at["end_y"]; P = -$at["clamp_fy"] }
        function theory(I) { return P*L^3/(3*0.7*I) + P*L/(5/6*3/8*0.7*H) }
        END { L = 0.1*columns; H = 0.1*rows*sqrt(3)/2; I = H^3/12; share = sag/theory(I*(1 - 1/rows^2))
              printf "| %d | %d | %.5f | %.4f | %.4f |\n", columns, rows, sag/L, share, sag/theory(I)
              exit !(share > 0.97 && share < 1.03) }' -v "columns=$columns" -v "rows=$rows" ||
        stop "the cantilever is off by more than 3 %"
done

cat <<'END_OF_TEXT'

`input/brazilian.dm2`: 2 P/(pi D h) at the first broken bond, P the force on the foot, over E eps/(1 + 3 nu) = E eps/2,
half of the strength in direct tension along the rows; within 5 % where the rows lie across the load. *Place* is the
distance of this bond from the centre along the load, of D/2: with rows along the load the disc is crushed at the jaws
first.

| D/d | rows | of theory | place | broken bonds |
|---|---|---|---|---|
END_OF_TEXT
for disc in $discs; do
    D=${disc%:*} angle=${disc#*:}
    run brazilian -D "D=$D mm" -D "angle=$angle deg"
    [ -f "$work/run/cracks.csv" ] || stop "no bond of the disc breaks"
    broken=$(($(wc -l <"$work/run/cracks.csv") - 1))
    first=$(sed -n 2p "$work/run/cracks.csv" | cut -d, -f2,4)
    measure '$2 <= when { P = -$at["foot_fy"] }
        END { share = 2*P/(3.14159265*0.1*D)/(0.7*0.002/2)
              y = (y - 0.3)/(0.05*D) - 1; if (y < 0) y = -y
              printf "| %d | %s | %.3f | %.2f | %d |\n", D, angle ? "along" : "across", share, y, broken
              exit !(angle ? y > 0.8 : share > 0.95 && share < 1.05 && y < 0.6) }' \
        -v "D=$D" -v "angle=$angle" -v "when=${first%,*}" -v "y=${first#*,}" -v "broken=$broken" ||
        stop "the disc breaks elsewhere, or more than 5 % off"
done

cat <<'END_OF_TEXT'

`input/notched-plate.dm2`: stress sigma at the first broken bond (force on the foot over the width W = 8 a), corrected
for the width: s = sigma sqrt(sec(pi a/W)), which falls as (a + d)^-1/2. K/K0 is s sqrt(a + d) over its first value. The
slope of log s against log(a + d), by least squares, is -0.5 within 0.05.

| a/d | sigma/(E eps) | s/(E eps) | K/K0 |
|---|---|---|---|
END_OF_TEXT
for a in $cracks; do
    run notched-plate -D "a=$a"
    [ -f "$work/run/cracks.csv" ] || stop "no bond of the plate breaks"
    when=$(sed -n 2p "$work/run/cracks.csv" | cut -d, -f2)
    measure '$2 <= when { P = $at["foot_fy"] } END { print a, P/(0.1*8*a)/(0.7*0.005) }' \
        -v "a=$a" -v "when=$when" >>"$work/stresses"
done
awk '{ s = $2/sqrt(cos(3.14159265/8)); K = s*sqrt($1 + 1); if (NR == 1) K0 = K
       printf "| %d | %.4f | %.4f | %.3f |\n", $1, $2, s, K/K0
       x = log($1 + 1); y = log(s); sx += x; sy += y; sxx += x*x; sxy += x*y }
    END { slope = (NR*sxy - sx*sy)/(NR*sxx - sx*sx); printf "\nSlope: %.3f.\n", slope
          exit !(slope > -0.55 && slope < -0.45) }' "$work/stresses" ||
    stop "the slope of the cracked plate is not -0.5 within 0.05"
