/* Recursive bisection of a grid of cells into rectangles (paper, section 5, "Load balancing", and Fig. 9).
 *
 * Pure geometry of whole numbers: the distributed run assigns cells to servers with bisect_grid, and the
 * performance model counts the cells that these servers will exchange. */
#ifndef DM2_BASE_BISECT_H
#define DM2_BASE_BISECT_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"

enum { BISECT_PARTS_MAX = 65535 };

/* Cells x0 <= i < x1, y0 <= j < y1. */
struct cell_rect {
    int x0, y0, x1, y1;
};

/* The number of cells in r. */
size_t bisect_cells(const struct cell_rect *r);

/* The sum of `weights` (per cell, row by row on a grid with cx columns) over r; bisect_cells(r) where
 * `weights` is NULL. */
uint64_t bisect_weight(int cx, const uint32_t *weights, const struct cell_rect *r);

/* Can cx x cy cells be bisected for `parts` servers? DM2_USAGE: fewer cells than parts (the message has both
 * numbers), or parts outside 1..BISECT_PARTS_MAX. */
enum dm2_status bisect_check(int cx, int cy, int parts, struct dm2_error *err);

/* Bisects a grid of cx x cy cells with edges lx, ly (cm) for `parts` servers, a number that bisect_check
 * accepts, and writes out[0 .. parts), rectangles that cover every cell exactly once. Every cut goes across
 * the longer side of the rectangle in cm, so that the new interface is the shorter of the two possible. n
 * parts are split into floor(n/2) and ceil(n/2), with the cells in proportion, or with the weight in
 * proportion where `weights` (elements per cell) is not NULL. Every part gets at least one cell. */
void bisect_grid(int cx, int cy, double lx, double ly, int parts, const uint32_t *weights,
                 struct cell_rect *out);

#endif
