/* Forces and heats of all pairs in the lists, summed in 64-bit fixed point. */
#ifndef DM2_ENGINE_FORCE_H
#define DM2_ENGINE_FORCE_H

#include <stdbool.h>

#include "dm2/base/exact.h"
#include "dm2/base/status.h"
#include "lists.h"
#include "particles.h"

/* What a measuring evaluation adds up over pairs; a pair counts where its lower id is owned. */
struct pair_totals {
    struct exact_sum potential, elastic; /* shift: measure_scales.energy */
    uint64_t links, contacts;
};

/* Evaluates every pair at the present positions and the velocities of the half step before: fills far_sum and
 * pair_sum of p, updates the memory of the near pairs; with totals (else NULL) also virial, links and
 * contacts of each element. dt_kick and dt_path as in engine/law.h. DM2_NUMERIC: a force or a heat is not
 * finite or beyond the range of the fixed-point sums; names the pair and `step`. */
/* The same in two halves, for a server: force_ahead evaluates what no mirrored element takes part in as soon
 * as the owned elements have moved, while their neighbours' new positions are still on the way. Then comes
 * force_rest, or, where the lists must be built anew first, force_drop, which leaves the memory of pairs as
 * it was before. force_ahead does nothing (pass->ahead stays false) where the deck does not allow it: kinds
 * that change, far pairs that are measured; or where there is no memory for it. `p`, `lists` and `totals`
 * stay as they are in between, but for the mirrored elements. */
struct pass;
void force_ahead(struct pass *pass, const struct model *m, struct particles *p, struct lists *lists,
                 double dt_kick, double dt_path, struct pair_totals *totals);
enum dm2_status force_rest(struct pass *pass, struct lists *lists, int64_t step, struct dm2_error *err);
void force_drop(struct pass *pass, struct lists *lists);

enum dm2_status force_evaluate(const struct model *m, struct particles *p, struct lists *lists,
                               double dt_kick, double dt_path, struct pair_totals *totals, int64_t step,
                               struct dm2_error *err);

#endif
