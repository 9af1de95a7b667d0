#!/bin/sh
# Draws the pictures of the plate impact that README and docs show, from a run of the deck as it is.
#
#     make && sh scripts/pictures.sh        writes docs/plate-impact*.svg
set -eu
bin=${DM2_BIN:-bin}
run=$(mktemp -d)
trap 'rm -rf "$run"' EXIT
"$bin/dm2-seq" input/plate-impact.dm2 -q -o "$run" --overwrite
"$bin/dm2-plot" snapshot "$run/snapshots/state-000000200.vtp" --links -o docs/plate-impact.svg \
    --title 'Plate impact: nickel onto nickel and aluminium at 400 m/s'
"$bin/dm2-plot" chart "$run/history.csv" --x time --y free_centre_vy,free_surface_vy \
    --title 'Velocity of the free surface, its middle and all of it' --ylabel 'velocity [cm/µs]' -o docs/plate-impact-velocity.svg
