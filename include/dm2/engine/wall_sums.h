/* What a wall feels at one evaluation. The sums are exact, so that the parts of any decomposition merge to
 * the same bits. */
#ifndef DM2_ENGINE_WALL_SUMS_H
#define DM2_ENGINE_WALL_SUMS_H

#include <stdint.h>

#include "dm2/base/exact.h"

/* Over the contacts of one wall, each counted with the sign of its feature. */
struct wall_sums {
    struct exact_sum force[2]; /* on the wall, in units of the fixed-point sums: the elements' integers with
                                  the opposite sign */
    struct exact_sum torque;   /* on the wall about its present centre; shift: measure_scales.energy */
    struct exact_sum heat;     /* conducted into the elements per time; same shift */
    int64_t contacts;
};

/* Adds to *into the sums of another part of the system at the same step. */
void wall_sums_merge(struct wall_sums *into, const struct wall_sums *part);

#endif
