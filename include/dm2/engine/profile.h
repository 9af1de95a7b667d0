/* Profiles: means over the elements of each of a row of bins along x or y (a block `profile` of the deck).
 * The sums are exact, so that the parts of any decomposition merge to the same bits. */
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

/* What is summed over the elements whose centres lie in a bin. */
struct profile_bin {
    uint64_t elements;
    struct exact_sum mass, momentum[2]; /* g, g cm/us, at the whole step */
    struct exact_sum volume, stress[3]; /* cm3, stress times volume: Mbar cm3 */
    struct exact_sum temperature;       /* K */
};

/* The means of a bin; not numbers where nothing is in it. */
struct profile_means {
    double density;     /* mass over the bin's part of the domain, g/cm3 */
    double velocity[2]; /* of the mass, cm/us */
    double stress[3];   /* of the volume, xx yy xy, Mbar */
    double temperature; /* of the elements, K */
};

/* The bin of a coordinate; -1 where it is outside of the range. */
long profile_bin_of(const struct profile_config *c, double x);

/* The coordinate of a bin's middle, cm. */
double profile_centre(const struct profile_config *c, size_t bin);

/* Adds the owned elements to bins[0 .. c->bins). The last force evaluation measured; `step` is its step.
 * DM2_NUMERIC: a value beyond what the sums can hold, with id, step and position. */
enum dm2_status profile_add(const struct model *m, const struct particles *p, const struct profile_config *c,
                            int64_t step, struct profile_bin *bins, struct dm2_error *err);

/* Adds the sums of another part of the same step. */
void profile_merge(struct profile_bin *bins, const struct profile_bin *part, size_t n);

struct profile_means profile_means(const struct profile_bin *bin, const struct profile_config *c,
                                   const struct config *config, const struct measure_scales *scales);

#endif
