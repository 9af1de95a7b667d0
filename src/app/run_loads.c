/* Lines about loads that are forces or stresses, from what the model has worked out. */
#include "run_loads.h"

#include "dm2/engine/loading.h"

static const double warned_share = 0.22; /* of omega dt; docs/physics.md, section 17 */

void run_loads_print(FILE *to, const struct model *model)
{
    struct forced_check c;
    for (size_t i = 0; i < model_forced(model); i++)
        for (int axis = 0; axis < 2; axis++)
            if (model_forced_check(model, i, axis, &c))
                (void)fprintf(
                    to,
                    "load '%s' moves '%s' along %c: mass %.6g g, omega dt %.3g, damping %.6g Mbar us "
                    "cm, at most %.6g cm/us\n",
                    c.load, c.body, axis == 0 ? 'x' : 'y', c.mass, c.share, c.damping, c.fastest);
}

void run_loads_warn(const char *program, const struct model *model)
{
    struct forced_check c;
    for (size_t i = 0; i < model_forced(model); i++)
        for (int axis = 0; axis < 2; axis++)
            if (model_forced_check(model, i, axis, &c) && c.share > warned_share)
                (void)fprintf(
                    stderr,
                    "%s: warning: load '%s': mass %.6g g gives omega dt %.3g, and above %.2f a body "
                    "may swing on soft ground: at least %.3g g is safe\n",
                    program, c.load, c.mass, c.share, warned_share,
                    c.mass * (c.share / warned_share) * (c.share / warned_share));
}
