# Programs that start with closed standard descriptors: no message lands in a file or a socket of the run.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"

cat >discs.dm2 <<'END'
let d = 0.04 cm
domain { size = 2 cm, 1 cm; r_c = 2.5*d; delta_r = 0.25*d }
time { dt = 0.01 us; steps = 40 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
body left { shape = disc 0.5 cm, 0.5 cm, 0.3 cm; spacing = d; material = Cu; velocity = 0.03, 0
    jitter = 0.001 }
body right { shape = disc 1.5 cm, 0.5 cm, 0.3 cm; spacing = d; material = Cu; velocity = 0.03, 0
    jitter = 0.001 }
output { history_every = 1 }
END
expect_status 0 "$DM2_BIN/dm2-seq" discs.dm2 -q -o good

# Every set of closed descriptors.
for closed in '<&-' '>&-' '2>&-' '<&- >&-' '<&- 2>&-' '>&- 2>&-' '<&- >&- 2>&-'; do
    for program in "dm2-seq" "dm2-client -n 2"; do
        got=0
        options='--overwrite -o run --progress always'
        eval "\"$DM2_BIN/\"$program discs.dm2 $options </dev/null >out 2>err $closed" || got=$?
        [ "$got" -eq 0 ] || fail "$program $closed: exit status $got"
        same_bytes good/history.csv run/history.csv
        same_bytes good/final.dm2 run/final.dm2
        rm -rf run
        got=0
        eval "\"$DM2_BIN/\"$program discs.dm2 -o run --hash-every 10 </dev/null >out 2>err $closed" || got=$?
        case $closed in
        *'>&- '* | *' >&-' | '>&-') # hashes have no place to go: refused before anything is written
            [ "$got" -eq 2 ] || fail "$program --hash-every $closed: exit status $got"
            [ ! -e run ] || fail "$program --hash-every $closed: $(find run)"
            ;;
        *)
            [ "$got" -eq 0 ] || fail "$program --hash-every $closed: exit status $got"
            same_bytes good/history.csv run/history.csv
            ;;
        esac
        rm -rf run
    done
done

# A server's first line goes nowhere, and no socket takes its place.
(exec "$DM2_BIN/dm2-server" --port 0 --once --timeout 1 <&- >&- 2>&-)
got=$?
[ "$got" -eq 3 ] || fail \
    "a server without descriptors: exit status $got, not that of a client that never came"
for program in dm2-model dm2-plot dm2-seq dm2-client dm2-server; do
    got=0
    "$DM2_BIN/$program" --version >&- 2>err || got=$?
    [ "$got" -eq 1 ] || fail "$program --version without standard output: exit status $got"
    expect_text err 'cannot write to standard output'
done
exit 0
