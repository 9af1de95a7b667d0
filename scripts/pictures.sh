#!/bin/sh
# Draws the pictures that README and docs show, each from a run of its deck as it is.
#
#     make && sh scripts/pictures.sh        writes docs/plate-impact*.svg and docs/gallery/*.svg
set -eu
bin=${DM2_BIN:-bin}
runs=$(mktemp -d)
trap 'rm -rf "$runs"' EXIT

# run DECK
run()
{
    "$bin/dm2-seq" "input/$1.dm2" -q -o "$runs/$1" --overwrite
}

# snapshot PICTURE DECK STEP OPTION...; chart PICTURE DECK TABLE OPTION...
snapshot()
{
    picture=$1 deck=$2 step=$3
    shift 3
    "$bin/dm2-plot" snapshot "$runs/$deck/snapshots/state-$(printf %09d "$step").vtp" -o "docs/$picture.svg" "$@"
}
chart()
{
    picture=$1 deck=$2 table=$3
    shift 3
    "$bin/dm2-plot" chart "$runs/$deck/$table.csv" -o "docs/$picture.svg" "$@"
}

run plate-impact
snapshot plate-impact plate-impact 200 --links --title 'Plate impact: nickel onto nickel and aluminium at 400 m/s'
chart plate-impact-velocity plate-impact history --x time --y free_centre_vy,free_surface_vy \
    --title 'Velocity of the free surface, its middle and all of it' --ylabel 'velocity [cm/µs]'
snapshot gallery/plate-impact plate-impact 200 -c links

run cu-polycrystal
snapshot gallery/cu-polycrystal-grains cu-polycrystal 0 -c grain
snapshot gallery/cu-polycrystal cu-polycrystal 120 -c pressure
chart gallery/cu-polycrystal-profile cu-polycrystal profile-shock --x y --y stress_yy --by time

run hmx-powder
snapshot gallery/hmx-powder hmx-powder 1800 -c temperature
snapshot gallery/hmx-powder-damage hmx-powder 1800 -c damage

run shear-band
snapshot gallery/shear-band shear-band 3500 -c temperature
snapshot gallery/shear-band-phase shear-band 2000 -c phase
snapshot gallery/shear-band-composition shear-band 3500 -c composition
chart gallery/shear-band-energy shear-band history --x time --y thermal,phase,chemical,work

run granular-shear
snapshot gallery/granular-shear granular-shear 20000 -c vx
chart gallery/granular-shear-profile granular-shear profile-flow --x y --y vx --by time

run spall
snapshot gallery/spall spall 250 -c vy
chart gallery/spall-surface spall history --x time --y surface_vy

run phase-front
snapshot gallery/phase-front phase-front 200 -c phase
chart gallery/phase-front-profile phase-front profile-bar --x x --y stress_xx --by time

run sliding-block
chart gallery/sliding-block sliding-block history --x time --y block_vx

run heat-rod
chart gallery/heat-rod heat-rod profile-rod --x x --y temperature --by time
