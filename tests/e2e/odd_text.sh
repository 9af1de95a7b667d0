# Decks as editors and web pages make them are read, or told by name; small inputs take memory in proportion,
# or are told before they take it.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq

deck()
{
    cat <<'END'
# A square of copper.
domain { size = 1 cm, 1 cm; r_c = 0.1 cm; delta_r = 0.01 cm }
time { dt = 0.01 us; steps = 1 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
body b { shape = rectangle 0.4 cm, 0.4 cm, 0.6 cm, 0.6 cm; spacing = 0.04 cm; material = Cu }
END
}
deck >good.dm2
expect_status 0 "$seq" good.dm2 -q -o good

# Read: a byte order mark, before a comment and before a block, also in an included file; line ends of CR
# alone.
{ printf '\357\273\277'; deck; } >mark.dm2
{ printf '\357\273\277'; deck | sed 1d; } >mark-block.dm2
deck | tr '\n' '\r' >cr.dm2
{ printf '\357\273\277'; deck | grep '^material'; } >part.dm2
{ deck | grep -v '^material'; echo 'include "part.dm2"'; } >include.dm2
for name in mark mark-block cr include; do
    expect_status 0 "$seq" $name.dm2 -q -o $name
    same_bytes good/history.csv $name/history.csv
done
deck | sed 's/dt = 0.01/dt = 0.01 x/' | tr '\n' '\r' >cr-wrong.dm2
expect_status 2 "$seq" cr-wrong.dm2 -q -o no
expect_text err 'cr-wrong.dm2:3:'

# told NAME TEXT...: the deck from standard input is wrong, and the message has these texts.
told()
{
    name=$1
    shift
    cat >"$name.dm2"
    expect_status 2 "$seq" "$name.dm2" -q -o no
    for text in "$@"; do
        expect_text err "$text"
    done
}
put() # REPLACED BYTES: the deck with the text replaced, BYTES for printf
{
    deck | sed "s/$1/$(printf "$2")/"
}
put 'dt = 0.01 us' 'dt = 0.01\302\240us' | told nbsp 'nbsp.dm2:3:' 'no-break space (U+00A0)' 'ordinary blank'
put 'dt = 0.01 us' 'dt = 0.01\342\200\257us' | told narrow 'U+202F' 'ordinary blank'
put 'dt = 0.01 us' 'dt = 0.01\342\200\211us' | told thin 'typographic space (U+2009)' 'ordinary blank'
put '0.4 cm, 0.4 cm,' '0.4 cm, \342\210\2220.4 cm,' | told minus 'minus sign (U+2212)' 'ordinary -'
put '0.4 cm, 0.4 cm,' '0.4 cm, \342\200\2230.4 cm,' | told dash 'en dash (U+2013)' 'ordinary -'
{ printf 'include \342\200\234m.dm2\342\200\235\n'; deck; } |
    told quotes 'typographic quote (U+201C)' 'ordinary "'
put '0.01 us' '0.01 \302\265s' | told micro 'micro sign (U+00B5)' 'put u'
put 'g.cm3' 'g\/cm\302\263' | told cube 'superscript three (U+00B3)' '^3'
put 'body b' 'body \351' | told latin 'byte E9' 'UTF-8'
deck | sed 's/./&\x00/g' | told utf16 'the file is UTF-16: save it as plain text, UTF-8'
{ printf '\377\376'; deck; } | told utf16-mark 'the file is UTF-16'
[ "$(wc -l <err)" -eq 1 ] || fail "more than one line about UTF-16: $(cat err)"

# The table of a load is text of the deck: a byte order mark, line ends of CR alone, blanks around fields are
# read; the first character outside ASCII is told by name, and text behind a unit is no heading.
{ deck | sed 's/material = Cu }/material = Cu; motion = driven }/'; echo \
    'load l { body = b; file = "l.csv" }'; } >load.dm2
printf 'time [us],velocity_x [km/s]\n0,0\n1,-0.5\n' >l.csv
expect_status 0 "$seq" load.dm2 -q -o load
for text in '\357\273\277time [us],velocity_x [km/s]\n0,0\n1,-0.5\n' \
    'time [us],velocity_x [km/s]\r0,0\r1,-0.5\r' ' time [us] ,\tvelocity_x [km/s]\n0, 0\n 1 ,\t-0.5 \r\n'; do
    printf "$text" >l.csv
    expect_status 0 "$seq" load.dm2 -q --overwrite -o load.2
    same_bytes load/final.dm2 load.2/final.dm2
done
# table PLACE TEXT BYTES: the table of these bytes, for printf, is wrong at this line and column.
table()
{
    printf "$3" >l.csv
    expect_status 2 "$seq" load.dm2 -q -o no
    expect_text err "l.csv:$1: error: $2"
}
table 1:5 'a no-break space (U+00A0)' 'time\302\240[us],velocity_x\n0,0\n1,0\n'
table 2:3 'a no-break space (U+00A0)' 'time,velocity_x\n0,\302\2400\n1,0\n'
table 3:3 'a minus sign (U+2212)' 'time,velocity_x\n0,0\n1,\342\210\2220.5\n'
table 1:7 'a micro sign (U+00B5)' 'time [\302\265s],velocity_x\n0,0\n1,0\n'
table 3:3 'a byte E9 (hexadecimal) that is no UTF-8' 'time,velocity_x\n0,0\n1,\351\n'
table 1:1 "the column 'time [us];velocity_x [km/s]'" 'time [us];velocity_x [km/s]\n0;0\n1;1\n'
table 1:1 "the column 'time [us] s'" 'time [us] s,velocity_x\n0,0\n1,0\n'
table 3:1 "'' in the column 'velocity_x' is no number" 'time,velocity_x\n0,0\n1, \n'

# 9e8 cells for thirty elements: told before the memory is taken, and by --check as well.
sed 's/domain.*/let n = 1000\ndomain { size = n*0.111 cm, n*0.111 cm; r_c = 0.1 cm; delta_r = 0.01 cm }/' \
    good.dm2 >cells.dm2
expect_status 0 "$seq" cells.dm2 -q -o cells
if [ "$FLAVOUR" = release ]; then # sanitizers reserve terabytes
    for command in "dm2-seq --check" "dm2-seq -q -o no" "dm2-client --check -n 2" \
        "dm2-client -q -n 2 -o no"; do
        program=$DM2_BIN/$command
        # shellcheck disable=SC2086
        expect_status 1 sh -c 'ulimit -v 3000000; exec "$@"' sh $program -D n=30000 cells.dm2
        expect_text err '30272 x 30272 cells'
        expect_text err 'GB'
        [ ! -e no ] || fail "$command made $(find no)"
    done
    # A stack of 64 KiB.
    for program in dm2-seq dm2-client dm2-server dm2-model dm2-plot; do
        expect_status 1 sh -c 'ulimit -s 64; exec "$@"' sh "$DM2_BIN/$program" --version
        expect_text err 'stack'
        expect_status 0 sh -c 'ulimit -S -s 64; exec "$@"' sh "$DM2_BIN/$program" --version
    done
    many() { awk -v n="$2" -v text="$1" 'BEGIN { for (i = 0; i < n; i++) printf "%s", text }'; }
    { cat good.dm2; echo "let x = $(many '(' 199)1$(many ')' 199)"; echo \
        "let z = $(many 'max(1,' 190)1$(many ')' 190)"; } >f60.dm2
    i=0
    while [ $i -lt 60 ]; do
        echo "include \"f$((i + 1)).dm2\"" >f$i.dm2
        i=$((i + 1))
    done
    expect_status 0 sh -c 'ulimit -s 256; exec "$@"' sh "$seq" --check f0.dm2
    expect_status 0 sh -c 'ulimit -s 256; exec "$@"' sh "$DM2_BIN/dm2-client" -n 2 -q -o nested f0.dm2
fi
exit 0
