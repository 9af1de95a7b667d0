/* Which rank owns a cell, and which ranks mirror it. */
#ifndef DM2_ENGINE_DOMAIN_MAP_H
#define DM2_ENGINE_DOMAIN_MAP_H

#include <stdint.h>

#include "dm2/base/grid.h"

/* The owner of each cell. The grid and the array are borrowed for the life of the subdomains made with the
 * map. */
struct domain_map {
    const struct grid *grid;
    int ranks;
    const uint16_t *owner; /* [global cell] a rank */
};

/* The ranks other than its owner that mirror a global cell, because they own a cell around it. Writes the
 * ranks to out and returns their number, at most 8. */
int domain_map_mirrored_by(const struct domain_map *map, int cell, uint16_t out[8]);

#endif
