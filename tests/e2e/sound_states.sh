# A spring that has grown to many times r_c is taken by every reader: a restart and two servers go on to the
# same bytes.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client

# A wheel on a belt spins against a fixed stop. The friction of their contact never slips, so that its spring
# grows with each turn, to many times r_c.
cat >wheel.dm2 <<'DECK'
let d = 0.04 cm
domain { size = 20*d, 10*d; boundary = periodic free; r_c = 1.5*d; delta_r = 0.25*d; gravity = 0.003, -0.01 }
time { dt = 0.01 us; steps = 2000 }
material A { rho0 = 8.9; c0 = 0.39; s = 1.5 }
material B { rho0 = 8.9; c0 = 0.39; s = 1.5 }
material C { rho0 = 8.9; c0 = 0.39; s = 1.5 }
interaction { zeta = 0.95 }
interface body A B { mu = 1; kt_ratio = 0.3 }
interface body B C { mu = 10; kt_ratio = 1e-7 }
body belt {
    shape = rectangle 0, 2*d, 20*d, 2.1*d; spacing = d/4; radius = 0.006; origin = 0, 2*d
    material = A; motion = driven; velocity = 0.02, 0
}
body wheel { shape = rectangle 9.9*d, 2.6*d, 10.1*d, 2.8*d; spacing = d; origin = 10*d, 0.1061; material = B }
body stop {
    shape = rectangle 10.9*d, 2.6*d, 11.2*d, 2.8*d; spacing = d; origin = 11*d, 0.1061
    material = C; motion = fixed
}
DECK

expect_status 0 "$seq" wheel.dm2 -q -o whole
expect_status 0 "$client" wheel.dm2 -n 2 -q --no-recover -o two
same_bytes whole/final.dm2 two/final.dm2
expect_status 0 "$seq" wheel.dm2 -q --steps 1500 -o part
expect_status 0 "$seq" wheel.dm2 -q --restart part/final.dm2
same_bytes whole/final.dm2 part/final.dm2
