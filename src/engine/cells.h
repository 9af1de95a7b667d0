/* The own and the mirrored cells of one subdomain, with their elements and the cells around them.
 *
 * Local numbers: own cells without a mirrored cell around are 0 .. n_inside-1, own cells at the edge
 * n_inside .. n_own-1, mirrored cells n_own .. n_own+n_mirrored-1; each group is in the order of the global
 * numbers (row by row). Owned elements are kept in cell order, so that an own cell is a range of slots, as
 * are all inside cells together; a mirrored cell has a list of slots. */
#ifndef DM2_ENGINE_CELLS_H
#define DM2_ENGINE_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/domain_map.h"
#include "dm2/engine/subdomain.h"
#include "particles.h"

struct cells {
    int n_inside, n_own, n_mirrored;
    int32_t *local_of;    /* [global cell] local number, -1: neither own nor mirrored */
    int32_t *global_of;   /* [n_own + n_mirrored] global number of a local cell */
    uint32_t *start;      /* [n_own + 1]: own cell c holds slots start[c] .. start[c+1]-1 */
    uint32_t *ring_start; /* [n_own + 1] into ring */
    int32_t *ring;        /* per own cell, ascending: own cells around with higher numbers, all mirrored cells
                             around */
    uint32_t *mirror_start; /* [n_mirrored + 1] into mirror_slot */
    uint32_t *mirror_slot;  /* slots of mirrored elements, by mirrored cell */
    size_t mirror_cap;
    uint8_t *seen_by; /* [global cell] 1: a rank other than the owner mirrors the cell */
};

/* Memory for a cell of the grid, and more for a cell that is own, bytes. */
enum { CELLS_BYTES = 5, CELLS_OWN_BYTES = SUBDOMAIN_CELL_BYTES - CELLS_BYTES };

/* Finds the cells that `rank` owns and mirrors, all of them empty. DM2_MEMORY, before any memory is taken
 * where this process may not have as much. */
enum dm2_status cells_build(struct cells *cells, const struct domain_map *map, int rank,
                            struct dm2_error *err);
void cells_free(struct cells *cells);
size_t cells_bytes(const struct cells *cells, const struct domain_map *map); /* memory held */

/* Sorts the mirrored elements, slots [n_own, n), into mirrored cells; cell_of[k] is the global cell of slot
 * n_own + k, which this subdomain must mirror. 0, or -1 without memory. */
int cells_assign_mirrored(struct cells *cells, const struct particles *p, const int32_t *cell_of);

#endif
