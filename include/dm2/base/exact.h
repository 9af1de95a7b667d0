/* Exact sums: 128-bit fixed point in two limbs with a carry, so that the order and the grouping of the terms
 * do not matter.
 *
 * A term `value` counts as value * 2^shift rounded down to an integer; |value * 2^shift| must stay below
 * 2^120. In units of the quantum 2^-shift, all sums of the same terms have the same bits. */
#ifndef DM2_BASE_EXACT_H
#define DM2_BASE_EXACT_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/real.h"

struct exact_sum {
    int64_t hi;
    uint64_t lo; /* the number is hi * 2^64 + lo, in quanta */
};

/* Adds *other, a sum of the same shift, to *sum. */
static inline void exact_merge(struct exact_sum *sum, const struct exact_sum *other)
{
    uint64_t low = sum->lo + other->lo;
    uint64_t carry = low < other->lo ? 1u : 0u;
    sum->hi = (int64_t)((uint64_t)sum->hi + (uint64_t)other->hi + carry);
    sum->lo = low;
}

/* Adds value * 2^shift, 64 - 1022 <= shift <= 64 + 1023. False, and *sum unchanged, where value is not finite
 * or too large. Inline and without a branch on the sign, because a measuring step adds some ten values per
 * element. */
static inline bool exact_add(struct exact_sum *sum, double value, int shift)
{
    double scaled = value * real_pow2(shift - 64); /* in units of 2^64 quanta; exact but for underflow */
    if (scaled == 0.0)
        return true;
    if (!(fabs(scaled) < 0x1p56))
        return false;
    int64_t hi = (int64_t)scaled; /* towards zero */
    /* The magnitude of the fraction in quanta, 32 bits at a time, every step exact. The magnitude of a
     * negative fraction is rounded up, to less than 2^64, because the fraction has 53 bits. */
    double rest = scaled - (double)hi, upper = fabs(rest) * 0x1p32;
    int64_t a = (int64_t)upper;
    double lower = (upper - (double)a) * 0x1p32;
    int64_t b = (int64_t)lower;
    uint64_t minus = rest < 0.0;
    uint64_t lo = ((uint64_t)a << 32) + (uint64_t)b + (minus & ((double)b < lower));
    struct exact_sum term = {.hi = hi - (int64_t)(minus & (lo != 0)), .lo = (lo ^ (0 - minus)) + minus};
    exact_merge(sum, &term);
    return true;
}

/* Adds units * 2^left quanta exactly, 0 <= left < 63. */
static inline void exact_add_units(struct exact_sum *sum, int64_t units, int left)
{
    uint64_t bits = (uint64_t)units;
    uint64_t sign = units < 0 ? ~(uint64_t)0 : 0;
    struct exact_sum term = {.hi = (int64_t)(left == 0 ? sign : (sign << left) | (bits >> (64 - left))),
                             .lo = bits << left};
    exact_merge(sum, &term);
}

/* The sum as a double, after at most three roundings: a function of the bits of *sum, within a relative 2^-51
 * of the exact value. */
double exact_value(const struct exact_sum *sum, int shift);

#endif
