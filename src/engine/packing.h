/* Packing of a powder: the places of the discs that are its grains, or in which its grains are inscribed. */
#ifndef DM2_ENGINE_PACKING_H
#define DM2_ENGINE_PACKING_H

#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "grains.h"

/* Allocates set->grain, set->n of them, and fills centre, radius, reach, cosine and sine of each. set->wraps,
 * period and pulse are the caller's; first_grain is the global number of grain 0. DM2_DECK, with the place of
 * the solid fraction in the deck, where the powder cannot be packed so densely; DM2_MEMORY. Free with
 * grains_free, also after a failure. */
enum dm2_status packing_build(const struct body_config *body, uint32_t first_grain, struct grain_set *set,
                              struct dm2_error *err);

#endif
