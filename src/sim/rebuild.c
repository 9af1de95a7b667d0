/* dmax and dumax. All is a comparison of sums; the guess for the next step may be wrong both ways: a rebuild
 * too early costs time, a missed one costs the distributed run a second round trip. Neither changes a result.
 */
#include "dm2/sim/rebuild.h"

static const double GROWTH = 1.5; /* of dmax from one step to the next that the guess allows for */

void rebuild_plan_start(struct rebuild_plan *plan, const struct config *config)
{
    *plan = (struct rebuild_plan){.delta_r = config->delta_r, .every = config->rebuild_every};
    if (config->search == SEARCH_CELLS)
        plan->every = 1;
}

static bool spent(const struct rebuild_plan *plan, double dumax, int64_t steps)
{
    return (plan->every > 0 && steps >= plan->every) || !(2.0 * dumax <= plan->delta_r);
}

bool rebuild_plan_step(struct rebuild_plan *plan, double dmax)
{
    plan->last = dmax;
    plan->dumax += dmax;
    plan->steps++;
    return spent(plan, plan->dumax, plan->steps);
}

void rebuild_plan_done(struct rebuild_plan *plan)
{
    plan->dumax = 0;
    plan->steps = 0;
}

bool rebuild_plan_expected(const struct rebuild_plan *plan)
{
    return spent(plan, plan->dumax + GROWTH * plan->last, plan->steps + 1);
}
