/* The inverse of the potentials: the bond length at which a bond yields. */
#include "law.h"

static double find_force(const struct pair_law *law, double x, double r0)
{
    double energy;
    return potential_force(law, x, r0, &energy);
}

/* The x with |f(x)| = cap of a Lennard-Jones potential: on the rising branch of the attraction (r0, peak), or
 * x < r0 for the repulsion. Both branches are monotonic, so bisection ends at neighbouring doubles, after at
 * most some 60 steps, which are the same on every machine. */
static double bisect_lennard_jones(const struct pair_law *law, double r0, double cap, bool tension)
{
    double near = r0, far = tension ? r0 * 0x1.1bd2ad2dcb0c6p0 : 0.25 * r0;
    if (tension && -find_force(law, far, r0) <= cap)
        return INFINITY;
    if (!tension && find_force(law, far, r0) <= cap)
        return 0.0;
    for (;;) {
        double mid = 0.5 * (near + far);
        if (mid == near || mid == far)
            return mid;
        if (fabs(find_force(law, mid, r0)) < cap)
            near = mid;
        else
            far = mid;
    }
}

double law_yield_length(const struct pair_law *law, double r0, double cap, bool tension)
{
    if (law->potential == POTENTIAL_QUADRATIC)
        return tension ? r0 + cap / law->k : r0 - cap / law->k;
    if (law->potential == POTENTIAL_LENNARD_JONES)
        return bisect_lennard_jones(law, r0, cap, tension);
    /* Morse: E^2 - E = -+q, q = cap alpha/k; no attraction exceeds q = 1/4. */
    double q = cap * law->shape / (law->k * r0);
    if (tension && q >= 0.25)
        return INFINITY;
    double e = 0.5 * (1.0 + sqrt(tension ? 1.0 - 4.0 * q : 1.0 + 4.0 * q));
    return r0 - real_log(e) * r0 / law->shape;
}
