/* A cell of another rank is mirrored where it is next to an own cell: mirrored cells are the outer boundary
 * of the paper (section 5.1), and belong to the inner boundaries of the neighbours. */
#include "cells.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"

static void number_cells(struct cells *c, const struct domain_map *map, int rank, int total)
{
    int around[8];
    for (int cell = 0; cell < total; cell++) {
        c->local_of[cell] = -1;
        c->seen_by[cell] = 0;
        int n = grid_neighbours(map->grid, cell, around);
        for (int k = 0; k < n; k++)
            c->seen_by[cell] |= map->owner[around[k]] != map->owner[cell];
        if (map->owner[cell] == rank && !c->seen_by[cell])
            c->local_of[cell] = c->n_inside++;
    }
    c->n_own = c->n_inside;
    for (int cell = 0; cell < total; cell++) {
        if (map->owner[cell] == rank && c->seen_by[cell])
            c->local_of[cell] = c->n_own++;
    }
    for (int cell = 0; cell < total; cell++) {
        if (map->owner[cell] == rank || !c->seen_by[cell])
            continue;
        int n = grid_neighbours(map->grid, cell, around), mine = 0;
        for (int k = 0; k < n; k++)
            mine |= map->owner[around[k]] == rank;
        if (mine)
            c->local_of[cell] = c->n_own + c->n_mirrored++;
    }
}

enum dm2_status cells_build(struct cells *c, const struct domain_map *map, int rank, struct dm2_error *err)
{
    int total = map->grid->cx * map->grid->cy;
    *c = (struct cells){0};
    size_t n_own = 0;
    for (int cell = 0; cell < total; cell++)
        n_own += map->owner[cell] == rank;
    enum dm2_status status =
        grid_check_memory(map->grid, CELLS_BYTES * (double)total + CELLS_OWN_BYTES * (double)n_own, err);
    if (status != DM2_OK)
        return status;
    c->local_of = mem_alloc((size_t)total, sizeof *c->local_of);
    c->seen_by = mem_alloc((size_t)total, sizeof *c->seen_by);
    if (c->local_of == NULL || c->seen_by == NULL)
        goto no_memory;
    number_cells(c, map, rank, total);
    size_t seen = (size_t)(c->n_own + c->n_mirrored);
    c->global_of = mem_alloc(seen, sizeof *c->global_of);
    c->start = mem_zalloc((size_t)c->n_own + 1, sizeof *c->start);
    c->ring_start = mem_alloc((size_t)c->n_own + 1, sizeof *c->ring_start);
    c->ring = mem_alloc((size_t)c->n_own, 8 * sizeof *c->ring);
    c->mirror_start = mem_zalloc((size_t)c->n_mirrored + 1, sizeof *c->mirror_start);
    if (c->global_of == NULL || c->start == NULL || c->ring_start == NULL || c->ring == NULL ||
        c->mirror_start == NULL)
        goto no_memory;
    for (int cell = 0; cell < total; cell++) {
        if (c->local_of[cell] >= 0)
            c->global_of[c->local_of[cell]] = cell;
    }
    uint32_t filled = 0;
    for (int own = 0; own < c->n_own; own++) {
        int around[8], n = grid_neighbours(map->grid, c->global_of[own], around);
        c->ring_start[own] = filled;
        for (int k = 0; k < n; k++) {
            int32_t local = c->local_of[around[k]];
            if (local <= own)
                continue;
            uint32_t at = filled++; /* kept ascending, so that adjacent ranges can be walked as one */
            while (at > c->ring_start[own] && c->ring[at - 1] > local) {
                c->ring[at] = c->ring[at - 1];
                at--;
            }
            c->ring[at] = local;
        }
    }
    c->ring_start[c->n_own] = filled;
    return DM2_OK;
no_memory:
    cells_free(c);
    return dm2_fail(err, DM2_MEMORY, "no memory for a grid of %d x %d cells", map->grid->cx, map->grid->cy);
}

void cells_free(struct cells *c)
{
    free(c->local_of);
    free(c->global_of);
    free(c->start);
    free(c->ring_start);
    free(c->ring);
    free(c->mirror_start);
    free(c->mirror_slot);
    free(c->seen_by);
    *c = (struct cells){0};
}

size_t cells_bytes(const struct cells *c, const struct domain_map *map)
{
    size_t total = (size_t)map->grid->cx * (size_t)map->grid->cy;
    return total * CELLS_BYTES + (size_t)c->n_own * CELLS_OWN_BYTES + (size_t)c->n_mirrored * 8 +
           c->mirror_cap * 4;
}

int cells_assign_mirrored(struct cells *c, const struct particles *p, const int32_t *cell_of)
{
    size_t count = p->n - p->n_own;
    uint32_t *slots = mem_grown(c->mirror_slot, &c->mirror_cap, 0, count, sizeof *slots);
    if (slots == NULL)
        return -1;
    c->mirror_slot = slots;
    memset(c->mirror_start, 0, ((size_t)c->n_mirrored + 1) * sizeof *c->mirror_start);
    for (size_t k = 0; k < count; k++)
        c->mirror_start[c->local_of[cell_of[k]] - c->n_own + 1]++;
    for (int cell = 0; cell < c->n_mirrored; cell++)
        c->mirror_start[cell + 1] += c->mirror_start[cell];
    /* mirror_start[cell + 1] becomes the start of `cell`, then is its cursor, and ends as the start of the
     * next cell. */
    for (int cell = c->n_mirrored; cell > 0; cell--)
        c->mirror_start[cell] = c->mirror_start[cell - 1];
    for (size_t k = 0; k < count; k++)
        c->mirror_slot[c->mirror_start[c->local_of[cell_of[k]] - c->n_own + 1]++] = (uint32_t)(p->n_own + k);
    return 0;
}
