/* Profiles: means over the elements of each bin of a row of bins along x or y (a block `profile` of the
 * deck). The sums are exact, so that the parts of any decomposition merge to the same bits. */
#ifndef DM2_ENGINE_PROFILE_H
#define DM2_ENGINE_PROFILE_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/exact.h"
#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "dm2/engine/measures.h"

struct model;
struct particles;

/* Sums over the elements whose centres lie in one bin. */
struct profile_bin {
    uint64_t elements;
    struct exact_sum mass, momentum[2]; /* g, g cm/us, at the whole step */
    struct exact_sum volume, stress[3]; /* cm3, stress times volume: Mbar cm3 */
    struct exact_sum temperature;       /* K */
    struct exact_sum area;              /* of the discs, cm2 */
};

/* The means of one bin; NaN, but for density and porosity, where the bin has no element. */
struct profile_means {
    double density;     /* mass over the volume of the bin, which spans the domain, g/cm3 */
    double porosity;    /* 1 - area of the discs over that of the bin, which spans the domain */
    double velocity[2]; /* weighted by mass, cm/us */
    double stress[3];   /* weighted by volume, xx yy xy, Mbar */
    double temperature; /* mean over the elements, K */
};

/* The bin of a coordinate x, cm; -1 where x is outside the range. */
long profile_bin_of(const struct profile_config *c, double x);

/* The coordinate of the middle of a bin, cm. */
double profile_centre(const struct profile_config *c, size_t bin);

/* Adds the owned elements of *p to bins[0 .. c->bins). The last force evaluation was a measuring one, that of
 * `step`. DM2_NUMERIC, with id, step and position, where the value of an element is beyond the range of the
 * sums. */
enum dm2_status profile_add(const struct model *m, const struct particles *p, const struct profile_config *c,
                            int64_t step, struct profile_bin *bins, struct dm2_error *err);

/* Adds to bins[0 .. n) the sums of another part of the system at the same step. */
void profile_merge(struct profile_bin *bins, const struct profile_bin *part, size_t n);

/* The means of *bin, one bin of the profile *c. `scales` are model_scales of the deck's model. */
struct profile_means profile_means(const struct profile_bin *bin, const struct profile_config *c,
                                   const struct config *config, const struct measure_scales *scales);

#endif
