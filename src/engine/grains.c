/* Polycrystal: seeds at random places, at least 0.6 grain sizes apart where SEED_TRIES tries find such a
 * place; a grain is the Voronoi cell of its seed, cut out of the body's box by the bisectors with the
 * neighbours, nearest first. A cell whose vertices all lie within s of the seed is not cut by seeds further
 * away than 2 s.
 *
 * Powder: packing.c places the discs that are the grains, or in which polygon grains are inscribed.
 *
 * Where the body spans a periodic direction of the domain, cells and discs continue across its sides. */
#include "grains.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "dm2/base/random.h"
#include "dm2/base/real.h"
#include "dm2/deck/shape.h"
#include "grain_sizes.h"
#include "packing.h"
#include "point_bins.h"

static const double pi = 0x1.921fb54442d18p1;

enum { SEED_TRIES = 1000 };
static const double seed_distance = 0.6; /* in grain sizes */

/* --- Voronoi cells --- */

/* A seed or one of its periodic images. */
struct image {
    double x[2], shift[2];
    int64_t grain;
};

static bool seed_is_free(const struct point_bins *b, const struct grain_set *set, const double x[2],
                         double apart)
{
    int64_t i = point_bins_index(b, 0, x[0]), j = point_bins_index(b, 1, x[1]);
    for (int64_t v = j > 0 ? j - 1 : 0; v <= j + 1 && v < b->n[1]; v++) {
        for (int64_t u = i > 0 ? i - 1 : 0; u <= i + 1 && u < b->n[0]; u++) {
            for (int64_t k = b->head[v * b->n[0] + u]; k >= 0; k = b->next[k]) {
                double dx = set->grain[k].centre[0] - x[0], dy = set->grain[k].centre[1] - x[1];
                if (dx * dx + dy * dy < apart * apart)
                    return false;
            }
        }
    }
    return true;
}

static int place_seeds(const struct body_config *body, const double box[4], uint32_t first,
                       struct grain_set *set)
{
    struct point_bins bins;
    double apart = seed_distance * body->grain_size;
    int status = point_bins_start(&bins, box, box + 2, apart, set->n);
    for (size_t g = 0; status == 0 && g < set->n; g++) {
        pulse_beat(set->pulse);
        double *x = set->grain[g].centre;
        for (uint64_t k = 0; k < SEED_TRIES; k++) {
            uint64_t number = ((uint64_t)first + g) * SEED_TRIES + k;
            for (int a = 0; a < 2; a++)
                x[a] =
                    box[a] + (box[a + 2] - box[a]) *
                                 random_uniform(body->seed, number, a == 0 ? RANDOM_GRAIN_X : RANDOM_GRAIN_Y);
            if (seed_is_free(&bins, set, x, apart))
                break;
        }
        point_bins_add(&bins, (int64_t)g, x);
    }
    point_bins_free(&bins);
    return status;
}

/* Cuts the polygon at the side. False: the polygon is unchanged. */
static bool cut_polygon(struct polygon *o, const struct grain_side *side)
{
    struct polygon cut = {0};
    bool outside = false;
    double beyond[POLYGON_CORNERS];
    for (size_t i = 0; i < o->n; i++) {
        beyond[i] = side->normal[0] * o->x[i][0] + side->normal[1] * o->x[i][1] - side->offset;
        outside |= beyond[i] > 0.0;
    }
    if (!outside || o->n + 1 >= POLYGON_CORNERS)
        return false;
    for (size_t i = 0; i < o->n; i++) {
        size_t j = (i + 1) % o->n;
        if (beyond[i] <= 0.0) {
            cut.x[cut.n][0] = o->x[i][0];
            cut.x[cut.n++][1] = o->x[i][1];
        }
        if ((beyond[i] < 0.0 && beyond[j] > 0.0) || (beyond[i] > 0.0 && beyond[j] < 0.0)) {
            double t = beyond[i] / (beyond[i] - beyond[j]);
            for (int a = 0; a < 2; a++)
                cut.x[cut.n][a] = o->x[i][a] + t * (o->x[j][a] - o->x[i][a]);
            cut.n++;
        }
    }
    *o = cut;
    return true;
}

/* The square of the largest distance of a corner from x. */
static double find_reach2(const struct polygon *o, const double x[2])
{
    double reach = 0.0;
    for (size_t i = 0; i < o->n; i++) {
        double dx = o->x[i][0] - x[0], dy = o->x[i][1] - x[1];
        reach = dx * dx + dy * dy > reach ? dx * dx + dy * dy : reach;
    }
    return reach;
}

static void find_box(const struct polygon *o, double box[4])
{
    for (size_t i = 0; i < o->n; i++) {
        for (int a = 0; a < 2; a++) {
            box[a] = i == 0 || o->x[i][a] < box[a] ? o->x[i][a] : box[a];
            box[a + 2] = i == 0 || o->x[i][a] > box[a + 2] ? o->x[i][a] : box[a + 2];
        }
    }
}

static int add_side(struct grain_set *set, struct grain *g, const struct grain_side *side)
{
    struct grain_side *grown =
        mem_grown(set->side, &set->side_cap, set->n_sides, set->n_sides + 1, sizeof *grown);
    if (grown == NULL)
        return -1;
    set->side = grown;
    set->side[set->n_sides++] = *side;
    g->n_sides++;
    return 0;
}

/* Cuts the cell of g, polygon *o, by the bisector with one image. Adds the bisector to the sides of g where a
 * corner of the cell is within `apart` of the bisector or beyond it. */
static int cut_by_image(struct grain_set *set, struct grain *g, const struct image *im, double apart,
                        struct polygon *o)
{
    struct grain_side side = {.neighbour = im->grain, .shift = {im->shift[0], im->shift[1]}};
    for (int a = 0; a < 2; a++)
        side.normal[a] = im->x[a] - g->centre[a];
    side.length = sqrt(side.normal[0] * side.normal[0] + side.normal[1] * side.normal[1]);
    side.offset =
        0.5 * (side.normal[0] * (im->x[0] + g->centre[0]) + side.normal[1] * (im->x[1] + g->centre[1]));
    bool near = false;
    for (size_t i = 0; i < o->n; i++)
        near |=
            side.offset - (side.normal[0] * o->x[i][0] + side.normal[1] * o->x[i][1]) < apart * side.length;
    (void)cut_polygon(o, &side);
    return near ? add_side(set, g, &side) : 0;
}

static int cut_cell(struct grain_set *set, size_t index, const struct image *images,
                    const struct point_bins *b, double apart, const double box[4])
{
    struct grain *g = &set->grain[index];
    struct polygon o = {.n = 4};
    for (int i = 0; i < 4; i++) {
        o.x[i][0] = box[i == 1 || i == 2 ? 2 : 0];
        o.x[i][1] = box[i >= 2 ? 3 : 1];
    }
    g->first_side = set->n_sides;
    int64_t i = point_bins_index(b, 0, g->centre[0]), j = point_bins_index(b, 1, g->centre[1]);
    for (int64_t ring = 0; ring <= b->n[0] + b->n[1]; ring++) {
        double inner = (double)(ring - 1) * b->edge - 2.0 * apart; /* no seed of this ring is nearer */
        if (inner > 0.0 && inner * inner > 4.0 * find_reach2(&o, g->centre))
            break;
        for (int64_t v = j - ring; v <= j + ring; v++) {
            int64_t stride = v == j - ring || v == j + ring || ring == 0 ? 1 : 2 * ring;
            if (v < 0 || v >= b->n[1])
                continue;
            for (int64_t u = i - ring; u <= i + ring; u += stride) {
                if (u < 0 || u >= b->n[0])
                    continue;
                for (int64_t k = b->head[v * b->n[0] + u]; k >= 0; k = b->next[k]) {
                    bool self = images[k].grain == (int64_t)index && images[k].shift[0] == 0.0 &&
                                images[k].shift[1] == 0.0;
                    if (!self && cut_by_image(set, g, &images[k], apart, &o) != 0)
                        return -1;
                }
            }
        }
    }
    find_box(&o, g->box);
    return 0;
}

static int cut_cells(struct grain_set *set, const double box[4], double size, double apart)
{
    int status = -1;
    size_t n = 0, copies = (set->wraps[0] ? 3 : 1) * (set->wraps[1] ? 3 : 1);
    struct image *images = mem_alloc(set->n * copies, sizeof *images);
    double low[2], high[2], wide[4];
    struct point_bins bins = {0};
    for (int a = 0; a < 2; a++) { /* the cells of seeds near a periodic side reach beyond the side */
        low[a] = set->wraps[a] ? box[a] - set->period[a] : box[a];
        high[a] = set->wraps[a] ? box[a + 2] + set->period[a] : box[a + 2];
        wide[a] = low[a];
        wide[a + 2] = high[a];
    }
    if (images == NULL || point_bins_start(&bins, low, high, size, set->n * copies) != 0)
        goto done;
    for (size_t g = 0; g < set->n; g++) {
        for (int v = set->wraps[1] ? -1 : 0; v <= (set->wraps[1] ? 1 : 0); v++) {
            for (int u = set->wraps[0] ? -1 : 0; u <= (set->wraps[0] ? 1 : 0); u++) {
                struct image *im = &images[n];
                *im = (struct image){.shift = {u * set->period[0], v * set->period[1]}, .grain = (int64_t)g};
                for (int a = 0; a < 2; a++)
                    im->x[a] = set->grain[g].centre[a] + im->shift[a];
                point_bins_add(&bins, (int64_t)n++, im->x);
            }
        }
    }
    status = 0;
    for (size_t g = 0; g < set->n && status == 0; g++) {
        pulse_beat(set->pulse);
        status = cut_cell(set, g, images, &bins, apart, wide);
    }
done:
    point_bins_free(&bins);
    free(images);
    return status;
}

static int build_cells(const struct body_config *body, uint32_t first, double apart, struct grain_set *set)
{
    double box[4];
    shape_box(&body->shape, box);
    double own = pi / 4.0 * (body->grain_size * body->grain_size);
    double n = rint((box[2] - box[0]) * (box[3] - box[1]) / own);
    set->n = n > 1.0 ? (size_t)n : 1;
    set->grain = mem_zalloc(set->n, sizeof *set->grain);
    if (set->grain == NULL || place_seeds(body, box, first, set) != 0)
        return -1;
    for (size_t g = 0; g < set->n; g++)
        set->grain[g].radius = INFINITY;
    return cut_cells(set, box, body->grain_size, apart);
}

/* --- outlines of the grains of a powder --- */

/* Sets the box of a grain of a powder, and the sides of a polygon grain. */
static int find_outline(const struct body_config *body, uint32_t id, struct grain_set *set, struct grain *g)
{
    struct polygon corners;
    g->first_side = set->n_sides;
    for (int a = 0; a < 2; a++) {
        g->box[a] = g->centre[a] - g->radius;
        g->box[a + 2] = g->centre[a] + g->radius;
    }
    if (body->structure == STRUCTURE_DISCS)
        return 0;
    grain_sizes_corners(body, id, &corners);
    for (size_t k = 0; k < corners.n; k++) {
        const double *p = corners.x[k], *q = corners.x[(k + 1) % corners.n];
        struct grain_side side = {.normal = {q[1] - p[1], p[0] - q[0]}, .neighbour = GRAIN_NO_NEIGHBOUR};
        side.length = sqrt(side.normal[0] * side.normal[0] + side.normal[1] * side.normal[1]);
        side.offset = side.normal[0] * (g->centre[0] + g->radius * p[0]) +
                      side.normal[1] * (g->centre[1] + g->radius * p[1]);
        if (add_side(set, g, &side) != 0)
            return -1;
    }
    return 0;
}

/* --- polycrystals and powders --- */

static void find_wraps(const struct config *c, const struct body_config *body, struct grain_set *set)
{
    for (int a = 0; a < 2; a++) {
        const double *box = body->shape.box;
        double off = fmax(fabs(box[a] - c->origin[a]), fabs(box[a + 2] - (c->origin[a] + c->size[a])));
        set->wraps[a] =
            c->periodic[a] && body->shape.kind == SHAPE_RECTANGLE && off <= SITE_TOLERANCE * body->spacing;
        set->low[a] = c->origin[a];
        set->period[a] = c->size[a];
    }
}

void grain_turn(const struct body_config *body, uint32_t id, struct grain *g)
{
    double symmetry = body->lattice == LATTICE_HEXAGONAL ? pi / 3.0 : pi / 2.0;
    double angle = symmetry * random_uniform(body->seed, id, RANDOM_GRAIN_ANGLE);
    g->cosine = real_cos(angle);
    g->sine = real_sin(angle);
}

enum dm2_status grains_build(const struct config *config, size_t index, uint32_t first_grain, double apart,
                             const struct pulse *pulse, struct grain_set *set, struct dm2_error *err)
{
    const struct body_config *body = &config->bodies[index];
    int failed = 0;
    *set = (struct grain_set){.pulse = pulse};
    find_wraps(config, body, set);
    if (body->structure == STRUCTURE_POLYCRYSTAL) {
        failed = build_cells(body, first_grain, apart, set);
        for (size_t g = 0; g < set->n && failed == 0; g++)
            grain_turn(body, first_grain + (uint32_t)g, &set->grain[g]);
    } else {
        enum dm2_status status = packing_build(body, first_grain, set, err);
        if (status != DM2_OK)
            return status;
        for (size_t g = 0; g < set->n && failed == 0; g++)
            failed = find_outline(body, first_grain + (uint32_t)g, set, &set->grain[g]);
    }
    if (failed != 0)
        return dm2_fail(err, DM2_MEMORY, "no memory for the grains of the body '%s'", body->name);
    return DM2_OK;
}

void grains_free(struct grain_set *set)
{
    free(set->grain);
    free(set->side);
    *set = (struct grain_set){0};
}

bool grain_holds(const struct grain_set *set, const struct grain *g, const double x[2], double margin)
{
    double dx = x[0] - g->centre[0], dy = x[1] - g->centre[1], most = g->radius - margin;
    if (g->n_sides == 0 && g->radius < INFINITY)
        return most >= 0.0 && dx * dx + dy * dy <= most * most;
    const struct grain_side *side = set->side + g->first_side;
    for (size_t k = 0; k < g->n_sides; k++) {
        if (!(side[k].normal[0] * x[0] + side[k].normal[1] * x[1] < side[k].offset - margin * side[k].length))
            return false;
    }
    return true;
}
