/* Prescribed motions: where a mover (a body or a wall) is at a step, and how fast.
 *
 * Times are t_n = t_start + (n - n_start) dt, multiplied out, so that no error accumulates and every process
 * has the same bits. A table of points is linear between the points; its integral is worked out from prefix
 * sums, so that a mover is where the integral of its velocity is, at every step, to rounding. */
#ifndef DM2_ENGINE_MOTION_H
#define DM2_ENGINE_MOTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"

struct model;

/* A mover at step n. */
struct rigid_motion {
    double dx, dy; /* displacement since the stage's start, cm */
    double vx, vy; /* velocity of the half step n - 1/2, which pairs see, cm/us; at the stage's start v(0) */
    double angle;  /* turned since the stage's start, radians, counter-clockwise */
    double spin;   /* of that half step, 1/us */
};

/* A table and the prefix sums of its integral. */
struct motion_table {
    const struct load_config *load; /* borrowed */
    double *sum;                    /* [n] integral from the first point to each point */
    double period;                  /* us, of a load that repeats; else 0 */
    double start;                   /* integral at the stage's start */
};

/* The tables that move a mover along x, y and by turning, and the constant where there is none. */
struct mover_path {
    const struct motion_table *table[3]; /* NULL: constant */
    double constant[3];                  /* cm/us, 1/us */
};

/* The value of a table at time t, us, and its integral from the first point to t. */
double motion_table_value(const struct motion_table *table, double t);
double motion_table_integral(const struct motion_table *table, double t);

/* Works out m->load_tables, m->paths, m->placed, m->driven. DM2_MEMORY. motion_free frees them. */
enum dm2_status motion_build(struct model *m, struct dm2_error *err);
void motion_free(struct model *m);

/* t_n, us. */
double motion_time(const struct model *m, int64_t step);

/* The value of load `load` of the config at t_n. */
double motion_load(const struct model *m, size_t load, int64_t step);

/* The prescribed motion of a mover: by its loads, or its constant velocity and spin. Along an axis under a
 * force the displacement and the velocity are 0. */
void motion_at(const struct model *m, size_t mover, int64_t step, struct rigid_motion *out);

/* Is the centroid of the body needed: does the body turn, or follow a table? */
bool motion_needs_centroid(const struct model *m, size_t body);

#endif
