# make figures: every figure of the timing study is drawn from its table.
. "$DM2_SRC/tests/lib.sh"
mkdir -p docs input
cp -R "$DM2_SRC/docs/figures" docs/figures
rm -f docs/figures/*.svg
expect_status 0 env DM2_BIN="$DM2_BIN" sh "$DM2_SRC/scripts/figures.sh"
for figure in 03-paper 13-paper 14-paper 15-paper 16-paper 17-paper 03-here 04-here 13-here 14-here 14-critical 15-here 16-here \
    17-here; do
    [ -s "docs/figures/fig-$figure.svg" ] || fail "figure $figure is missing"
done
expect_text docs/figures/fig-13-here.svg 'stroke-dasharray'
expect_text docs/figures/fig-14-paper.svg '>speedup-8<'
expect_text docs/figures/fig-17-paper.svg '>speedup-processors-x10<'
