/* dmax and surveys. All is a comparison of sums; the guess for the next step may be wrong both ways: a
 * rebuild too early costs time, a missed one costs the distributed run a second round trip. Neither changes a
 * result.
 *
 * Two bounds of what a pair can have approached come out of a survey: twice the longest displacement, the
 * better one where motion has no direction, and the diagonal of the box of all displacements, the better one
 * where bodies move as wholes. Where elements only touch, they are sorted into bins as well, and the
 * displacements in each bin are compared with those in the bins around it. After a survey bounds grow by 2
 * dmax again, so as one gets near its margin surveys become frequent; one costs about as much as integrating
 * positions, a rebuild as much as a few steps.
 *
 * The mirrored elements in a survey are a step behind: those that it compares can have come nearer by dmax
 * since.
 */
#include "dm2/engine/rebuild.h"

#include <math.h>

static const double GROWTH = 1.1; /* of dmax from one step to the next that the guess allows for */
static const double ROUNDING =
    1e-9; /* share of a margin left for the rounding of positions and of these sums */

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

/* After so many more steps in which the bounds grow by so much altogether. */
static bool spent_after(const struct rebuild_plan *plan, int64_t steps, double growth)
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
    return spent_after(plan, 0, 0.0);
}

void rebuild_plan_done(struct rebuild_plan *plan)
{
    plan->approach = plan->close = 0;
    plan->steps = 0;
}

bool rebuild_plan_expected(const struct rebuild_plan *plan)
{
    return spent_after(plan, 1, 2.0 * GROWTH * plan->last);
}

bool rebuild_plan_survey(const struct rebuild_plan *plan)
{
    return !rebuild_plan_expected(plan) && spent_after(plan, 0, 4.0 * GROWTH * plan->last);
}
