/* Exact sums in 128 bits, in plain C11: two limbs and a carry. */
#include "dm2/base/exact.h"

#include <math.h>

static void add_limbs(struct exact_sum *sum, int64_t hi, uint64_t lo)
{
    uint64_t low = sum->lo + lo;
    uint64_t carry = low < lo ? 1u : 0u;
    sum->hi = (int64_t)((uint64_t)sum->hi + (uint64_t)hi + carry);
    sum->lo = low;
}

bool exact_add(struct exact_sum *sum, double value, int shift)
{
    double scaled = rint(ldexp(value, shift));
    if (!(fabs(scaled) < 0x1p120))
        return false;
    /* Both parts are exact: the multiple of 2^64 in the magnitude, and what is left, which is below 2^64. */
    double magnitude = fabs(scaled);
    double high = floor(magnitude * 0x1p-64);
    uint64_t hi = (uint64_t)high, lo = (uint64_t)(magnitude - high * 0x1p64);
    if (scaled < 0.0) {
        lo = ~lo + 1u;
        hi = ~hi + (lo == 0 ? 1u : 0u);
    }
    add_limbs(sum, (int64_t)hi, lo);
    return true;
}

void exact_merge(struct exact_sum *sum, const struct exact_sum *other)
{
    add_limbs(sum, other->hi, other->lo);
}

double exact_value(const struct exact_sum *sum, int shift)
{
    uint64_t hi = (uint64_t)sum->hi, lo = sum->lo;
    bool negative = sum->hi < 0;
    if (negative) {
        lo = ~lo + 1u;
        hi = ~hi + (lo == 0 ? 1u : 0u);
    }
    double magnitude = (double)hi * 0x1p64 + (double)lo;
    return ldexp(negative ? -magnitude : magnitude, -shift);
}
