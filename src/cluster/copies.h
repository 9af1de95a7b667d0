/* When the client takes a copy of the state, so that a server that is lost costs the steps since then and no
 * more.
 *
 * A copy costs time: servers send everything, the client compiles it. The next one comes when it fits into
 * 2 % of the time so far, as far as those before it tell its cost; the first one comes early. */
#ifndef DM2_CLUSTER_COPIES_H
#define DM2_CLUSTER_COPIES_H

#include <stdbool.h>
#include <stdint.h>

struct copy_plan {
    int64_t fixed;   /* every so many steps; 0: never; -1: by cost */
    int64_t last;    /* the step of the last copy that was asked for, or at which the plan started */
    double plain[2]; /* seconds of a step without a copy, without and with a snapshot: running means; 0: not
                        known yet */
    double seconds;  /* of all steps, without what copies cost, */
    double spent;    /* and that */
    double most;     /* the most that one has cost */
};

void copy_plan_start(struct copy_plan *plan, int64_t fixed, int64_t step);

/* Whether the state at `step` is wanted. */
bool copy_plan_due(const struct copy_plan *plan, int64_t step);

/* The state at `step` has been asked for, for this or another reason: it will be there. */
void copy_plan_asked(struct copy_plan *plan, int64_t step);

/* A step without a copy took so long. */
void copy_plan_plain(struct copy_plan *plan, bool snapshot, double seconds);

/* The step that brought a copy, with compiling it, took so long. Returns what of it the copy cost. Not for
 * the state that a checkpoint needs. */
double copy_plan_done(struct copy_plan *plan, bool snapshot, double seconds);

#endif
