# The plate impact does what the paper shows: the grid of its Fig. 6, the free surface's velocity, the spall
# of Fig. 12; momentum and energy are kept.
# labels: e2e physics
. "$DM2_SRC/tests/lib.sh"
deck=$DM2_SRC/input/plate-impact.dm2

expect_status 0 "$DM2_BIN/dm2-seq" --check "$deck"
expect_text out 'particles 1689'
expect_text out 'cells 171 = 19 x 9'
expect_text out 'steps 200 of 0.025 us'
expect_status 0 "$DM2_BIN/dm2-seq" "$deck" -q -o run
"$DM2_BUILD/tools/check_impact" run || fail "this is not the plate impact"
