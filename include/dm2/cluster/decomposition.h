/* The spatial decomposition: which rank owns which cell of the grid (paper, sections 5 and 6.2, Figs 6 and
 * 9).
 *
 * The grid is bisected recursively into one rectangle of cells per rank. The module knows neither sockets nor
 * elements. */
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
    struct cell_rect *rect; /* [ranks] */
    uint16_t *owner;        /* [cells] a rank; struct domain_map borrows this array */
};

/* Bisects the grid for `ranks` ranks with bisect_grid: by weights[cells] (elements per cell), or by cells
 * where weights is NULL. *out belongs to the caller (decomposition_free). DM2_USAGE: fewer cells than ranks
 * (both numbers are named), or ranks outside 1..DECOMPOSITION_RANKS_MAX. DM2_MEMORY. */
enum dm2_status decomposition_bisect(const struct grid *grid, int ranks, const uint32_t *weights,
                                     struct decomposition *out, struct dm2_error *err);

/* Builds the decomposition from rects[ranks], which another program sent. *out belongs to the caller
 * (decomposition_free). DM2_PROTOCOL: the rectangles do not cover every cell exactly once; DM2_MEMORY. */
enum dm2_status decomposition_from_rects(const struct grid *grid, int ranks, const struct cell_rect *rects,
                                         struct decomposition *out, struct dm2_error *err);

/* Frees the arrays of *d and empties *d. */
void decomposition_free(struct decomposition *d);

/* The eight-element array: the number of distinct other ranks that own cells straight beyond each side, and
 * diagonally beyond each corner (0 or 1); periodic sides are crossed. 0: the domain ends there, or the rank
 * meets itself. */
void decomposition_interfaces(const struct decomposition *d, int rank, int out[SIDE_COUNT]);

struct rank_boundary {
    size_t inner;           /* owned cells that another rank mirrors */
    size_t outer;           /* cells of other ranks that this rank mirrors */
    size_t interface_cells; /* edges of cells between this rank and other ranks, corners excluded */
    double interface_cm;    /* length of these edges, cm */
    int neighbours;         /* distinct other ranks beyond sides and corners */
};

/* Counts the cells and edges of the boundary of `rank`. DM2_MEMORY. */
enum dm2_status decomposition_boundary(const struct decomposition *d, int rank, struct rank_boundary *out,
                                       struct dm2_error *err);

/* The number of cells that the rank owns. */
size_t decomposition_cells(const struct decomposition *d, int rank);

/* The sum of weights (elements per cell) over the rank's cells. */
uint64_t decomposition_weight(const struct decomposition *d, int rank, const uint32_t *weights);

#endif
