/* Checks of loads: what each quantity can be prescribed for, that no motion is prescribed twice, the
 * keywords that belong to forces and stresses. And the spins of bodies, by the body's block or by a load. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/deck/shape.h"
#include "bind_loads.h"
#include "check.h"

/* The largest angle by which a body may turn, radians: the range of real_sin. */
static const double turn_most = 1e5;

static const struct load_config *load_at(const struct deck_binding *b, size_t i)
{
    return &b->config->loads[i];
}

static const char *quantity_name(enum load_quantity quantity)
{
    return schema_block(BLOCK_LOAD)->keys[quantity].name;
}

static bool is_force(enum load_quantity q)
{
    return q == LOAD_FORCE_X || q == LOAD_FORCE_Y || q == LOAD_STRESS_XX || q == LOAD_STRESS_YY;
}

/* Loads of one number prescribe the same of a mover: 0 and 1 the motion along x and y, 2 the turning, 3 the
 * temperature, 4 and 5 the acceleration. */
static int prescribes(enum load_quantity q)
{
    static const int what[LOAD_QUANTITIES] = {
        [LOAD_VELOCITY_X] = 0,     [LOAD_VELOCITY_Y] = 1,     [LOAD_SPIN] = 2,      [LOAD_FORCE_X] = 0,
        [LOAD_FORCE_Y] = 1,        [LOAD_STRESS_XX] = 0,      [LOAD_STRESS_YY] = 1, [LOAD_TEMPERATURE] = 3,
        [LOAD_ACCELERATION_X] = 4, [LOAD_ACCELERATION_Y] = 5,
    };
    return what[q];
}

/* Adds an error at load i because of the statement at `before`, whose line the message names. */
static void report_twice(const struct deck_binding *b, size_t i, struct deck_place before, const char *what)
{
    char *place = findings_place(b->findings, before);
    int where = place == NULL ? 0 : (int)strcspn(place, "\n");
    const struct load_config *load = load_at(b, i);
    findings_error(b->findings, load_place(b, i), "'%s' of '%s' is prescribed twice: %s at %.*s",
                   quantity_name(load->quantity), config_mover_name(b->config, load->mover), what, where,
                   place == NULL ? "" : place);
    free(place);
}

static void check_twice(const struct deck_binding *b, size_t i)
{
    const struct load_config *load = load_at(b, i);
    for (size_t k = 0; k < i; k++) {
        const struct load_config *other = load_at(b, k);
        if (other->mover == load->mover && prescribes(other->quantity) == prescribes(load->quantity)) {
            report_twice(b, i, load_place(b, k), "there is a load before");
            return;
        }
    }
    if (load->mover >= b->config->n_bodies)
        return;
    const struct body_config *body = &b->config->bodies[load->mover];
    size_t block = b->blocks[BLOCK_BODY][load->mover];
    int what = prescribes(load->quantity);
    if (what <= 1 && body->motion == MOTION_DRIVEN && body->velocity[what] != 0 &&
        binding_given(b, block, "velocity"))
        report_twice(b, i, binding_place(b, block, "velocity", (size_t)what), "the body has a velocity");
    if (what == 2 && binding_given(b, block, "spin"))
        report_twice(b, i, binding_place(b, block, "spin", 0), "the body has a spin");
}

/* Does the quantity suit the motion of the body? */
static void check_body_of(const struct deck_binding *b, size_t i)
{
    static const char *const motions[] = {"free", "fixed", "driven"};
    const struct load_config *load = load_at(b, i);
    if (load->mover >= b->config->n_bodies)
        return;
    const struct body_config *body = &b->config->bodies[load->mover];
    const char *name = quantity_name(load->quantity);
    bool accelerates = load->quantity == LOAD_ACCELERATION_X || load->quantity == LOAD_ACCELERATION_Y;
    if (binding_bad(b, b->blocks[BLOCK_BODY][load->mover], "motion"))
        return;
    if (accelerates && body->motion != MOTION_FREE)
        findings_error(b->findings, load_place(b, i), "'%s' needs motion = free, and the body '%s' is %s",
                       name, body->name, motions[body->motion]);
    else if (!accelerates && load->quantity != LOAD_TEMPERATURE && body->motion != MOTION_DRIVEN)
        findings_error(b->findings, load_place(b, i), "'%s' needs motion = driven, and the body '%s' is %s",
                       name, body->name, motions[body->motion]);
    for (size_t m = 0; m < body->n_mix && load->quantity == LOAD_TEMPERATURE; m++) {
        const struct material_config *material = &b->config->materials[body->mix_material[m]];
        if (isnan(material->cp) && binding_missing(b, b->blocks[BLOCK_MATERIAL][body->mix_material[m]], "cp"))
            findings_error(b->findings, load_place(b, i),
                           "'temperature' needs 'cp' of the material '%s': without a heat capacity its "
                           "temperature stays",
                           material->name);
    }
}

static void check_ends(const struct deck_binding *b, size_t i)
{
    const struct load_config *load = load_at(b, i);
    struct number_text first, last;
    if (load->repeat && load->value[0] != load->value[load->n - 1])
        findings_error(b->findings, load_place(b, i),
                       "'%s' repeats, so that its first value and its last are equal, not %s and %s",
                       quantity_name(load->quantity), number_text(load->value[0], &first),
                       number_text(load->value[load->n - 1], &last));
}

/* A body or a wall under a force does not turn, because the force acts on one of its sides. */
static void check_force_alone(const struct deck_binding *b, size_t i)
{
    const struct config *c = b->config;
    const struct load_config *load = load_at(b, i);
    if (!is_force(load->quantity))
        return;
    const bool wall = load->mover >= c->n_bodies;
    double spin = wall ? c->walls[load->mover - c->n_bodies].spin : c->bodies[load->mover].spin;
    if ((wall || c->bodies[load->mover].motion == MOTION_DRIVEN) &&
        (spin != 0 || config_load(c, load->mover, LOAD_SPIN) != NULL))
        findings_error(b->findings, load_place(b, i),
                       "the %s '%s' has a spin, and under a force a %s does not turn: leave one of them out",
                       wall ? "wall" : "body", config_mover_name(c, load->mover), wall ? "wall" : "body");
}

/* Refuses the keywords of forces and stresses for other loads, and contradictions among them. */
static void check_force_keys(const struct deck_binding *b, size_t i)
{
    static const char *const keys[] = {"zeta", "max_velocity", "mass", "length", "between"};
    const struct load_config *load = load_at(b, i);
    size_t block = b->blocks[BLOCK_LOAD][i];
    bool force = false, stress = false;
    for (size_t k = 0; k < b->config->n_loads; k++) { /* a block may have several quantities */
        if (b->blocks[BLOCK_LOAD][k] != block)
            continue;
        force = force || is_force(load_at(b, k)->quantity);
        stress =
            stress || load_at(b, k)->quantity == LOAD_STRESS_XX || load_at(b, k)->quantity == LOAD_STRESS_YY;
    }
    for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++)
        if (binding_given(b, block, keys[k]) && !(k < 3 ? force : stress))
            findings_error(b->findings, binding_place(b, block, keys[k], 0),
                           "'%s' belongs to a %s; the load '%s' has none", keys[k],
                           k < 3 ? "force or a stress" : "stress", load->name);
    if (binding_given(b, block, "length") && binding_given(b, block, "between"))
        findings_error(b->findings, binding_place(b, block, "between", 0),
                       "give 'length' or 'between', not both");
    for (size_t a = 0; a < 2; a++)
        if (load->quantity == (a == 0 ? LOAD_STRESS_XX : LOAD_STRESS_YY) && b->config->periodic[a])
            findings_error(b->findings, load_place(b, i),
                           "'%s' acts on a side, and the domain is periodic in %c: it has no side there",
                           quantity_name(load->quantity), "xy"[a]);
}

/* --- spins --- */

/* A body that turns about its centroid: through no periodic side onto itself, and within the range of
 * angles. `fastest`: of its spins, 1/us. */
static void check_turn(const struct deck_binding *b, size_t body, struct deck_place place, double fastest)
{
    const struct config *c = b->config;
    double box[4], angle = fastest * (double)c->steps * c->dt;
    if (c->bodies[body].motion == MOTION_DRIVEN && angle > turn_most)
        findings_error(b->findings, place,
                       "the body '%s' would turn by %.3g radians; angles are computed up to %g",
                       c->bodies[body].name, angle, turn_most);
    if (!binding_given(b, b->blocks[BLOCK_BODY][body], "shape"))
        return;
    shape_box(&c->bodies[body].shape, box);
    for (int a = 0; a < 2; a++)
        if (c->periodic[a] && box[a + 2] - box[a] + c->r_c > c->size[a])
            findings_error(b->findings, place,
                           "the body '%s' meets itself across the periodic %c: it cannot turn about its "
                           "centroid",
                           c->bodies[body].name, "xy"[a]);
}

static void check_body_spin(const struct deck_binding *b, size_t i)
{
    const struct body_config *body = &b->config->bodies[i];
    size_t block = b->blocks[BLOCK_BODY][i];
    if (!binding_given(b, block, "spin") || body->spin == 0)
        return;
    struct deck_place place = binding_place(b, block, "spin", 0);
    if (body->motion == MOTION_FIXED)
        findings_error(b->findings, place,
                       "the body '%s' is fixed: it has no spin; 'motion = driven' keeps one", body->name);
    else
        check_turn(b, i, place, fabs(body->spin));
}

void check_loads(const struct deck_binding *b)
{
    const struct config *c = b->config;
    for (size_t i = 0; i < c->n_bodies; i++)
        check_body_spin(b, i);
    for (size_t i = 0; i < c->n_loads; i++) {
        const struct load_config *load = load_at(b, i);
        check_ends(b, i);
        check_force_keys(b, i);
        if (load->mover == MOVER_NONE)
            continue;
        check_twice(b, i);
        check_body_of(b, i);
        check_force_alone(b, i);
        double fastest = 0;
        for (size_t k = 0; k < load->n; k++)
            fastest = fmax(fastest, fabs(load->value[k]));
        if (load->quantity == LOAD_SPIN && load->mover < c->n_bodies)
            check_turn(b, load->mover, load_place(b, i), fastest);
    }
}
