/* Exact sums: 128-bit fixed point, so that the order and the grouping of the terms never matter.
 *
 * A term `value` counts as value * 2^shift rounded to an integer; |value * 2^shift| must stay below
 * 2^120. With 2^-shift as the quantum, every sum of the same terms has the same bits whoever adds them. */
#ifndef DM2_BASE_EXACT_H
#define DM2_BASE_EXACT_H

#include <stdbool.h>
#include <stdint.h>

struct exact_sum {
    int64_t hi;
    uint64_t lo; /* the number is hi * 2^64 + lo, in quanta */
};

/* Adds value * 2^shift. False, and *sum unchanged, where value is not finite or too large. */
bool exact_add(struct exact_sum *sum, double value, int shift);

/* Adds another sum of the same shift. */
void exact_merge(struct exact_sum *sum, const struct exact_sum *other);

/* The sum as a double (three roundings at most): the same
 * for the same bits of *sum, within 2^-51 of the exact value. */
double exact_value(const struct exact_sum *sum, int shift);

#endif
