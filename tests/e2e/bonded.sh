# Bonded lattices against theory, in pieces smaller than those of scripts/validate-bonded.sh: a cantilever
# sags within 3 % of the theory of beams; a disc between jaws splits within 5 % of half its direct
# strength, with its rows along the load at the jaws first; the stress at which a crack runs goes as its
# length to the power -0.5 within 0.05. Each deck leaves the same bytes on servers.
# labels: e2e physics bits
# timeout: 120
. "$DM2_SRC/tests/lib.sh"
sh "$DM2_SRC/scripts/validate-bonded.sh" small >table 2>err || {
    cat table err
    fail 'a figure is out of its bounds'
}
grep '^|\|^Slope' table

# servers DECK OPTION...: one process and three servers.
servers()
{
    deck=$DM2_SRC/input/$1.dm2
    shift
    expect_status 0 "$DM2_BIN/dm2-seq" "$deck" "$@" -q -o one --overwrite
    expect_status 0 "$DM2_BIN/dm2-client" "$deck" "$@" -n 3 -q -o several --overwrite
    same_bytes one/final.dm2 several/final.dm2
    same_bytes one/history.csv several/history.csv
}
servers cantilever -D rows=4 -D columns=24 --steps 60
servers brazilian -D 'D=24 mm' --steps 60
servers notched-plate -D a=3 -D speed=4
same_bytes one/cracks.csv several/cracks.csv
exit 0
