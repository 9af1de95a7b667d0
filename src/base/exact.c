/* The value of an exact sum: sign and magnitude of the two limbs. */
#include "dm2/base/exact.h"

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
