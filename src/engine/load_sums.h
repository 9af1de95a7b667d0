/* The totals of the bodies under force (dm2/engine/load_totals.h) of one subdomain, from the sums and lists
 * of the pair forces. */
#ifndef DM2_ENGINE_LOAD_SUMS_H
#define DM2_ENGINE_LOAD_SUMS_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/engine/load_totals.h"
#include "lists.h"
#include "particles.h"
#include "wall.h"

/* A near pair of a body under force with an element of another body. */
struct loaded_pair {
    uint32_t i, k; /* owned slot, entry of its near row */
};

struct load_sums {
    struct loaded_pair *pair;
    uint32_t *slot; /* owned elements of bodies under force */
    size_t n_pairs, pair_cap, n_slots, slot_cap;
    struct load_totals own[FORCED_MAX]; /* of the last evaluation */
};

/* Finds the pairs and the slots in lists that have been built. 0, or -1 without memory. */
int load_sums_build(struct load_sums *s, const struct model *m, const struct particles *p,
                    const struct lists *l);

/* Sums the totals of an evaluation that is complete, at the positions and velocities of this evaluation. A
 * pair counts where the element with the lower id is owned, a force or a contact with a wall where the
 * element is. */
void load_sums_add(struct load_sums *s, const struct model *m, const struct particles *p,
                   const struct lists *l, const struct walls *ws);

void load_sums_free(struct load_sums *s);
size_t load_sums_bytes(const struct load_sums *s); /* memory held */

#endif
