# A disc that hits something held (a fixed or driven element) is damped by the mass that moves: the
# restitution is that of zeta, whatever mass the wall's elements have, whoever of the two moves, and the same
# as of two free discs.
. "$DM2_SRC/tests/lib.sh"

cat >bounce.dm2 <<'END'
let d = 0.1 cm
let zeta = 0.3
let v = 0.001
let wall = 8 g/cm3
let push = 0
domain { size = 2 cm, 1 cm; r_c = 2*d; delta_r = 0.2*d }
time { dt = 0.002 us; steps = 2500 }
material D { rho0 = 8 g/cm3 }
material W { rho0 = wall }
interaction { potential = quadratic; k = 0.5; zeta = zeta; linked = no }
body disc { shape = rectangle 0.45 cm, 0.45 cm, 0.54 cm, 0.54 cm; spacing = d; origin = 0.5 cm, 0.5 cm
    material = D; velocity = v, 0 }
body wall { shape = rectangle 0.555 cm, 0.45 cm, 0.65 cm, 0.54 cm; spacing = d; origin = 0.601 cm, 0.5 cm
    material = W; motion = driven; velocity = -push, 0 }
probe disc { region = 0.45 cm, 0.45 cm, 0.54 cm, 0.54 cm }
probe wall { region = 0.555 cm, 0.45 cm, 0.65 cm, 0.54 cm }
output { history_every = 100 }
END
sed 's/material = W/material = D/' bounce.dm2 >uniform.dm2 # one kind of element, free and held
sed 's/motion = driven; velocity = -push, 0/motion = fixed/' bounce.dm2 >fixed.dm2
sed 's/; motion = driven; velocity = -push, 0//' bounce.dm2 >free.dm2

# leaves E WHAT OPTION...: the speed at which the disc leaves the wall, over the speed of the meeting, is
# within 0.3 %.
leaves()
{
    want=$1 what=$2
    shift 2
    expect_status 0 "$DM2_BIN/dm2-seq" "$@" -q -o run --overwrite
    awk -F, -v want="$want" -v what="$what" 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/ .*/, "", $i);
        at[$i] = i } }
        END { e = ($at["wall_vx"] - $at["disc_vx"])/0.001
              printf "%s: restitution %.5f, expected %s\n", what, e, want
              exit !(e > want*0.997 &&
                  e < want*1.003) }' run/history.csv || fail "$what: the restitution is not $want"
}

# The closed form of m x'' = -k x - c x' that never pulls, for zeta = 0.3 and 0.1.
for wall in 0.8 8 800; do
    leaves 0.4510 "wall of $wall g/cm3" bounce.dm2 -D wall=$wall
done
leaves 0.4510 pushed bounce.dm2 -D v=0 -D push=0.001
leaves 0.4510 fixed fixed.dm2 -D wall=0.8
leaves 0.4510 "one kind" uniform.dm2
leaves 0.4510 "two free discs" free.dm2
leaves 0.7441 "zeta 0.1" bounce.dm2 -D zeta=0.1 -D wall=0.8

for n in 1 2 3; do
    expect_status 0 "$DM2_BIN/dm2-client" bounce.dm2 -n $n -D zeta=0.1 -D wall=0.8 -q -o many --overwrite
    same_bytes run/final.dm2 many/final.dm2
    same_bytes run/history.csv many/history.csv
done
exit 0
