/* The leapfrog (paper, section 4): velocities midway between positions. Kick, then drift. */
#ifndef DM2_ENGINE_LEAPFROG_H
#define DM2_ENGINE_LEAPFROG_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/measures.h"
#include "particles.h"

/* dt_kick of step n: v(n-1/2) becomes v(n+1/2); the start has v(0), so step 0 kicks for half a step. */
double leapfrog_kick_time(const struct model *m, int64_t step);
/* dt_path of step n: the time between the positions of the last evaluation and these. */
double leapfrog_path_time(const struct model *m, int64_t step);

/* Velocity of owned slot i at the whole step, between its kicks, from the sums of the last evaluation. */
void leapfrog_whole_velocity(const struct model *m, const struct particles *p, size_t i, int64_t step,
                             double v[2], double *w);

/* Kicks and drifts every owned element: v, w, heat, temperature, x. With out (else NULL) adds the elements'
 * part of the measures: kinetic, thermal, work, momentum, extremes, probes. With `drift` false nothing moves
 * and nothing changes: only measures. *dmax is the largest displacement, cm. DM2_NUMERIC: an element goes
 * non-finite or further than a cell edge in one step; id, step and position are named. */
enum dm2_status leapfrog_move(const struct model *m, struct particles *p, int64_t step, bool drift,
                              double *dmax, struct measures *out, struct dm2_error *err);

/* Pressure of every owned element from the virial sums: P = -tr(sigma)/2 (docs/physics.md, section 12), into
 * p->p. */
void leapfrog_set_pressure(const struct model *m, struct particles *p);

/* Stress of slot i, xx yy xy, Mbar: sigma = -(1/V) sum_j (1/2) r_ij (x) f_ij, V the element's hexagonal
 * cell, as its neighbours have strained it. */
void leapfrog_stress(const struct model *m, const struct particles *p, size_t i, double stress[3]);

#endif
