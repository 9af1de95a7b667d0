# A run begins from the state of another deck: `start { state = FILE }` and --start.
#
# A stage begun from the state of 5 servers on 3 servers has the bytes of one process. A stage that keeps time
# and changes nothing goes on to the same hashes and rows. A stage goes on with --restart auto. Each mistake
# is told at its line.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
seq=$DM2_BIN/dm2-seq
client=$DM2_BIN/dm2-client

cat >common.dm2 <<'END'
domain { size = 2 1.6; boundary = periodic free; r_c = 0.125; delta_r = 0.0125; gravity = 0 -0.0005 }
material Cu { rho0 = 8.93; c0 = 0.394; s = 1.489; shear = 0.477; yield = 0.0012; cp = 3.8e-6; t0 = 300 }
interaction { zeta = 0.1; mu = 0.2 }
output { history_every = 10; checkpoint_every = 20; strain = yes }
wall floor { line = 0.2 0.15 1.8 0.15; material = Cu }
probe face { region = 0.9 0 1 1.6 }
END
cat >one.dm2 <<'END'
include "common.dm2"
time { dt = 0.02; steps = 40 }
body left { shape = disc 0.6 0.8 0.35; spacing = 0.05; material = Cu; velocity = 0.02 0 }
body plug { shape = disc 0.9 0.25 0.1; spacing = 0.05; material = Cu; velocity = 0 -0.01 }
body right { shape = disc 1.34 0.8 0.35; spacing = 0.05; material = Cu; motion = driven; velocity = -0.02 0 }
END
expect_status 0 "$seq" one.dm2 -q -o one
expect_status 0 "$client" one.dm2 -n 5 -q -o five
same_bytes one/final.dm2 five/final.dm2

# --- nothing changes ---
cat >same.dm2 <<'END'
include "common.dm2"
time { dt = 0.02; steps = 80 }
start { state = "five/final.dm2"; time = keep }
body left { from = state }
body plug { from = state }
body right { from = state }
END
expect_status 0 "$seq" one.dm2 --steps 80 -q -o straight --hash-every 20
grep -E 'step (4|6|8)0 ' out >hashes
rows() { awk -F, -v OFS=, '$1 + 0 >= 40 { $20 = ""; print }' "$1/history.csv"; } # all columns but drift
head -1 straight/history.csv | cut -d, -f20 | grep -q '^drift$' || fail 'column 20 is not drift'
for run in "$seq" "$client -n 3"; do
    # shellcheck disable=SC2086 # a program and its options
    expect_status 0 $run same.dm2 -q -o same --overwrite --hash-every 20
    cmp out hashes || fail "$run: not the hashes of the run that goes on"
    rows straight >want
    rows same >got
    cmp want got || fail "$run: not the rows of the run that goes on"
done

# --- another deck: bodies in another order, one left out, one that is new and falls on the others ---
cat >two.dm2 <<'END'
include "common.dm2"
time { dt = 0.01; steps = 120 }
start { state = "five/final.dm2"; without = left }
material tin { rho0 = 7.3; c0 = 0.25; s = 1.4; cp = 2.3e-6 }
interaction tin Cu { mu = 0.4 }
body right { from = state; motion = driven; velocity = -0.01 0 }
body cap { shape = disc 0.86 0.44 0.06; spacing = 0.04; material = tin; velocity = 0 -0.01 }
body plug { from = state }
probe felt { body = plug }
END
expect_status 0 "$seq" two.dm2 -q -o two
expect_status 0 "$client" two.dm2 -n 3 -q -o two3
same_bytes two/final.dm2 two3/final.dm2
same_bytes two/history.csv two3/history.csv
grep -q "^# begun from the state five/final.dm2, SHA-256 [0-9a-f]*: give it with --start" two/deck.dm2 ||
    fail 'deck.dm2 does not name its state'
grep -q '^from: the state five/final.dm2, SHA-256' two/run.log || fail 'run.log does not name the state'
links=$(awk -F, 'END { print $15 }' two/history.csv)
[ "$links" -gt 100 ] || fail "only $links links"

# deck.dm2 gives the same bytes elsewhere, with the state named
mkdir elsewhere
cp two/deck.dm2 elsewhere
expect_status 0 "$seq" elsewhere/deck.dm2 --start one/final.dm2 -q -o again
same_bytes two/final.dm2 again/final.dm2
expect_status 2 "$seq" elsewhere/deck.dm2 -q -o again --overwrite
expect_text err 'elsewhere/five/final.dm2'
expect_text err '--start FILE names another place'

# a stage goes on from its checkpoint, and begins another one
rm -rf cut && cp -R two cut && rm cut/final.dm2
expect_status 0 "$client" two.dm2 -n 2 --restart auto -q -o cut
same_bytes two/final.dm2 cut/final.dm2
same_bytes two/history.csv cut/history.csv
cat >three.dm2 <<'END'
include "common.dm2"
time { dt = 0.01; steps = 20 }
start { velocity = zero; links = none }
material tin { rho0 = 7.3; c0 = 0.25; s = 1.4; cp = 2.3e-6 }
body plug { from = state }
body right { from = state; motion = fixed }
body cap { from = state; velocity = 0 0.03 }
END
expect_status 0 "$seq" three.dm2 --start two/final.dm2 -q -o three
expect_status 0 "$client" three.dm2 -n 2 --start two3/final.dm2 -q -o three2
same_bytes three/final.dm2 three2/final.dm2
awk -F, 'NR == 2 && ($15 != 0 || $1 != 0) { exit 1 }' three/history.csv ||
    fail 'there are links, or no row of step 0'

# --- mistakes ---
refused() # LINES TEXT: the deck of stdin is refused with a text
{
    cat >bad.dm2
    expect_status 2 "$seq" bad.dm2 -q -o bad --check
    expect_text err "$1"
}
body='from = state'
refused 'bad.dm2:3:1: error: the state has body plug: take it with `body plug { from = state }`' <<END
include "common.dm2"
time { dt = 0.01; steps = 20 }
start { state = "five/final.dm2" }
body left { $body }
body right { $body }
END
refused "bad.dm2:4:19: error: the state has no body 'lid'; it has left, plug, right" <<END
include "common.dm2"
time { dt = 0.01; steps = 20 }
start { state = "five/final.dm2"; without = left, plug, right }
body lid { from = state }
END
refused "bad.dm2:4:37: error: the elements of 'left' are there already" <<END
include "common.dm2"
time { dt = 0.01; steps = 20 }
start { state = "five/final.dm2"; without = plug, right }
body left { from = state; spacing = 0.05 }
END
refused "bad.dm2:3:45: error: the state has no body and no wall 'lid'" <<END
include "common.dm2"
time { dt = 0.01; steps = 20 }
start { state = "five/final.dm2"; without = lid, plug, right }
body left { from = state }
END
refused "new elements are pressed into elements of the state; the deepest, element" <<END
include "common.dm2"
time { dt = 0.01; steps = 20 }
start { state = "five/final.dm2"; without = plug, right }
body left { from = state }
body new { shape = disc 0.9 0.9 0.1; spacing = 0.03; material = Cu }
END
refused "bad.dm2:3:20: error: there is no state to take 'left' from: name one by a block" <<END
include "common.dm2"
time { dt = 0.01; steps = 20 }
body left { from = state }
END
refused "bad.dm2:2:27: error: the run begins with step 40 of its state" <<END
include "common.dm2"
time { dt = 0.01; steps = 20 }
start { state = "five/final.dm2"; without = plug, right; time = keep }
body left { from = state }
END
refused "five/nothing.dm2: cannot open" <<END
include "common.dm2"
time { dt = 0.01; steps = 20 }
start { state = "five/nothing.dm2" }
body left { from = state }
END
refused 'a file beside or below the deck is expected' <<END
include "common.dm2"
time { dt = 0.01; steps = 20 }
start { state = "../five/final.dm2" }
body left { from = state }
END
sed -e 's/8.93/8.94/' -e 's/periodic free/free free/' -e 's/^wall.*//' common.dm2 >other.dm2
refused "'rho0' of 'Cu' was 8.93 in the state, is 8.94: elements that are there keep it" <<END
include "other.dm2"
time { dt = 0.01; steps = 20 }
start { state = "five/final.dm2"; without = plug, right }
body left { from = state }
END
expect_text err 'the domain of the state is periodic in x'
expect_text err 'the state has wall floor: give it in a block'
expect_status 2 "$seq" two.dm2 -q -o one --restart auto
expect_text err 'to go on from this state with another deck: `start { state = ... }`'
