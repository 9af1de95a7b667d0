/* A body is a shape filled with the sites of a lattice; site (row j, column i) lies at
 *   hexagonal: origin + (i + (j odd ? 1/2 : 0)) d along the row + j row_spacing across it,
 *   square:    origin + i d + j row_spacing,
 * turned about the origin by the body's angle. A site holds an element where the site is in the shape and in
 * no void; voids and regions of probes go round the periodic sides. A polycrystal or a powder is filled grain
 * by grain; each grain has its own angle and origin (grains.h). */
#include "generate.h"

#include <math.h>

#include "dm2/base/grid.h"
#include "dm2/base/random.h"
#include "dm2/base/real.h"
#include "dm2/deck/shape.h"
#include "grains.h"
#include "kinds.h"
#include "tables.h"

/* The lattice of one body or grain, and the range of its sites in a box. */
struct sites {
    double origin[2], cosine, sine, d, row;
    double shift; /* offset of odd rows along the row, cm */
    int64_t row_first, row_last, column_first, column_last;
};

/* Finds the rows and columns of a lattice through `origin` whose sites may lie in the box. */
static void find_sites(const struct body_config *b, const double origin[2], double cosine, double sine,
                       const double box[4], struct sites *s)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    *s = (struct sites){.origin = {origin[0], origin[1]},
                        .cosine = cosine,
                        .sine = sine,
                        .d = b->spacing,
                        .row = b->row_spacing};
    s->shift = b->lattice == LATTICE_HEXAGONAL ? 0.5 * b->spacing : 0.0;
    for (int corner = 0; corner < 4; corner++) {
        double dx = box[(corner & 1) * 2] - origin[0], dy = box[(corner >> 1) * 2 + 1] - origin[1];
        double along[2] = {s->cosine * dx + s->sine * dy, s->cosine * dy - s->sine * dx};
        for (int a = 0; a < 2; a++) {
            low[a] = along[a] < low[a] ? along[a] : low[a];
            high[a] = along[a] > high[a] ? along[a] : high[a];
        }
    }
    s->column_first = (int64_t)floor(low[0] / s->d) - 1;
    s->column_last = (int64_t)ceil(high[0] / s->d) + 1;
    s->row_first = (int64_t)floor(low[1] / s->row) - 1;
    s->row_last = (int64_t)ceil(high[1] / s->row) + 1;
}

static void locate_site(const struct sites *s, int64_t row, int64_t column, double out[2])
{
    double along = (double)column * s->d + ((row & 1) != 0 ? s->shift : 0.0), across = (double)row * s->row;
    out[0] = s->origin[0] + (s->cosine * along - s->sine * across);
    out[1] = s->origin[1] + (s->sine * along + s->cosine * across);
}

/* The material of an element with number `id`, or of all elements of a grain with number `id` where the body
 * has grains: the mix divides [0, 1) in the ratio of its fractions, and the random number of `id` picks the
 * part. */
static int choose_material(const struct body_config *b, uint32_t id)
{
    if (b->n_mix == 1)
        return b->mix_material[0];
    double u = random_uniform(b->seed, id, RANDOM_MIX), sum = 0.0;
    for (size_t m = 0; m + 1 < b->n_mix; m++) {
        sum += b->mix_fraction[m];
        if (u < sum)
            return b->mix_material[m];
    }
    return b->mix_material[b->n_mix - 1];
}

int generate_material(const struct body_config *b, uint32_t id, uint32_t grain)
{
    return choose_material(b, b->structure == STRUCTURE_CRYSTAL ? id : grain);
}

uint8_t generate_probes(const struct config *c, const double r[2], double spacing)
{
    uint8_t mask = 0;
    for (size_t p = 0; p < c->n_probes; p++) {
        const double *box = c->probes[p].box;
        if (c->probes[p].mover >= 0)
            continue;
        struct shape_config region = {.kind = SHAPE_RECTANGLE, .box = {box[0], box[1], box[2], box[3]}};
        if (shape_contains_image(&region, c, r, spacing))
            mask = (uint8_t)(mask | 1u << c->probes[p].bit);
    }
    return mask;
}

struct generation {
    const struct model *model;
    element_sink sink;
    void *context;
    uint64_t id;    /* of the next element */
    uint64_t grain; /* of the next grain */
    size_t body;
    bool has_voids;            /* some void applies to this body */
    bool turns;                /* this body has a centroid: it turns, or follows a table */
    bool placed;               /* its elements have homes */
    struct rigid_motion start; /* its velocity, where it is placed, and its spin */
    double temperature;        /* of this body at the start, K */
    struct grain_set set;      /* the grains of this body, if any */
    double apart;              /* least distance of elements of two grains, cm */
};

/* Sets home, velocity and spin of an element at r, not wrapped, of a body that follows a table or turns. */
static void start_motion(const struct generation *g, const double r[2], struct element *e)
{
    const double *centroid = g->model->centroids != NULL ? &g->model->centroids[2 * g->body] : NULL;
    const struct rigid_motion *start = &g->start;
    for (int a = 0; a < 2; a++)
        e->home[a] = centroid != NULL ? r[a] - centroid[a] : r[a];
    e->v[0] = (g->placed ? start->vx : e->v[0]) - start->spin * e->home[1];
    e->v[1] = (g->placed ? start->vy : e->v[1]) + start->spin * e->home[0];
    e->w = start->spin;
    if (!g->placed && centroid != NULL)
        e->home[0] = e->home[1] = 0.0;
}

static enum dm2_status make_element(struct generation *g, uint64_t grain, const double r[2],
                                    struct dm2_error *err)
{
    const struct model *model = g->model;
    const struct config *c = model->config;
    const struct body_config *b = &c->bodies[g->body];
    if (g->id >= UINT32_MAX)
        return dm2_fail(err, DM2_DECK, "the deck makes more than 2^32 - 1 elements");
    uint32_t id = (uint32_t)g->id++;
    int material = generate_material(b, id, (uint32_t)grain);
    const struct kind *kind = &model->kinds[material];
    struct element e = {.id = id,
                        .grain = (uint32_t)grain,
                        .body = (uint16_t)g->body,
                        .kind = (uint16_t)material,
                        .was = (uint16_t)(model->has_kinds ? material : 0),
                        .flags = b->motion == MOTION_FREE ? 0 : ELEMENT_FIXED_MOTION,
                        .radius = b->radius};
    e.mass = kind_mass(&c->materials[material], b->radius);
    for (int a = 0; a < 2; a++) {
        int32_t turns;
        e.r[a] = c->periodic[a] ? grid_wrap(c->origin[a], c->size[a], r[a], &turns) : r[a];
        e.v[a] = b->velocity[a];
        if (b->jitter > 0.0)
            e.v[a] += b->jitter * (2.0 * random_uniform(b->seed, id, RANDOM_VELOCITY_X + a) - 1.0);
    }
    if (g->turns)
        start_motion(g, r, &e);
    if (isfinite(kind->cp))
        e.heat = e.mass * kind->cp * (g->temperature - kind->t0);
    for (int a = 0; a < 2 && model->reaction.any; a++)
        e.share[a] = material == model->reaction.reactant[a] ? 1.0 : 0.0;
    e.probes = generate_probes(c, e.r, b->spacing);
    if (pulse_stopped(&model->pulse))
        return pulse_give_up(err);
    return g->sink(g->context, &e, err);
}

/* Is r within the shape of the body and in no void? */
static bool is_in_body(const struct generation *g, const double r[2])
{
    const struct config *c = g->model->config;
    double spacing = c->bodies[g->body].spacing;
    if (!shape_contains_site(&c->bodies[g->body].shape, r, spacing))
        return false;
    for (size_t k = 0; g->has_voids && k < c->n_voids; k++) {
        const struct void_config *v = &c->voids[k];
        if ((v->body < 0 || (size_t)v->body == g->body) && shape_contains_image(&v->shape, c, r, spacing))
            return false;
    }
    return true;
}

static enum dm2_status fill_crystal(struct generation *g, struct dm2_error *err)
{
    const struct body_config *b = &g->model->config->bodies[g->body];
    double box[4];
    struct sites s;
    shape_box(&b->shape, box);
    find_sites(b, b->origin, b->angle != 0.0 ? real_cos(b->angle) : 1.0,
               b->angle != 0.0 ? real_sin(b->angle) : 0.0, box, &s);
    for (int64_t row = s.row_first; row <= s.row_last; row++) {
        pulse_beat(&g->model->pulse);
        for (int64_t column = s.column_first; column <= s.column_last; column++) {
            double r[2];
            locate_site(&s, row, column, r);
            if (!is_in_body(g, r))
                continue;
            enum dm2_status status = make_element(g, g->grain, r, err);
            if (status != DM2_OK)
                return status;
        }
    }
    g->grain++;
    return DM2_OK;
}

/* --- bodies with grains --- */

/* The position in the domain of x, which may lie beyond a periodic side that the body spans. */
static void wrap_position(const struct grain_set *set, const double x[2], double r[2])
{
    int32_t turns;
    for (int a = 0; a < 2; a++)
        r[a] = set->wraps[a] ? grid_wrap(set->low[a], set->period[a], x[a], &turns) : x[a];
}

/* Does grain `other`, shifted by `shift`, hold a site whose distance from x is below g->apart? */
static bool has_site_near(const struct generation *g, const struct grain *other, const double shift[2],
                          const double x[2])
{
    const struct body_config *b = &g->model->config->bodies[g->body];
    double at[2] = {x[0] - shift[0], x[1] - shift[1]};
    double box[4] = {at[0] - g->apart, at[1] - g->apart, at[0] + g->apart, at[1] + g->apart};
    double least2 = g->apart * g->apart * (1.0 - 1e-9);
    struct sites s;
    find_sites(b, other->centre, other->cosine, other->sine, box, &s);
    for (int64_t row = s.row_first; row <= s.row_last; row++) {
        for (int64_t column = s.column_first; column <= s.column_last; column++) {
            double y[2], r[2];
            locate_site(&s, row, column, y);
            double dx = y[0] - at[0], dy = y[1] - at[1];
            if (dx * dx + dy * dy >= least2 || !grain_holds(&g->set, other, y, 0.0))
                continue;
            wrap_position(&g->set, y, r);
            if (is_in_body(g, r))
                return true;
        }
    }
    return false;
}

/* Does grain `index` keep its site x at its boundaries? A grain loses each site too close to a site of a
 * neighbour with a lower number, even if the neighbour loses its site to a third grain, so that the answer
 * depends on the places of the grains alone. */
static bool keeps_site(const struct generation *g, size_t index, const double x[2])
{
    const struct grain *grain = &g->set.grain[index];
    for (size_t k = 0; k < grain->n_sides; k++) {
        const struct grain_side *side = &g->set.side[grain->first_side + k];
        bool first = side->neighbour != GRAIN_NO_NEIGHBOUR && (size_t)side->neighbour < index;
        if ((size_t)side->neighbour == index) /* the grain's own image across a periodic side */
            first = side->shift[0] > 0.0 || (side->shift[0] == 0.0 && side->shift[1] > 0.0);
        double inside = side->offset - (side->normal[0] * x[0] + side->normal[1] * x[1]);
        if (first && inside < g->apart * side->length &&
            has_site_near(g, &g->set.grain[side->neighbour], side->shift, x))
            return false;
    }
    return true;
}

static enum dm2_status fill_grain(struct generation *g, size_t index, struct dm2_error *err)
{
    const struct body_config *b = &g->model->config->bodies[g->body];
    const struct grain *grain = &g->set.grain[index];
    bool cells = b->structure == STRUCTURE_POLYCRYSTAL;
    struct sites s;
    find_sites(b, grain->centre, grain->cosine, grain->sine, grain->box, &s);
    for (int64_t row = s.row_first; row <= s.row_last; row++) {
        pulse_beat(&g->model->pulse);
        for (int64_t column = s.column_first; column <= s.column_last; column++) {
            double x[2], r[2];
            locate_site(&s, row, column, x);
            if (!grain_holds(&g->set, grain, x, cells ? 0.0 : b->radius * (1.0 - 1e-9)))
                continue;
            wrap_position(&g->set, x, r);
            if (!is_in_body(g, r) || (cells && !keeps_site(g, index, x)))
                continue;
            enum dm2_status status = make_element(g, g->grain + index, r, err);
            if (status != DM2_OK)
                return status;
        }
    }
    return DM2_OK;
}

/* The least distance of elements of two grains, cm. Elements that start linked may be closer than their
 * contact distance, because their links start without force; unlinked elements would repel each other. */
static double find_least_distance(const struct config *c, const struct body_config *b)
{
    bool linked = true;
    for (size_t i = 0; i < b->n_mix; i++)
        for (size_t j = 0; j < b->n_mix; j++)
            linked =
                linked &&
                config_interaction(c, b->mix_material[i], b->mix_material[j], RELATION_OTHER_GRAIN).linked;
    return 2.0 * b->radius * (linked ? 0.8 : 1.0);
}

static enum dm2_status fill_grains(struct generation *g, struct dm2_error *err)
{
    const struct config *c = g->model->config;
    g->apart = find_least_distance(c, &c->bodies[g->body]);
    enum dm2_status status =
        grains_build(c, g->body, (uint32_t)g->grain, g->apart, &g->model->pulse, &g->set, err);
    if (status == DM2_OK && g->grain + g->set.n > UINT32_MAX)
        status = dm2_fail(err, DM2_DECK, "the deck makes more than 2^32 - 1 grains");
    for (size_t k = 0; k < g->set.n && status == DM2_OK; k++)
        status = fill_grain(g, k, err);
    g->grain += g->set.n;
    grains_free(&g->set);
    return status;
}

/* Sets what the elements of the body under way have in common at the start. */
static void start_body(struct generation *g)
{
    const struct model *m = g->model;
    const struct config *c = m->config;
    const struct load_config *held = config_load(c, g->body, LOAD_TEMPERATURE);
    g->turns = motion_needs_centroid(m, g->body);
    g->placed = m->placed[g->body];
    g->start = (struct rigid_motion){.spin = c->bodies[g->body].spin};
    if (g->placed)
        motion_at(m, g->body, m->config->n_start, &g->start);
    g->temperature = held != NULL ? motion_load(m, (size_t)(held - c->loads), m->config->n_start)
                                  : c->bodies[g->body].temperature;
}

enum dm2_status generate_elements(const struct model *model, element_sink sink, void *context,
                                  struct dm2_error *err)
{
    const struct config *c = model->config;
    struct generation g = {.model = model,
                           .sink = sink,
                           .context = context,
                           .id = c->start.next_id,
                           .grain = c->start.next_grain};
    for (g.body = 0; g.body < c->n_bodies; g.body++) {
        if (c->bodies[g.body].from_state)
            continue;
        uint64_t first = g.id;
        start_body(&g);
        g.has_voids = false;
        for (size_t k = 0; k < c->n_voids; k++)
            g.has_voids |= c->voids[k].body < 0 || (size_t)c->voids[k].body == g.body;
        enum dm2_status status =
            c->bodies[g.body].structure == STRUCTURE_CRYSTAL ? fill_crystal(&g, err) : fill_grains(&g, err);
        if (status != DM2_OK)
            return status;
        if (g.id == first)
            return dm2_fail(err, DM2_DECK,
                            "body '%s' holds no element: no lattice site has its centre in its shape",
                            c->bodies[g.body].name);
    }
    return DM2_OK;
}
