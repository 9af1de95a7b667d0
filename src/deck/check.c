/* Checks of the domain, the output and the profiles, each over several keywords. A value that did not read is
 * NaN, and every comparison is written to be false for NaN, so that one mistake gives one finding. */
#include "check.h"

#include <math.h>
#include <string.h>

#include "dm2/base/grid.h"

static void check_domain(const struct deck_binding *b)
{
    const struct config *c = b->config;
    size_t block = b->single[BLOCK_DOMAIN];
    struct number_text r_c;
    struct grid grid;
    struct dm2_error err;
    double reach = c->r_c + c->delta_r;
    if (c->r_c < config_contact_distance(c))
        findings_error(b->findings, binding_place(b, block, "r_c", 0),
                       "r_c = %s cm is below the contact distance of %g cm, so that contacts would be missed",
                       number_text(c->r_c, &r_c), config_contact_distance(c));
    /* False where a value is NaN. */
    bool known = reach > 0 && c->size[0] > 0 && c->size[1] > 0;
    for (int a = 0; a < 2; a++)
        known = known && isfinite(c->size[a]) && isfinite(c->origin[a]) && !binding_bad(b, block, "boundary");
    if (known && grid_build(c->origin, c->size, c->periodic, reach, &grid, &err) != DM2_OK)
        findings_error(b->findings, binding_place(b, block, "size", 0), "%s", err.text);
}

static void check_output(const struct deck_binding *b)
{
    const struct config *c = b->config;
    size_t block = b->single[BLOCK_OUTPUT];
    const struct output_config *o = &c->output;
    if (b->steps_replaced || c->steps < 0 || !binding_given(b, block, "snapshot_at"))
        return;
    if (o->n_snapshot_at > 0 && o->snapshot_at[o->n_snapshot_at - 1] > c->steps)
        findings_warn(b->findings, binding_place(b, block, "snapshot_at", 0),
                      "the run has %lld steps; there is no snapshot at %lld", (long long)c->steps,
                      (long long)o->snapshot_at[o->n_snapshot_at - 1]);
}

static void check_profiles(const struct deck_binding *b)
{
    const struct config *c = b->config;
    for (size_t i = 0; i < c->n_profiles; i++) {
        const double *range = c->profiles[i].range;
        struct number_text from, to;
        if (range[0] >= range[1] && binding_given(b, b->blocks[BLOCK_PROFILE][i], "range"))
            findings_error(
                b->findings, binding_place(b, b->blocks[BLOCK_PROFILE][i], "range", 0),
                "the range of a profile goes from a smaller to a larger coordinate, not from %s to %s cm",
                number_text(range[0], &from), number_text(range[1], &to));
    }
}

static void check_stops(const struct deck_binding *b)
{
    static const char *const conditions[] = {"unbalanced", "kinetic", "probe"};
    for (size_t i = 0; i < b->config->n_stops; i++) {
        size_t block = b->blocks[BLOCK_STOP][i];
        bool missing = true;
        for (size_t k = 0; k < sizeof conditions / sizeof conditions[0]; k++)
            missing = missing && binding_missing(b, block, conditions[k]);
        if (missing)
            findings_error(b->findings, binding_place(b, block, "unbalanced", 0),
                           "the block 'stop' lacks a condition: unbalanced, kinetic or probe");
    }
}

bool deck_check(const struct deck_binding *b)
{
    check_domain(b);
    check_materials(b);
    check_chemistry(b);
    check_output(b);
    check_profiles(b);
    check_stops(b);
    check_walls(b);
    check_loads(b);
    check_lines(b);
    return check_bodies(b);
}
