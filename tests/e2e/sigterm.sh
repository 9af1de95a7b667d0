# A batch system ends a run by TERM and issues a command again: the exit status tells an interrupted run (4)
# from a failed one (1), and the same command with --restart auto goes on to the bytes of the run without a
# break.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"

cat >deck.dm2 <<'END'
let d = 0.04 cm
let speed = 0.001
domain { size = 2 cm, 2 cm; r_c = 2.5*d; delta_r = 0.25*d }
time { dt = 0.02 us; steps = 100000 }
material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489 }
body disc { shape = disc 1 cm, 1 cm, 0.2 cm; spacing = d; origin = 1 cm, 1 cm; material = Cu; jitter = speed }
END
for program in 'dm2-seq' 'dm2-client -n 2'; do
    set -- $program
    name=$DM2_BIN/$1
    shift
    rm -rf hashes run whole
    mkfifo hashes
    "$name" "$@" deck.dm2 -q -o run --hash-every 1 >hashes 2>err </dev/null & # waits for its reader
    pid=$!
    exec 4<hashes
    IFS= read -r line <&4
    kill -TERM $pid
    cat <&4 >/dev/null
    exec 4<&-
    got=0
    wait $pid || got=$?
    [ $got -eq 4 ] || fail "$program: exit status $got after TERM: $(cat err)"
    expect_text err 'the same command with --restart auto goes on'
    step=$(sed -n 's/.*interrupted by a signal at step \([0-9]*\);.*/\1/p' err)
    [ -n "$step" ] || fail "no step is told: $(cat err)"
    expect_status 1 "$name" "$@" deck.dm2 -q -o run
    expect_text err 'go on from its state with --restart auto'
    last=$((step + 50))
    expect_status 0 "$name" "$@" deck.dm2 -q -o run --steps $last --restart auto
    expect_status 0 "$DM2_BIN/dm2-seq" deck.dm2 -q -o whole --steps $last
    same_bytes whole/final.dm2 run/final.dm2
done
expect_status 1 "$DM2_BIN/dm2-seq" deck.dm2 -q -o bad -D speed=10
