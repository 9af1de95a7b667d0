#!/bin/sh
# Draws the pictures that README and docs show, each from a run of its deck as it is.
#
#     make && sh scripts/pictures.sh            writes docs/plate-impact*.svg and docs/gallery/*.svg
#     sh scripts/pictures.sh -o DIR [DECK...]   writes the pictures of these decks below DIR
#
# tests/e2e/pictures.sh draws them anew and compares the bytes.
set -eu
bin=${DM2_BIN:-bin}
to=docs
while getopts o: option; do
    case $option in
    o) to=$OPTARG ;;
    *) sed -n '4,5s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
    esac
done
shift $((OPTIND - 1))
all='plate-impact cu-polycrystal hmx-powder shear-band granular-shear spall phase-front sliding-block heat-rod
    shear-box cantilever brazilian notched-plate biaxial drum'
runs=$(mktemp -d)
trap 'rm -rf "$runs"' EXIT
mkdir -p "$to/gallery"

# snapshot PICTURE STEP OPTION...; chart PICTURE TABLE OPTION...: of the run of $deck
snapshot()
{
    picture=$1 step=$2
    shift 2
    "$bin/dm2-plot" snapshot "$runs/$deck/snapshots/state-$(printf %09d "$step").vtp" -o "$to/$picture.svg" "$@"
}
chart()
{
    picture=$1 table=$2
    shift 2
    "$bin/dm2-plot" chart "$runs/$deck/$table.csv" -o "$to/$picture.svg" "$@"
}

draw()
{
    case $deck in
    plate-impact)
        snapshot plate-impact 200 --links --title 'Plate impact: nickel onto nickel and aluminium at 400 m/s'
        chart plate-impact-velocity history --x time --y free_centre_vy,free_surface_vy \
            --title 'Velocity of the free surface, its middle and all of it' --ylabel 'velocity [cm/µs]'
        snapshot gallery/plate-impact 200 -c links
        ;;
    cu-polycrystal)
        snapshot gallery/cu-polycrystal-grains 0 -c grain
        snapshot gallery/cu-polycrystal 120 -c pressure
        chart gallery/cu-polycrystal-profile profile-shock --x y --y stress_yy --by time
        ;;
    hmx-powder)
        snapshot gallery/hmx-powder 1800 -c temperature
        snapshot gallery/hmx-powder-damage 1800 -c damage
        ;;
    shear-band)
        snapshot gallery/shear-band 3500 -c temperature
        snapshot gallery/shear-band-phase 2000 -c phase
        snapshot gallery/shear-band-composition 3500 -c composition
        chart gallery/shear-band-energy history --x time --y thermal,phase,chemical,work
        ;;
    granular-shear)
        snapshot gallery/granular-shear 20000 -c vx
        chart gallery/granular-shear-profile profile-flow --x y --y vx --by time
        ;;
    spall)
        snapshot gallery/spall 250 -c vy
        chart gallery/spall-surface history --x time --y surface_vy
        ;;
    phase-front)
        snapshot gallery/phase-front 200 -c phase
        chart gallery/phase-front-profile profile-bar --x x --y stress_xx --by time
        ;;
    sliding-block) chart gallery/sliding-block history --x time --y block_vx ;;
    cantilever) snapshot gallery/cantilever 36023 -c stress-xx ;;
    brazilian)
        snapshot gallery/brazilian 8160 -c stress-xx --range -0.002 0.002
        snapshot gallery/brazilian-split 8400 -c links
        ;;
    notched-plate) snapshot gallery/notched-plate 2425 -c stress-yy ;;
    drum) snapshot gallery/drum 13884 -c velocity ;;
    heat-rod) chart gallery/heat-rod profile-rod --x x --y temperature --by time ;;
    shear-box)
        chart gallery/shear-box-force history --x time --y lid_fy --dashed lid_fx
        snapshot gallery/shear-box 8571 -c contacts
        ;;
    biaxial)
        chart gallery/biaxial-force history --x time --y lid_fy,right_fx
        snapshot gallery/biaxial 16838 -c contacts
        ;;
    *) echo "pictures.sh: no pictures of '$deck'; there are: $all" >&2; exit 2 ;;
    esac
}

chosen=${*:-$all}
for deck in $chosen; do
    case $deck in
    shear-box) options='-D inertial=1e-3' ;;
    biaxial)
        "$bin/dm2-seq" input/biaxial.dm2 -D columns=12 -q -o "$runs/pressed"
        options="-D columns=12 -D inertial=5e-4 --start $runs/pressed/final.dm2"
        ;;
    *) options= ;;
    esac
    case $deck in
    biaxial) file=input/stages/biaxial-shear.dm2 ;;
    *) file=input/$deck.dm2 ;;
    esac
    # shellcheck disable=SC2086 # the words of the options
    "$bin/dm2-seq" "$file" $options -q -o "$runs/$deck" --overwrite
    draw
done
