/* A copy is due when the cost of all copies, the next one included, stays within SHARE of the time so far. If
 * a copy costs C seconds and a step s seconds, the distance between copies is C / (SHARE s) steps. The first
 * copy is taken after NEAREST steps to learn its cost; the next copy is assumed to cost as much as the most
 * expensive copy so far.
 *
 * The cost of a copy is the time by which its step exceeds the mean of steps without a copy. Steps with a
 * snapshot have a mean of their own, so that the cost is found even if every step has a snapshot. */
#include "copies.h"

static const double SHARE = 0.02; /* largest share of the time for copies */
static const double WEIGHT = 0.1; /* weight of the newest step in the running means */

enum { NEAREST = 20 }; /* least number of steps between copies by cost */

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
