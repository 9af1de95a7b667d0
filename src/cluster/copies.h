/* The steps at which the client takes a copy of the state. After the loss of a server the run repeats only
 * the steps since the last copy.
 *
 * A copy costs time, because every server sends its whole state and the client compiles the parts. The plan
 * takes the next copy when the cost of all copies stays within 2 % of the time so far. */
#ifndef DM2_CLUSTER_COPIES_H
#define DM2_CLUSTER_COPIES_H

#include <stdbool.h>
#include <stdint.h>

struct copy_plan {
    int64_t fixed;   /* steps between copies; 0: no copies; -1: by cost */
    int64_t last;    /* the step of the last copy that was asked for, or the step at which the plan started */
    double plain[2]; /* running means of the seconds of a step without a copy: [0] without, [1] with a
                        snapshot; 0: not known yet */
    double seconds;  /* all steps, copies excluded */
    double spent;    /* all copies, seconds */
    double most;     /* the most expensive copy, seconds */
};

/* Starts at `step` without any known cost; fixed as above. */
void copy_plan_start(struct copy_plan *plan, int64_t fixed, int64_t step);

/* Whether the plan wants a copy of the state at `step`. */
bool copy_plan_due(const struct copy_plan *plan, int64_t step);

/* Records that the state at `step` has been asked for, by the plan or for a checkpoint. */
void copy_plan_asked(struct copy_plan *plan, int64_t step);

/* Records the seconds of a step without a copy; snapshot: the step had a snapshot. */
void copy_plan_plain(struct copy_plan *plan, bool snapshot, double seconds);

/* Records the seconds of a step with a copy, its compilation included; snapshot: the step also had a
 * snapshot. Returns the seconds that the copy cost. Not to be called for the state of a checkpoint. */
double copy_plan_done(struct copy_plan *plan, bool snapshot, double seconds);

#endif
