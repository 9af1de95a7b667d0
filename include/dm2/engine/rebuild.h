/* When lists, mirrors and owners are renewed (paper, section 4): the bookkeeping of dmax, and surveys.
 *
 * Lists hold every pair that was within a margin of interacting when they were built: dR, or more where
 * elements only link and touch. They are valid while no two elements that stood within R_c + dR of each other
 * have approached by more than that, and no two others by more than R_c + dR exceeds the reach of
 * interaction, which is several dR where that is contact. What counts is relative: a body that moves as a
 * whole uses nothing up, and one that is evenly strained no more than its strain across two cells. The plan
 * keeps upper bounds of both. They grow by twice the greatest displacement dmax in every step, which costs
 * nothing to know; when one would soon be spent, the elements' displacements since the last rebuild are
 * surveyed, and the bounds fall to what they say. The sequential program and the client of a distributed run
 * decide with this one piece of code; no result depends on when rebuilds happen. */
#ifndef DM2_ENGINE_REBUILD_H
#define DM2_ENGINE_REBUILD_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "dm2/deck/config.h"

/* The displacements of a set of elements since the last rebuild, cm. Along a periodic direction each is known
 * up to whole periods, and so are the distances of pairs. */
struct spread {
    double low[2], high[2]; /* the least and greatest in x and y; of no element: infinite, low > high */
    double most;            /* the longest */
    double close; /* by how much two of them that stood within R_c + dR of each other can have approached at
                   * most; infinite where that was not looked at */
};

struct spread spread_none(void);
void spread_merge(struct spread *into, const struct spread *other);

/* By how much two of the elements can have approached at most, cm. */
double spread_approach(const struct spread *s);

/* By how much an element of one set can have approached one of another at most, cm. toward: -1 or 1 where all
 * of b stood on that side of all of a along x or y, so that what parts them does not count; 0: on either. */
static inline double spread_between(const struct spread *a, const struct spread *b, const int toward[2])
{
    double apart[2], most = a->most + b->most;
    for (int k = 0; k < 2; k++) {
        double ab = a->high[k] - b->low[k], ba = b->high[k] - a->low[k];
        apart[k] = toward[k] > 0 || (toward[k] == 0 && ab > ba) ? ab : ba;
        apart[k] = apart[k] > 0.0 ? apart[k] : 0.0;
    }
    double diagonal = sqrt(apart[0] * apart[0] + apart[1] * apart[1]);
    return diagonal < most ? diagonal : most;
}

/* By how much two elements that are not in the lists may approach before they can interact, cm; both at least
 * dR. */
struct margins {
    double close; /* if they stood within R_c + dR of each other: the reach of the lists beyond that of
                     interaction */
    double wide;  /* any two others: how much longer than the reach of interaction R_c + dR is */
};

struct rebuild_plan {
    struct margins margins;
    int64_t every;   /* also every so many steps; 0: never for that reason */
    double close;    /* upper bound of what two that stood within R_c + dR have approached since the last
                        rebuild, cm */
    double approach; /* the same for any two */
    double last;     /* dmax of the last step, cm */
    int64_t steps;   /* steps since the last rebuild */
};

/* At the start of a run, when the lists are fresh; margins: model_margins. Search by cells alone rebuilds at
 * every step. */
void rebuild_plan_start(struct rebuild_plan *plan, const struct config *config, struct margins margins);

/* After a step whose global dmax is `dmax`, with the spread of all elements where it was surveyed, else NULL:
 * true where the lists must be rebuilt before the next forces. */
bool rebuild_plan_step(struct rebuild_plan *plan, double dmax, const struct spread *survey);

/* The lists have been rebuilt after the last step. */
void rebuild_plan_done(struct rebuild_plan *plan);

/* A guess made one step ahead, so that a distributed run need not ask twice: will the step after the last one
 * end in a rebuild, were dmax to grow by a tenth? */
bool rebuild_plan_expected(const struct rebuild_plan *plan);

/* Shall the step after the last one end in a survey, because otherwise a rebuild would be expected of the one
 * after it? */
bool rebuild_plan_survey(const struct rebuild_plan *plan);

#endif
