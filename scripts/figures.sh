#!/bin/sh
# The figures of the paper's sections 6 and 7, as SVG in docs/figures/, and the tables of
# docs/timing-study.md, from the CSV files there:
#
#     scripts/figures.sh            draws
#     scripts/figures.sh measure    measures all CSV files of this machine anew (half an hour on two idle processors, most of
#                                   them the emulated cluster's, which takes root), then draws
#     scripts/figures.sh sweep      all of them but the emulated cluster's (four minutes), then draws
#     scripts/figures.sh accuracy   measures the model's error for two local servers alone (a minute), then draws
#
# SIZES, RUNS and STEPS in the environment shorten the measuring. *-paper.svg are computed from the paper's constants,
# *-here.svg are measured on this machine, with the model dashed, *-emulated.svg come from scripts/emulated-study.sh, and
# 9 to 12 are pictures of runs.
set -eu

bin=${DM2_BIN:-bin}
to=docs/figures
plot=$bin/dm2-plot
model=$bin/dm2-model
sizes=${SIZES:-1689,10000,50000,100000,200000}
runs=${RUNS:-5} steps=${STEPS:-100}
study=docs/timing-study.md
work=build/figures
mkdir -p "$to" "$work"

# What the machine had to do besides, when the measuring began.
note_conditions() # WHAT
{
    touch "$to/conditions.csv"
    { echo what,processors,load
      sed -e 1d -e "/^$1,/d" "$to/conditions.csv"
      echo "$1,$(getconf _NPROCESSORS_ONLN),$(uptime | sed -e 's/.*load average[s]*: *//' -e 's/[, ].*//')"
    } >"$work/conditions.csv"
    mv "$work/conditions.csv" "$to"
}

measure_accuracy()
{
    note_conditions accuracy
    "$model" calibrate --n "${SIZES:-1689,5000,10000,25000,50000,100000,200000}" --runs "$runs" --steps "$steps" \
        -f "$to/calibration.csv" -o "$work/runs"
    "$model" compare --calibration "$to/calibration.csv" --n "${SIZES:-10000,50000,200000}" -n 2 --runs "$runs" --steps "$steps" \
        -o "$work/runs" --csv >"$work/accuracy.csv"
    mv "$work/accuracy.csv" "$to"
}

# All that is measured here itself.
measure_sweep()
{
    measure_accuracy
    note_conditions sweep
    "$model" netbench -n 2,4,8 --csv >"$work/netbench.csv"
    "$model" compare --calibration "$to/calibration.csv" --n "$sizes" --runs "$runs" --steps "$steps" \
        -o "$work/runs" --csv >"$work/compare.csv"
    mv "$work/netbench.csv" "$work/compare.csv" "$to"
    measure_search
}

measure()
{
    measure_sweep
    note_conditions emulated
    status=0
    (unset STEPS; sh "${0%/*}/emulated-study.sh") || status=$?
    [ "$status" -eq 0 ] || [ "$status" -eq 77 ] || exit "$status" # 77: no rights; it has said why, and the old table stays
}

# Fig. 4: the three ways to find neighbours. Lists last for ten steps, as the paper's may; cells alone are searched in each.
measure_search()
{
    echo 'n,search,seconds' >"$work/search.csv"
    for search in lists cells cells+lists; do
        sed -e "s/^    delta_r = .*/&\n    search = $search\n    rebuild_every = 10/" input/timing.dm2 >"$work/$search.dm2"
        for n in 500 1000 2000 5000 10000 20000 50000; do
            "$bin/dm2-seq" "$work/$search.dm2" -D n=$n --steps 20 -q --overwrite -o "$work/search.run"
            awk -v search=$search '/^elements: / { n = $2 } /^time steps alone: / { t = $4 / $7 }
                END { print n "," search "," t }' "$work/search.run/run.log" >>"$work/search.csv"
        done
    done
    mv "$work/search.csv" "$to"
}

# pivot X KEY VALUE PREFIX: rows with the columns X, KEY, VALUE (numbers) become one row per X and a column per KEY.
pivot()
{
    awk -F , -v x="$1" -v key="$2" -v values="$3" '
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; n_values = split(values, value, " "); next }
        { if (!($at[x] in seen_x)) { seen_x[$at[x]] = 1; xs[++n_x] = $at[x] }
          if (!($at[key] in seen_k)) { seen_k[$at[key]] = 1; ks[++n_k] = $at[key] }
          for (v = 1; v <= n_values; v++) cell[$at[x], $at[key], v] = $at[value[v]] }
        END { line = x
              for (v = 1; v <= n_values; v++) for (k = 1; k <= n_k; k++) line = line "," value[v] "-" ks[k]
              print line
              for (i = 1; i <= n_x; i++) {
                  line = xs[i]
                  for (v = 1; v <= n_values; v++) for (k = 1; k <= n_k; k++)
                      line = line "," (((xs[i], ks[k], v) in cell) ? cell[xs[i], ks[k], v] : "nan")
                  print line } }'
}

chart() # OUT TITLE XLABEL YLABEL FILE OPTION...
{
    out=$to/$1.svg title=$2 xlabel=$3 ylabel=$4 file=$5
    shift 5
    "$plot" chart "$file" -o "$out" --title "$title" --xlabel "$xlabel" --ylabel "$ylabel" "$@"
}

draw_paper()
{
    { echo bytes,2-servers,4-servers,8-servers
      awk 'BEGIN { for (x = 0; x <= 50000; x += 5000) print x "," 3.6e-6*x + 3.3e-3 "," 7.3e-6*x + 4.1e-3 "," 14.6e-6*x + 25.8e-3 }'
    } >"$work/fig.csv"
    chart fig-03-paper 'Fig. 3, eqs. (2)-(4): Ultra-10, 10BaseT' 'bytes' 'seconds per cycle' "$work/fig.csv" --x bytes \
        --y 2-servers,4-servers,8-servers
    "$model" predict --preset paper --n 1689,5000,10000,20000,50000,100000,150000,200000 --servers 1,2,4,8 --csv |
        pivot n servers 't_dist speedup efficiency' >"$work/fig.csv"
    chart fig-13-paper "Fig. 13, the paper's model" elements 'seconds per step' "$work/fig.csv" --x n \
        --y t_dist-1,t_dist-2,t_dist-4,t_dist-8
    chart fig-14-paper "Fig. 14, the paper's model" elements speedup "$work/fig.csv" --x n --y speedup-2,speedup-4,speedup-8
    chart fig-15-paper "Fig. 15, the paper's model" elements efficiency "$work/fig.csv" --x n \
        --y efficiency-2,efficiency-4,efficiency-8
    "$model" predict --preset paper --n 10000,100000,200000 --servers 1,2,3,4,5,6,7,8 --csv |
        pivot servers n speedup | awk -F , -v OFS=, 'NR == 1 { print $0, "ideal"; next } { print $0, $1 }' >"$work/fig.csv"
    chart fig-16-paper "Fig. 16, the paper's model" servers speedup "$work/fig.csv" --x servers \
        --y speedup-10000,speedup-100000,speedup-200000 --dashed ideal
    "$model" what-if --preset paper --n 1689,5000,10000,20000,50000,100000,150000,200000 --csv |
        pivot n case speedup >"$work/fig.csv"
    chart fig-17-paper "Fig. 17, eight servers, the paper's constants" elements speedup "$work/fig.csv" --x n \
        --y "$(sed -n '1s/^n,//p' "$work/fig.csv")"
}

# here COMMAND...: of dm2-model, with this machine's constants, wherever the figures are drawn.
here()
{
    constant() { sed -n "s/^$1,,\([^,]*\),.*/\1/p" "$to/calibration.csv"; }
    rows() { awk -F , -v of="$1" '$1 == of { printf "%s%s=%s", sep, $2, $3; sep = "," }' "$to/calibration.csv"; }
    "$model" "$@" --k "$(constant k)" --g "$(constant g)" --lx "$(constant L_x)" --ly "$(constant L_y)" --m "$(rows m)" \
        --b "$(rows b)"
}

draw_here()
{
    pivot bytes servers 'seconds fit' <"$to/netbench.csv" >"$work/fig.csv"
    chart fig-03-here 'Fig. 3, measured here; the line fitted' bytes 'seconds per cycle' "$work/fig.csv" --x bytes --markers \
        --y seconds-2,seconds-4,seconds-8 --dashed fit-2,fit-4,fit-8
    pivot n search seconds <"$to/search.csv" >"$work/fig.csv"
    chart fig-04-here 'Fig. 4, measured here' elements 'seconds per step' "$work/fig.csv" --x n --markers --log-x --log-y \
        --y "$(sed -n '1s/^n,//p' "$work/fig.csv")"
    awk -F , -v OFS=, 'NR > 1 && $1 == "dm2-seq" { $3 = "seq" } { print }' "$to/compare.csv" |
        pivot n servers 'measured predicted speedup speedup_predicted efficiency efficiency_predicted speedup_critical' \
            >"$work/fig.csv"
    chart fig-13-here 'Fig. 13, measured here; model dashed' elements 'seconds per step' "$work/fig.csv" --x n --markers \
        --y measured-seq,measured-2,measured-4,measured-8 --dashed predicted-seq,predicted-2,predicted-4,predicted-8
    chart fig-14-here 'Fig. 14, measured here; model dashed' elements speedup "$work/fig.csv" --x n --markers \
        --y speedup-2,speedup-4,speedup-8 --dashed speedup_predicted-2,speedup_predicted-4,speedup_predicted-8
    chart fig-14-critical 'Fig. 14, computed: a processor for each server' elements speedup "$work/fig.csv" --x n --markers \
        --y speedup_critical-2,speedup_critical-4,speedup_critical-8
    chart fig-15-here 'Fig. 15, measured here; model dashed' elements efficiency "$work/fig.csv" --x n --markers \
        --y efficiency-2,efficiency-4,efficiency-8 \
        --dashed efficiency_predicted-2,efficiency_predicted-4,efficiency_predicted-8
    sed -e '/^dm2-seq/d' "$to/compare.csv" | pivot servers n 'speedup speedup_critical' |
        awk -F , -v OFS=, 'NR == 1 { print $0, "ideal"; next } { print $0, $1 }' >"$work/fig.csv"
    chart fig-16-here 'Fig. 16, measured here; computed dashed' servers speedup "$work/fig.csv" --x servers --markers \
        --y "$(sed -n 1p "$work/fig.csv" | tr , '\n' | grep '^speedup-' | paste -s -d , -)" \
        --dashed "$(sed -n 1p "$work/fig.csv" | tr , '\n' | grep '^speedup_critical-' | paste -s -d , -),ideal"
    here what-if --n 1689,5000,10000,20000,50000,100000,150000,200000 --csv | pivot n case speedup >"$work/fig.csv"
    chart fig-17-here "Fig. 17, eight servers, this machine's constants" elements speedup "$work/fig.csv" --x n \
        --y "$(sed -n '1s/^n,//p' "$work/fig.csv")"
}

# Figs. 9 to 12: decompositions and the plate impact, from runs.
picture() # NUMBER STEP COLOUR TITLE
{
    "$bin/dm2-plot" snapshot "$work/impact/snapshots/state-000000$2.vtp" --colour "$3" --width 700 --title "Fig. $1: $4" \
        -o "$to/fig-$1.svg"
}

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
draw_pictures()
{
    "$bin/dm2-seq" input/plate-impact.dm2 -q -o "$work/impact" --overwrite
    picture 10 000 body 'the problem: a flyer at 400 m/s below a target at rest'
    picture 11 000 material 'initial geometry, 1689 elements'
    picture 12 200 material 'geometry after 200 steps, 5 µs'
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
    } >"$work/fig-09.svg"
    mv "$work/fig-09.svg" "$to"
}

draw_emulated()
{
    paper() { awk -F , -v network="$1" -v processor="$2" 'NR == 1 || ($1 == network && $2 == processor)' "$to/emulated.csv"; }
    paper 10baset paper | pivot n servers 'speedup efficiency speedup_predicted' >"$work/fig.csv"
    chart fig-14-emulated 'Fig. 14, emulated: Ultra-10 speed, 10BaseT; eqs. (18)-(20) dashed' elements speedup "$work/fig.csv" --x n \
        --markers --y speedup-2,speedup-4,speedup-8 --dashed speedup_predicted-2,speedup_predicted-4,speedup_predicted-8
    chart fig-15-emulated 'Fig. 15, emulated: Ultra-10 speed, 10BaseT' elements efficiency "$work/fig.csv" --x n --markers \
        --y efficiency-2,efficiency-4,efficiency-8
    awk -F , -v OFS=, '{ $1 = NR == 1 ? "case" : $1 "-" $2; if (NR == 1 || $5 == 8) print }' "$to/emulated.csv" |
        pivot n case speedup >"$work/fig.csv"
    chart fig-17-emulated 'Fig. 17, emulated: eight servers' elements speedup "$work/fig.csv" --x n --markers \
        --y "$(sed -n '1s/^n,//p' "$work/fig.csv")"
}

# --- the tables of the study ------------------------------------------------------------------------------------

# markdown: CSV becomes a table for Markdown.
markdown()
{
    awk -F , '{ line = "|"; rule = "|"; for (i = 1; i <= NF; i++) { line = line " " $i " |"; rule = rule "---|" } print line }
        NR == 1 { print rule }'
}

# insert NAME: standard input replaces what stands in the study between the comments <!-- NAME --> and <!-- end NAME -->.
insert()
{
    cat >"$work/table"
    awk -v name="$1" -v table="$work/table" '
        $0 == "<!-- end " name " -->" { inside = 0 }
        !inside { print }
        $0 == "<!-- " name " -->" { inside = found = 1; while ((getline line <table) > 0) print line }
        END { if (!found || inside) exit 1 }' "$study" >"$work/study.md" ||
        { echo "figures.sh: $study has no place for the table $1" >&2; exit 1; }
    cmp -s "$work/study.md" "$study" || cp "$work/study.md" "$study"
}

tables()
{
    markdown <"$to/conditions.csv" | insert conditions
    awk -F , -v OFS=, 'BEGIN { print "servers", "m here [s/byte]", "b here [ms]", "m 10BaseT emulated", "m Fast Ethernet emulated", "m paper", "b paper [ms]"
            m[2] = "3.6e-06"; m[4] = "7.3e-06"; m[8] = "1.46e-05"; b[2] = 3.3; b[4] = 4.1; b[8] = 25.8 }
        FNR == 1 { file++ }
        ($1 == "m" || $1 == "b") && $2 in m { value[file, $1, $2] = $3 }
        END { for (n = 2; n <= 8; n *= 2)
                  print n, sprintf("%.2e", value[1, "m", n]), sprintf("%.3f", 1e3 * value[1, "b", n]), sprintf("%.2e", value[2, "m", n]),
                      sprintf("%.2e", value[3, "m", n]), m[n], b[n] }' \
        "$to/calibration.csv" "$to/link-10baset.csv" "$to/link-fast.csv" | markdown | insert network
    awk -F , -v OFS=, 'BEGIN { print "elements", "k alone [s]", "k of a server (one on each processor) [s]" } $1 == "size" { n = $3 }
        $1 == "k_alone" { alone = $3 } $1 == "k_shared" { print n, sprintf("%.3e", alone), sprintf("%.3e", $3) }' \
        "$to/calibration.csv" | markdown | insert k
    awk -F , -v OFS=, 'BEGIN { print "program", "elements", "servers", "runs", "measured [ms]", "predicted [ms]", "error [%]" }
        NR > 1 { print $1, $2, $3, $4, sprintf("%.3f", 1e3 * $5), sprintf("%.3f", 1e3 * $6), sprintf("%+.1f", $7) }' \
        "$to/accuracy.csv" | markdown | insert accuracy
    awk -F , -v OFS=, 'BEGIN { print "elements", "servers", "measured [ms]", "predicted [ms]", "error [%]", "speedup", "efficiency", "speedup with a processor each (computed)" }
        NR > 1 { print $2, $1 == "dm2-seq" ? "dm2-seq" : $3, sprintf("%.3f", 1e3 * $5), sprintf("%.3f", 1e3 * $6), sprintf("%+.1f", $7),
                 sprintf("%.2f", $9), sprintf("%.2f", $11), sprintf("%.2f", $14) }' "$to/compare.csv" | markdown | insert sweep
    awk -F , -v OFS=, 'BEGIN { print "network", "processors", "elements", "speedup 2", "4", "8 servers", "efficiency 2", "4", "8 servers", "eqs. (18)-(20): 2", "4", "8 servers", "working ahead: 2", "4", "8 servers" }
        NR > 1 { key = $1 "," $2 "," $4; if (!(key in seen)) { seen[key] = 1; keys[++n] = key }
                 s[key] = s[key] sprintf(",%.2f", $12); e[key] = e[key] sprintf(",%.2f", $13); p[key] = p[key] sprintf(",%.2f", $14); a[key] = a[key] sprintf(",%.2f", $17) }
        END { for (i = 1; i <= n; i++) print keys[i] s[keys[i]] e[keys[i]] p[keys[i]] a[keys[i]] }' "$to/emulated.csv" | markdown | insert emulated
    awk -F , -v OFS=, 'BEGIN { print "network", "servers", "from elements", "to", "computing grows as n to the", "communication as n to the" }
        NR > 1 && $2 == "paper" { key = $1 "," $5; if (!(key in first)) { first[key] = $4; keys[++n] = key; c[key] = $9; m[key] = $7 - $9 + $15 }
            last[key] = $4; computing[key] = $9; messages[key] = $7 - $9 + $15 }
        function grows(from, to, key) { return sprintf("%.2f", log(to / from) / log(last[key] / first[key])) }
        END { for (i = 1; i <= n; i++) { k = keys[i]
                  print k, first[k], last[k], grows(c[k], computing[k], k), grows(m[k], messages[k], k) } }' "$to/emulated.csv" |
        markdown | insert exponent
    awk -F , -v OFS=, 'BEGIN { print "network", "elements", "servers", "measured [ms]", "predicted [ms]", "error [%]" }
        NR > 1 && $2 == "paper" { print $1, $4, $5, sprintf("%.2f", 1e3 * $7), sprintf("%.2f", 1e3 * $8), sprintf("%+.1f", 100 * ($8 - $7) / $7) }' \
        "$to/emulated.csv" | markdown | insert link
    here what-if --table break-even --csv | awk -F , -v OFS=, 'NR == 1 { print "case", "servers", "pay from elements" } NR > 1 { print $1, $3, $4 }' |
        markdown | insert break-even
}

mkdir -p "$work"
case ${1:-} in
'') ;;
measure) measure ;;
sweep) measure_sweep ;;
accuracy) measure_accuracy ;;
*) echo 'usage: scripts/figures.sh [measure | sweep | accuracy]' >&2; exit 2 ;;
esac
draw_pictures
draw_paper
draw_here
draw_emulated
tables
