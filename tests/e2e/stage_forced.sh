# A sheared stage begun from a pressed one: bodies under force and after a table of velocities keep their
# place and speed, whatever the number of servers, from a restart too.
# labels: e2e bits
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client

cat >pack.dm2 <<'END'
let d = 0.02
let width = 24 * d
let top = 12 * d
let load = -0.0005 Mbar
domain { size = width, top + 4*d; boundary = periodic free; r_c = 1.3*d; delta_r = 0.3*d }
time { dt = 0.006 us; steps = 300 }
material al { rho0 = 2.7; c0 = 0.534; s = 1.34; cp = 9e-6 }
interaction { zeta = 0.2; ct_ratio = 0.05; mu = 0.5; linked = no }
body floor { shape = rectangle 0, d, width, 2*d; lattice = square; spacing = width/16; radius = d/2
             origin = d/2, 1.5*d; material = al; motion = fixed }
body lid { shape = rectangle 0, top, width, top + d; lattice = square; spacing = width/16; radius = d/2
           origin = d/2, top + 0.5*d; material = al; motion = driven; velocity = 0.002, 0 }
body grains { shape = rectangle 0, 2*d, width, top; structure = discs; grain_size = 1.001*d
              solid_fraction = 0.75; spacing = d; material = al; seed = 2; jitter = 0.005 }
load press { body = lid; stress_yy = 0 us, load, 3 us, 2*load; max_velocity = 0.003 }
output { history_every = 50 }
END
cat >shear.dm2 <<'END'
let d = 0.02
let width = 24 * d
let top = 12 * d
let load = -0.001 Mbar
domain { size = width, top + 4*d; boundary = periodic free; r_c = 1.3*d; delta_r = 0.3*d }
time { dt = 0.005 us; steps = 300 }
start { state = "pack.run/final.dm2" }
material al { rho0 = 2.7; c0 = 0.534; s = 1.34; cp = 9e-6 }
interaction { zeta = 0.2; ct_ratio = 0.05; mu = 0.5; linked = no }
body grains { from = state }
body floor { from = state; motion = driven }
body lid { from = state; velocity = 0.004 0 }
load press { body = lid; stress_yy = 0 us, load, 3 us, load; max_velocity = 0.003 }
load slide { body = floor; velocity_x = 0 0, 1 -0.002, 2 -0.002 }
probe top { body = lid }
probe mid { region = 0, 4*d, width, 8*d }
output { history_every = 50; checkpoint_every = 100 }
END
expect_status 0 "$seq" pack.dm2 -q
expect_status 0 "$client" pack.dm2 -n 5 -q -o five
same_bytes pack.run/final.dm2 five/final.dm2
expect_status 0 "$seq" shear.dm2 -q -o whole
expect_status 0 "$client" shear.dm2 -n 3 -q -o three --start five/final.dm2
same_bytes whole/final.dm2 three/final.dm2
same_bytes whole/history.csv three/history.csv
cp -R whole cut
rm cut/final.dm2
expect_status 0 "$client" shear.dm2 -n 2 -q -o cut --restart auto
same_bytes whole/final.dm2 cut/final.dm2

# The lid begins where and as fast as it was: its row of step 0 is near the last one of the run before.
column() # FILE NAME ROW: the value of a column, ROW in awk's numbers
{
    awk -F, -v name="$2" -v row="$3" '
        NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ name) k = i }
        NR == row { print $k }' "$1"
}
sed -e '/^output/d' pack.dm2 >probed.dm2
printf 'probe top { body = lid }\noutput { history_every = 50 }\n' >>probed.dm2
expect_status 0 "$seq" probed.dm2 -q
for name in top_y top_fy; do
    was=$(column probed.run/history.csv "^$name" 8)
    is=$(column whole/history.csv "^$name" 2)
    [ "$was" = "$is" ] || fail "$name was $was at the end, is $is at the start"
done

# The packed grains become a rock: no link has a force at first, and then the rock stays as it is.
sed -e 's/start {.*/start { state = "pack.run\/final.dm2"; without = lid; velocity = zero; links = form }/' \
    -e '/^body lid/d' -e '/^load/d' -e '/^probe top/d' -e 's/velocity = 0.004 0//' shear.dm2 >rock.dm2
printf 'interface grain { linked = yes }\ninterface body { linked = yes }\n' >>rock.dm2
expect_status 0 "$seq" rock.dm2 -q
expect_status 0 "$client" rock.dm2 -n 3 -q -o rock3
same_bytes rock.run/final.dm2 rock3/final.dm2
links=$(column rock.run/history.csv '^links' 2)
[ "$links" -gt 150 ] || fail "only $links links formed"
awk -F, 'NR == 2 { exit !($3 == 0 && $4 < 1e-20 && $5 == 0) }' rock.run/history.csv ||
    fail 'the rock begins with a force'
