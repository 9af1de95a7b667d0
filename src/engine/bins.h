/* Bins: elements sorted into a grid of any fineness that covers the elements, also those outside the domain.
 * Cells differ: they cover the domain, an element outside belongs to the nearest cell, and their edges must
 * exceed R_c + dR. The paper's decks choose R_c + dR as 2.5 diameters and more, where contact needs one
 * diameter and the margin of close pairs. */
#ifndef DM2_ENGINE_BINS_H
#define DM2_ENGINE_BINS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/grid.h"

struct bins {
    struct grid grid; /* its cells are the bins */
    uint32_t *start;  /* [bins + 1] into slot */
    uint32_t *slot;   /* [n] slots by bin, ascending in each bin */
    uint32_t *bin;    /* [n] bin of each slot */
    size_t start_cap, slot_cap, bin_cap;
};

/* Lays out bins with edges longer than `reach`, cm, that cover the positions r[n][2], cm; along a periodic
 * side of `cells` the bins cover the domain. False where there would be more than `most` bins, or fewer than
 * three along a periodic side. */
bool bins_lay_out(struct bins *bins, const struct grid *cells, const double *r, size_t n, double reach,
                  double most);

/* Sorts n slots into the bins of their positions r[n][2], cm. 0, or -1 without memory. */
int bins_assign(struct bins *bins, const double *r, size_t n);
void bins_free(struct bins *bins);
size_t bins_bytes(const struct bins *bins); /* memory held */

#endif
