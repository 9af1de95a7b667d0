/* Polycrystal: seeds at random, not closer than 0.6 grain sizes where that can be had; a grain is the Voronoi
 * cell of its seed, cut out of the body's box by the bisectors with its neighbours, nearest first. A cell
 * whose vertices are all within s of the seed is not cut by seeds further than 2 s.
 *
 * Powder: discs at random places, overlapping; then sweeps in which every overlapping pair is pushed apart by
 * half its overlap each and every disc into the container, until none overlaps (after 1000 sweeps: by no more
 * than 1e-5 of the grain size; large dense packings come that far and hardly further). That reaches solid
 * fractions of about 0.8 (the random close packing of discs is 0.82 to 0.84). Polygons are inscribed in such
 * discs, with 5 to 8 corners.
 *
 * Where the body spans a periodic direction of the domain, cells and discs go round it. */
#include "grains.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "dm2/base/random.h"
#include "dm2/base/real.h"
#include "dm2/deck/shape.h"

static const double pi = 0x1.921fb54442d18p1;

enum { SEED_TRIES = 1000, SWEEPS = 20000, PATIENCE = 1000, OUTLINE_MAX = 64 };
static const double seed_distance = 0.6; /* of the grain size */
static const double push_slack = 1e-3;   /* discs are pushed apart by so much more than they need */
static const double left_over = 1e-5;    /* of the grain size: an overlap that may stay after many sweeps */

/* --- bins: points by the square they lie in --- */

struct bins {
    double low[2], edge;
    int64_t n[2];
    int64_t *head, *next; /* -1: none */
};

static int bins_start(struct bins *b, const double low[2], const double high[2], double edge, size_t points)
{
    *b = (struct bins){.low = {low[0], low[1]}};
    double area = (high[0] - low[0]) * (high[1] - low[1]), least = sqrt(area / (4.0 * (double)points + 16.0));
    b->edge = edge > least ? edge : least;
    for (int a = 0; a < 2; a++) {
        b->n[a] = (int64_t)floor((high[a] - low[a]) / b->edge);
        b->n[a] = b->n[a] > 0 ? b->n[a] : 1;
    }
    b->head = mem_alloc((size_t)(b->n[0] * b->n[1]), sizeof *b->head);
    b->next = mem_alloc(points, sizeof *b->next);
    if (b->head == NULL || b->next == NULL)
        return -1;
    for (int64_t i = 0; i < b->n[0] * b->n[1]; i++)
        b->head[i] = -1;
    return 0;
}

static void bins_free(struct bins *b)
{
    free(b->head);
    free(b->next);
    *b = (struct bins){0};
}

/* The column or row of a coordinate; the last one also takes what is beyond. */
static int64_t bins_index(const struct bins *b, int a, double x)
{
    double i = floor((x - b->low[a]) / b->edge);
    return !(i > 0.0) ? 0 : i >= (double)b->n[a] ? b->n[a] - 1 : (int64_t)i;
}

static void bins_add(struct bins *b, int64_t point, const double x[2])
{
    int64_t bin = bins_index(b, 1, x[1]) * b->n[0] + bins_index(b, 0, x[0]);
    b->next[point] = b->head[bin];
    b->head[bin] = point;
}

static void bins_clear(struct bins *b)
{
    for (int64_t i = 0; i < b->n[0] * b->n[1]; i++)
        b->head[i] = -1;
}

/* --- Voronoi cells --- */

/* A seed or a periodic image of one. */
struct image {
    double x[2], shift[2];
    int64_t grain;
};

static bool seed_is_free(const struct bins *b, const struct grain_set *set, const double x[2], double apart)
{
    int64_t i = bins_index(b, 0, x[0]), j = bins_index(b, 1, x[1]);
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
    struct bins bins;
    double apart = seed_distance * body->grain_size;
    int status = bins_start(&bins, box, box + 2, apart, set->n);
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
        bins_add(&bins, (int64_t)g, x);
    }
    bins_free(&bins);
    return status;
}

struct outline {
    size_t n;
    double x[OUTLINE_MAX][2];
};

/* Cuts the convex outline at the side. False: it is as it was. */
static bool outline_cut(struct outline *o, const struct grain_side *side)
{
    struct outline cut = {0};
    bool outside = false;
    double beyond[OUTLINE_MAX];
    for (size_t i = 0; i < o->n; i++) {
        beyond[i] = side->normal[0] * o->x[i][0] + side->normal[1] * o->x[i][1] - side->offset;
        outside |= beyond[i] > 0.0;
    }
    if (!outside || o->n + 1 >= OUTLINE_MAX)
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

/* Square of the largest distance of a vertex from x. */
static double outline_reach2(const struct outline *o, const double x[2])
{
    double reach = 0.0;
    for (size_t i = 0; i < o->n; i++) {
        double dx = o->x[i][0] - x[0], dy = o->x[i][1] - x[1];
        reach = dx * dx + dy * dy > reach ? dx * dx + dy * dy : reach;
    }
    return reach;
}

static void outline_box(const struct outline *o, double box[4])
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
    void *sides = set->side;
    int status = mem_grow(&sides, &set->side_cap, set->n_sides, set->n_sides + 1, sizeof *set->side);
    set->side = sides;
    if (status != 0)
        return -1;
    set->side[set->n_sides++] = *side;
    g->n_sides++;
    return 0;
}

/* Lets one image cut the cell of g; a neighbour that only comes within `apart` of it is kept as a side too.
 */
static int meet_image(struct grain_set *set, struct grain *g, const struct image *im, double apart,
                      struct outline *o)
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
    (void)outline_cut(o, &side);
    return near ? add_side(set, g, &side) : 0;
}

static int cut_cell(struct grain_set *set, size_t index, const struct image *images, const struct bins *b,
                    double apart, const double box[4])
{
    struct grain *g = &set->grain[index];
    struct outline o = {.n = 4};
    for (int i = 0; i < 4; i++) {
        o.x[i][0] = box[i == 1 || i == 2 ? 2 : 0];
        o.x[i][1] = box[i >= 2 ? 3 : 1];
    }
    g->first_side = set->n_sides;
    int64_t i = bins_index(b, 0, g->centre[0]), j = bins_index(b, 1, g->centre[1]);
    for (int64_t ring = 0; ring <= b->n[0] + b->n[1]; ring++) {
        double inner = (double)(ring - 1) * b->edge - 2.0 * apart; /* nothing of this ring is nearer */
        if (inner > 0.0 && inner * inner > 4.0 * outline_reach2(&o, g->centre))
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
                    if (!self && meet_image(set, g, &images[k], apart, &o) != 0)
                        return -1;
                }
            }
        }
    }
    outline_box(&o, g->box);
    return 0;
}

static int cut_cells(struct grain_set *set, const double box[4], double size, double apart)
{
    int status = -1;
    size_t n = 0, copies = (set->wraps[0] ? 3 : 1) * (set->wraps[1] ? 3 : 1);
    struct image *images = mem_alloc(set->n * copies, sizeof *images);
    double low[2], high[2], wide[4];
    struct bins bins = {0};
    for (int a = 0; a < 2; a++) { /* the cells of seeds near a seam reach beyond it */
        low[a] = set->wraps[a] ? box[a] - set->period[a] : box[a];
        high[a] = set->wraps[a] ? box[a + 2] + set->period[a] : box[a + 2];
        wide[a] = low[a];
        wide[a + 2] = high[a];
    }
    if (images == NULL || bins_start(&bins, low, high, size, set->n * copies) != 0)
        goto done;
    for (size_t g = 0; g < set->n; g++) {
        for (int v = set->wraps[1] ? -1 : 0; v <= (set->wraps[1] ? 1 : 0); v++) {
            for (int u = set->wraps[0] ? -1 : 0; u <= (set->wraps[0] ? 1 : 0); u++) {
                struct image *im = &images[n];
                *im = (struct image){.shift = {u * set->period[0], v * set->period[1]}, .grain = (int64_t)g};
                for (int a = 0; a < 2; a++)
                    im->x[a] = set->grain[g].centre[a] + im->shift[a];
                bins_add(&bins, (int64_t)n++, im->x);
            }
        }
    }
    status = 0;
    for (size_t g = 0; g < set->n && status == 0; g++) {
        pulse_beat(set->pulse);
        status = cut_cell(set, g, images, &bins, apart, wide);
    }
done:
    bins_free(&bins);
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

/* --- powders --- */

/* Keeps a disc of this radius in the container. Gives how far it was outside, cm. */
static double contain(const struct body_config *body, const struct grain_set *set, double x[2], double radius)
{
    const struct shape_config *s = &body->shape;
    double out = 0.0;
    if (s->kind == SHAPE_DISC) {
        double dx = x[0] - s->centre[0], dy = x[1] - s->centre[1], r = sqrt(dx * dx + dy * dy),
               most = s->radius - radius;
        if (r > most) {
            out = r - most;
            x[0] = s->centre[0] + dx * (most / r);
            x[1] = s->centre[1] + dy * (most / r);
        }
        return out;
    }
    for (int a = 0; a < 2; a++) {
        double low = s->box[a], high = s->box[a + 2], before = x[a];
        if (set->wraps[a])
            x[a] = x[a] < low ? x[a] + set->period[a] : x[a] >= high ? x[a] - set->period[a] : x[a];
        else {
            x[a] = x[a] < low + radius ? low + radius : x[a] > high - radius ? high - radius : x[a];
            out = fabs(x[a] - before) > out ? fabs(x[a] - before) : out;
        }
    }
    return out;
}

/* Pushes two discs apart where they overlap or almost touch. Gives their overlap, without slack. */
static double separate(struct grain_set *set, size_t i, size_t j, double slack, uint64_t seed)
{
    struct grain *p = &set->grain[i], *q = &set->grain[j];
    double d[2], touch = p->radius + q->radius, wanted = touch * (1.0 + slack);
    for (int a = 0; a < 2; a++) {
        d[a] = p->centre[a] - q->centre[a];
        if (set->wraps[a])
            d[a] -= set->period[a] * rint(d[a] / set->period[a]);
    }
    double r2 = d[0] * d[0] + d[1] * d[1];
    if (r2 >= wanted * wanted)
        return 0.0;
    double r = sqrt(r2);
    if (!(r > 1e-6 * touch)) { /* on one another: along any direction */
        double angle = 2.0 * pi * random_uniform(seed, i, RANDOM_GRAIN_ANGLE);
        d[0] = real_cos(angle);
        d[1] = real_sin(angle);
        r = 0.0;
    } else {
        d[0] /= r;
        d[1] /= r;
    }
    for (int a = 0; a < 2; a++) {
        p->centre[a] += 0.5 * (wanted - r) * d[a];
        q->centre[a] -= 0.5 * (wanted - r) * d[a];
    }
    return touch - r;
}

/* The bins of one row or column around i, without meeting one twice where there are few and they go round. */
static size_t around(int64_t i, int64_t n, bool wraps, int64_t out[3])
{
    size_t count = 0;
    for (int64_t k = i - 1; k <= i + 1; k++) {
        int64_t at = wraps ? (k + n) % n : k;
        bool seen = at < 0 || at >= n;
        for (size_t m = 0; m < count; m++)
            seen |= out[m] == at;
        if (!seen)
            out[count++] = at;
    }
    return count;
}

/* One sweep over all discs. Gives the largest overlap that it met. */
static double sweep(const struct body_config *body, struct grain_set *set, struct bins *b, double slack)
{
    double worst = 0.0;
    bins_clear(b);
    for (size_t g = 0; g < set->n; g++)
        bins_add(b, (int64_t)g, set->grain[g].centre);
    for (size_t g = 0; g < set->n; g++) {
        int64_t us[3], vs[3];
        size_t n_u = around(bins_index(b, 0, set->grain[g].centre[0]), b->n[0], set->wraps[0], us);
        size_t n_v = around(bins_index(b, 1, set->grain[g].centre[1]), b->n[1], set->wraps[1], vs);
        for (size_t v = 0; v < n_v; v++) {
            for (size_t u = 0; u < n_u; u++) {
                for (int64_t k = b->head[vs[v] * b->n[0] + us[u]]; k >= 0; k = b->next[k]) {
                    double overlap = (size_t)k < g ? separate(set, g, (size_t)k, slack, body->seed) : 0.0;
                    worst = overlap > worst ? overlap : worst;
                }
            }
        }
    }
    for (size_t g = 0; g < set->n; g++) {
        double out = contain(body, set, set->grain[g].centre, set->grain[g].radius);
        worst = out > worst ? out : worst;
    }
    return worst;
}

/* Corners of a polygon grain: 5 to 8. */
static int corners_of(const struct body_config *body, uint32_t grain)
{
    return 5 + (int)floor(4.0 * random_uniform(body->seed, grain, RANDOM_GRAIN_CORNERS));
}

/* The corners on the unit circle, each near its place in a regular polygon. Gives the area of the polygon. */
static double polygon_corners(const struct body_config *body, uint32_t grain, struct outline *out)
{
    int n = corners_of(body, grain);
    double area = 0.0;
    for (int k = 0; k < n; k++) {
        double u = random_uniform(body->seed, (uint64_t)grain * 16 + (uint64_t)k, RANDOM_GRAIN_CORNER);
        double angle = 2.0 * pi / n * (k + 0.6 * u);
        out->x[k][0] = real_cos(angle);
        out->x[k][1] = real_sin(angle);
    }
    out->n = (size_t)n;
    for (int k = 0; k < n; k++) {
        const double *p = out->x[k], *q = out->x[(k + 1) % n];
        area += 0.5 * (p[0] * q[1] - q[0] * p[1]);
    }
    return area;
}

/* Share of a grain in the square of its radius. */
static double grain_share(const struct body_config *body, uint32_t grain)
{
    struct outline corners;
    return body->structure == STRUCTURE_POLYGONS ? polygon_corners(body, grain, &corners) : pi;
}

/* Radii with the deck's mean and spread, then scaled (by little) so that the solid fraction is exact. */
static int choose_radii(const struct body_config *body, uint32_t first, struct grain_set *set)
{
    double want = body->solid_fraction * shape_area(&body->shape), mean = 0.0, sum = 0.0;
    for (uint32_t g = 0; g < 64; g++)
        mean += grain_share(body, first + g) / 64.0;
    double spread2 = body->grain_spread * body->grain_spread / 3.0; /* of a uniform distribution */
    double n = rint(want / (mean * 0.25 * (body->grain_size * body->grain_size) * (1.0 + spread2)));
    set->n = n > 1.0 ? (size_t)n : 1;
    set->grain = mem_zalloc(set->n, sizeof *set->grain);
    if (set->grain == NULL)
        return -1;
    for (size_t g = 0; g < set->n; g++) {
        uint32_t id = first + (uint32_t)g;
        double u = 2.0 * random_uniform(body->seed, id, RANDOM_GRAIN_SIZE) - 1.0;
        double radius = 0.5 * body->grain_size * (1.0 + body->grain_spread * u);
        set->grain[g].radius = radius;
        sum += grain_share(body, id) * (radius * radius);
    }
    double scale = sqrt(want / sum);
    for (size_t g = 0; g < set->n; g++)
        set->grain[g].radius *= scale;
    return 0;
}

static enum dm2_status pack(const struct body_config *body, uint32_t first, struct grain_set *set,
                            struct dm2_error *err)
{
    double box[4], largest = 0.0, worst = INFINITY;
    struct bins bins = {0};
    shape_box(&body->shape, box);
    if (choose_radii(body, first, set) != 0)
        return dm2_fail(err, DM2_MEMORY, "no memory for the grains of the body '%s'", body->name);
    for (size_t g = 0; g < set->n; g++) {
        struct grain *p = &set->grain[g];
        largest = p->radius > largest ? p->radius : largest;
        for (int a = 0; a < 2; a++)
            p->centre[a] =
                box[a] + (box[a + 2] - box[a]) *
                             random_uniform(body->seed, first + g, a == 0 ? RANDOM_GRAIN_X : RANDOM_GRAIN_Y);
    }
    int sweeps = 0, most = set->n > 4000 ? SWEEPS / 4 : SWEEPS;
    if (bins_start(&bins, box, box + 2, 2.0 * largest * (1.0 + push_slack), set->n) != 0) {
        bins_free(&bins);
        return dm2_fail(err, DM2_MEMORY, "no memory for the grains of the body '%s'", body->name);
    }
    double touch = 1e-9 * body->grain_size;
    while (sweeps++ < most && worst > (sweeps <= PATIENCE ? touch : left_over * body->grain_size)) {
        pulse_beat(set->pulse);
        worst = sweep(body, set, &bins, push_slack);
        if (worst <= touch) /* what the slack pushed may overlap now; without it, nothing moves unless
                               something does */
            worst = sweep(body, set, &bins, 0.0);
    }
    bins_free(&bins);
    if (worst > left_over * body->grain_size)
        return config_fail(
            body->packing_place, err, DM2_DECK,
            "the powder of the body '%s' cannot be packed to a solid fraction of %g: after %d sweeps grains "
            "still overlap by %.2g of their size; discs reach about 0.8, polygons about 0.6: choose less",
            body->name, body->solid_fraction, most, worst / body->grain_size);
    return DM2_OK;
}

/* The sides of a polygon grain, or the box of a disc. */
static int outline_grain(const struct body_config *body, uint32_t id, struct grain_set *set, struct grain *g)
{
    struct outline corners;
    g->first_side = set->n_sides;
    for (int a = 0; a < 2; a++) {
        g->box[a] = g->centre[a] - g->radius;
        g->box[a + 2] = g->centre[a] + g->radius;
    }
    if (body->structure == STRUCTURE_DISCS)
        return 0;
    (void)polygon_corners(body, id, &corners);
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

/* --- all --- */

static void find_seams(const struct config *c, const struct body_config *body, struct grain_set *set)
{
    for (int a = 0; a < 2; a++) {
        const double *box = body->shape.box;
        set->wraps[a] = c->periodic[a] && body->shape.kind == SHAPE_RECTANGLE && box[a] == c->origin[a] &&
                        box[a + 2] == c->origin[a] + c->size[a];
        set->low[a] = c->origin[a];
        set->period[a] = c->size[a];
    }
}

static void turn(const struct body_config *body, uint32_t id, struct grain *g)
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
    find_seams(config, body, set);
    if (body->structure == STRUCTURE_POLYCRYSTAL) {
        failed = build_cells(body, first_grain, apart, set);
    } else {
        enum dm2_status status = pack(body, first_grain, set, err);
        if (status != DM2_OK)
            return status;
        for (size_t g = 0; g < set->n && failed == 0; g++)
            failed = outline_grain(body, first_grain + (uint32_t)g, set, &set->grain[g]);
    }
    if (failed != 0)
        return dm2_fail(err, DM2_MEMORY, "no memory for the grains of the body '%s'", body->name);
    for (size_t g = 0; g < set->n; g++)
        turn(body, first_grain + (uint32_t)g, &set->grain[g]);
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
