/* Strain of elements: average Eulerian, accumulated over time (docs/physics.md, section 12).
 *
 *   L = (sum_j dv (x) r)(sum_j r (x) r)^-1,   D = (L + L^T)/2,   strain += D dt
 *
 * over the neighbours j that the element interacts with: linked or in contact. r and dv are the differences
 * of positions and velocities, r midway between the last two evaluations. L is the velocity gradient that
 * fits the neighbours' velocities best, in the sense of least squares: exact in a uniform gradient. */
#ifndef DM2_ENGINE_STRAIN_H
#define DM2_ENGINE_STRAIN_H

#include <stdint.h>

#include "dm2/base/status.h"
#include "lists.h"
#include "particles.h"

enum { STRAIN_SUMS = 7 };

/* Working room of one subdomain; empty at the start. */
struct strain_sums {
    int64_t *sum; /* [cap][STRAIN_SUMS] fixed point */
    size_t cap;
};

void strain_free(struct strain_sums *s);

/* Adds to p->strain of every owned element what the time dt_path (us; 0: nothing) before the present
 * positions did. The status of pairs is that of the lists, so force_evaluate comes before; velocities of
 * mirrored elements count. An element whose neighbours lie on one line, or that has none, keeps its strain.
 * DM2_MEMORY; DM2_NUMERIC: a difference of velocities out of range, with id, step and position. */
enum dm2_status strain_add(const struct model *m, struct particles *p, const struct lists *lists,
                           double dt_path, int64_t step, struct strain_sums *s, struct dm2_error *err);

#endif
