/* When lists, mirrors and owners are renewed (paper, section 4): the bookkeeping of dmax, and surveys.
 *
 * Lists hold every pair that was within a margin of interacting when they were built: dR, or more where
 * elements only link and touch. Lists are valid while no two elements that were within R_c + dR of each other
 * have approached by more than that margin, and no two other elements by more than the difference of R_c + dR
 * and the reach of interaction, which is several dR where that reach is contact. Only relative motion counts:
 * a body that moves as a whole uses no margin up, and an evenly strained body no more than its strain across
 * two cells.
 *
 * The plan keeps upper bounds of both approaches. In every step the bounds grow by twice the greatest
 * displacement dmax, which is known anyway. When a bound would soon reach its margin, a survey takes the
 * displacements of the elements since the last rebuild, and the bounds fall to its values. No result depends
 * on when rebuilds happen; the sequential program and the client of a distributed run decide with the same
 * code. */
#ifndef DM2_ENGINE_REBUILD_H
#define DM2_ENGINE_REBUILD_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "dm2/deck/config.h"

/* The displacements of a set of elements since the last rebuild, cm. Along a periodic direction a
 * displacement is known up to whole periods, as is the distance of a pair. */
struct spread {
    double low[2], high[2]; /* least and greatest in x and y; of no element: infinite, low > high */
    double most;            /* greatest length of a displacement */
    double close; /* upper bound of the approach of two elements of the set that were within R_c + dR
                     of each other; infinite where the survey did not compare such elements */
};

/* The spread of no element. */
struct spread spread_none(void);

/* Adds the elements of *other to *into. */
void spread_merge(struct spread *into, const struct spread *other);

/* Upper bound of the approach of any two elements of the set, cm. */
double spread_approach(const struct spread *s);

/* Upper bound of the approach of an element of a and an element of b, cm. toward[k]: -1 or 1 where along x or
 * y all elements of b were on that side of all of a, so that displacements that part them do not count; 0: b
 * was on either side. */
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

/* The approach of two elements without an entry in the lists after which they can interact, cm; both margins
 * are at least dR. */
struct margins {
    double close; /* of elements that were within R_c + dR of each other: the reach of the lists less the
                     reach of interaction */
    double wide;  /* of any other two: R_c + dR less the reach of interaction */
};

struct rebuild_plan {
    struct margins margins;
    int64_t every;   /* a rebuild is due after so many steps at the latest; 0: no such limit */
    double close;    /* upper bound of the approach since the last rebuild of two elements that were within
                        R_c + dR of each other, cm */
    double approach; /* the same of any two elements, cm */
    double last;     /* dmax of the last step, cm */
    int64_t steps;   /* steps since the last rebuild */
};

/* The plan at the start of a run, when the lists have just been built; margins: those of model_margins. A
 * deck that searches by cells alone rebuilds at every step. */
void rebuild_plan_start(struct rebuild_plan *plan, const struct config *config, struct margins margins);

/* Takes a step into account. dmax: the greatest displacement of any element of the run in the step, cm;
 * survey: the spread of all elements where a survey was made, else NULL. True where the lists must be rebuilt
 * before the next forces. */
bool rebuild_plan_step(struct rebuild_plan *plan, double dmax, const struct spread *survey);

/* Takes a rebuild after the last step into account. */
void rebuild_plan_done(struct rebuild_plan *plan);

/* Will the next step end in a rebuild, if dmax grows by a tenth? A guess, which saves a distributed run a
 * second round trip where it is right. */
bool rebuild_plan_expected(const struct rebuild_plan *plan);

/* Shall the next step end in a survey, because a rebuild would be expected one step later without? */
bool rebuild_plan_survey(const struct rebuild_plan *plan);

#endif
