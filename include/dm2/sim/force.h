/* Forces and heats of all pairs in the lists, summed in 64-bit fixed point. */
#ifndef DM2_SIM_FORCE_H
#define DM2_SIM_FORCE_H

#include <stdbool.h>

#include "dm2/base/exact.h"
#include "dm2/base/status.h"
#include "dm2/sim/lists.h"
#include "dm2/sim/particles.h"

/* What a measuring evaluation adds up over pairs; a pair counts where its lower id is owned. */
struct pair_totals {
    struct exact_sum potential, elastic; /* shift: measure_scales.energy */
    uint64_t links, contacts;
};

/* Evaluates every pair at the present positions and the velocities of the half step before: fills far_sum and pair_sum
 * of p, updates the memory of the near pairs; with totals (else NULL) also virial, links and contacts of each element.
 * dt_kick and dt_path as in dm2/sim/law.h. DM2_NUMERIC: a force or a heat is not finite or beyond the range of the
 * fixed-point sums; names the pair and `step`. */
enum dm2_status force_evaluate(const struct model *m, struct particles *p, struct lists *lists, double dt_kick,
                               double dt_path, struct pair_totals *totals, int64_t step, struct dm2_error *err);

#endif
