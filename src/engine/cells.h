/* The cells that one subdomain sees: its own and those it mirrors, with who is in them and who is around
 * them.
 *
 * Local numbering, each in the order of the global numbers (row by row): own cells that no mirrored cell
 * surrounds, 0 .. n_inside-1, own cells at the edge up to n_own-1, then the mirrored ones. Owned elements are
 * kept in cell order, so an own cell is a range of slots, and so is the inside; a mirrored cell has a list.
 */
#ifndef DM2_ENGINE_CELLS_H
#define DM2_ENGINE_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/domain_map.h"
#include "particles.h"

struct cells {
    int n_inside, n_own, n_mirrored;
    int32_t *local_of;    /* [global cell] local number, -1: not seen from here */
    int32_t *global_of;   /* [n_own + n_mirrored] */
    uint32_t *start;      /* [n_own + 1]: own cell c holds slots start[c] .. start[c+1]-1 */
    uint32_t *ring_start; /* [n_own + 1] into ring */
    int32_t
        *ring; /* per own cell: the later own cells around it, ascending, and all mirrored ones around it */
    uint32_t *mirror_start; /* [n_mirrored + 1] into mirror_slot */
    uint32_t *mirror_slot;  /* slots of mirrored elements, by mirrored cell */
    size_t mirror_cap;
    uint8_t *seen_by; /* [global cell] 1: some other rank than its owner mirrors it */
};

/* The static part: which cells `rank` owns and mirrors. */
enum dm2_status cells_build(struct cells *cells, const struct domain_map *map, int rank,
                            struct dm2_error *err);
void cells_free(struct cells *cells);
size_t cells_bytes(const struct cells *cells, const struct domain_map *map);

/* Sorts the mirrored elements, slots [n_own, n), into mirrored cells; cell_of[k] is the global cell of slot
 * n_own + k, all mirrored here. 0, or -1 without memory. */
int cells_assign_mirrored(struct cells *cells, const struct particles *p, const int32_t *cell_of);

#endif
