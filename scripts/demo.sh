#!/bin/sh
# The plate impact of the paper (section 7.1) on 4 local servers, and its picture. `make demo` builds the programs
# first and calls this from the top of the source tree.
set -eu

bin=${DM2_BIN:-bin}
build=${DM2_BUILD:-build}
run=$build/demo.run
picture=$build/demo.svg

mkdir -p "$build"
"$bin/dm2-client" input/plate-impact.dm2 -n 4 -o "$run" --overwrite

last=
for snapshot in "$run"/snapshots/state-*.vtp; do
    last=$snapshot # their names sort by step
done
"$bin/dm2-plot" snapshot "$last" --links --title 'Plate impact, 5 us' -o "$picture"

printf '\n'
printf 'The plate impact ran on 4 servers.\n'
printf '  results   %s  (history.csv, final.dm2, snapshots/, timing.csv, run.log)\n' "$run"
printf '  picture   %s  (open it in a web browser)\n' "$picture"
