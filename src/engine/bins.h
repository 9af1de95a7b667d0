/* Bins: elements sorted into a grid of any fineness that covers them, wherever they are. The cells are
 * another matter: they cover the domain, whoever leaves it stands in the nearest one, and they must exceed
 * R_c + dR, which the paper's decks choose at 2.5 diameters and more where contact needs one diameter and the
 * margin of close pairs. */
#ifndef DM2_ENGINE_BINS_H
#define DM2_ENGINE_BINS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/grid.h"

struct bins {
    struct grid grid; /* bins are its cells */
    uint32_t *start;  /* [bins + 1] into slot */
    uint32_t *slot;   /* [n] by bin, ascending in each */
    uint32_t *bin;    /* [n] bin of each slot */
    size_t start_cap, slot_cap, bin_cap;
};

/* Lays out as many bins with edges longer than `reach`, cm, as cover the positions r[2 n], cm; along a
 * periodic side of `cells` they cover the domain. False where there would be more than `most`, or fewer than
 * three along a periodic side. */
bool bins_lay_out(struct bins *bins, const struct grid *cells, const double *r, size_t n, double reach,
                  double most);

/* Sorts n slots into the bins of their positions. 0, or -1 without memory. */
int bins_assign(struct bins *bins, const double *r, size_t n);
void bins_free(struct bins *bins);
size_t bins_bytes(const struct bins *bins);

#endif
