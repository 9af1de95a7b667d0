/* Strain of elements: average Eulerian, accumulated over time (docs/physics.md, section 12).
 *
 *   L = (sum_j dv (x) r)(sum_j r (x) r)^-1,   D = (L + L^T)/2,   strain += D dt
 *
 * over the interacting neighbours j: linked or in contact. r and dv are the differences of positions and
 * velocities, r midway between the last two evaluations. L is the least-squares fit of a velocity gradient to
 * the neighbours' velocities: exact in a uniform gradient. */
#ifndef DM2_ENGINE_STRAIN_H
#define DM2_ENGINE_STRAIN_H

#include <stdint.h>

#include "dm2/base/status.h"
#include "lists.h"
#include "particles.h"

enum { STRAIN_SUMS = 7 };

/* Working room of one subdomain; zeroed at the start. */
struct strain_sums {
    int64_t *sum; /* [cap][STRAIN_SUMS] fixed point */
    size_t cap;
};

void strain_free(struct strain_sums *s);

/* Adds to p->strain of every owned element the increment of the time dt_path (us; 0: none) up to the present
 * positions. The lists give the status of pairs, so force_evaluate comes first; the velocities of mirrored
 * elements must be up to date. An element without neighbours, or with neighbours on one line, keeps its
 * strain. DM2_MEMORY; DM2_NUMERIC: a difference of velocities out of range, with ids, step and position. */
enum dm2_status strain_add(const struct model *m, struct particles *p, const struct lists *lists,
                           double dt_path, int64_t step, struct strain_sums *s, struct dm2_error *err);

#endif
