/* The sizes of a powder's grains: how many there are, and their radii, so that the elements have the mass
 * that the deck asks for. */
#ifndef DM2_ENGINE_GRAIN_SIZES_H
#define DM2_ENGINE_GRAIN_SIZES_H

#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "grains.h"

/* Allocates set->grain, set->n of them, and fills radius, reach, cosine and sine of each. The sum of the
 * elements' lattice cells is solid_fraction times the area of the shape, to half an element per grain at
 * worst. first_grain is the global number of grain 0. DM2_DECK, with the place of the solid fraction in the
 * deck, where the circles of the grains, packed as densely as possible, would not fit; DM2_MEMORY. Free with
 * grains_free, also after a failure. */
enum dm2_status grain_sizes_choose(const struct body_config *body, uint32_t first_grain,
                                   struct grain_set *set, struct dm2_error *err);

/* The solid fraction that random packing reaches with these grains, rounded down to 0.01, and less
 * than what the deck asks for: circles at random take 0.82 of the area, and the elements a part of them. */
double grain_sizes_reachable(const struct body_config *body, uint32_t first_grain,
                             const struct grain_set *set);

/* The 5 to 8 corners of polygon grain `grain` (a global number), counter-clockwise on the unit circle about
 * its centre, each near its place in a regular polygon. */
void grain_sizes_corners(const struct body_config *body, uint32_t grain, struct polygon *out);

#endif
