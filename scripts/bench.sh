#!/bin/sh
# Speed per core, as ratios in one run on one machine: dm2-seq and, where it is installed, LAMMPS on the same work, in
# turn, several times. Prints medians with their spread, writes build/bench/bench.csv and a chart of the medians per work.
#   scripts/bench.sh [REPEATS] [WORK...]      WORK: lj, full, two-lj, two-full (two processes against one); default all
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
bin=${DM2_BIN:-$here/bin}
out=${DM2_BENCH_DIR:-$here/build/bench}
repeats=${1:-5}
[ $# -gt 0 ] && shift
work=${*:-lj full two-lj two-full}
mkdir -p "$out"
csv=$out/bench.csv
echo 'work,elements,program,repeat,element-steps/s' >"$csv"
lmp=$(command -v lmp || true)
mpirun=$(command -v mpirun || true)
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
[ -n "$lmp" ] || echo "LAMMPS (lmp) is not installed: dm2 alone is measured (Debian's package is 'lammps')"

dm2_rate() # PROGRAM AND OPTIONS
{
    "$@" -q --overwrite -o "$out/run" >/dev/null
    awk '/element-steps\/s/ { for (i = 1; i <= NF; i++) if ($i == "element-steps/s") printf "%.0f\n", $(i - 1) }' "$out/run/run.log"
}

lammps_rate() # INPUT NX NY STEPS OPTIONS
{
    input=$1 nx=$2 ny=$3 steps=$4
    shift 4
    (cd "$out" && $launch "$lmp" "$@" -in "$here/scripts/peers/$input" -var nx "$nx" -var ny "$ny" -var steps "$steps" -log none </dev/null) |
        awk '/^Loop time/ { printf "%.0f\n", $(NF - 1) * $(NF - 4) / $4 }'
}

launch= # what starts LAMMPS
note() # WORK ELEMENTS PROGRAM REPEAT RATE
{
    echo "$1,$2,$3,$4,$5" >>"$csv"
}

# The sizes of the comparison: unit cells for LAMMPS, elements for the lattice, scale for the plate impact, steps.
sizes='38 22 1700 1.003 2000
100 58 11600 2.6 400
250 145 73000 6.5 60
500 290 290000 13 20'

each_size() # WORK
{
    echo "$sizes" | while read -r nx ny n scale steps; do
        k=1
        while [ "$k" -le "$repeats" ]; do
            if [ "$1" = lj ]; then
                [ -z "$lmp" ] || note lj "$n" lammps "$k" "$(lammps_rate lammps-lj.in "$nx" "$ny" "$steps")"
                [ -z "$lmp" ] || note lj "$n" lammps-opt "$k" "$(lammps_rate lammps-lj.in "$nx" "$ny" "$steps" -sf opt)"
                note lj "$n" dm2 "$k" "$(dm2_rate "$bin/dm2-seq" "$here/input/lj-lattice.dm2" -D n="$n" --steps "$steps")"
            else
                [ -z "$lmp" ] || note full "$n" lammps "$k" "$(lammps_rate lammps-full.in "$nx" "$ny" "$steps")"
                note full "$n" dm2 "$k" \
                    "$(dm2_rate "$bin/dm2-seq" "$here/input/plate-impact.dm2" -D scale="$scale" -D every=100 --steps "$steps")"
            fi
            k=$((k + 1))
        done
    done
}

# One process against two, on the same deck, in turn; LAMMPS with one and with two MPI ranks.
two() # WORK
{
    echo "$sizes" | while read -r nx ny n scale steps; do
        steps=$((steps + steps / 2))
        case $1 in
        two-lj) deck=lj-lattice size="n=$n" input=lammps-lj.in ;;
        *) deck=plate-impact size="scale=$scale" input=lammps-full.in ;;
        esac
        k=1
        while [ "$k" -le "$repeats" ]; do
            for program in "dm2-seq" "dm2-client -n 2"; do
                # shellcheck disable=SC2086
                note "$1" "$n" "$program" "$k" \
                    "$(dm2_rate $bin/$program "$here/input/$deck.dm2" -D "$size" $(every "$deck") --steps "$steps")"
            done
            if [ -n "$lmp" ] && [ -n "$mpirun" ]; then
                note "$1" "$n" lammps "$k" "$(lammps_rate "$input" "$nx" "$ny" "$steps")"
                launch="$mpirun -np 2"
                note "$1" "$n" lammps-2 "$k" "$(lammps_rate "$input" "$nx" "$ny" "$steps")"
                launch=
            fi
            k=$((k + 1))
        done
    done
}

# The plate impact has a row of its history at every step, unless asked not to.
every() # DECK
{
    [ "$1" = lj-lattice ] || echo "-D every=100"
}

for w in $work; do
    case $w in
    lj | full) each_size "$w" ;;
    two-lj | two-full) two "$w" ;;
    *) echo "bench: '$w' is not a work: lj, full, two-lj or two-full is expected" >&2; exit 2 ;;
    esac
done

# Medians with spread, and each program's ratio to the first of its size.
sort -t, -k1,1 -k2,2n -k3,3 -k5,5n "$csv" | awk -F, -v out="$out" '
    $1 == "work" { next }
    { key = $1 "," $2 "," $3; if (key != last) { order[++m] = key; last = key } value[key, ++count[key]] = $5 }
    END {
        printf "%-9s %9s  %-16s %12s  %-25s %s\n", "work", "elements", "program", "median M/s", "least - most", "dm2, or two, times faster"
        for (i = 1; i <= m; i++) {
            key = order[i]; n = count[key]; split(key, f, ",")
            median[key] = n % 2 ? value[key, (n + 1) / 2] : 0.5 * (value[key, n / 2] + value[key, n / 2 + 1])
        }
        for (i = 1; i <= m; i++) {
            key = order[i]; n = count[key]; split(key, f, ",")
            own = f[1] "," f[2] ",dm2"
            if (f[1] ~ /^two/) own = f[1] "," f[2] (f[3] ~ /^lammps/ ? ",lammps-2" : ",dm2-client -n 2")
            printf "%-9s %9d  %-16s %12.3f  %-25s %s\n", f[1], f[2], f[3], 1e-6 * median[key],
                sprintf("%.3f - %.3f", 1e-6 * value[key, 1], 1e-6 * value[key, n]),
                key == own ? "" : sprintf("%.2f", median[own] / median[key])
            if (!(f[1] SUBSEP f[3] in seen)) { seen[f[1], f[3]] = 1; columns[f[1]] = columns[f[1]] "," f[3] }
            if (!(f[1] SUBSEP f[2] in row)) rows[f[1]] = rows[f[1]] " " f[2]
            row[f[1], f[2]] = row[f[1], f[2]] sprintf(",%.6g", median[key])
        }
        for (w in columns) { # a table per work: a row per size, a column per program
            print "elements" columns[w] >(out "/" w ".csv")
            n = split(rows[w], size, " ")
            for (i = 1; i <= n; i++)
                print size[i] row[w, size[i]] >(out "/" w ".csv")
        }
    }'
for w in $work; do
    "$bin/dm2-plot" chart "$out/$w.csv" --x elements --y "$(sed -n '1s/^elements,//p' "$out/$w.csv")" --log-x --markers \
        -t "$w: element-steps per second, medians" -o "$out/$w.svg"
done
echo "every run: $csv"
