/* The entry point of a fuzz target, which libFuzzer and replay.c call. */
#ifndef DM2_TESTS_FUZZ_H
#define DM2_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif
