/* When lists, mirrors and owners are renewed (paper, section 4): the bookkeeping of dmax, and surveys.
 *
 * Lists hold every pair closer than R_c + dR at the time they were built, so they are valid while no two elements can
 * have approached by more than dR. What counts is relative: a body that moves as a whole uses nothing up. The plan keeps
 * an upper bound of the approach. It grows by twice the greatest displacement dmax in every step, which costs nothing to
 * know; when it would soon be spent, the elements' displacements since the last rebuild are surveyed, and the bound
 * falls to what they say. The sequential program and the client of a distributed run decide with this one piece of
 * code; no result depends on when rebuilds happen. */
#ifndef DM2_SIM_REBUILD_H
#define DM2_SIM_REBUILD_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/sim/config.h"

/* The displacements of a set of elements since the last rebuild, cm. Along a periodic direction each is known up to
 * whole periods, and so are the distances of pairs. */
struct spread {
    double low[2], high[2]; /* the least and greatest in x and y; of no element: infinite, low > high */
    double most;            /* the longest */
};

struct spread spread_none(void);
void spread_merge(struct spread *into, const struct spread *other);

/* By how much two of the elements can have approached at most, cm. */
double spread_approach(const struct spread *s);

struct rebuild_plan {
    double delta_r;  /* dR, cm */
    int64_t every;   /* also every so many steps; 0: never for that reason */
    double approach; /* upper bound of what two elements have approached since the last rebuild, cm */
    double last;     /* dmax of the last step, cm */
    int64_t steps;   /* steps since the last rebuild */
};

/* At the start of a run, when the lists are fresh. Search by cells alone rebuilds at every step. */
void rebuild_plan_start(struct rebuild_plan *plan, const struct config *config);

/* After a step whose global dmax is `dmax`, with the spread of all elements where it was surveyed, else NULL: true where
 * the lists must be rebuilt before the next forces. */
bool rebuild_plan_step(struct rebuild_plan *plan, double dmax, const struct spread *survey);

/* The lists have been rebuilt after the last step. */
void rebuild_plan_done(struct rebuild_plan *plan);

/* A guess made one step ahead, so that a distributed run need not ask twice: will the step after the last one
 * end in a rebuild, were dmax to grow by a tenth? */
bool rebuild_plan_expected(const struct rebuild_plan *plan);

/* Shall the step after the last one end in a survey, because otherwise a rebuild would be expected of the one after it? */
bool rebuild_plan_survey(const struct rebuild_plan *plan);

#endif
