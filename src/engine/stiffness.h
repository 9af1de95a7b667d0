/* The stable time step that holds at the present positions: Gershgorin's bound of the stiffest mode, over the
 * neighbours that each element has.
 *
 *   Q(dt) = sum over linked and touching j of (u'' dt^2 + 2 c_n dt) w n (x) n + (kt dt^2 + 2 c_t dt)/3 w t
 * (x) t s(dt) = largest eigenvalue of Q/(4 m_i);     limit: s = 1;     w = 1 + sqrt(m_i/m_j), 1 where j is
 * driven
 *
 * and for the rotation s(dt) = sum of (kt dt^2 + 2 c_t dt) max(w, 2)/(2 m_i). In a lattice of equals this is
 * the limit of stability.h. Conduction: s(dt) = 3/8 sum of G dt (1 + sqrt(C_i/C_j))/C_i, with the conductance
 * G of a pair and heat capacities C. Source: docs/physics.md, section 7. */
#ifndef DM2_ENGINE_STIFFNESS_H
#define DM2_ENGINE_STIFFNESS_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "lists.h"
#include "particles.h"
#include "wall.h"

/* Working room of one subdomain; zeroed at the start. */
struct stiffness_sums {
    int64_t *sum; /* [cap], fixed point: of the elements whose rows are under way */
    size_t cap;
};

void stiffness_free(struct stiffness_sums *s);
size_t stiffness_bytes(const struct stiffness_sums *s); /* memory held */

struct stiffness {
    double dt_share;    /* largest share of its limit that the deck's dt is for an owned element */
    double compression; /* largest 1 - x/r0 of the bonds and contacts of free elements, at least 0 */
};

/* Fills *out at the present positions. The lists give the status of pairs, so force_evaluate comes first, and
 * the pressures are those that it used. 0 where a potential has scope `all`, because far pairs are not
 * counted. A wall counts as a driven partner. DM2_MEMORY. */
enum dm2_status stiffness_measure(const struct model *m, const struct particles *p, const struct lists *lists,
                                  const struct walls *walls, struct stiffness_sums *s, struct stiffness *out,
                                  struct dm2_error *err);

#endif
