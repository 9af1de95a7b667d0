#!/bin/sh
# Shock speeds of nickel, aluminium and copper against the LASL fits: runs 24 small impacts with dm2-seq and writes
# the table of docs/validation.md to standard output.
#
#     sh scripts/validate-shock.sh >docs/validation.md
#
# A block hits an equal one at rest at v = 2 up, along the rows of the lattice (x) or normal to them (y), periodic
# across. Us is the distance of two rows of the target over the time between the shock's arrivals there: when the mean
# velocity of a row passes up/2. Exit status 1 where a speed is off by more than 6 %.
set -eu
bin=${DM2_BIN:-bin}
[ -x "$bin/dm2-seq" ] || { echo "validate-shock.sh: no $bin/dm2-seq: run make first, in the source directory" >&2; exit 1; }
work=$(mktemp -d "${TMPDIR:-/tmp}/dm2-validate.XXXXXX")
trap 'rm -rf "$work"' EXIT

# deck AXIS STEP ACROSS BOUNDARY METAL VELOCITY: places along AXIS are in units of STEP, the distance of its rows.
deck()
{
    place() { # FROM TO: a box from one row to another
        if [ "$1" = x ]; then echo "$2*a 0 $3*a across"; else echo "0 $2*a across $3*a"; fi
    }
    if [ "$1" = x ]; then size='90*a across' along="$6 0"; else size='across 90*a' along="0 $6"; fi
    cat <<END
let d = 0.04
let a = $2
let across = $3
domain { size = $size; boundary = $4; r_c = 1.1*d; delta_r = 0.1*d }
time { dt = 0.01; steps = 520 }
material Ni { rho0 = 8.874; c0 = 0.4602; s = 1.437 }
material Al { rho0 = 2.703; c0 = 0.5350; s = 1.340 }
material Cu { rho0 = 8.930; c0 = 0.3940; s = 1.489 }
interaction { potential = morse; zeta = 0.1; ct_ratio = 0.02; link_break = 1.09 }
body flyer { shape = rectangle $(place "$1" 0 30); spacing = d; origin = d/8 sqrt(3)/4*d; material = $5; velocity = $along }
body target { shape = rectangle $(place "$1" 30 90); spacing = d; origin = d/8 sqrt(3)/4*d; material = $5 }
probe near { region = $(place "$1" 50 51) }
probe far { region = $(place "$1" 80 81) }
output { history_every = 1 }
END
}

# speed AXIS STEP UP: Us from the history in $work/run.
speed()
{
    awk -F, -v axis="$1" -v step="$2" -v up="$3" '
        NR == 1 {
            for (k = 1; k <= NF; k++) {
                if (index($k, "time ") == 1) t = k
                if (index($k, "near_v" axis " ") == 1) probe[1] = k
                if (index($k, "far_v" axis " ") == 1) probe[2] = k
            }
            next
        }
        {
            for (p = 1; p <= 2; p++) {
                if (!(p in at) && $probe[p] >= up/2)
                    at[p] = before + ($t - before) * (up/2 - old[p]) / ($probe[p] - old[p])
                old[p] = $probe[p]
            }
            before = $t
        }
        END { if (!(2 in at)) exit 1; printf "%.4f", 30 * step / (at[2] - at[1]) }' "$work/run/history.csv"
}

cat <<END
# Validation: shock speeds

Written by \`scripts/validate-shock.sh\`. Us of plane shocks in the lattice (\`uniaxial\` calibration, Morse potential, no shear
stiffness, zeta = 0.1), against the fits Us = c0 + S up of the LASL Shock Hugoniot Data (Marsh, 1980), in cm/us. The shocks
run along the close-packed rows of the lattice and normal to them.

| metal | up | LASL | along the rows | off by | normal to the rows | off by |
|---|---|---|---|---|---|---|
END
worst=0
for metal in 'Ni 0.4602 1.437' 'Al 0.5350 1.340' 'Cu 0.3940 1.489'; do
    set -- $metal
    name=$1 c0=$2 s=$3
    for up in 0.02 0.04 0.07 0.10; do
        fit=$(awk "BEGIN { printf \"%.4f\", $c0 + $s * $up }")
        row="| $name | $up | $fit |"
        for axis in x y; do
            if [ $axis = x ]; then
                step=0.04
                deck x d '3*sqrt(3)*d' 'free periodic' "$name" "2*$up" >"$work/deck.dm2"
            else
                step=0.034641016151377546
                deck y 'sqrt(3)/2*d' '6*d' 'periodic free' "$name" "2*$up" >"$work/deck.dm2"
            fi
            "$bin/dm2-seq" "$work/deck.dm2" -q -o "$work/run" --overwrite
            us=$(speed $axis $step $up)
            off=$(awk "BEGIN { printf \"%+.1f\", 100 * ($us / $fit - 1) }")
            worst=$(awk "BEGIN { w = $off < 0 ? -($off) : $off; print (w > $worst ? w : $worst) }")
            row="$row $us | $off % |"
        done
        echo "$row"
    done
done
printf '\nThe largest difference is %s %%. Normal to the rows the lattice is the softer, the stronger the shock; along them the\n' "$worst"
printf 'stiffer: the two directions enclose the fit.\n'
awk "BEGIN { exit !($worst <= 6) }" || { echo "validate-shock.sh: off by more than 6 %" >&2; exit 1; }
