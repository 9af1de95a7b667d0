/* The arithmetic fingerprint: does this build, on this machine, compute as IEEE 754 specifies?
 *
 * The same bits on all machines need that + - * / and sqrt of doubles round once, to nearest, with subnormals
 * and without contraction. The fingerprint is a part of the one that programs compare (engine/self_test.h).
 */
#ifndef DM2_BASE_FINGERPRINT_H
#define DM2_BASE_FINGERPRINT_H

#include <stdint.h>

/* The fingerprint of every conforming build. */
#define FINGERPRINT_IEEE 0x13c92c2cc024804aU

/* The fingerprint of this build: a hash of the bits of 512 results, computed at the call. */
uint64_t fingerprint_compute(void);

#endif
