/* When lists, mirrors and owners are renewed (paper, section 4): the bookkeeping of dmax and dumax.
 *
 * Lists hold every pair closer than R_c + dR at the time they were built. Two elements approach by at most
 * twice the sum dumax of the global largest displacements dmax since then, so the lists are valid while 2
 * dumax <= dR. The sequential program and the client of a distributed run decide with this one piece of code;
 * no result depends on when rebuilds happen. */
#ifndef DM2_SIM_REBUILD_H
#define DM2_SIM_REBUILD_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/sim/config.h"

struct rebuild_plan {
    double delta_r; /* dR, cm */
    int64_t every;  /* also every so many steps; 0: never for that reason */
    double dumax;   /* sum of dmax since the last rebuild, cm */
    double last;    /* dmax of the last step, cm */
    int64_t steps;  /* steps since the last rebuild */
};

/* At the start of a run, when the lists are fresh. Search by cells alone rebuilds at every step. */
void rebuild_plan_start(struct rebuild_plan *plan, const struct config *config);

/* After a step whose global dmax is `dmax`: true where the lists must be rebuilt before the next forces. */
bool rebuild_plan_step(struct rebuild_plan *plan, double dmax);

/* The lists have been rebuilt after the last step. */
void rebuild_plan_done(struct rebuild_plan *plan);

/* A guess made one step ahead, so that a distributed run need not ask twice: will the step after the last one
 * end in a rebuild, were dmax to grow by half? */
bool rebuild_plan_expected(const struct rebuild_plan *plan);

#endif
