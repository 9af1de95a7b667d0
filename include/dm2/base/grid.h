/* The cell grid (paper, sections 2.1 and 4): the domain is divided into cells whose edges strictly exceed R_c
 * + dR, so that an element interacts only with elements in its own cell and the eight surrounding cells. */
#ifndef DM2_BASE_GRID_H
#define DM2_BASE_GRID_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"

struct grid {
    int cx, cy;       /* columns and rows; c = cx * cy cells, numbered row by row: cell = j * cx + i */
    double lx, ly;    /* L_x, L_y, cell edges, cm */
    double origin[2]; /* lower left corner of the domain, cm */
    double size[2];   /* of the domain, cm */
    bool periodic[2];
};

/* The grid with the most cells whose edges strictly exceed `reach` = R_c + dR, in cm like origin and size; at
 * least one cell along each direction. DM2_DECK where a periodic direction has fewer than three cells,
 * because a pair of elements could be found twice, or where the grid would have more than 2^30 cells. */
enum dm2_status grid_build(const double origin[2], const double size[2], const bool periodic[2], double reach,
                           struct grid *out, struct dm2_error *err);

/* Whether this process may have `bytes` of memory for the grid: DM2_MEMORY, with both numbers, where not
 * (dm2/base/machine.h). To be asked before the memory is taken. */
enum dm2_status grid_check_memory(const struct grid *g, double bytes, struct dm2_error *err);

/* The cell of a position, cm. Elements outside the grid belong to the nearest edge cell. */
int grid_cell(const struct grid *g, double x, double y);

/* Writes to `out` the distinct cells around `cell`, without `cell` itself, across periodic sides too. Returns
 * their number, at most 8. */
int grid_neighbours(const struct grid *g, int cell, int out[8]);

/* grid_wrap of a place that is a whole size or more outside the domain. */
double grid_wrap_far(double low, double size, double x, int32_t *turns);

/* The coordinate x, cm, along a periodic direction as a place in the half-open domain [low, low + size), and
 * the sizes that were taken off in *turns: 1 across the upper edge, -1 across the lower edge, 0 within. A
 * coordinate just below `low` whose place rounds to the upper edge is at `low`, and has made no turn. A
 * coordinate that is not a number stays as it is. */
static inline double grid_wrap(double low, double size, double x, int32_t *turns)
{
    double high = low + size, place = x;
    *turns = 0;
    if (x >= high) {
        if (x - size >= high)
            return grid_wrap_far(low, size, x, turns);
        *turns = 1;
        place = x - size;
        return place < low ? low : place;
    }
    if (x < low) {
        place = x + size;
        if (place < low)
            return grid_wrap_far(low, size, x, turns);
        if (place >= high)
            return low;
        *turns = -1;
    }
    return place;
}

#endif
