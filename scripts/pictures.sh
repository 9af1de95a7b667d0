#!/bin/sh
# Draws the pictures of the plate impact that README and docs show, from a run of the deck as it is, and the decompositions of the
# paper's Fig. 9, from those that runs of the same plate would have.
#
#     make && sh scripts/pictures.sh        writes docs/plate-impact*.svg, docs/figures/fig-09.svg to fig-12.svg
set -eu
bin=${DM2_BIN:-bin}
run=$(mktemp -d)
trap 'rm -rf "$run"' EXIT
mkdir -p docs/figures
"$bin/dm2-seq" input/plate-impact.dm2 -q -o "$run" --overwrite
"$bin/dm2-plot" snapshot "$run/snapshots/state-000000200.vtp" --links -o docs/plate-impact.svg \
    --title 'Plate impact: nickel onto nickel and aluminium at 400 m/s'
"$bin/dm2-plot" chart "$run/history.csv" --x time --y free_centre_vy,free_surface_vy \
    --title 'Velocity of the free surface, its middle and all of it' --ylabel 'velocity [cm/µs]' -o docs/plate-impact-velocity.svg

picture() # NUMBER STEP COLOUR TITLE
{
    "$bin/dm2-plot" snapshot "$run/snapshots/state-000000$2.vtp" --colour "$3" --width 700 --title "Fig. $1: $4" \
        -o "docs/figures/fig-$1.svg"
}
picture 10 000 body 'the problem: a flyer at 400 m/s below a target at rest'
picture 11 000 material 'initial geometry, 1689 elements'
picture 12 200 material 'geometry after 200 steps, 5 µs'

# One decomposition as rectangles, at most 180 units wide and 100 high, from the lines that --check prints for its servers.
decomposition() # ASPECT SERVERS LEFT TOP
{
    "$bin/dm2-client" input/timing.dm2 -D n=20000 -D aspect="$1" -n "$2" --check |
        awk -v title="aspect $1, $2 servers" -v left="$3" -v top="$4" '
            /^cells / { columns = $4; rows = $6 }
            /^cell edges/ { x = $3; y = $5 }
            /^server / { sub(/.* cells [0-9]+ = /, ""); gsub(/[(),]/, " ")
                         n++; wide[n] = $1; high[n] = $3; from_x[n] = $5; from_y[n] = $6 }
            END { scale = 180 / (columns * x); if (scale * rows * y > 100) scale = 100 / (rows * y)
                  printf "<text x=\"%g\" y=\"%g\">%s</text>\n", left, top - 8, title
                  for (k = 1; k <= n; k++)
                      printf "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n", left + scale * x * from_x[k],
                          top + scale * y * (rows - from_y[k] - high[k]), scale * x * wide[k], scale * y * high[k] }'
}
{
    echo '<svg xmlns="http://www.w3.org/2000/svg" width="610" height="300" viewBox="0 0 610 300" font-family="sans-serif" font-size="13">'
    echo '<title>Fig. 9: decomposition for 2, 4 and 8 servers at three aspect ratios</title>'
    echo '<rect width="610" height="300" fill="white"/>'
    for row in 1.3571:30 3:160 6:250; do
        left=10
        for servers in 2 4 8; do
            decomposition "${row%:*}" "$servers" "$left" "${row#*:}" |
                sed -e 's/^<text /&fill="black" /' -e 's/^<rect /&fill="#dbe9f6" stroke="#08519c" /'
            left=$((left + 200))
        done
    done
    echo '</svg>'
} >"$run/fig-09.svg"
mv "$run/fig-09.svg" docs/figures/fig-09.svg
