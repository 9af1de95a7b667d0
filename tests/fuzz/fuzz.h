/* The entry point of a fuzz target, which libFuzzer and replay.c call. */
#ifndef DM2_TESTS_FUZZ_H
#define DM2_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "dm2/base/fingerprint.h"
#include "dm2/engine/self_test.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Inputs have FINGERPRINT_IEEE where the fingerprint of the release is due, so that they do not age. */
static inline void fuzz_renew_fingerprint(unsigned char bytes[8])
{
    const uint64_t now = SELF_TEST_FINGERPRINT;
    uint64_t there = 0;
    for (int k = 0; k < 8; k++)
        there |= (uint64_t)bytes[k] << 8 * k;
    for (int k = 0; k < 8 && there == FINGERPRINT_IEEE; k++)
        bytes[k] = (unsigned char)(now >> 8 * k);
}

#endif
