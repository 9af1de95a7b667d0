/* Another copy is taken when, together with those before it, it would cost no more than SHARE of the time so
 * far. Where one costs C seconds and a step s, their distance comes to C / (SHARE s) steps. The first one
 * comes after a few steps, to learn its cost; what the next one will cost is taken to be the most that one
 * has cost yet.
 *
 * What a copy cost is what its step took longer than steps like it: those with a snapshot are compared with
 * those with a snapshot, so that the cost is found where every step has one. */
#include "copies.h"

static const double SHARE = 0.02; /* of the time, at most */
static const double WEIGHT = 0.1; /* of the newest step in the running means */

enum { NEAREST = 20 }; /* steps from one to the next, at least */

void copy_plan_start(struct copy_plan *plan, int64_t fixed, int64_t step)
{
    *plan = (struct copy_plan){.fixed = fixed, .last = step};
}

bool copy_plan_due(const struct copy_plan *plan, int64_t step)
{
    if (plan->fixed >= 0)
        return plan->fixed > 0 && step - plan->last >= plan->fixed;
    return step - plan->last >= NEAREST && plan->spent + plan->most <= SHARE * (plan->seconds + plan->spent);
}

void copy_plan_plain(struct copy_plan *plan, bool snapshot, double seconds)
{
    double *plain = &plan->plain[snapshot];
    *plain = *plain > 0 ? (1 - WEIGHT) * *plain + WEIGHT * seconds : seconds;
    plan->seconds += seconds;
}

void copy_plan_asked(struct copy_plan *plan, int64_t step)
{
    plan->last = step;
}

double copy_plan_done(struct copy_plan *plan, bool snapshot, double seconds)
{
    double plain = plan->plain[snapshot] > 0 ? plan->plain[snapshot] : plan->plain[!snapshot];
    double cost = seconds > plain ? seconds - plain : 0;
    plan->spent += cost;
    plan->seconds += seconds - cost;
    plan->most = cost > plan->most ? cost : plan->most;
    return cost;
}
