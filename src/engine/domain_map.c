/* A rank mirrors a cell of another rank where it owns one of the eight cells around. */
#include "dm2/engine/domain_map.h"

int domain_map_mirrored_by(const struct domain_map *map, int cell, uint16_t out[8])
{
    int around[8], count = 0, n = grid_neighbours(map->grid, cell, around);
    for (int k = 0; k < n; k++) {
        uint16_t rank = map->owner[around[k]];
        int seen = rank == map->owner[cell];
        for (int q = 0; q < count; q++)
            seen |= out[q] == rank;
        if (!seen)
            out[count++] = rank;
    }
    return count;
}
