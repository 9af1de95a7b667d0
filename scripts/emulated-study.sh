#!/bin/sh
# The paper's timing study on an emulated cluster: real runs through a link of 10 and of 100 Mbit/s (scripts/emulated-cluster),
# and what their steps would take on slower processors, as docs/figures/emulated.csv:
#
#     sh scripts/emulated-study.sh          some twenty-five minutes, most of them the link's; as root
#
# SIZES (1689,10000,50000,100000,200000), RUNS (5), STEPS (100 below 20,000 elements, 30 below 80,000, else 12) and TURNS of messages
# (6) in the environment change the sweep. Sizes and numbers of servers take turns, and all of them have had one before the next run
# of each: what the machine does besides meets all alike.
#
# Measured through the link: link_step, the time of a step, and the processor seconds in which the busiest server computes
# (forces, integration, rebuilds; not what its messages cost the system). Processors here are so much faster than an Ultra-10
# that a step through 10BaseT consists of communication. The time on a cluster of processors `factor` times slower is
# computed, along the critical path, the busiest server's:
#
#     messages = link_step - (computing - ahead)           ahead: the part of computing done while messages are on the way
#     t_dist   = factor computing + messages               t_seq = factor (computing of dm2-seq)
#     t_ahead  = factor (computing - ahead) + the larger of messages and factor ahead
#
# t_dist is the paper's flow, in which a server first computes and then exchanges; t_ahead is what dm2 does.
# `paper` is the factor with which dm2-seq takes the paper's 0.3316 ms per element and step (eq. 13) at 50,000 elements,
# `paper-x10` a tenth of it. speedup_predicted is eqs. (18)-(20) with that processor and the m_N and b_N of the link.
# The client stays as fast as it is here.
set -eu

bin=${DM2_BIN:-bin}
to=docs/figures
work=$PWD/build/figures/emulated
sizes=${SIZES:-1689,10000,50000,100000,200000}
runs=${RUNS:-5} steps=${STEPS:-}
counts=2,4,8
model=$bin/dm2-model
mkdir -p "$to" "$work"

# through NETWORK: the link's constants and the runs, below $work/NETWORK.
through()
{
    network=$1
    rm -rf "$work/$network"
    mkdir -p "$work/$network"
    status=0
    sh "${0%/*}/emulated-cluster" "$network" 8 sh -e -c '
        model=$1 to=$2 counts=$3 sizes=$4 runs=$5 steps=$6
        "$model" calibrate --hosts "$HOSTS" --key "$KEY" -n "$counts" --n 10000 --runs 1 --turns "$7" \
            -f "$to/link.csv" -o "$to/calibrate"
        run=0
        while [ "$((run += 1))" -le "$runs" ]; do
            for n in $(echo "$sizes" | tr , " "); do
                enough=100
                [ "$n" -lt 20000 ] || enough=30
                [ "$n" -lt 80000 ] || enough=12
                "$model" compare --calibration "$to/link.csv" --hosts "$HOSTS" --key "$KEY" -n "$counts" --n "$n" --runs 1 \
                    --steps "${steps:-$enough}" -o "$to/runs/$run" --csv >>"$to/sizes.csv"
            done
        done' study \
        "$model" "$work/$network" "$counts" "$sizes" "$runs" "$steps" "${TURNS:-6}" >"$work/$network/said" || status=$?
    [ "$status" -eq 0 ] || { cat "$work/$network/said"; exit "$status"; }
}

# computing DIRECTORY: seconds per step of the busiest server of a run, and of these the seconds ahead (read off a clock: where
# another program was let in between, they can seem to be more than all).
computing()
{
    awk -F , 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { w = $at["forces [s]"] + $at["integrate [s]"] + $at["rebuild [s]"]
          part = $at["cpu [s]"] / (w + $at["pack [s]"] + $at["unpack [s]"]) / $at["steps"]
          if (w * part > most) { most = w * part; ahead = ($at["ahead [s]"] < w ? $at["ahead [s]"] : w) * part } }
        END { printf "%.17g,%.17g\n", most, ahead }' "$1/timing.csv"
}

# cases NETWORK: n,servers,runs,link_step,link_predicted,computing,ahead; servers 0 is dm2-seq. Means over the runs, but of the computing
# the least: what other programs do to caches only ever adds.
cases()
{
    awk -F , -v OFS=, '/^program/ { next }
        { case_of = $2 OFS ($1 == "dm2-seq" ? 0 : $3)
          if (!(case_of in times)) order[++cases] = case_of
          times[case_of]++; step[case_of] += $5; said[case_of] = $6 }
        END { for (i = 1; i <= cases; i++) print order[i], times[order[i]], step[order[i]] / times[order[i]], said[order[i]] }' \
        "$work/$1/sizes.csv" |
        while IFS=, read -r n count times step predicted; do
            kind=servers$count
            [ "$count" -ne 0 ] || kind=seq
            for run in "$work/$1"/runs/*/n*-"$kind"-*; do
                ! grep -q "^elements: $n\$" "$run/run.log" || computing "$run"
            done | sort -g | sed -n "1s/^/$n,$count,$times,$step,$predicted,/p"
        done
}

# predicted NETWORK FACTOR_OF_PAPER: n,servers,speedup by eqs. (18)-(20).
predicted()
{
    file=$work/$1/link.csv
    value() { sed -n "s/^$1,,\([^,]*\),.*/\1/p" "$file"; }
    rows() { awk -F , -v of="$1" '$1 == of { printf "%s%s=%s", sep, $2, $3; sep = "," }' "$file"; }
    k=$(awk -v l="$(value L_x)" -v part="$2" 'BEGIN { printf "%.17g", 0.3316e-3 * part * 0.04 * 0.03464 / (l * l) }')
    "$model" predict --preset paper --k "$k" --lx "$(value L_x)" --ly "$(value L_y)" --g "$(value g)" --m "$(rows m)" \
        --b "$(rows b)" --servers "$counts" --n "$(cut -d , -f 1 "$work/$1/cases.csv" | uniq | paste -s -d , -)" --csv |
        awk -F , -v OFS=, 'NR > 1 { print $1, $3, $9 }'
}

table() # NETWORK NAME PART: a part of the table, with processors that take PART of the paper's time
{
    predicted "$1" "$3" >"$work/predicted.csv"
    awk -F , -v OFS=, -v network="$1" -v name="$2" -v part="$3" '
        FILENAME ~ /predicted.csv$/ { speedup[$1, $2] = $3; next }
        $2 == 0 { seq[$1] = $6; from = $1 < 50000 ? 50000 - $1 : $1 - 50000
                  if (!(nearest > 0) || from < least) { least = from; nearest = $6 / $1 }; next }
        { n[++rows] = $1; servers[rows] = $2; runs[rows] = $3; step[rows] = $4; said[rows] = $5; most[rows] = $6; ahead[rows] = $7 }
        END { factor = part * 0.3316e-3 / nearest
              for (i = 1; i <= rows; i++) {
                  t_seq = factor * seq[n[i]]
                  messages = step[i] - (most[i] - ahead[i])
                  t_dist = factor * most[i] + messages
                  t_ahead = factor * (most[i] - ahead[i]) + (messages > factor * ahead[i] ? messages : factor * ahead[i])
                  print network, name, factor, n[i], servers[i], runs[i], step[i], said[i], most[i], t_seq, t_dist, t_seq / t_dist,
                      t_seq / t_dist / servers[i], speedup[n[i], servers[i]], ahead[i], t_ahead, t_seq / t_ahead } }' "$work/predicted.csv" "$work/$1/cases.csv"
}

for network in 10baset fast; do
    through "$network"
    cases "$network" >"$work/$network/cases.csv"
done
{
    echo network,processor,factor,n,servers,runs,link_step,link_predicted,computing,t_seq,t_dist,speedup,efficiency,speedup_predicted,ahead,t_ahead,speedup_ahead
    table 10baset paper 1
    table 10baset paper-x10 0.1
    table fast paper 1
} >"$work/emulated.csv"
mv "$work/emulated.csv" "$to/emulated.csv"
for network in 10baset fast; do
    mv "$work/$network/link.csv" "$to/link-$network.csv"
done
