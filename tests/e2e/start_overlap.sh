# Elements that start pressed into each other are told, alike by every program; they do not link there by
# chance.
# timeout: 200
. "$DM2_SRC/tests/lib.sh"

head='let d = 0.04 cm
time { dt = 0.01 us; steps = 2 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
output { history_every = 1 }'
two="let gap = 0.6
domain { size = 1 cm, 1 cm; r_c = 2*d; delta_r = 0.2*d }
body lower { shape = rectangle 0.2 cm, 0.2 cm, 0.6 cm, 0.2 cm + 4*d; lattice = square; spacing = d
             origin = 0.2 cm + d/2, 0.2 cm + d/2; material = Cu MOTION }
body upper { shape = rectangle 0.2 cm, 0.2 cm + 4*d, 0.6 cm, 0.2 cm + 8*d; lattice = square; spacing = d
             origin = 0.2 cm + d/2, 0.2 cm + (3.5 + gap)*d; material = Cu MOTION }"
printf '%s\n' "$head" "$two" | sed 's/ MOTION//' >overlap.dm2
{
    cat overlap.dm2
    echo 'interface body { linked = yes }'
} >joined.dm2
printf '%s\n' "$head" "$two" | sed 's/ MOTION/; motion = fixed/' >walls.dm2
{
    printf '%s\n' "$head"
    cat <<'D'
let short = 0.4
domain { size = (12 - short)*d, 1 cm; boundary = periodic free; r_c = 2*d; delta_r = 0.2*d }
body crystal { shape = rectangle 0, 0.2 cm, (12 - short)*d, 0.2 cm + 4*d; lattice = square; spacing = d
               origin = 0.2*d, 0.2 cm + d/2; material = Cu }
D
} >seam.dm2
{
    printf '%s\n' "$head"
    cat <<'D'
domain { size = 1 cm, 1 cm; r_c = 2*d; delta_r = 0.2*d }
let close = 0.9
body a { shape = rectangle 0.2 cm, 0.2 cm, 0.6 cm, 0.6 cm; spacing = close*d; radius = d/2; material = Cu }
body b { shape = rectangle 0.2 cm, 0.6 cm, 0.6 cm, 0.8 cm; spacing = close*d; radius = d/2; material = Cu }
D
} >compressed.dm2
{
    printf '%s\n' "$head"
    cat <<'D'
domain { size = 1 cm, 1 cm; boundary = periodic periodic; r_c = 2*d; delta_r = 0.2*d }
body a { shape = rectangle 0, 0, 1, 1; spacing = d; material = Cu; structure = polycrystal; grain_size = 0.3
    seed = 5
         missing_links = 0.2 }
interface grain { linked = yes }
flaw f { line = 0.1, 0.5, 0.9, 0.52 }
D
} >grains.dm2

case $FLAVOUR in
release) ways='seq 1 2 3 check' ;;
*) ways='seq 3 check' ;; # slower by far
esac

# warnings DECK NAME=VALUE: what dm2-seq, dm2-client with 1 to 3 servers and --check say on standard error, in
# the file `said`, the same of all.
warnings()
{
    for way in $ways; do
        case $way in
        seq) set -- "$1" "$2" dm2-seq -o run-seq --overwrite ;;
        check) set -- "$1" "$2" dm2-client -n 2 --check ;;
        *) set -- "$1" "$2" dm2-client -n $way -o run-$way --overwrite ;;
        esac
        deck=$1 define=$2 program=$3
        shift 3
        expect_status 0 "$DM2_BIN/$program" "$deck" -D "$define" --progress never "$@"
        sed -e "s/^$program: //" -e '/energy book/d' -e '/what is stable/d' -e '/of what was stable/d' err \
            >"said-$way"
        same_bytes said-seq "said-$way"
        [ "$way" = seq ] || [ "$way" = check ] || same_bytes run-seq/history.csv "run-$way/history.csv"
        [ "$way" = seq ] || [ "$way" = check ] || same_bytes run-seq/final.dm2 "run-$way/final.dm2"
        set -- "$deck" "$define"
    done
    mv said-seq said
}

# links COUNT: the links of the first row.
links()
{
    awk -F, -v n="$1" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } NR == 2 { exit $at["links"] != n }' \
        run-seq/history.csv || fail "the run does not start with $1 links: $(sed -n 2p run-seq/history.csv)"
}

remedy='move a body, or make a period a whole number of spacings'
for gap in 0.51 0.97; do
    warnings overlap.dm2 gap=$gap
    expect_text said 'warning: 10 pairs of elements start pressed into each other; the deepest,
        elements 30 of '
    expect_text said "elements 30 of 'lower' at (0.22, 0.34) cm and 40 of 'upper' at (0.22, "
    expect_text said "stand at $gap of their contact distance: $remedy"
    links 132
done
warnings joined.dm2 gap=0.9
expect_text said 'warning: 10 pairs'
links 132
warnings seam.dm2 short=0.4
expect_text said "warning: 4 pairs of elements start pressed into each other; the deepest"
expect_text said "stand at 0.6 of their contact distance: $remedy"
links 80

# Nothing is told where no force acts, nor of lattices that are meant so.
for quiet in 'overlap.dm2 gap=1' 'overlap.dm2 gap=0.985' 'joined.dm2 gap=1' 'seam.dm2 short=0' \
    'walls.dm2 gap=0.9' \
    'compressed.dm2 close=0.9' 'grains.dm2 d=0.02 cm'; do
    warnings "${quiet%% *}" "${quiet#* }"
    [ ! -s said ] || fail "$quiet: a warning without a reason: $(cat said)"
done

# Closer than half is an error, which names the deepest pair, the same for every search and number of servers.
# Elements at one place have no finite force.
{
    printf '%s\n' "$head"
    echo 'let deep = 0.3
domain { size = 2 cm, 1 cm; r_c = 2*d; delta_r = 0.2*d }'
    for at in '1.7 0.2 0.4' '0.2 0.8 0.45' '1.1 0.5 deep' '0.6 0.3 0.4'; do
        set -- $at
        for name in a b; do
            x="($1 cm + $([ $name = a ] && echo 0 || echo "$3")*d)"
            echo "body $name${1#*.}${2#*.} { shape = disc $x, $2 cm, d/4; material = Cu
                spacing = d; origin = $x, $2 cm }"
        done
    done
} >four.dm2
# refused: dm2-seq and dm2-client with any cut and search end with this text.
refused()
{
    for search in cells+lists lists cells; do
        sed "s/delta_r/search = $search; delta_r/" four.dm2 >four-$search.dm2
        for way in $ways; do
            case $way in
            seq) set -- dm2-seq -o refused.run ;;
            check) set -- dm2-client -n 3 --check ;;
            *) set -- dm2-client -n $way -o refused.run ;;
            esac
            program=$1
            shift
            expect_status 2 "$DM2_BIN/$program" four-$search.dm2 -D deep=$deep --overwrite "$@"
            expect_text err "$text"
            expect_text err "start closer than half their contact distance, at $deep of it"
        done
    done
}
deep=0.3
text="elements 4 of 'a15' at (1.1, 0.5) cm and 5 of 'b15' at (1.112, 0.5) cm start"
refused
deep=0
text="elements 4 of 'a15' at (1.1, 0.5) cm and 5 of 'b15' at (1.1, 0.5) cm start"
refused
deep=0.4 # three pairs alike but for the last bits
text="elements 0 of 'a72' at"
refused
expect_status 2 "$DM2_BIN/dm2-seq" seam.dm2 -D short=0.55 --check
expect_text err 'start closer than half their contact distance'
expect_text err 'a period is no whole number of spacings'
expect_status 0 "$DM2_BIN/dm2-seq" overlap.dm2 -q -o quiet --overwrite
[ ! -s err ] || fail "--quiet prints: $(cat err)"
