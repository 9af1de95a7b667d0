# A checkpoint with a sound checksum, in which one number of an element or a pair cannot come of this deck:
# refused when it is read, with the file, the element, the field, what was found and what is expected.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client
patch=$DM2_BUILD/tools/patch_state
cat >react.dm2 <<'DECK'
let d = 0.04 cm
domain { size = 1 cm, 1 cm; boundary = periodic free; r_c = 2.5*d; delta_r = 0.25*d }
time { dt = 0.001 us; steps = 20 }
material A { rho0 = 5 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K }
material B { rho0 = 5 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K }
material C { rho0 = 5 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K }
material X { rho0 = 5 g/cm3; c0 = 4 km/s; s = 1.5; cp = 500 J/kg/K }
reaction burn { reactants = A B; product = C; kind = non-stoichiometric; k0 = 1; ea = 0; heat = 1 kJ/g }
body a { shape = rectangle 0.2 cm, 0.2 cm, 0.4 cm, 0.4 cm; lattice = square; spacing = 0.99*d; radius = d/2
    origin = 0.22 cm, 0.22 cm; material = A }
body b { shape = rectangle 0.4 cm, 0.2 cm, 0.6 cm, 0.4 cm; lattice = square; spacing = 0.99*d; radius = d/2
    origin = 0.22 cm, 0.22 cm; material = B }
probe p { region = 0, 0, 0.4 cm, 1 cm }
DECK
expect_status 0 "$seq" react.dm2 --checkpoint-every 10 -q -o run
good=run/checkpoint.prev.dm2
[ -f $good ] || good=run/checkpoint.dm2

# Elements that became another kind are taken: C, the product.
expect_status 0 "$patch" $good same.dm2 3 kind 2
cp -R run again
rm again/final.dm2
expect_status 0 "$patch" same.dm2 again/same.dm2 3 was 2
expect_status 0 "$seq" react.dm2 -q --restart again/same.dm2

# So is an element below 0 K, as an unstable run makes them: not the reader refuses the run, but its energy
# book.
cp -R run cold
rm cold/final.dm2
expect_status 0 "$patch" $good cold/cold.dm2 3 heat -1e-4
expect_status 1 "$seq" react.dm2 -q --restart cold/cold.dm2
expect_text err 'the energy book is off by'

# refused ID FIELD VALUE TEXT
refused()
{
    expect_status 0 "$patch" $good bad.dm2 "$1" "$2" "$3"
    expect_status 3 "$seq" react.dm2 -q --restart bad.dm2
    expect_text err "bad.dm2: $4"
}
refused 0 share 7 'element 0 has share 7, 0 to 1 is expected'
refused 0 share -1 'element 0 has share -1, 0 to 1 is expected'
refused 0 share1 1e300 'element 0 has share 1e+300, 0 to 1 is expected'
refused 0 share1 1e-3 'element 0 has share'
refused 49 share 1e-9 'element 49 has share 1e-09 '
refused 0 kind 1 "element 0 has kind 1, 'B': a kind that its material 'A' can become is expected"
refused 0 kind 3 "element 0 has kind 3, 'X': a kind that its material 'A' can become is expected"
refused 0 kind 9 'element 0 is of a body or a kind that the deck does not have: kind 9'
refused 0 was 60000 'element 0 is of a body or a kind that the deck does not have: was 60000'
refused 0 was 1 "element 0 has was 1, 'B': a kind that its material 'A' can become is expected"
refused 0 body 1 'element 0 has body 1, 0 is expected'
refused 49 body 0 'element 49 has body 0, 1 is expected'
refused 0 body 9 'element 0 is of a body or a kind that the deck does not have: body 9'
refused 0 grain 4000000000 'element 0 of grain 4000000000 is beyond the next element, 50, or the next'
refused 0 grain 1 'element 0 has grain 1, 0 is expected'
refused 49 grain 0 'element 49 has grain 0, 1 is expected'
refused 0 flags 1 "element 0 has flags 1, 0 is expected by the motion of the body 'a'"
refused 0 flags 2 'element 0 has a flag that this program does not know: flags 2'
refused 0 flags 128 'element 0 has a flag that this program does not know: flags 128'
refused 0 probes 255 'element 0 belongs to probe 7, counted from 0; the deck has 1'
refused 0 radius 0.4 'element 0 has radius 0.4 cm, 0.02 is expected'
refused 0 radius 1e-9 'element 0 has radius 1e-09 cm, 0.02 is expected'
refused 0 radius 0.02000001 'element 0 has radius 0.02000001 cm, 0.02 is expected'
refused 0 mass 1e9 'element 0 has mass 1000000000 g, 0.0069282032302755'
refused 0 mass 0.00692820323027 'element 0 has mass 0.0069282032302'
refused 0 r 1e6 'element 0 has r 1000000 cm in x, 0 <= r < 1 is expected'
refused 0 r -0.3 'element 0 has r -0.29999999999999999 cm in x, 0 <= r < 1 is expected'
refused 0 r 1 'element 0 has r 1 cm in x, 0 <= r < 1 is expected'
refused 0 v 1e4 'element 0 has v (10000, '
refused 0 w 1e300 'element 0 has w 1e+300, beyond the energies that a run can hold'
refused 0 heat -1e20 'element 0 has heat -1e+20, beyond the energies that a run can hold'
refused 0 heat 1e300 'element 0 has heat 1e+300, beyond the energies that a run can hold'
refused 0 p nan 'element 0 has a number that is not finite: p nan'
refused 0 p 1e300 'element 0 has p 1e+300, beyond the energies that a run can hold'
refused 0 moved 1e300 'element 0 has moved 1e+300, beyond the energies that a run can hold'
refused 0 damped 1e-9 'element 0 has damped 1e-09, 0 is expected: the deck has no damping'
refused 0 image 1073741825 'element 0 has image 1073741825 in x, at most 2^30 either way is expected'
refused 0 bonds 65535 'element 0 has bonds 65535, at most '
refused 0 stretch 5 'the pair (0, 1) has stretch 5 cm, below r_c = 0.1 cm either way is expected'
refused 0 stretch -1e300 'the pair (0, 1) has stretch -1e+300 cm'
refused 0 spring 1e300 'the pair (0, 1) has spring 1e+300 cm, below 2^30 r_c = '
refused 49 r 0.65 'the pair (' # 0.04 cm from its place: the links of this element would be too long
expect_text err 'is expected where they touch or are linked'
expect_status 3 "$client" react.dm2 -n 2 -q --progress never --restart bad.dm2
expect_text err 'is expected where they touch or are linked'
