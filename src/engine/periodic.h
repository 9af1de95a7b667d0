/* Differences of positions across periodic sides. */
#ifndef DM2_ENGINE_PERIODIC_H
#define DM2_ENGINE_PERIODIC_H

#include <math.h>

#include "dm2/base/grid.h"
#include "dm2/base/simd.h"

/* The sides of the domain, x and y, in cm; half of a side that is not periodic is infinite. */
struct period {
    double size[2], half[2];
};

static inline struct period period_of(const struct grid *grid)
{
    struct period p;
    for (int a = 0; a < 2; a++) {
        p.size[a] = grid->size[a];
        p.half[a] = grid->periodic[a] ? 0.5 * grid->size[a] : INFINITY;
    }
    return p;
}

/* The shortest difference along one side; antisymmetric bit for bit. */
static inline double period_nearest(double d, double size, double half)
{
    return d > half ? d - size : d < -half ? d + size : d;
}

/* The same in each lane of *d. */
DM2_INLINE void lanes_nearest(simd_real *d, double size, double half)
{
    const simd_real zero = {0.0}, sizes = zero + size, halves = zero + half;
    *d = *d - SIMD_CHOOSE(*d > halves, sizes, zero) + SIMD_CHOOSE(*d < -halves, sizes, zero);
}

#endif
