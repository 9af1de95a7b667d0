/* Bodies and walls under force: what bodies cover and weigh is found by one more walk of the generator, which
 * decks without such loads do not make. */
#include "forced.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "dm2/engine/load_totals.h"
#include "generate.h"
#include "kinds.h"
#include "motion.h"
#include "tables.h"
#include "wall_shape.h"

static const double share_most = 0.3;    /* of omega dt: the equation is stable up to here on soft ground */
static const double mass_factor = 25.0;  /* of the default mass: omega dt = 0.2 */
static const double reset_factor = 25.0; /* of the time T in which the offset acts, in steps per diameter */

static bool is_force(enum load_quantity q)
{
    return q >= LOAD_FORCE_X && q <= LOAD_STRESS_YY;
}

static const char *const axis_names[2] = {"x", "y"};

/* --- what the elements of a body cover, or the points of a wall --- */

struct body_extent {
    double low[2], high[2]; /* cm */
    double mass;            /* g; of a wall 0 */
    double along;           /* length of a wall, cm; of a body 0 */
};

struct body_extents {
    struct body_extent *of; /* [movers] */
    double least;           /* smallest radius, cm, */
    double lightest;        /* and the least mass of such an element, g */
};

/* Takes an element, if it is smaller or as small and lighter. */
static void note_least(struct body_extents *x, double radius, double mass)
{
    if (radius > x->least || (radius == x->least && mass >= x->lightest))
        return;
    x->least = radius;
    x->lightest = mass;
}

static enum dm2_status add_extent(void *context, const struct element *e, struct dm2_error *err)
{
    struct body_extents *x = context;
    struct body_extent *of = &x->of[e->body];
    (void)err;
    for (int a = 0; a < 2; a++) {
        of->low[a] = fmin(of->low[a], e->r[a] - e->radius);
        of->high[a] = fmax(of->high[a], e->r[a] + e->radius);
    }
    of->mass += e->mass;
    note_least(x, e->radius, e->mass);
    return DM2_OK;
}

static void measure_wall(const struct wall_config *w, struct body_extent *of)
{
    for (size_t k = 0; k < w->n_points; k++) {
        const double *p = w->points + 2 * k;
        for (int a = 0; a < 2; a++) {
            of->low[a] = fmin(of->low[a], p[a]);
            of->high[a] = fmax(of->high[a], p[a]);
        }
        if (k + 1 < w->n_points)
            of->along += sqrt((p[2] - p[0]) * (p[2] - p[0]) + (p[3] - p[1]) * (p[3] - p[1]));
    }
    if (w->n_points > 0)
        return;
    for (int a = 0; a < 2; a++) {
        of->low[a] = w->circle[a] - w->circle[2];
        of->high[a] = w->circle[a] + w->circle[2];
    }
    of->along = 0x1.921fb54442d18p2 * w->circle[2]; /* 2 pi R */
}

/* Measures all bodies and walls. *x is to be freed by free(x->of), after an error, too. */
static enum dm2_status find_extents(const struct model *m, struct body_extents *x, struct dm2_error *err)
{
    const struct config *c = m->config;
    size_t n = config_movers(c);
    *x = (struct body_extents){.of = mem_zalloc(n, sizeof *x->of), .least = INFINITY};
    if (x->of == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the extents of %zu bodies", n);
    for (size_t b = 0; b < n; b++)
        x->of[b] = (struct body_extent){.low = {INFINITY, INFINITY}, .high = {-INFINITY, -INFINITY}};
    for (size_t w = 0; w < c->n_walls; w++)
        measure_wall(&c->walls[w], &x->of[c->n_bodies + w]);
    for (size_t b = 0; b < c->n_bodies; b++) {
        const struct body_start *s = &c->bodies[b].start;
        if (!c->bodies[b].from_state)
            continue;
        x->of[b] = (struct body_extent){
            .low = {s->low[0], s->low[1]}, .high = {s->high[0], s->high[1]}, .mass = s->mass};
        note_least(x, s->least, s->lightest);
    }
    return generate_elements(m, add_extent, x, err);
}

/* --- one load --- */

/* The stiffest law between elements of the body and wall w, Mbar cm. */
static double find_wall_stiffness(const struct model *m, const struct body_config *body, const struct wall *w)
{
    double stiffness = 0.0;
    for (size_t i = 0; i < body->n_mix; i++)
        for (size_t k = 0; k < m->n_kinds; k++)
            if (kind_may_become(m, body->mix_material[i], k))
                stiffness = fmax(stiffness, w->laws[k].k);
    return stiffness;
}

/* The stiffest law between the mover and elements of others or walls, Mbar cm. */
static double find_stiffness(const struct model *m, size_t mover)
{
    const struct config *c = m->config;
    double stiffness = 0.0;
    if (mover >= c->n_bodies) {
        for (size_t b = 0; b < c->n_bodies; b++)
            stiffness =
                fmax(stiffness, find_wall_stiffness(m, &c->bodies[b], &m->walls[mover - c->n_bodies]));
        return stiffness;
    }
    const size_t body = mover;
    const struct body_config *own = &c->bodies[body];
    for (size_t w = 0; w < m->n_walls; w++)
        stiffness = fmax(stiffness, find_wall_stiffness(m, own, &m->walls[w]));
    for (size_t other = 0; other < c->n_bodies; other++) {
        const struct body_config *b = &c->bodies[other];
        for (size_t pair = 0; other != body && pair < own->n_mix * b->n_mix; pair++) {
            int one = own->mix_material[pair / b->n_mix], two = b->mix_material[pair % b->n_mix];
            for (size_t k = 0; k < m->n_kinds * m->n_kinds; k++) {
                size_t i = k / m->n_kinds, j = k % m->n_kinds;
                if (kind_may_become(m, one, i) && kind_may_become(m, two, j))
                    stiffness = fmax(stiffness, model_law(m, i, j, RELATION_OTHER_BODY)->k);
            }
        }
    }
    return stiffness;
}

/* The gap of the movers between[2] along axis `across`, cm, and facing[2]; not above 0 where they overlap. */
static double find_gap(const struct body_extents *x, const size_t between[2], int across, size_t facing[2])
{
    bool swapped = x->of[between[0]].low[across] > x->of[between[1]].low[across];
    facing[0] = between[swapped ? 1 : 0];
    facing[1] = between[swapped ? 0 : 1];
    return x->of[facing[1]].low[across] - x->of[facing[0]].high[across];
}

/* The length on which a stress acts, at the start, and the movers that bound it. */
static enum dm2_status find_length(const struct model *m, const struct body_extents *x, size_t mover,
                                   int axis, struct forced_axis *at, struct dm2_error *err)
{
    const struct config *c = m->config;
    const struct load_config *load = at->load;
    int across = 1 - axis;
    at->facing[0] = at->facing[1] = MOVER_NONE;
    at->length = x->of[mover].high[across] - x->of[mover].low[across];
    if (load->between[0] != MOVER_NONE) {
        for (int k = 0; k < 2; k++)
            if (load->between[k] < c->n_bodies && c->bodies[load->between[k]].motion == MOTION_FREE)
                return config_fail(
                    load->mass_place, err, DM2_DECK,
                    "load '%s': `between` takes two walls, or bodies that are fixed or driven, and '%s' is "
                    "not: name two such bodies, or give `length`",
                    load->name, config_mover_name(c, load->between[k]));
        at->length = find_gap(x, load->between, across, at->facing);
        if (!(at->length > 0.0))
            return config_fail(
                load->mass_place, err, DM2_DECK,
                "load '%s': there is no gap along %s between '%s' and '%s': name two bodies apart, "
                "or give `length`",
                load->name, axis_names[across], config_mover_name(c, load->between[0]),
                config_mover_name(c, load->between[1]));
    } else if (!isnan(load->length)) {
        at->length = load->length;
    } else if (c->periodic[across]) {
        at->length = c->size[across];
    }
    if (!at->stress || at->length > 0.0)
        return DM2_OK;
    return config_fail(
        load->mass_place, err, DM2_DECK,
        "load '%s': the wall '%s' has no extent along %s on which a stress acts: give `length` or "
        "`between`",
        load->name, config_mover_name(c, mover), axis_names[across]);
}

/* How many of the smallest elements touch the mover, side by side. A wall is touched along its whole length.
 */
static double count_contacts(const struct body_extents *x, size_t mover, double length)
{
    return fmax(1.0, fmax(length, x->of[mover].along) / (2.0 * x->least));
}

static double find_greatest(const struct load_config *load)
{
    double most = 0.0;
    for (size_t i = 0; i < load->n; i++)
        most = fmax(most, fabs(load->value[i]));
    return most;
}

/* max_velocity: at this speed a row of the smallest elements, as long as the load, meets a wall with the
 * asked load. */
static enum dm2_status find_fastest(const struct load_config *load, const struct forced_axis *at,
                                    const struct body_extents *x, double n, double *fastest,
                                    struct dm2_error *err)
{
    double most = find_greatest(load) * (at->stress ? at->length : 1.0) + fabs(at->weight);
    *fastest = load->max_velocity;
    if (isnan(*fastest))
        *fastest = most / n / sqrt(at->control.stiffness * x->lightest);
    if (*fastest > 0.0)
        return DM2_OK;
    return config_fail(
        load->mass_place, err, DM2_DECK,
        "load '%s' is 0 at all times, so no greatest velocity of the body follows from it: give "
        "`max_velocity`",
        load->name);
}

/* Fills one axis of the mover from its load. */
static enum dm2_status fill_axis(const struct model *m, const struct body_extents *x, size_t mover, int axis,
                                 const struct load_config *load, struct forced_axis *at,
                                 struct dm2_error *err)
{
    const struct config *c = m->config;
    const struct body_extent *of = &x->of[mover];
    double dt = c->dt;
    *at = (struct forced_axis){.load = load, .stress = load->quantity >= LOAD_STRESS_XX};
    enum dm2_status status = find_length(m, x, mover, axis, at, err);
    if (status != DM2_OK)
        return status;
    double n = count_contacts(x, mover, at->length), k = find_stiffness(m, mover);
    double middle = c->origin[axis] + 0.5 * c->size[axis];
    at->side = 0.5 * (of->low[axis] + of->high[axis]) > middle ? 1.0 : -1.0;
    at->weight = at->stress ? 0.0 : of->mass * c->gravity[axis];
    at->control = (struct control_constants){
        .dt = dt,
        .mass = isnan(load->mass) ? fmax(mass_factor * n * k * (dt * dt), of->mass) : load->mass,
        .stiffness = k,
        .zeta = load->zeta,
        .reset = reset_factor * dt * (c->size[axis] / (2.0 * x->least))};
    at->share = dt * sqrt(n * k / at->control.mass);
    if (at->share > share_most)
        return config_fail(
            load->mass_place, err, DM2_DECK,
            "load '%s': mass = %g g gives omega dt = %.3g with %.0f contacts, above %g the body "
            "throws off what it touches: give at least %.3g g, or leave it out",
            load->name, load->mass, at->share, n, share_most, n * k * (dt * dt) / (share_most * share_most));
    return find_fastest(load, at, x, n, &at->control.fastest, err);
}

/* --- all loads --- */

/* The forced body of a mover, added where it is new; NULL beyond FORCED_MAX. */
static struct forced_body *get_forced(struct model *m, const struct body_extents *x, size_t mover)
{
    if (m->forced_of[mover] == 0) {
        if (m->n_forced == FORCED_MAX)
            return NULL;
        struct forced_body *new = &m->forced[m->n_forced++];
        new->mover = mover;
        new->radius = x->least;
        for (int a = 0; a < 2; a++) {
            new->low[a] = x->of[mover].low[a];
            new->high[a] = x->of[mover].high[a];
        }
        m->forced_of[mover] = (uint8_t)m->n_forced;
    }
    return &m->forced[m->forced_of[mover] - 1];
}

/* Puts the bodies in the order of movers, that of the records in a state. */
static void sort_forced(struct model *m)
{
    for (size_t i = 1; i < m->n_forced; i++)
        for (size_t k = i; k > 0 && m->forced[k].mover < m->forced[k - 1].mover; k--) {
            struct forced_body later = m->forced[k - 1];
            m->forced[k - 1] = m->forced[k];
            m->forced[k] = later;
        }
    for (size_t i = 0; i < m->n_forced; i++)
        m->forced_of[m->forced[i].mover] = (uint8_t)(i + 1);
}

static enum dm2_status fill_forced(struct model *m, const struct body_extents *x, struct dm2_error *err)
{
    const struct config *c = m->config;
    for (size_t i = 0; i < c->n_loads; i++) {
        const struct load_config *load = &c->loads[i];
        if (!is_force(load->quantity))
            continue;
        struct forced_body *body = get_forced(m, x, load->mover);
        if (body == NULL)
            return config_fail(load->mass_place, err, DM2_DECK,
                               "load '%s': at most %d bodies and walls move by forces or stresses",
                               load->name, FORCED_MAX);
        int axis = load->quantity == LOAD_FORCE_Y || load->quantity == LOAD_STRESS_YY;
        enum dm2_status status = fill_axis(m, x, load->mover, axis, load, &body->axis[axis], err);
        if (status != DM2_OK)
            return status;
    }
    sort_forced(m);
    return DM2_OK;
}

enum dm2_status forced_build(struct model *m, struct dm2_error *err)
{
    const struct config *c = m->config;
    const struct load_config *first = NULL;
    for (size_t i = c->n_loads; i > 0; i--)
        if (is_force(c->loads[i - 1].quantity))
            first = &c->loads[i - 1];
    if (first == NULL)
        return DM2_OK;
    if (m->has_far)
        return config_fail(first->mass_place, err, DM2_DECK,
                           "load '%s': a body moves by forces only where all interactions have scope linked, "
                           "because the motion follows from its contacts",
                           first->name);
    struct body_extents x;
    m->forced = mem_zalloc(FORCED_MAX, sizeof *m->forced);
    m->forced_of = mem_zalloc(config_movers(c), sizeof *m->forced_of);
    enum dm2_status status = find_extents(m, &x, err);
    if (status == DM2_OK && (m->forced == NULL || m->forced_of == NULL))
        status = dm2_fail(err, DM2_MEMORY, "no memory for the loads of %zu bodies", c->n_bodies);
    if (status == DM2_OK)
        status = fill_forced(m, &x, err);
    free(x.of);
    return status;
}

double forced_load(const struct model *m, const struct forced_axis *axis, int64_t step, double gap)
{
    double value = motion_load(m, (size_t)(axis->load - m->config->loads), step);
    if (!axis->stress)
        return value;
    return axis->side * value * (axis->facing[0] == MOVER_NONE ? axis->length : gap);
}
