#!/bin/sh
# dm2-plot from a user's seat: pictures, charts, exit codes, messages that name the file, nothing half-written.
set -u
plot=$DM2_BIN/dm2-plot
fake=$DM2_BUILD/tools/fake_snapshot
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0

fail()
{
    echo "FAIL: $*"
    failures=$((failures + 1))
}

# expect STATUS TEXT COMMAND...: the command's exit status, and a part of what it prints.
expect()
{
    want=$1 text=$2
    shift 2
    "$@" >out 2>&1
    got=$?
    [ "$got" -eq "$want" ] || fail "$*: exit status $got, expected $want: $(cat out)"
    grep -qF -e "$text" out || fail "$*: expected '$text' in: $(cat out)"
}

"$fake" 55 31 state.vtp || exit 1
expect 0 state.svg "$plot" snapshot state.vtp
[ "$(wc -c <state.svg)" -lt 250000 ] || fail "state.svg is too large"
grep -q 'nickel' state.svg || fail "no legend in state.svg"
for colour in material velocity vy stress pressure temperature links grain body; do
    expect 0 picture.svg "$plot" snapshot state.vtp -o picture.svg --colour $colour --links --title "By $colour" --width 500
done
expect 0 picture.svg "$plot" snapshot --range -0.5 0.5 state.vtp --colour vy --output=picture.svg
grep -q '0.4<' picture.svg || fail "--range did not reach the colour bar"
expect 0 "WHAT is one of: material velocity" "$plot" snapshot --help
expect 0 "dm2-plot chart" "$plot" --help
expect 2 "one file is expected, 0 were given" "$plot" snapshot
expect 2 "--range needs two numbers" "$plot" snapshot state.vtp --range 1
expect 2 "is nothing to colour by" "$plot" snapshot state.vtp --colour mass
expect 2 "is no command" "$plot" photograph state.vtp
expect 1 "absent.vtp: cannot open: No such file" "$plot" snapshot absent.vtp
head -c 5000 state.vtp >cut.vtp
expect 1 "cut.vtp:" "$plot" snapshot cut.vtp
[ ! -e cut.svg ] || fail "a picture of a damaged snapshot"
expect 1 "no/picture.svg: cannot create" "$plot" snapshot state.vtp -o no/picture.svg

printf 'step,time [us],kinetic [erg],thermal [erg]\n0,0,3,0\n1,0.5,2,1\n2,1,1.5,1.5\n' >history.csv
expect 0 history.svg "$plot" chart history.csv --x time --y kinetic,thermal --title Energies
for part in '>Energies<' '>time [us]<' '>[erg]<' '>kinetic<' '>thermal<'; do
    grep -qF -e "$part" history.svg || fail "no '$part' in history.svg"
done
expect 0 other.svg "$plot" chart history.csv --x step --y kinetic --log-y -o other.svg
expect 2 "has no column 'mass'; it has: step, time [us]" "$plot" chart history.csv --x step --y mass
expect 2 "--x and --y must name columns" "$plot" chart history.csv --x step
printf 'a,b\n1,x\n' >bad.csv
expect 1 "bad.csv:2: 'x' in column 'b' is not a number" "$plot" chart bad.csv --x a --y b

# A disk that is full: the message names the file, and neither the picture nor its temporary file stays.
(
    ulimit -f 1
    "$plot" snapshot state.vtp -o full.svg
) >out 2>&1
status=$?
[ $status -eq 1 ] || fail "full disk: exit status $status"
grep -q 'full.svg: cannot write: File too large' out || fail "full disk: $(cat out)"
[ ! -e full.svg ] && [ ! -e full.svg.part ] || fail "full disk: something is left"

[ $failures -eq 0 ] || exit 1
echo "dm2-plot: all as expected"
