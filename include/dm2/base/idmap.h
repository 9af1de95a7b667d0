/* The paper's hash table (section 5.1) from global id to local index; its size is set at run time. */
#ifndef DM2_BASE_IDMAP_H
#define DM2_BASE_IDMAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct idmap {
    uint32_t *id;
    int32_t *index; /* -1: empty slot */
    size_t slots;   /* a power of two, at least twice the entries */
    size_t entries;
};

/* Empties *map, which is {0} or was prepared before, and makes room for `entries` entries. Returns 0, or -1
 * without memory (the map is then empty and has no room). The caller frees the map with idmap_free. */
int idmap_prepare(struct idmap *map, size_t entries);
void idmap_free(struct idmap *map);

/* Adds id -> index, index >= 0. False where the map has the id already or is full. */
bool idmap_add(struct idmap *map, uint32_t id, int32_t index);

/* The index of an id, -1 where the map does not have the id. */
int32_t idmap_find(const struct idmap *map, uint32_t id);

#endif
