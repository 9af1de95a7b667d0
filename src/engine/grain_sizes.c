/* A grain's elements are the sites of its lattice, which has a site at the grain's centre, that lie within
 * the outline by at least the radius of an element. Their number follows from radius, corners and
 * orientation, not from the grain's place, and is counted row by row. Each element stands for one cell of the
 * hexagonal lattice in contact, as its mass does (kind_mass).
 *
 * Grains with the deck's sizes are added until their cells fill the fraction; then all radii are scaled by
 * one number near 1, found by bisection, that takes out the rest of at most half a grain. */
#include "grain_sizes.h"

#include <math.h>

#include "dm2/base/mem.h"
#include "dm2/base/random.h"
#include "dm2/base/real.h"
#include "dm2/deck/shape.h"

static const double pi = 0x1.921fb54442d18p1;
static const double root3 = 0x1.bb67ae8584caap0;
static const double densest = 0.9069;      /* pi/sqrt(12): circles of one size on a lattice */
static const double random_packing = 0.82; /* of circles of somewhat different sizes */
static const double gap =
    1e-3; /* in radii of an element, around a grain: more than what packing leaves over */

static double cell_area(const struct body_config *body)
{
    double d = 2.0 * body->radius;
    return 0.5 * root3 * (d * d);
}

/* The number of corners of a polygon grain, 5 to 8. */
static int count_corners(const struct body_config *body, uint32_t grain)
{
    return 5 + (int)floor(4.0 * random_uniform(body->seed, grain, RANDOM_GRAIN_CORNERS));
}

void grain_sizes_corners(const struct body_config *body, uint32_t grain, struct polygon *out)
{
    int n = count_corners(body, grain);
    for (int k = 0; k < n; k++) {
        double u = random_uniform(body->seed, (uint64_t)grain * 16 + (uint64_t)k, RANDOM_GRAIN_CORNER);
        double angle = 2.0 * pi / n * (k + 0.6 * u);
        out->x[k][0] = real_cos(angle);
        out->x[k][1] = real_sin(angle);
    }
    out->n = (size_t)n;
}

/* Cuts the part [along[0], along[1]] of a row at distance `across` from the centre to the inside of a polygon
 * of this radius, less the margin. */
static void cut_row(const struct polygon *corners, const struct grain *g, double margin, double across,
                    double along[2])
{
    for (size_t k = 0; k < corners->n; k++) {
        const double *p = corners->x[k], *q = corners->x[(k + 1) % corners->n];
        double normal[2] = {q[1] - p[1], p[0] - q[0]};
        double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1]);
        double rest = (normal[0] * p[0] + normal[1] * p[1]) * g->radius - margin * length -
                      across * (normal[1] * g->cosine - normal[0] * g->sine);
        double slope = normal[0] * g->cosine + normal[1] * g->sine;
        if (slope > 0.0)
            along[1] = fmin(along[1], rest / slope);
        else if (slope < 0.0)
            along[0] = fmax(along[0], rest / slope);
        else if (rest <= 0.0)
            along[1] = -INFINITY;
    }
}

/* The number of elements of a grain of this radius, cm; `corners` is NULL for a disc. *furthest2 is the
 * square of the largest distance of an element from the grain's centre. */
static double count_elements(const struct body_config *body, const struct polygon *corners,
                             const struct grain *g, double *furthest2)
{
    double margin = body->radius * (1.0 - 1e-9), most = g->radius - margin, count = 0.0;
    *furthest2 = 0.0;
    if (most < 0.0)
        return 0.0;
    double rows = floor(most / body->row_spacing);
    for (double row = -rows; row <= rows; row++) {
        double across = row * body->row_spacing, half = sqrt(most * most - across * across);
        double along[2] = {-half, half};
        double shift = body->lattice == LATTICE_HEXAGONAL && fmod(row, 2.0) != 0.0 ? 0.5 : 0.0;
        if (corners != NULL)
            cut_row(corners, g, margin, across, along);
        double first = ceil(along[0] / body->spacing - shift), last = floor(along[1] / body->spacing - shift);
        if (last < first)
            continue;
        double end = fmax(-(first + shift), last + shift) * body->spacing;
        count += last - first + 1.0;
        *furthest2 = fmax(*furthest2, across * across + end * end);
    }
    return count;
}

/* The number of elements of grain `id` (a global number), whose radius is `scale` times that of *g, and
 * *furthest2 as in count_elements. */
static double count_scaled(const struct body_config *body, uint32_t id, const struct grain *g, double scale,
                           double *furthest2)
{
    struct polygon corners;
    struct grain scaled = *g;
    bool polygon = body->structure == STRUCTURE_POLYGONS;
    scaled.radius *= scale;
    if (polygon)
        grain_sizes_corners(body, id, &corners);
    return count_elements(body, polygon ? &corners : NULL, &scaled, furthest2);
}

/* Scales the grain's radius and finds its reach. */
static double resize_grain(const struct body_config *body, uint32_t id, struct grain *g, double scale)
{
    double furthest2, count = count_scaled(body, id, g, scale, &furthest2);
    g->radius *= scale;
    g->reach = fmin(g->radius, sqrt(furthest2) + body->radius * (1.0 + gap));
    return count;
}

static double count_all(const struct body_config *body, uint32_t first, const struct grain_set *set,
                        double scale)
{
    double count = 0.0, furthest2;
    pulse_beat(set->pulse);
    for (size_t k = 0; k < set->n; k++)
        count += count_scaled(body, first + (uint32_t)k, &set->grain[k], scale, &furthest2);
    return count;
}

static double circle_area(const struct grain_set *set)
{
    double sum = 0.0;
    for (size_t k = 0; k < set->n; k++)
        sum += pi * (set->grain[k].reach * set->grain[k].reach);
    return sum;
}

double grain_sizes_reachable(const struct body_config *body, uint32_t first, const struct grain_set *set)
{
    double solid = count_all(body, first, set, 1.0) * cell_area(body);
    double reached = floor(100.0 * random_packing * solid / circle_area(set)) / 100.0;
    return fmin(reached, floor(100.0 * body->solid_fraction - 0.5) / 100.0);
}

static enum dm2_status refuse_fraction(const struct body_config *body, uint32_t first,
                                       const struct grain_set *set, struct dm2_error *err)
{
    return config_fail(body->packing_place, err, DM2_DECK,
                       "the powder of the body '%s' cannot be packed to a solid fraction of %g: the circles "
                       "of its grains would take more than %g of the area; grains of this size reach about "
                       "%.2f: choose less, or larger grains",
                       body->name, body->solid_fraction, densest, grain_sizes_reachable(body, first, set));
}

/* Adds grains until their elements are nearest to `want` elements. */
static enum dm2_status add_grains(const struct body_config *body, uint32_t first, double want,
                                  struct grain_set *set, struct dm2_error *err)
{
    double count = 0.0, circles = 0.0, area = shape_area(&body->shape);
    size_t cap = 0;
    for (;;) {
        uint32_t id = first + (uint32_t)set->n;
        double u = 2.0 * random_uniform(body->seed, id, RANDOM_GRAIN_SIZE) - 1.0;
        struct grain g = {.radius = 0.5 * body->grain_size * (1.0 + body->grain_spread * u)};
        grain_turn(body, id, &g);
        double own = resize_grain(body, id, &g, 1.0);
        if (set->n > 0 && count + 0.5 * own >= want)
            return DM2_OK;
        struct grain *grown = mem_grown(set->grain, &cap, set->n, set->n + 1, sizeof *grown);
        if (grown == NULL)
            return dm2_fail(err, DM2_MEMORY, "no memory for the grains of the body '%s'", body->name);
        set->grain = grown;
        set->grain[set->n++] = g;
        count += own;
        circles += pi * (g.reach * g.reach);
        if (circles > densest * area && count < want)
            return refuse_fraction(body, first, set, err);
    }
}

enum dm2_status grain_sizes_choose(const struct body_config *body, uint32_t first, struct grain_set *set,
                                   struct dm2_error *err)
{
    double want = body->solid_fraction * shape_area(&body->shape) / cell_area(body);
    enum dm2_status status = add_grains(body, first, want, set, err);
    if (status != DM2_OK)
        return status;
    double low = 0.5, high = 2.0, best = 1.0, off = fabs(count_all(body, first, set, 1.0) - want);
    for (int k = 0; k < 50 && off > 0.5; k++) {
        double middle = k == 0 ? 1.0 : 0.5 * (low + high), rest = count_all(body, first, set, middle) - want;
        if (fabs(rest) < off) {
            off = fabs(rest);
            best = middle;
        }
        if (rest < 0.0)
            low = middle;
        else
            high = middle;
    }
    for (size_t k = 0; k < set->n; k++)
        resize_grain(body, first + (uint32_t)k, &set->grain[k], best);
    return DM2_OK;
}
