/* Open addressing with linear probing. The table is at most half full, so that a search ends after a few
 * slots. */
#include "dm2/base/idmap.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"

int idmap_prepare(struct idmap *map, size_t entries)
{
    size_t slots = 16;
    while (slots / 2 < entries && slots <= SIZE_MAX / 4)
        slots *= 2;
    if (slots != map->slots) {
        idmap_free(map);
        map->id = mem_alloc(slots, sizeof *map->id);
        map->index = mem_alloc(slots, sizeof *map->index);
        if (map->id == NULL || map->index == NULL) {
            idmap_free(map);
            return -1;
        }
        map->slots = slots;
    }
    map->entries = 0;
    memset(map->index, 0xff, slots * sizeof *map->index);
    return 0;
}

void idmap_free(struct idmap *map)
{
    free(map->id);
    free(map->index);
    *map = (struct idmap){0};
}

static size_t slot_of(const struct idmap *map, uint32_t id)
{
    uint64_t h = (uint64_t)id * 0x9e3779b97f4a7c15u;
    size_t at = (size_t)(h >> 32) & (map->slots - 1);
    while (map->index[at] >= 0 && map->id[at] != id)
        at = (at + 1) & (map->slots - 1);
    return at;
}

bool idmap_add(struct idmap *map, uint32_t id, int32_t index)
{
    if (map->slots == 0 || map->entries >= map->slots / 2)
        return false;
    size_t at = slot_of(map, id);
    if (map->index[at] >= 0)
        return false;
    map->id[at] = id;
    map->index[at] = index;
    map->entries++;
    return true;
}

int32_t idmap_find(const struct idmap *map, uint32_t id)
{
    return map->slots == 0 ? -1 : map->index[slot_of(map, id)];
}
