/* The leapfrog (paper, section 4): velocities midway between positions. After the forces of a step: kick,
 * then drift. */
#ifndef DM2_ENGINE_LEAPFROG_H
#define DM2_ENGINE_LEAPFROG_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/measures.h"
#include "particles.h"

/* dt_kick of a step, us: v(n-1/2) becomes v(n+1/2); a run starts with v(0), so step 0 kicks for half a step.
 */
double leapfrog_kick_time(const struct model *m, int64_t step);

/* dt_path of a step, us: the time from the positions of the last evaluation to the present positions. */
double leapfrog_path_time(const struct model *m, int64_t step);

/* Velocity v, cm/us, and angular velocity *w, 1/us, of owned slot i at the whole step, between the kicks,
 * from the sums of the last evaluation. */
void leapfrog_whole_velocity(const struct model *m, const struct particles *p, size_t i, int64_t step,
                             double v[2], double *w);

/* Kicks and drifts every owned element: v, w, heat, temperature, r. With out (else NULL) adds, before, the
 * elements' part of the measures: kinetic, thermal, work, momentum, extremes, probes. With `drift` false only
 * measures. *dmax is the largest displacement, cm. DM2_NUMERIC: an element becomes non-finite or would move
 * further than a cell edge in one step, or a measure leaves the range of its sum; names id, step and
 * position. */
enum dm2_status leapfrog_move(const struct model *m, struct particles *p, int64_t step, bool drift,
                              double *dmax, struct measures *out, struct dm2_error *err);

/* Sets p->p of every owned element, Mbar, from the virial sums: P = -tr(sigma)/2 (docs/physics.md, section
 * 12). */
void leapfrog_set_pressure(const struct model *m, struct particles *p);

/* Stress of slot i, xx yy xy, Mbar: sigma = -(1/V) sum_j (1/2) r_ij (x) f_ij, V the volume of the element's
 * hexagonal cell as deformed with its neighbours. */
void leapfrog_stress(const struct model *m, const struct particles *p, size_t i, double stress[3]);

#endif
