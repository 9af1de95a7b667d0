/* What every fuzz target has: libFuzzer's entry point, which replay.c calls as well. */
#ifndef DM2_TESTS_FUZZ_H
#define DM2_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif
