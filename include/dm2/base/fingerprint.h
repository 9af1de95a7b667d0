/* The arithmetic fingerprint: does this machine, as compiled, compute as IEEE 754 says?
 *
 * The promise of the same bits rests on + - * / and sqrt of doubles rounding once, to nearest, with
 * subnormals and without contraction. Client and servers compare fingerprints before they compute together.
 */
#ifndef DM2_BASE_FINGERPRINT_H
#define DM2_BASE_FINGERPRINT_H

#include <stdint.h>

/* What every conforming build computes. */
#define FINGERPRINT_IEEE 0x13c92c2cc024804aU

/* Hash of the bits of some hundred results, computed now. */
uint64_t fingerprint_compute(void);

#endif
