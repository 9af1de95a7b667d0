/* Scales of the fixed-point sums, and the ranges in which the values of those sums stay. */
#ifndef DM2_ENGINE_SCALES_H
#define DM2_ENGINE_SCALES_H

#include "tables.h"

/* Fills m->fixed, m->scales, m->reaction.mass_scale and m->far_place. Needs laws, far_cutoff, radius_max and
 * n_elements. */
void scales_choose(struct model *m);

/* Fills r2_least of every law. Needs m->fixed. */
void scales_find_far_ranges(struct model *m);

#endif
