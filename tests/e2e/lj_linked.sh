# Lennard-Jones of `epsilon` and `sigma` is that potential, between all pairs, or the deck is refused: with
# the scope `linked`, the default, its minimum would lie at the contact distance.
# labels: e2e physics
. "$DM2_SRC/tests/lib.sh"

# pair SCOPE DISTANCE: two atoms, epsilon = sigma = mass = 1.
pair()
{
    cat >pair.dm2 <<END
domain { size = 20 10; r_c = 3; delta_r = 0.3 }
time { dt = 0.002; steps = 1 }
material atom { mass = 1 }
interaction { potential = lennard-jones; epsilon = 1; sigma = 1; $1 }
body left { shape = rectangle 9.5 4.5 10.5 5.5; spacing = 1; radius = 0.5; origin = 10 5; material = atom }
body right { shape = rectangle 9.5 + $2 4.5 10.5 + $2 5.5; spacing = 1; radius = 0.5; origin = 10 + $2, 5
    material = atom }
output { history_every = 1 }
END
}

for scope in '' 'scope = linked'; do
    pair "$scope" 1.3
    for program in "$DM2_BIN/dm2-seq" "$DM2_BIN/dm2-client"; do
        expect_status 2 "$program" pair.dm2 -q -o run
        expect_text err "pair.dm2:4:52: error: 'epsilon' and 'sigma' give the Lennard-Jones potential"
        expect_text err "of all pairs within 'cutoff': write 'scope = all'"
        [ ! -e run ] || fail 'a refused deck has a run directory'
    done
done
# An interface has a scope of its own.
pair 'scope = all } interface body { scope = linked' 1.3
expect_status 2 "$DM2_BIN/dm2-seq" pair.dm2 -q -o run
expect_text err "write 'scope = all'"

# Energies in the first row: 4 ((1/r)^12 - (1/r)^6), less the value at the cutoff, 3.
for r in 1.1 1.2 1.3; do
    pair 'scope = all' $r
    expect_status 0 "$DM2_BIN/dm2-seq" pair.dm2 --progress never -o run --overwrite
    ! grep 'pair.dm2:.*warning' err || fail 'a warning of a deck that is right'
    awk -F, -v r=$r 'function u(r) { return 4 * (r^-12 - r^-6) }
        NR == 1 { for (i = 1; i <= NF; i++) if (index($i, "potential ") == 1) at = i }
        NR == 2 { off = $at - (u(r) - u(3)); exit !(off < 1e-12 && off > -1e-12) }' run/history.csv ||
        fail "the energy at r = $r is not that of Lennard-Jones"
done

# Without links a pair of scope `all` has no use for keywords of links.
pair 'scope = all; link_break = 1.2; tensile = 1; linked = yes; k = 3' 1.3
expect_status 0 "$DM2_BIN/dm2-seq" pair.dm2 --progress never -o run --overwrite
for key in link_break tensile linked k; do
    expect_text err "'$key' has no meaning for"
done
pair 'scope = all; link_break = 1.2; linked = yes; zeta = 0.1' 1.3
expect_status 0 "$DM2_BIN/dm2-seq" pair.dm2 --progress never -o run --overwrite
! grep 'pair.dm2:.*warning' err || fail 'links of damped pairs have a meaning'
exit 0
