/* Probes: what is measured at a row of the history of a body, of a wall, or of the elements that start in a
 * region. The sums are exact, so that the parts of any decomposition merge to the same bits. */
#ifndef DM2_ENGINE_PROBE_H
#define DM2_ENGINE_PROBE_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/exact.h"
#include "dm2/deck/config.h"

struct measure_scales;

/* The sums of a probe. Places are unwrapped; those of a body are from the middle of the body's box in the
 * deck, so that sums of products with them lose no digits far from the origin. */
enum probe_sum {
    PROBE_X, /* of a region or wall: sum of x, y, cm, */
    PROBE_Y,
    PROBE_VX, /* and of velocities, cm/us */
    PROBE_VY,
    PROBE_MASS, /* g */
    PROBE_MX,   /* g cm */
    PROBE_MY,
    PROBE_PX, /* momentum, g cm/us */
    PROBE_PY,
    PROBE_ANGULAR, /* m (x v_y - y v_x) + spin, g cm2/us */
    PROBE_INERTIA, /* m (r^2 + R^2/2), g cm2 */
    PROBE_FX,      /* pair forces, Mbar cm2, in whole quanta of the forces */
    PROBE_FY,
    PROBE_TORQUE,    /* x f_y - y f_x + torque, Mbar cm3 */
    PROBE_STRESS_XX, /* V_0 sigma, Mbar cm3 */
    PROBE_STRESS_YY,
    PROBE_STRESS_XY,
    PROBE_VOLUME,      /* V_0, cm3 */
    PROBE_TEMPERATURE, /* K */
    PROBE_KINETIC,     /* g cm2/us2 */
    PROBE_AREA,        /* of the discs whose centre is in the region now, cm2 */
    PROBE_SPIN,        /* of a wall, 1/us; its place and velocity are PROBE_X to PROBE_VY */
    PROBE_HEAT,        /* that a wall conducts into elements, g cm2/us3 */
    PROBE_SUMS
};

struct probe_sums {
    uint32_t needs; /* bit k: sum[k] is kept */
    uint64_t count; /* elements; of a wall 1 */
    struct exact_sum sum[PROBE_SUMS];
};

/* The sums that the columns of the probe need, as probe_sums.needs. */
uint32_t probe_needs(const struct probe_config *p);

/* The shift (dm2/base/exact.h) of a sum. */
int probe_shift(const struct measure_scales *scales, enum probe_sum sum);

/* The point from which the places of the probe's sums are counted, cm; 0 0 for a region or wall. */
void probe_origin(const struct probe_config *p, double origin[2]);

/* Adds to *sums those of another part of the system at the same step. */
void probe_merge(struct probe_sums *sums, const struct probe_sums *part);

/* The columns of a probe in history.csv, in their order. */
struct probe_column {
    const char *suffix, *unit; /* the column's name is that of the probe, _, suffix */
    enum probe_quantity quantity;
};
enum { PROBE_COLUMNS = 15 };
extern const struct probe_column probe_columns[PROBE_COLUMNS];

/* The values of all columns; those that the probe does not report are 0. NaN for a mean of no element. */
void probe_values(const struct probe_config *p, const struct measure_scales *scales,
                  const struct probe_sums *sums, double values[PROBE_COLUMNS]);

#endif
