/* A rectangle is handled as a polygon of four vertices, except in shape_contains and in the overlap of two
 * rectangles. Comparisons of shapes have no tolerance, because the shapes of a deck either clearly overlap or
 * share a border exactly; sites of lattices, whose coordinates are rounded, have one. */
#include "dm2/deck/shape.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

struct outline {
    size_t n;
    const double (*at)[2];
    double corners[4][2];
};

static void outline_of(const struct shape_config *s, struct outline *out)
{
    if (s->kind == SHAPE_POLYGON) {
        out->n = s->n_vertices;
        out->at = s->vertex;
        return;
    }
    for (int i = 0; i < 4; i++) {
        out->corners[i][0] = i == 1 || i == 2 ? s->box[2] : s->box[0];
        out->corners[i][1] = i >= 2 ? s->box[3] : s->box[1];
    }
    out->n = 4;
    out->at = (const double(*)[2])out->corners;
}

static double square(double x)
{
    return x * x;
}

bool shape_contains(const struct shape_config *s, double x, double y)
{
    if (s->kind == SHAPE_RECTANGLE)
        return s->box[0] <= x && x < s->box[2] && s->box[1] <= y && y < s->box[3];
    if (s->kind == SHAPE_DISC)
        return square(x - s->centre[0]) + square(y - s->centre[1]) <= square(s->radius);
    bool inside = false;
    for (size_t i = 0; i < s->n_vertices; i++) {
        const double *a = s->vertex[i], *b = s->vertex[(i + 1) % s->n_vertices];
        if ((a[1] <= y) == (b[1] <= y))
            continue;
        /* The crossing is computed from the lower end of the edge, so that both directions of one edge round
         * alike. */
        const double *low = a[1] <= b[1] ? a : b, *high = a[1] <= b[1] ? b : a;
        if (x < low[0] + (y - low[1]) / (high[1] - low[1]) * (high[0] - low[0]))
            inside = !inside;
    }
    return inside;
}

void shape_site_shift(double spacing, double shift[2])
{
    shift[0] = SITE_TOLERANCE * spacing;
    shift[1] = 0.618 * shift[0]; /* along no border of a usual shape */
}

bool shape_contains_site(const struct shape_config *s, const double r[2], double spacing)
{
    double shift[2];
    shape_site_shift(spacing, shift);
    if (s->kind == SHAPE_DISC)
        return square(r[0] - s->centre[0]) + square(r[1] - s->centre[1]) <= square(s->radius + shift[0]);
    return shape_contains(s, r[0] + shift[0], r[1] + shift[1]);
}

void shape_box(const struct shape_config *s, double box[4])
{
    if (s->kind == SHAPE_DISC) {
        for (int i = 0; i < 4; i++)
            box[i] = s->centre[i % 2] + (i < 2 ? -s->radius : s->radius);
        return;
    }
    struct outline o;
    outline_of(s, &o);
    for (int i = 0; i < 4; i++)
        box[i] = o.at[0][i % 2];
    for (size_t v = 1; v < o.n; v++) {
        for (int i = 0; i < 2; i++) {
            box[i] = fmin(box[i], o.at[v][i]);
            box[i + 2] = fmax(box[i + 2], o.at[v][i]);
        }
    }
}

struct image_range shape_images(const struct config *c, const double low[2], const double high[2])
{
    struct image_range range = {{0, 0}, {0, 0}};
    for (int a = 0; a < 2; a++) {
        double first = ceil(low[a] / c->size[a] - 1e-6), last = floor(high[a] / c->size[a] + 1e-6);
        if (!c->periodic[a] || !(fabs(first) < 1e15) || !(fabs(last) < 1e15))
            continue;
        range.first[a] = (int64_t)first;
        range.last[a] = (int64_t)fmin(last, first + IMAGE_MAX - 1);
    }
    return range;
}

bool shape_contains_image(const struct shape_config *s, const struct config *c, const double r[2],
                          double spacing)
{
    double box[4];
    shape_box(s, box);
    struct image_range k =
        shape_images(c, (double[]){box[0] - r[0], box[1] - r[1]}, (double[]){box[2] - r[0], box[3] - r[1]});
    for (int64_t v = k.first[1]; v <= k.last[1]; v++) {
        for (int64_t u = k.first[0]; u <= k.last[0]; u++) {
            double at[2] = {u == 0 ? r[0] : r[0] + (double)u * c->size[0],
                            v == 0 ? r[1] : r[1] + (double)v * c->size[1]};
            if (shape_contains_site(s, at, spacing))
                return true;
        }
    }
    return false;
}

double shape_area(const struct shape_config *s)
{
    struct outline o;
    double twice = 0;
    if (s->kind == SHAPE_DISC)
        return 3.14159265358979323846 * square(s->radius);
    outline_of(s, &o);
    for (size_t i = 0; i < o.n; i++) {
        const double *a = o.at[i], *b = o.at[(i + 1) % o.n];
        twice += a[0] * b[1] - b[0] * a[1];
    }
    return fabs(twice) / 2;
}

/* Twice the signed area of a triangle; > 0 where c is on the left of the line from a to b. */
static double twice_signed_area(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool edges_cross(const double a[2], const double b[2], const double c[2], const double d[2])
{
    double s1 = twice_signed_area(a, b, c), s2 = twice_signed_area(a, b, d), s3 = twice_signed_area(c, d, a),
           s4 = twice_signed_area(c, d, b);
    return ((s1 > 0 && s2 < 0) || (s1 < 0 && s2 > 0)) && ((s3 > 0 && s4 < 0) || (s3 < 0 && s4 > 0));
}

static double distance2_to_edge(const double p[2], const double a[2], const double b[2])
{
    double l2 = square(b[0] - a[0]) + square(b[1] - a[1]);
    double t = l2 > 0 ? ((p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1])) / l2 : 0;
    t = fmin(fmax(t, 0), 1);
    return square(a[0] + t * (b[0] - a[0]) - p[0]) + square(a[1] + t * (b[1] - a[1]) - p[1]);
}

static bool touches_edge(const double p[2], const double a[2], const double b[2])
{
    return distance2_to_edge(p, a, b) == 0;
}

static bool disc_overlaps(const struct shape_config *disc, const struct shape_config *other)
{
    struct outline o;
    outline_of(other, &o);
    if (shape_contains(other, disc->centre[0], disc->centre[1]))
        return true;
    for (size_t i = 0; i < o.n; i++)
        if (distance2_to_edge(disc->centre, o.at[i], o.at[(i + 1) % o.n]) < square(disc->radius))
            return true;
    return false;
}

/* True if a point inside `self`, whose outline is `o`, is in `other`. The points are the centres of three
 * consecutive vertices, where these are inside `self`, because the vertices may lie on a shared border. */
static bool share_inner_point(const struct outline *o, const struct shape_config *self,
                              const struct shape_config *other)
{
    for (size_t i = 0; i < o->n; i++) {
        const double *a = o->at[i], *b = o->at[(i + 1) % o->n], *c = o->at[(i + 2) % o->n];
        double middle[2] = {(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3};
        if (shape_contains(self, middle[0], middle[1]) && shape_contains(other, middle[0], middle[1]))
            return true;
    }
    return false;
}

static bool polygon_overlaps(const struct shape_config *a, const struct shape_config *b)
{
    struct outline p, q;
    outline_of(a, &p);
    outline_of(b, &q);
    for (size_t i = 0; i < p.n; i++)
        for (size_t j = 0; j < q.n; j++)
            if (edges_cross(p.at[i], p.at[(i + 1) % p.n], q.at[j], q.at[(j + 1) % q.n]))
                return true;
    return share_inner_point(&p, a, b) || share_inner_point(&q, b, a);
}

bool shape_overlaps(const struct shape_config *a, const struct shape_config *b)
{
    double p[4], q[4];
    shape_box(a, p);
    shape_box(b, q);
    for (int i = 0; i < 2; i++) { /* a shared border, written as 30*0.06 and as 1.8, is rounded differently */
        double slack = 4 * DBL_EPSILON * (fabs(p[i]) + fabs(p[i + 2]));
        if (!(p[i] + slack < q[i + 2] && q[i] + slack < p[i + 2]))
            return false;
    }
    if (a->kind == SHAPE_RECTANGLE && b->kind == SHAPE_RECTANGLE)
        return true;
    if (a->kind == SHAPE_DISC && b->kind == SHAPE_DISC)
        return square(a->centre[0] - b->centre[0]) + square(a->centre[1] - b->centre[1]) <
               square(a->radius + b->radius);
    if (a->kind == SHAPE_DISC)
        return disc_overlaps(a, b);
    if (b->kind == SHAPE_DISC)
        return disc_overlaps(b, a);
    return polygon_overlaps(a, b);
}

static struct shape_config move_shape(const struct shape_config *s, double dx, double dy)
{
    struct shape_config moved = *s;
    for (int i = 0; i < 2; i++) {
        double by = i == 0 ? dx : dy;
        moved.box[i] += by;
        moved.box[i + 2] += by;
        moved.centre[i] += by;
        for (size_t v = 0; v < s->n_vertices; v++)
            moved.vertex[v][i] += by;
    }
    return moved;
}

bool shape_image_overlaps(const struct shape_config *a, const struct config *c, const struct shape_config *b)
{
    double p[4], q[4];
    if (shape_overlaps(a, b))
        return true;
    shape_box(a, p);
    shape_box(b, q);
    struct image_range k =
        shape_images(c, (double[]){q[0] - p[2], q[1] - p[3]}, (double[]){q[2] - p[0], q[3] - p[1]});
    for (int64_t v = k.first[1]; v <= k.last[1]; v++) {
        for (int64_t u = k.first[0]; u <= k.last[0]; u++) {
            struct shape_config image =
                move_shape(a, u == 0 ? 0.0 : (double)u * c->size[0], v == 0 ? 0.0 : (double)v * c->size[1]);
            if (shape_overlaps(&image, b))
                return true;
        }
    }
    return false;
}

bool shape_crosses_itself(const struct shape_config *s)
{
    size_t n = s->n_vertices;
    for (size_t i = 0; i < n; i++) {
        const double *a = s->vertex[i], *b = s->vertex[(i + 1) % n];
        for (size_t j = 0; j < n; j++) {
            const double *c = s->vertex[j], *d = s->vertex[(j + 1) % n];
            bool shares = j == i || j == (i + 1) % n || i == (j + 1) % n;
            if (!shares && edges_cross(a, b, c, d))
                return true;
            if (j != i && j != (i + 1) % n && touches_edge(c, a, b))
                return true;
        }
    }
    return false;
}
