# Outputs go to plain files and to standard output: a FIFO, a link, a device or a directory of the name is
# refused and stays as it is, for pictures, calibrations and every file of a run directory.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
plot=$DM2_BIN/dm2-plot
printf 'x,y\n0,1\n1,2\n2,4\n' >a.csv
chart() { "$plot" chart a.csv --x x --y y -o "$1"; }

# odd_names NAME: makes what is no plain file in its place, one after the other; `still` tells whether it is
# unchanged.
odd_kinds='fifo link dangling directory device'
make_odd() # KIND NAME
{
    case $1 in
    fifo) mkfifo "$2" ;;
    link) echo old >target.txt && ln -s "$PWD/target.txt" "$2" ;;
    dangling) ln -s "$PWD/nowhere.txt" "$2" ;;
    directory) mkdir "$2" ;;
    device) ln -s /dev/null "$2" ;; # a link to a device, because only root makes devices
    esac
}
still() # KIND NAME
{
    case $1 in
    fifo) [ -p "$2" ] ;;
    link) [ -h "$2" ] && [ "$(cat target.txt)" = old ] ;;
    dangling) [ -h "$2" ] && [ ! -e nowhere.txt ] ;;
    directory) [ -d "$2" ] && [ ! -h "$2" ] ;;
    device) [ -h "$2" ] && [ -c "$2" ] ;;
    esac
}

for kind in $odd_kinds; do
    make_odd $kind plot.svg
    expect_status 2 chart plot.svg
    expect_text err 'plot.svg: is '
    still $kind plot.svg || fail "$kind: plot.svg was replaced"
    [ ! -e plot.svg.part ] || fail "$kind: plot.svg.part was left"
    rm -rf plot.svg
done
# Standard output, also in a pipe; a plain file is replaced; a link in place of the temporary file is not
# followed.
expect_status 0 chart -
[ ! -e ./- ] || fail 'a file - was made'
mv out picture.svg
expect_text picture.svg '</svg>'
expect_status 0 chart plot.svg
same_bytes picture.svg plot.svg
echo old >plot.svg
echo old >target.txt
ln -s "$PWD/target.txt" plot.svg.part
expect_status 0 chart plot.svg
same_bytes picture.svg plot.svg
[ "$(cat target.txt)" = old ] || fail 'a link in place of the temporary file was followed'
[ ! -h plot.svg.part ] && [ ! -e plot.svg.part ] || fail 'plot.svg.part was left'
if [ -c /dev/full ]; then
    got=0
    chart - >/dev/full 2>err || got=$?
    [ "$got" -eq 1 ] || fail "exit status $got into a full device"
fi

# A calibration: refused before an hour of measuring.
for kind in $odd_kinds; do
    make_odd $kind constants.csv
    expect_status 2 "$DM2_BIN/dm2-model" calibrate --file constants.csv -n 2 \
        --deck "$DM2_SRC/input/timing.dm2"
    expect_text err 'constants.csv: is '
    still $kind constants.csv || fail "$kind: constants.csv was replaced"
    rm -rf constants.csv
done

# Every file of a run directory, in a run that replaces an earlier one and in one that goes on.
cat >deck.dm2 <<'END'
domain { size = 1 cm, 1 cm; r_c = 0.1 cm; delta_r = 0.01 cm }
time { dt = 0.01 us; steps = 8 }
material M { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5 }
body b { shape = rectangle 0.4 cm, 0.4 cm, 0.6 cm, 0.6 cm; spacing = 0.04 cm; material = M }
profile p { axis = x; bins = 4; every = 4 }
output { history_every = 1; snapshot_every = 4; format = vtp, xyz; checkpoint_every = 2 }
END
expect_status 0 "$seq" deck.dm2 -q -o good
(cd good && find . -type f | sort) >files
for name in final.dm2 history.csv fragments.csv profile-p.csv run.log timing.csv schedule.csv \
    deck.dm2 checkpoint.dm2 checkpoint.prev.dm2; do
    grep -q "/$name\$" files || fail "the run has no $name: $(cat files)"
done
while IFS= read -r name; do
    for kind in $odd_kinds; do
        rm -rf run
        cp -R good run
        rm "run/$name"
        make_odd $kind "run/$name"
        expect_status 2 "$seq" deck.dm2 -q -o run --overwrite
        still $kind "run/$name" || fail "$kind: run/$name was replaced"
        [ "$(find run -type f | wc -l)" -ge $(($(wc -l <files) - 1)) ] ||
            fail "$kind $name: files were removed before the refusal"
        [ -z "$(find run -name '*.part')" ] || fail "$kind $name: $(find run -name '*.part')"
        case $kind$name in
        link*) ;;
        *) continue ;;
        esac
        case $name in
        ./checkpoint.*) continue ;; # what the run goes on from
        esac
        expect_status 2 "$seq" deck.dm2 -q --steps 12 --restart run/checkpoint.dm2
        still $kind "run/$name" || fail "restart, $kind: run/$name was replaced"
    done
done <files
# The directory of the snapshots.
rm -rf run store
cp -R good run
mv run/snapshots store
ln -s "$PWD/store" run/snapshots
expect_status 2 "$seq" deck.dm2 -q -o run --overwrite
[ -h run/snapshots ] && [ -f store/series.pvd ] || fail 'snapshots behind a link were removed'
# A name that comes into being during the run is not replaced.
rm -rf run
mkfifo hashes
"$seq" deck.dm2 -q -o run --hash-every 1 >hashes 2>err &
pid=$!
exec 4<hashes
IFS= read -r line <&4
mkfifo run/final.dm2
cat <&4 >rest
exec 4<&-
got=0
wait $pid || got=$?
# The run may have been quicker than this script.
[ -p run/final.dm2 ] && { [ "$got" -eq 2 ] || fail "exit status $got: $(cat err)"; }
exit 0
