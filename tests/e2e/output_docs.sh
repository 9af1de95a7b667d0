# docs/output.md has the columns of every table of a run directory and the arrays of a snapshot, with their
# units, and no other ones; every file of the directory is in the README or there.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"

cat >all.dm2 <<'END'
domain { size = 60 60; r_c = 1.6; delta_r = 0.3 }
time { dt = 0.2; steps = 40 }
material A { mass = 1; tensile = 0.03 }
interaction { potential = morse; k = 1; shape = 4; kt_ratio = 0.3; mu = 0.2; link_break = 1.05; zeta = 0.1 }
body left { shape = rectangle 10 10 30 20.3; spacing = 1; origin = 10.1 10.1; material = A
    velocity = -0.05 0.03 }
body right { shape = rectangle 30 10 50 20.3; spacing = 1; origin = 10.1 10.1; material = A
    velocity = 0.05 0 }
wall w { line = 5 5 55 5; material = A }
probe r { region = 10 10 20 20; report = position, velocity, force, stress, temperature, kinetic, porosity }
probe b { body = left; report = position, velocity, force, torque, spin, stress, temperature, kinetic }
probe h { body = w; report = position, velocity, force, torque, spin, heat }
profile a { axis = x; bins = 2; every = 20 }
output { history_every = 10; snapshot_at = 0, 40; strain = yes; checkpoint_every = 20 }
END
expect_status 0 "$DM2_BIN/dm2-client" all.dm2 -n 2 -q -o run

# documented FILE: "column [unit]" of each row of the file's section.
documented()
{
    awk -v file="## \`$1\`" '/^## / { here = $0 == file; next }
        here && /^\| `/ { split($0, cell, " *[|] *"); name = cell[2]; gsub("`", "", name)
            print name (cell[3] == "" ? "" : " [" cell[3] "]") }' "$DM2_SRC/docs/output.md"
}
# compare FILE: the columns in `written` with those of the manual.
compare()
{
    documented "$1" | LC_ALL=C sort -u >expected
    [ -s expected ] || fail "docs/output.md has no section of $1"
    LC_ALL=C sort -u written | diff expected - || fail "docs/output.md and $1: other columns"
}
for table in run/*.csv; do
    name=${table##*/}
    head -n 1 "$table" | tr , '\n' | sed 's/^[rbh]_/NAME_/' >written
    case $name in profile-*) name=profile-NAME.csv ;; esac
    compare "$name"
done
# Arrays of the file format itself: connectivity, offsets. A unit is the manual's alone.
LC_ALL=C grep -a -o 'Name="[^"]*"' run/snapshots/state-000000040.vtp | sed 's/Name="\(.*\)"/\1/' |
    grep -v -x -e connectivity -e offsets >arrays
documented 'snapshots/state-STEP.vtp' | sed 's/ \[.*//' | LC_ALL=C sort -u >expected
LC_ALL=C sort -u arrays | diff expected - || fail 'docs/output.md and the snapshot: other arrays'

for file in run/*; do
    name=${file##*/}
    case $name in profile-*) name=profile-NAME.csv ;; esac
    grep -q "\`$name" "$DM2_SRC/README.md" || [ "$name" = snapshots ] ||
        fail "the README, \"The run directory\", has no $name"
done
