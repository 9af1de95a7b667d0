# dm2-plot as a user runs it: pictures, charts, exit codes, messages that name the file, nothing half-written.
# labels: e2e plot
. "$DM2_SRC/tests/lib.sh"
plot=$DM2_BIN/dm2-plot
fake=$DM2_BUILD/tools/fake_snapshot

# refuses STATUS TEXT COMMAND...: COMMAND exits with STATUS, says TEXT on standard error, nothing on standard
# output.
refuses()
{
    status=$1 text=$2
    shift 2
    expect_status "$status" "$@"
    expect_text err "$text"
    [ ! -s out ] || fail "$* prints although it failed: $(cat out)"
}

"$fake" 55 31 state.vtp || fail "fake_snapshot failed"
expect_status 0 "$plot" snapshot state.vtp
expect_text out state.svg
expect_text state.svg '>nickel<'
[ "$(wc -c <state.svg)" -lt 250000 ] || fail "state.svg is too large"
for colour in material velocity vy stress pressure temperature links grain body; do
    expect_status 0 "$plot" snapshot state.vtp -o picture.svg --colour "$colour" --links --title \
        "By $colour" --width 500
    expect_text picture.svg ">By $colour<"
done
expect_status 0 "$plot" snapshot --range -0.5 0.5 state.vtp --colour vy --output=picture.svg
expect_text picture.svg '0.4<' # a tick of the colour bar
expect_status 0 "$plot" snapshot --help
expect_text out 'WHAT is one of: material velocity'
expect_status 0 "$plot" --help
expect_text out 'dm2-plot chart'
expect_status 0 "$plot" --version
expect_text out "dm2-plot "
refuses 2 'one file is expected, 0 were given' "$plot" snapshot
refuses 2 '--range needs two numbers' "$plot" snapshot state.vtp --range 1
refuses 2 'is nothing to colour by' "$plot" snapshot state.vtp --colour mass
refuses 2 'is no command' "$plot" photograph state.vtp
refuses 1 'absent.vtp: cannot open: No such file' "$plot" snapshot absent.vtp
refuses 1 'no/picture.svg: cannot create' "$plot" snapshot state.vtp -o no/picture.svg
head -c 5000 state.vtp >cut.vtp
refuses 1 'cut.vtp:' "$plot" snapshot cut.vtp
[ ! -e cut.svg ] || fail "a picture of a damaged snapshot"

printf 'step,time [us],kinetic [erg],thermal [erg]\n0,0,3,0\n1,0.5,2,1\n2,1,1.5,1.5\n' >history.csv
expect_status 0 "$plot" chart history.csv --x time --y kinetic,thermal --title Energies
for part in '>Energies<' '>time [µs]<' '>[erg]<' '>kinetic<' '>thermal<'; do
    expect_text history.svg "$part"
done
expect_status 0 "$plot" chart history.csv --x step --y kinetic --log-y -o other.svg
refuses 2 "has no column 'mass'; it has: step, time [us]" "$plot" chart history.csv --x step --y mass
refuses 2 '--x and --y must name columns' "$plot" chart history.csv --x step
printf 'a,b\n1,x\n' >bad.csv
refuses 1 "bad.csv:2: 'x' in column 'b' is not a number" "$plot" chart bad.csv --x a --y b

# A disk that is full: the message names the file, and neither the picture nor its temporary file stays.
cat >limited.sh <<'END'
ulimit -f 1
exec "$@"
END
refuses 1 'full.svg: cannot write: File too large' sh limited.sh "$plot" snapshot state.vtp -o full.svg
[ ! -e full.svg ] && [ ! -e full.svg.part ] || fail "full disk: something is left"
