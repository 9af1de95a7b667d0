/* A body is a shape filled with the sites of a lattice: site (row j, column i) lies at
 *   hexagonal: origin + (i + (j odd ? 1/2 : 0)) d along the row + j row_spacing across it,
 *   square:    origin + i d + j row_spacing,
 * turned about the origin by the body's angle. An element is made where a site's centre is in the shape. */
#include "dm2/sim/generate.h"

#include <math.h>

#include "dm2/base/random.h"
#include "dm2/base/real.h"
#include "dm2/sim/tables.h"

static bool shape_holds(const struct shape_config *s, double x, double y)
{
    if (s->kind == SHAPE_RECTANGLE)
        return x >= s->box[0] && x < s->box[2] && y >= s->box[1] && y < s->box[3];
    if (s->kind == SHAPE_DISC) {
        double dx = x - s->centre[0], dy = y - s->centre[1];
        return dx * dx + dy * dy <= s->radius * s->radius;
    }
    bool inside = false; /* even-odd rule: count the edges that a ray towards +x crosses */
    for (size_t i = 0, j = s->n_vertices - 1; i < s->n_vertices; j = i++) {
        const double *a = s->vertex[i], *b = s->vertex[j];
        if ((a[1] > y) != (b[1] > y) && x < (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) + a[0])
            inside = !inside;
    }
    return inside;
}

static void shape_bounds(const struct shape_config *s, double box[4])
{
    if (s->kind == SHAPE_RECTANGLE) {
        for (int a = 0; a < 4; a++)
            box[a] = s->box[a];
        return;
    }
    if (s->kind == SHAPE_DISC) {
        for (int a = 0; a < 2; a++) {
            box[a] = s->centre[a] - s->radius;
            box[a + 2] = s->centre[a] + s->radius;
        }
        return;
    }
    for (int a = 0; a < 2; a++) {
        box[a] = box[a + 2] = s->vertex[0][a];
        for (size_t i = 1; i < s->n_vertices; i++) {
            box[a] = s->vertex[i][a] < box[a] ? s->vertex[i][a] : box[a];
            box[a + 2] = s->vertex[i][a] > box[a + 2] ? s->vertex[i][a] : box[a + 2];
        }
    }
}

/* The lattice of one body in numbers. */
struct sites {
    double origin[2], cosine, sine, d, row;
    double shift; /* of odd rows along the row, cm */
    int64_t row_first, row_last, column_first, column_last;
};

static void sites_of(const struct body_config *b, struct sites *s)
{
    double box[4], low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    *s = (struct sites){.cosine = 1.0, .sine = 0.0, .d = b->spacing, .row = b->row_spacing};
    if (b->angle != 0.0) {
        s->cosine = real_cos(b->angle);
        s->sine = real_sin(b->angle);
    }
    s->shift = b->lattice == LATTICE_HEXAGONAL ? 0.5 * b->spacing : 0.0;
    shape_bounds(&b->shape, box);
    for (int corner = 0; corner < 4; corner++) {
        double dx = box[(corner & 1) * 2] - b->origin[0], dy = box[(corner >> 1) * 2 + 1] - b->origin[1];
        double along[2] = {s->cosine * dx + s->sine * dy, s->cosine * dy - s->sine * dx};
        for (int a = 0; a < 2; a++) {
            low[a] = along[a] < low[a] ? along[a] : low[a];
            high[a] = along[a] > high[a] ? along[a] : high[a];
        }
    }
    for (int a = 0; a < 2; a++)
        s->origin[a] = b->origin[a];
    s->column_first = (int64_t)floor(low[0] / s->d) - 1;
    s->column_last = (int64_t)ceil(high[0] / s->d) + 1;
    s->row_first = (int64_t)floor(low[1] / s->row) - 1;
    s->row_last = (int64_t)ceil(high[1] / s->row) + 1;
}

static void site_position(const struct sites *s, int64_t row, int64_t column, double out[2])
{
    double along = (double)column * s->d + ((row & 1) != 0 ? s->shift : 0.0), across = (double)row * s->row;
    out[0] = s->origin[0] + (s->cosine * along - s->sine * across);
    out[1] = s->origin[1] + (s->sine * along + s->cosine * across);
}

/* The material of an element of a mix: the one in whose share of [0, 1) its random number falls. */
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

static uint8_t probes_at(const struct config *c, const double r[2])
{
    uint8_t mask = 0;
    for (size_t p = 0; p < c->n_probes; p++) {
        const double *box = c->probes[p].box;
        if (r[0] >= box[0] && r[0] < box[2] && r[1] >= box[1] && r[1] < box[3])
            mask = (uint8_t)(mask | 1u << p);
    }
    return mask;
}

static void make_element(const struct model *model, size_t body, uint32_t id, const double r[2], struct element *e)
{
    const struct config *c = model->config;
    const struct body_config *b = &c->bodies[body];
    int material = choose_material(b, id);
    const struct kind *kind = &model->kinds[material];
    *e = (struct element){.id = id, .grain = (uint32_t)body, .body = (uint16_t)body, .kind = (uint16_t)material,
                          .flags = b->motion == MOTION_FREE ? 0 : ELEMENT_FIXED_MOTION, .radius = b->radius};
    e->mass = model_element_mass(&c->materials[material], b->radius);
    for (int a = 0; a < 2; a++) {
        e->r[a] = r[a];
        e->v[a] = b->velocity[a];
        if (b->jitter > 0.0)
            e->v[a] += b->jitter * (2.0 * random_uniform(b->seed, id, RANDOM_VELOCITY_X + a) - 1.0);
    }
    if (isfinite(kind->cp))
        e->heat = e->mass * kind->cp * (b->temperature - kind->t0);
    e->probes = probes_at(c, r);
}

enum dm2_status generate_elements(const struct model *model, element_sink sink, void *context, struct dm2_error *err)
{
    const struct config *c = model->config;
    uint64_t id = 0;
    for (size_t body = 0; body < c->n_bodies; body++) {
        struct sites s;
        uint64_t first = id;
        sites_of(&c->bodies[body], &s);
        for (int64_t row = s.row_first; row <= s.row_last; row++) {
            for (int64_t column = s.column_first; column <= s.column_last; column++) {
                double r[2];
                struct element e;
                site_position(&s, row, column, r);
                if (!shape_holds(&c->bodies[body].shape, r[0], r[1]))
                    continue;
                if (id >= UINT32_MAX)
                    return dm2_fail(err, DM2_DECK, "the deck makes more than 2^32 - 1 elements");
                make_element(model, body, (uint32_t)id, r, &e);
                id++;
                enum dm2_status status = sink(context, &e, err);
                if (status != DM2_OK)
                    return status;
            }
        }
        if (id == first)
            return dm2_fail(err, DM2_DECK, "body '%s' holds no element: no lattice site has its centre in its shape",
                            c->bodies[body].name);
    }
    return DM2_OK;
}
