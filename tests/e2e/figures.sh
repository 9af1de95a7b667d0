# make figures: every figure of the timing study is drawn from its table.
. "$DM2_SRC/tests/lib.sh"
mkdir -p docs
cp -R "$DM2_SRC/docs/figures" docs/figures
cp -R "$DM2_SRC/input" input
cp "$DM2_SRC/docs/timing-study.md" docs/timing-study.md
rm -f docs/figures/*.svg
expect_status 0 env DM2_BIN="$DM2_BIN" sh "$DM2_SRC/scripts/figures.sh"
for figure in 09 10 11 12 14-emulated 15-emulated 17-emulated 03-paper 13-paper 14-paper 15-paper 16-paper \
    17-paper 03-here 04-here 13-here 14-here 14-critical 15-here 16-here \
    17-here; do
    [ -s "docs/figures/fig-$figure.svg" ] || fail "figure $figure is missing"
done
expect_text docs/figures/fig-13-here.svg 'stroke-dasharray'
expect_text docs/figures/fig-14-paper.svg '>speedup-8<'
expect_text docs/figures/fig-17-paper.svg '>speedup-processors-x10<'
[ "$(grep -c '<rect fill=' docs/figures/fig-09.svg)" -eq 42 ] ||
    fail "Fig. 9 does not have three rows of 2, 4 and 8 servers"
expect_text docs/figures/fig-12.svg '1689 elements'

# The tables of the study are the tables that its CSV files give.
cmp docs/timing-study.md "$DM2_SRC/docs/timing-study.md" || {
    diff docs/timing-study.md "$DM2_SRC/docs/timing-study.md"
    fail "docs/timing-study.md does not have the tables of docs/figures: make figures"
}
for table in conditions network k accuracy sweep emulated exponent link break-even; do
    [ "$(sed -n "/^<!-- $table -->\$/,/^<!-- end $table -->\$/p" docs/timing-study.md | grep -c '^| [^ ]')" \
        -ge 2 ] ||
        fail "the table $table is empty"
done
grep -v '<!-- end k -->' docs/timing-study.md >cut
mv cut docs/timing-study.md
expect_status 1 env DM2_BIN="$DM2_BIN" sh "$DM2_SRC/scripts/figures.sh"
expect_text err 'has no place for the table'
expect_status 2 env DM2_BIN="$DM2_BIN" sh "$DM2_SRC/scripts/figures.sh" measured
