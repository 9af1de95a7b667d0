# A checkpoint continues with a deck that means the same: other comments, order, units, names of lets, other
# ways to compute, more steps, other snapshots. A deck of another meaning is refused, and the first keyword
# that differs is told.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client

cat >deck.dm2 <<'END'
let d = 0.05 cm
domain { size = 2 cm, 1.6 cm; r_c = 2.5*d; delta_r = 0.25*d }
time { dt = 0.02 us; steps = 300 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489; shear = 47.7 GPa; yield = 0.12 GPa
    cp = 383 J/kg/K }
interaction { zeta = 0.1; mu = 0.2 }
body left { shape = disc 0.6 cm, 0.8 cm, 0.35 cm; spacing = d; material = Cu; velocity = 200 m/s, 0 }
body right { shape = disc 1.34 cm, 0.8 cm, 0.35 cm; spacing = d; material = Cu; velocity = -200 m/s, 0 }
output { history_every = 10; checkpoint_every = 120 }
END
cat >same.dm2 <<'END'
# The same run in other words.
body left { material = Cu; velocity = 0.02, 0; spacing = 0.05; shape = disc 6 mm, 8 mm, 3.5 mm; jitter = 0 }
body right { shape = disc 13.4 mm, 8 mm, 3.5 mm; spacing = 0.05; mix = Cu 1; velocity = -0.02, 0 }
time { steps = 100; dt = 20 ns }
interaction { mu = 1/5; zeta = 1/10; link_break = 1.05 }
material Cu { cp = 383 J/kg/K; rho0 = 8.93; c0 = 0.394; s = 1.489; shear = 0.477; yield = 0.0012 }
domain { size = 2, 1.6; r_c = 0.125; delta_r = 0.02; search = lists; rebuild_every = 7; balance = particles }
output { history_every = 10; snapshot_at = 270, 300; format = vtp xyz }
END
expect_status 0 "$seq" deck.dm2 -q -o whole
for program in "$seq" "$client -n 3"; do
    rm -rf cut
    cp -R whole cut
    rm cut/final.dm2
    # shellcheck disable=SC2086 # a program and its options
    expect_status 0 $program same.dm2 --steps 300 -q --restart cut/checkpoint.prev.dm2
    same_bytes whole/final.dm2 cut/final.dm2
    same_bytes whole/history.csv cut/history.csv
    [ -f cut/snapshots/state-000000270.xyz ] || fail 'no snapshot of the new schedule'
done

# refused SED TEXT: the deck changed by SED is told by its first keyword.
refused()
{
    sed "$1" deck.dm2 >changed.dm2
    cmp -s deck.dm2 changed.dm2 && fail "nothing changed: $1"
    for program in "$seq" "$client -n 2"; do
        # shellcheck disable=SC2086 # a program and its options
        expect_status 3 $program changed.dm2 -q --restart whole/checkpoint.dm2
        expect_text err "whole/checkpoint.dm2: belongs to another deck: $2"
    done
}
refused 's/velocity = -200/velocity = -250/' '`velocity` of body right was -0.02 0, is -0.025 0 cm/us'
refused 's/mu = 0.2/mu = 0.25/' '`mu` of interaction was 0.2, is 0.25'
refused 's/material = Cu; velocity = 200/temperature = 77 K; &/' '`temperature` of body left was 300, is 77 K'
refused '/^body left/d' '`body left` was there, and is not'
refused 's/^body left/body middle/' '`body left` was there, and is not'
refused 's/^output.*/&\nprobe p { region = 0 0 1 1 }/' '`probe p` is there, and was not'
refused '/^body left/{h;d};/^body right/G' \
    'blocks `body` were left, right, are right, left: their order numbers them'
