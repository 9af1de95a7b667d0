/* When the client takes a copy of the state, so that a server that is lost costs the steps since then and no more.
 *
 * A copy costs time: servers send everything, the client compiles it. The distance between copies is chosen from what
 * the last one took and what a plain step takes, so that copies stay below 2 % of the time. */
#ifndef DM2_DIST_COPIES_H
#define DM2_DIST_COPIES_H

#include <stdbool.h>
#include <stdint.h>

struct copy_plan {
    int64_t fixed; /* every so many steps; 0: never; -1: by cost */
    int64_t last;  /* the step of the last copy, or at which the plan started */
    int64_t every; /* steps from one to the next, now */
    double plain;  /* seconds of a step without a copy, a running mean; 0: not known yet */
};

void copy_plan_start(struct copy_plan *plan, int64_t fixed, int64_t step);

/* Whether the state at `step` is wanted. */
bool copy_plan_due(const struct copy_plan *plan, int64_t step);

/* A step without a copy took so long; the step that brought the copy of `step`, with compiling it, did. */
void copy_plan_plain(struct copy_plan *plan, double seconds);
void copy_plan_done(struct copy_plan *plan, int64_t step, double seconds);

#endif
