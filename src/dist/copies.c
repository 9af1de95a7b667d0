/* With a cost of C seconds per copy and s seconds per step, copies every K steps take the share C / (K s) of the time:
 * K = C / (share s). The first copy comes after a few steps, to learn its cost early. */
#include "dm2/dist/copies.h"

#include <math.h>

static const double SHARE = 0.02; /* of the time, at most */
static const double WEIGHT = 0.1; /* of the newest step in the running mean */

enum { FIRST = 20, FURTHEST = 1000000 };

void copy_plan_start(struct copy_plan *plan, int64_t fixed, int64_t step)
{
    *plan = (struct copy_plan){.fixed = fixed, .last = step, .every = fixed >= 0 ? fixed : FIRST};
}

bool copy_plan_due(const struct copy_plan *plan, int64_t step)
{
    return plan->every > 0 && step - plan->last >= plan->every;
}

void copy_plan_plain(struct copy_plan *plan, double seconds)
{
    plan->plain = plan->plain > 0 ? (1 - WEIGHT) * plan->plain + WEIGHT * seconds : seconds;
}

void copy_plan_done(struct copy_plan *plan, int64_t step, double seconds)
{
    plan->last = step;
    if (plan->fixed >= 0)
        return;
    double cost = seconds - plan->plain;
    double every = plan->plain > 0 && cost > 0 ? ceil(cost / (SHARE * plan->plain)) : FIRST;
    plan->every = every < FIRST ? FIRST : every > FURTHEST ? FURTHEST : (int64_t)every;
}
