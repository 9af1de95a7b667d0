# Every fuzz target with every seed of its corpus, each as it is and changed at random in the same ways every
# time: no crash, no finding of a sanitizer. `make fuzz` builds the same targets for libFuzzer.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"

for target in deck message session client state calibration reader; do
    expect_status 0 "$DM2_BUILD/fuzz/replay_fuzz_$target" 200 "$DM2_SRC/tests/fuzz/corpus/$target"/*
    cat out
done
