#!/bin/sh
# The figures of the paper that are curves (3, 4, 13 to 17), as SVG in docs/figures/, from the tables there:
#
#     scripts/figures.sh            draws
#     scripts/figures.sh measure    measures the tables of this cluster anew (minutes), then draws
#
# SIZES, RUNS and STEPS in the environment shorten the measuring. *-paper.svg are computed from the paper's constants,
# *-here.svg are measured on this machine, with the model dashed.
set -eu

bin=${DM2_BIN:-bin}
to=docs/figures
plot=$bin/dm2-plot
model=$bin/dm2-model
sizes=${SIZES:-1689,10000,50000,100000}
work=build/figures
mkdir -p "$to" "$work"

measure()
{
    "$model" calibrate --n "$sizes" --runs "${RUNS:-3}" --steps "${STEPS:-20}" -f "$to/calibration.csv" -o "$work/runs"
    "$model" netbench -n 2,4,8 --csv >"$work/netbench.csv"
    "$model" compare --calibration "$to/calibration.csv" --n "$sizes" --runs "${RUNS:-3}" --steps "${STEPS:-20}" \
        -o "$work/runs" --csv >"$work/compare.csv"
    mv "$work/netbench.csv" "$work/compare.csv" "$to"
    measure_search
}

# Fig. 4: the three ways to find neighbours. Lists alone compare all pairs, so small systems have to do.
measure_search()
{
    echo 'n,search,seconds' >"$work/search.csv"
    for search in lists cells cells+lists; do
        sed -e "s/^    delta_r = .*/&\n    search = $search/" input/timing.dm2 >"$work/$search.dm2"
        for n in 500 1000 2000 4000 8000; do
            "$bin/dm2-seq" "$work/$search.dm2" -D n=$n --steps 10 -q --overwrite -o "$work/search.run"
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

draw_here()
{
    pivot bytes servers 'seconds fit' <"$to/netbench.csv" >"$work/fig.csv"
    chart fig-03-here 'Fig. 3, measured here; the line fitted' bytes 'seconds per cycle' "$work/fig.csv" --x bytes --markers \
        --y seconds-2,seconds-4,seconds-8 --dashed fit-2,fit-4,fit-8
    pivot n search seconds <"$to/search.csv" >"$work/fig.csv"
    chart fig-04-here 'Fig. 4, measured here' elements 'seconds per step' "$work/fig.csv" --x n --markers \
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
    k=$(sed -n 's/^k,,\(.*\),s$/\1/p' "$to/calibration.csv")
    g=$(sed -n 's/^g,,\(.*\),byte$/\1/p' "$to/calibration.csv")
    m=$(awk -F , -v OFS= '$1 == "m" { printf "%s%s=%s", sep, $2, $3; sep = "," }' "$to/calibration.csv")
    b=$(awk -F , -v OFS= '$1 == "b" { printf "%s%s=%s", sep, $2, $3; sep = "," }' "$to/calibration.csv")
    l=$(sed -n 's/^L_x,,\(.*\),cm$/\1/p' "$to/calibration.csv")
    "$model" what-if --k "$k" --g "$g" --m "$m" --b "$b" --lx "$l" --ly "$l" \
        --n 1689,5000,10000,20000,50000,100000,150000,200000 --csv | pivot n case speedup >"$work/fig.csv"
    chart fig-17-here "Fig. 17, eight servers, this machine's constants" elements speedup "$work/fig.csv" --x n \
        --y "$(sed -n '1s/^n,//p' "$work/fig.csv")"
}

[ "${1:-}" != measure ] || measure
draw_paper
draw_here
