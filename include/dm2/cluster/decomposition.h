/* The spatial decomposition: which rank owns which cell of the grid (paper, sections 5 and 6.2, Figs 6 and
 * 9).
 *
 * The grid is bisected recursively into one rectangle of cells per rank. Pure: no sockets, no particles. */
#ifndef DM2_CLUSTER_DECOMPOSITION_H
#define DM2_CLUSTER_DECOMPOSITION_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/bisect.h"
#include "dm2/base/grid.h"
#include "dm2/base/status.h"

enum { DECOMPOSITION_RANKS_MAX = BISECT_PARTS_MAX };

/* The eight-element array of a rank: sides first, then corners. */
enum side {
    SIDE_WEST,
    SIDE_EAST,
    SIDE_SOUTH,
    SIDE_NORTH,
    CORNER_SOUTH_WEST,
    CORNER_SOUTH_EAST,
    CORNER_NORTH_WEST,
    CORNER_NORTH_EAST,
    SIDE_COUNT
};

struct decomposition {
    struct grid grid;
    int ranks;
    struct cell_rect *rect; /* per rank */
    uint16_t *owner;        /* per cell; the engine's struct domain_map borrows it */
};

/* Bisects the grid for `ranks` ranks as bisect_grid does: by cells, or with `weights` (elements per cell) not
 * NULL by weight. DM2_USAGE: fewer cells than ranks (both numbers are named), or ranks outside 1..65535.
 * DM2_MEMORY. */
enum dm2_status decomposition_bisect(const struct grid *grid, int ranks, const uint32_t *weights,
                                     struct decomposition *out, struct dm2_error *err);

/* From the rectangles that another program sent. DM2_PROTOCOL where they do not cover every cell exactly
 * once. */
enum dm2_status decomposition_from_rects(const struct grid *grid, int ranks, const struct cell_rect *rects,
                                         struct decomposition *out, struct dm2_error *err);

/* Frees what *d owns and empties it. */
void decomposition_free(struct decomposition *d);

/* The eight-element array: how many distinct other ranks own cells straight beyond each side, and diagonally
 * beyond each corner (0 or 1); across periodic sides too. 0: that boundary is the domain's own, or the rank
 * meets itself there. */
void decomposition_interfaces(const struct decomposition *d, int rank, int out[SIDE_COUNT]);

struct rank_boundary {
    size_t inner;           /* owned cells that another rank mirrors */
    size_t outer;           /* others' cells that this rank mirrors */
    size_t interface_cells; /* edges of cells along which the rank meets others, corners apart */
    double interface_cm;    /* their length */
    int neighbours;         /* distinct other ranks beyond sides and corners */
};

/* DM2_MEMORY. */
enum dm2_status decomposition_boundary(const struct decomposition *d, int rank, struct rank_boundary *out,
                                       struct dm2_error *err);

/* How many cells the rank owns. */
size_t decomposition_cells(const struct decomposition *d, int rank);

/* The sum of weights (elements per cell) over the rank's cells. */
uint64_t decomposition_weight(const struct decomposition *d, int rank, const uint32_t *weights);

#endif
