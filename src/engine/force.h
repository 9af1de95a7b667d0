/* Forces and heats of all pairs in the lists, summed in 64-bit fixed point. */
#ifndef DM2_ENGINE_FORCE_H
#define DM2_ENGINE_FORCE_H

#include <stdbool.h>

#include "dm2/base/exact.h"
#include "dm2/base/status.h"
#include "lists.h"
#include "particles.h"

/* Sums over all pairs of a measuring evaluation; a pair counts where the element with the lower id is owned.
 */
struct pair_totals {
    struct exact_sum potential, elastic; /* shift: measure_scales.energy */
    uint64_t links, contacts;
    uint64_t pairs, wall_contacts, loaded_pairs; /* as in struct measures */
    struct exact_sum fabric[2];                  /* likewise */
    struct exact_sum magnitudes;                 /* likewise */
};

/* Evaluates every pair at the present positions and the velocities of the half step before: fills far_sum and
 * pair_sum of p and updates the memory of the near pairs; with totals (else NULL) also the virial, links and
 * contacts of each element; lists->cracks has the links that broke. dt_kick and dt_path in us, as in law.h.
 * DM2_NUMERIC: a force or a heat is not finite or beyond the range of the fixed-point sums; names the pair
 * and `step`. DM2_MEMORY: no room to sort the pairs. */
enum dm2_status force_evaluate(const struct model *m, struct particles *p, struct lists *lists,
                               double dt_kick, double dt_path, struct pair_totals *totals, int64_t step,
                               struct dm2_error *err);

/* force_evaluate in two halves, for a server. force_ahead evaluates the pairs without mirrored elements as
 * soon as the owned elements have moved, while the new positions of the mirrored elements are still on the
 * way. Then force_rest evaluates the other pairs; or, where the lists must be rebuilt first, force_drop
 * restores the memory of pairs from before force_ahead and drops the cracks. force_ahead does nothing
 * (pass->ahead stays false) where kinds change, where far pairs are measured, or without memory for the copy.
 * Until force_rest or force_drop, `p` (but for its mirrored elements), `lists` and `totals` must not change.
 * Errors of force_rest: those of force_evaluate. */
struct pass;
void force_ahead(struct pass *pass, const struct model *m, struct particles *p, struct lists *lists,
                 double dt_kick, double dt_path, struct pair_totals *totals);
enum dm2_status force_rest(struct pass *pass, struct lists *lists, int64_t step, struct dm2_error *err);
void force_drop(struct pass *pass, struct lists *lists);

#endif
