/* Mass and first moments of a body, exact, so that the centroid does not depend on the order of the elements.
 */
#ifndef DM2_ENGINE_MOMENTS_H
#define DM2_ENGINE_MOMENTS_H

#include "dm2/base/exact.h"
#include "dm2/deck/config.h"

struct moments {
    struct exact_sum mass, moment[2];
    int shift[2]; /* of the mass, of the moments */
};

/* Empty sums for a body of a config whose first element has this mass, g. */
void moments_start(struct moments *m, const struct config *c, double mass);

/* Adds an element at r, not wrapped, cm. */
void moments_add(struct moments *m, double mass, const double r[2]);

/* The centre of mass of what was added, cm; the mass, g. */
void moments_centroid(const struct moments *m, double out[2]);
double moments_mass(const struct moments *m);

#endif
