# The study on the emulated cluster, at its smallest: every case is there, and the computed columns follow
# from the others.
# labels: e2e model
# timeout: 180
. "$DM2_SRC/tests/lib.sh"
cp -R "$DM2_SRC/input" input
status=0
SIZES=400 RUNS=2 STEPS=4 TURNS=4 DM2_BIN=$DM2_BIN sh "$DM2_SRC/scripts/emulated-study.sh" >out 2>err ||
    status=$?
[ "$status" -ne 77 ] || skip "$(sed -n -e 's/^skipped: //p' out)"
[ "$status" -eq 0 ] || { cat out err; fail "exit status $status"; }

table=docs/figures/emulated.csv
[ "$(sed -e 1d "$table" | cut -d , -f 1,2,5 | tr '\n' ' ')" = \
    '10baset,paper,2 10baset,paper,4 10baset,paper,8 '\
'10baset,paper-x10,2 10baset,paper-x10,4 10baset,paper-x10,8 fast,paper,2 fast,paper,4 fast,paper,8 ' ] ||
    { cat "$table"; fail "these are not the cases"; }
awk -F , '
    function near(a, b) { return a - b < 1e-4 * b && b - a < 1e-4 * b }
    NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    { factor = $at["factor"]; n = $at["n"]; computing = $at["computing"]; step = $at["link_step"]
      if (!(computing > 0 && step > computing && $at["link_predicted"] > 0 &&
          $at["speedup_predicted"] > 0)) exit 1
      if (!near($at["t_seq"],
          n * 0.3316e-3 * ($2 == "paper" ? 1 : 0.1))) exit 2 # eq. (13), at the only size there is
      ahead = $at["ahead"]; messages = step - computing + ahead
      if (!(ahead > 0 && ahead <= computing)) exit 6
      if (!near($at["t_dist"], factor * computing + messages)) exit 3
      more = messages > factor * ahead ? messages : factor * ahead
      if (!near($at["t_ahead"], factor * (computing - ahead) + more)) exit 7
      if (!near($at["speedup_ahead"], $at["t_seq"] / $at["t_ahead"])) exit 8
      if (!near($at["speedup"], $at["t_seq"] / $at["t_dist"]) || !near($at["efficiency"],
          $at["speedup"] / $5)) exit 4
      if ($2 == "paper") slow[$1] = factor
      if ($2 == "paper-x10" && !near(factor * 10,
          slow[$1])) exit 5 }' "$table" || { cat "$table"; fail "a column is wrong: $?"; }
for network in 10baset fast; do
    expect_text "docs/figures/link-$network.csv" 'networks,,3,'
done

# Ten times the rate, at most half of the time for a byte.
m() { sed -n 's/^m,8,\([^,]*\),.*/\1/p' "docs/figures/link-$1.csv"; }
awk -v slow="$(m 10baset)" -v fast="$(m fast)" 'BEGIN { exit !(slow > 6e-6 && slow > 2 * fast) }' ||
    fail "8 servers: $(m 10baset) s per byte by 10BaseT, $(m fast) by Fast Ethernet"
