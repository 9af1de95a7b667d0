#!/bin/sh
# Runs through faults drawn from seeds (tests/tools/faults.c), in a directory of its own. `make soak` calls
# it:
#
#     sh tests/soak.sh [-s SEED] [-n FAULTS] [-t TIMEOUT]
#
# SEED is the first (1), FAULTS how many are to happen (500), TIMEOUT the client's patience in seconds (1.5;
# with the sanitizers 5). The files of failed runs stay in the directory that is named at the end.
# Environment: DM2_BIN, DM2_BUILD, DM2_SRC, FLAVOUR.
set -eu

seed=1 faults=500 timeout=1.5
[ "${FLAVOUR:-release}" = release ] || timeout=5
while getopts s:n:t: option; do
    case $option in
    s) seed=$OPTARG ;;
    n) faults=$OPTARG ;;
    t) timeout=$OPTARG ;;
    *)
        echo 'usage: sh tests/soak.sh [-s SEED] [-n FAULTS] [-t TIMEOUT]' >&2
        exit 2
        ;;
    esac
done

# Leaks are valgrind's part; a sanitizer's report must not look like an error of the program's own.
ASAN_OPTIONS=detect_leaks=0:exitcode=99
UBSAN_OPTIONS=exitcode=99
export ASAN_OPTIONS UBSAN_OPTIONS

directory=$(mktemp -d "${TMPDIR:-/tmp}/dm2-soak.XXXXXX")
cd "$directory"
sed 's/let steps = 400/let steps = 90/; s/output {/output { snapshot_every = 25; strain = yes;/' \
    "$DM2_SRC/tests/decks/good/scatter.dm2" >deck.dm2
echo 'profile across { axis = x; bins = 4; every = 20 }' >>deck.dm2
"$DM2_BIN/dm2-seq" deck.dm2 -q -o whole
(cd whole && find . -type f ! -name run.log ! -name timing.csv) >results
"$DM2_BIN/dm2-server" --new-key key >/dev/null
if "$DM2_BUILD/tools/faults" "$seed" $((3 * faults)) "$faults" "$timeout"; then
    rm -rf "$directory"
    exit 0
fi
echo "what failed is in $directory"
exit 1
