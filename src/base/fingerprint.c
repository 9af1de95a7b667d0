/* Each term of the chain below shows one departure from IEEE 754 in its last bit: a fused a*b+c, a
 * reassociated sum, an x87 register, a reciprocal instead of a division, subnormals flushed to zero, another
 * rounding mode. The inputs come from an integer generator, so that no compiler can fold them away. The only
 * library functions are sqrt, floor, rint and ldexp, which are exact or rounded once. */
#include "dm2/base/fingerprint.h"

#include <math.h>
#include <string.h>

static uint64_t mix(uint64_t h, uint64_t value)
{
    h ^= value;
    h *= 0x9e3779b97f4a7c15U;
    return h ^ h >> 29;
}

static uint64_t mix_double(uint64_t h, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return mix(h, bits);
}

static double next_number(uint64_t *state)
{
    *state = *state * 6364136223846793005U + 1442695040888963407U;
    return ldexp((double)(*state >> 11), -53) + 0x1p-54;
}

uint64_t fingerprint_compute(void)
{
    volatile uint64_t seed = 20020813; /* read at run time */
    uint64_t state = seed, h = 0;
    for (int k = 0; k < 64; k++) {
        double a = next_number(&state), b = next_number(&state), c = next_number(&state);
        h = mix_double(h, a * b - c);           /* not contracted */
        h = mix_double(h, (a + b) + c);         /* in this order */
        h = mix_double(h, a / b);               /* a division, not a reciprocal */
        h = mix_double(h, sqrt(a * a + b * b)); /* rounded once */
        h = mix_double(h, (a * 0x1p-1030) * b); /* a subnormal */
        h = mix_double(h, (1e16 + 1e3 * a) - 1e16);
        h = mix_double(h, rint(1e6 * a) - floor(1e6 * b)); /* ties and rounding mode */
        h = mix(h, (uint64_t)(int64_t)((a - b) * 0x1p52));
    }
    return h;
}
