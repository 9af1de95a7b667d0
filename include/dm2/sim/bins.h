/* Bins: a finer grid than the cells, for finding the near pairs of a deck whose elements only touch. The cells must
 * exceed R_c + dR, which the paper's decks choose at 2.5 diameters and more; contact needs one diameter and the margin of
 * close pairs. */
#ifndef DM2_SIM_BINS_H
#define DM2_SIM_BINS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/sim/grid.h"
#include "dm2/sim/particles.h"

struct bins {
    struct grid grid;   /* over the whole domain; bins are its cells */
    uint32_t *start;    /* [bins + 1] into slot */
    uint32_t *slot;     /* all slots, owned and mirrored, by bin */
    uint32_t *bin;      /* [n] bin of each slot */
    size_t start_cap, slot_cap, bin_cap;
    bool ready;         /* the grid has been laid out */
};

/* Lays out bins longer than `reach` over the domain of `cells`. False where they would not be finer than the cells
 * by half, or too many for the elements, so that cells serve as well. */
bool bins_lay_out(struct bins *bins, const struct grid *cells, double reach, size_t elements);

/* Sorts every slot of p into its bin. 0, or -1 without memory. */
int bins_assign(struct bins *bins, const struct particles *p);
void bins_free(struct bins *bins);
size_t bins_bytes(const struct bins *bins);

#endif
