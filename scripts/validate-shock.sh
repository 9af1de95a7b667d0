#!/bin/sh
# Shocks and spall of nickel, aluminium and copper with the whole physics of input/materials, against what is known of
# them: runs 39 small impacts with dm2-seq and writes the first part of docs/validation.md to standard output.
#
#     (sh scripts/validate-shock.sh && sh scripts/validate-decks.sh) >docs/validation.md
#
# A block hits another at rest, along the rows of the lattice (x) or normal to them (y), periodic across. Us is the
# distance of two rows of the target over the time between the shock's arrivals there: when the mean velocity of a row
# passes up/2. Exit status 1 where a speed is off by more than 6 %, a velocity behind a shock by more than 5 %, or a
# spall strength normal to the rows by more than 10 %.
set -eu
bin=${DM2_BIN:-bin}
[ -x "$bin/dm2-seq" ] || { echo "validate-shock.sh: no $bin/dm2-seq: run make first, in the source directory" >&2; exit 1; }
work=$(mktemp -d "${TMPDIR:-/tmp}/dm2-validate.XXXXXX")
trap 'rm -rf "$work"' EXIT
cp -r "${DM2_SRC:-.}/input/materials" "$work"
row=0.034641016151377546

# deck AXIS FLYER TARGET VELOCITY ROWS ROWS STEPS TENSILE: flyer and target have so many rows along AXIS.
deck()
{
    place() { # FROM TO: a box from one row to another
        if [ "$axis" = x ]; then echo "$1*a 0 $2*a across"; else echo "0 $1*a across $2*a"; fi
    }
    axis=$1 flyer=$2 target=$3 end=$(($5 + $6)) near=$(($5 + 20))
    case $axis in
    x) across="3*sqrt(3)*d" a=d size="$end*a across" along="$4 0" boundary='free periodic' step=0.04 ;;
    y) across="6*d" a="sqrt(3)/2*d" size="across $end*a" along="0 $4" boundary='periodic free' step=$row ;;
    esac
    cat >"$work/deck.dm2" <<END
let d = 0.04
let a = $a
let across = $across
domain { size = $size; boundary = $boundary; r_c = 1.1*d; delta_r = 0.1*d }
time { dt = 0.01; steps = $7 }
include "materials/ni.dm2"
include "materials/al.dm2"
include "materials/cu.dm2"
interaction { zeta = ${zeta:-0.1}; ct_ratio = 0.02; link_break = ${link_break:-1.05}$8 }
body flyer { shape = rectangle $(place 0 "$5"); spacing = d; origin = d/8 sqrt(3)/4*d; material = $flyer; velocity = $along }
body target { shape = rectangle $(place "$5" $end); spacing = d; origin = d/8 sqrt(3)/4*d; material = $target }
probe near { region = $(place $near $((near + 1))) }
probe far { region = $(place $((near + 30)) $((near + 31))) }
probe middle { region = $(place $(($5 + 25)) $(($5 + 35))) }
probe surface { region = $(place $((end - 1)) $end) }
output { history_every = 1 }
END
    "$bin/dm2-seq" "$work/deck.dm2" -q -o "$work/run" --overwrite
}

# column NAME: the values of a probe's velocity along the axis, with the time before them.
column()
{
    awk -F, -v name="$1_v$axis " 'NR == 1 { for (k = 1; k <= NF; k++) if (index($k, name) == 1) at = k; next }
        { print $2, $at }' "$work/run/history.csv"
}

# arrival PROBE HALF: when it passes that velocity.
arrival()
{
    column "$1" | awk -v half="$2" '$2 >= half { printf "%.9f", before + ($1 - before) * (half - old) / ($2 - old); exit }
        { before = $1; old = $2 }'
}

# calc EXPRESSION FORMAT; percent VALUE REFERENCE: the difference.
calc() { awk "BEGIN { printf \"$2\", $1 }"; }
percent() { calc "100 * ($1 / $2 - 1)" %+.1f; }

# limit PERCENT MOST WHAT: keeps the largest difference in $worst; ends the script where it is beyond.
limit()
{
    worst=$(awk "BEGIN { w = $1 < 0 ? -($1) : $1; print (w > $worst ? w : $worst) }")
    awk "BEGIN { exit !($worst <= $2) }" || { echo "validate-shock.sh: $3 is off by $1 %" >&2; exit 1; }
}

constants() # METAL: rho0 c0 s of LASL, as the library has them, in g/cm3, cm/us
{
    file=$work/materials/$(echo "$1" | tr '[:upper:]' '[:lower:]').dm2
    rho0=$(sed -n 's/^ *rho0 = \([0-9.]*\) g.*/\1/p' "$file")
    c0=$(calc "$(sed -n 's/^ *c0 = \([0-9.]*\) km.*/\1/p' "$file") / 10" %.6g)
    s=$(sed -n 's/^.*; *s = \([0-9.]*\).*/\1/p' "$file")
}

# pull_back AXIS TENSILE FLYER TARGET STEPS: the spall strength of nickel, from the fall of the free surface's velocity.
pull_back()
{
    deck "$1" Ni Ni 0.04 "$3" "$4" "$5" "; tensile = $2"
    constants Ni
    column surface | awk -v impedance="$(calc "$rho0 * $c0" %.9g)" '$2 > peak { peak = $2; least = peak }
        $2 < least { least = $2 } END { printf "%.5f", 0.5 * impedance * (peak - least) }'
}

cat <<END
# Validation

Written by \`scripts/validate-shock.sh\` (shocks and spall) and \`scripts/validate-decks.sh\` (energy books). The metals
are the files of \`input/materials/\` with all their properties: shear stiffness, yield, tensile strength, softening,
heat conduction. The results of the unit tests are in [physics.md](physics.md).

## Shock speeds

Us of plane shocks in the lattice (\`uniaxial\` calibration, Morse potential, zeta = 0.1), against the fits Us = c0 + S
up of the LASL Shock Hugoniot Data (Marsh, 1980), in cm/us. The shocks run along the close-packed rows of the lattice
and normal to them. Shear stiffness and yield act in the lattice: a stiffness without yield would add kt to C11; the
yield stresses bound this addition.

| metal | up | LASL | along the rows | off by | normal to the rows | off by |
|---|---|---|---|---|---|---|
END
worst=0
for metal in Ni Al Cu; do
    constants $metal
    for up in 0.02 0.04 0.07 0.10; do
        half=$(calc "$up / 2" %g)
        fit=$(calc "$c0 + $s * $up" %.4f)
        line="| $metal | $up | $fit |"
        for direction in x y; do
            deck $direction $metal $metal "2*$up" 30 60 520 ''
            us=$(calc "30 * $step / ($(arrival far "$half") - $(arrival near "$half"))" %.4f)
            off=$(percent "$us" "$fit")
            limit "$off" 6 "Us of $metal"
            line="$line $us | $off % |"
        done
        echo "$line"
    done
done
cat <<END

The largest difference is $worst %. The stronger the shock, the softer is the lattice normal to the rows, and the stiffer
along the rows: the two directions enclose the fit, except for weak shocks, where yield adds most.

## Impedance matching

Nickel hits aluminium. Behind the shock the target has the velocity at which both Hugoniots have the same pressure.

| speed | matched | along the rows | off by | normal to the rows | off by |
|---|---|---|---|---|---|
END
worst=0
constants Ni
flyer_p="$rho0 * ($c0 + $s * w) * w"
constants Al
target_p="$rho0 * ($c0 + $s * u) * u"
for v in 0.04 0.10; do
    want=$(awk "BEGIN { low = 0; high = $v
        for (n = 0; n < 60; n++) {
            u = (low + high) / 2; w = $v - u
            if ($target_p < $flyer_p) low = u; else high = u
        }
        printf \"%.5f\", u }")
    line="| $v | $want |"
    for direction in x y; do
        deck $direction Ni Al $v 60 80 380 ''
        got=$(column middle | awk '{ v = $2 } END { printf "%.5f", v }')
        off=$(percent "$got" "$want")
        limit "$off" 5 "the velocity of aluminium"
        line="$line $got | $off % |"
    done
    echo "$line"
done
cat <<END

## Spall strength

Nickel hits nickel at 400 m/s; the spall strength is 1/2 rho0 c0 times the fall of the free surface's velocity from
its peak, in Mbar. \`tensile\` of \`input/materials/ni.dm2\` is 0.020.

| tensile Yt | normal to the rows | of Yt | along the rows | of Yt |
|---|---|---|---|---|
END
worst=0
for yt in 0.010 0.015 0.020 0.030; do
    line="| $yt |"
    for direction in y x; do
        got=$(pull_back $direction $yt 30 70 1350)
        [ $direction = x ] || limit "$(percent "$got" "$yt")" 10 'the spall strength of nickel'
        line="$line $got | $(calc "$got / $yt" %.3f) |"
    done
    echo "$line"
done
above() { percent "$1" "$2" | tr -d +; }
small=$(above "$(pull_back y 0.006 30 70 1350)" 0.006)
large=$(above "$(pull_back y 0.006 60 140 2700)" 0.006)
damped=$(above "$(zeta=0.2 pull_back y 0.010 30 70 1350)" 0.010)
longer=$(above "$(link_break=1.09 pull_back y 0.010 30 70 1350)" 0.010)
rings=$(above "$(zeta=0.05 pull_back y 0.010 30 70 1350)" 0.010)
cat <<END

Normal to the rows the strength is within 10 % of Yt from 0.010 Mbar on. The excess over Yt is the damping of the rows
that are torn apart: a stress of c_n times their speed, whatever Yt is. So the share of the excess grows as Yt falls
(at 0.006 Mbar the strength is $small % above Yt), with zeta (0.2 instead of 0.1: $damped % at 0.010 Mbar) and with
\`link_break\` (1.09 instead of 1.05: $longer % at 0.010 Mbar); with twice the rows in flyer and target the excess is
$large % at 0.006 Mbar. With little damping (zeta = 0.05) the lattice rings, and the ringing counts as pull-back ($rings %
at 0.010 Mbar). Along the rows the links of a row, 2/3 of the strength, flow first; the part that the links at 60
degrees add until a crack opens depends on Yt. A deck that is to show a given spall strength has its impact normal to
the rows, as in \`plate-impact.dm2\` and \`spall.dm2\`.

END
