/* All decisions are comparisons of sums. The guess for the next step may be wrong both ways: a rebuild too
 * early costs time, a rebuild that was not expected costs a distributed run a second round trip. Neither
 * error changes a result.
 *
 * A survey gives two bounds of the approach of a pair: twice the longest displacement, which is the lower
 * bound where motion has no direction, and the diagonal of the box of all displacements, which is the lower
 * bound where bodies move as wholes. Where elements only touch, a survey also sorts the elements into bins
 * and compares the displacements in each bin with those in the bins around. After a survey the bounds grow by
 * 2 dmax again, so that surveys become frequent as a bound gets near its margin; a survey costs about as much
 * as the integration of positions, a rebuild as much as a few steps.
 *
 * A survey has the mirrored elements at their positions before the last step, so that a mirrored and an owned
 * element can be nearer to each other by dmax than the survey says. */
#include "dm2/engine/rebuild.h"

#include <math.h>

/* Growth of dmax from one step to the next that the guess allows for. */
static const double GROWTH = 1.1;

/* Share of a margin that is left for the rounding of positions and of the bounds. */
static const double ROUNDING = 1e-9;

struct spread spread_none(void)
{
    return (struct spread){.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
}

void spread_merge(struct spread *into, const struct spread *other)
{
    for (int a = 0; a < 2; a++) {
        into->low[a] = other->low[a] < into->low[a] ? other->low[a] : into->low[a];
        into->high[a] = other->high[a] > into->high[a] ? other->high[a] : into->high[a];
    }
    into->most = other->most > into->most ? other->most : into->most;
    into->close = other->close > into->close ? other->close : into->close;
}

double spread_approach(const struct spread *s)
{
    double x = s->high[0] - s->low[0], y = s->high[1] - s->low[1];
    if (x < 0.0 || y < 0.0)
        return 0.0;
    double diagonal = sqrt(x * x + y * y), twice = 2.0 * s->most;
    return diagonal < twice ? diagonal : twice;
}

void rebuild_plan_start(struct rebuild_plan *plan, const struct config *config, struct margins margins)
{
    *plan = (struct rebuild_plan){.margins = margins, .every = config->rebuild_every};
    if (config->search == SEARCH_CELLS)
        plan->every = 1;
}

/* Is a rebuild due after `steps` more steps in which the bounds grow by `growth`, cm, altogether? */
static bool is_due_after(const struct rebuild_plan *plan, int64_t steps, double growth)
{
    return (plan->every > 0 && plan->steps + steps >= plan->every) ||
           !(plan->close + growth <= plan->margins.close * (1.0 - ROUNDING)) ||
           !(plan->approach + growth <= plan->margins.wide * (1.0 - ROUNDING));
}

bool rebuild_plan_step(struct rebuild_plan *plan, double dmax, const struct spread *survey)
{
    plan->last = dmax;
    plan->approach += 2.0 * dmax;
    plan->close += 2.0 * dmax;
    if (survey != NULL) {
        double approach = spread_approach(survey), close = survey->close + dmax;
        plan->approach = plan->approach <= approach ? plan->approach : approach;
        plan->close = plan->close <= close ? plan->close : close;
    }
    plan->close = plan->close <= plan->approach ? plan->close : plan->approach;
    plan->steps++;
    return is_due_after(plan, 0, 0.0);
}

void rebuild_plan_done(struct rebuild_plan *plan)
{
    plan->approach = plan->close = 0;
    plan->steps = 0;
}

bool rebuild_plan_expected(const struct rebuild_plan *plan)
{
    return is_due_after(plan, 1, 2.0 * GROWTH * plan->last);
}

bool rebuild_plan_survey(const struct rebuild_plan *plan)
{
    return !rebuild_plan_expected(plan) && is_due_after(plan, 0, 4.0 * GROWTH * plan->last);
}
