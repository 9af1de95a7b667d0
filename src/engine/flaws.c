/* A link is a segment from centre to centre. Two segments cross where the ends of each lie on different sides
 * of the other. The link moves by shape_site_shift, so that a centre on the line lies to the right of the
 * line or above it, and an end of the line on the link in the same way to one side. The link starts at its
 * end of lower id and goes the shortest way, so that every server that sees the link decides with the same
 * numbers. */
#include "flaws.h"

#include <math.h>

#include "dm2/base/random.h"
#include "dm2/deck/shape.h"

/* Is p left of the line from a to b? */
static bool is_left_of(const double *a, const double *b, const double *p)
{
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) >= 0.0;
}

static bool segments_cross(const double line[4], const double p[2], const double q[2])
{
    return is_left_of(line, line + 2, p) != is_left_of(line, line + 2, q) &&
           is_left_of(p, q, line) != is_left_of(p, q, line + 2);
}

/* Does the flaw, or an image of the flaw whole periods away, cut the link? from_high is the vector from
 * `high` to `low`. */
static bool flaw_cuts(const struct config *c, const struct flaw_config *f, struct link_end low,
                      struct link_end high, const double from_high[2])
{
    double move[2], p[2], q[2], first[2], last[2];
    if (f->body >= 0 && (f->body != low.body || f->body != high.body))
        return false;
    shape_site_shift(c->bodies[low.body].spacing, move);
    for (int a = 0; a < 2; a++) {
        p[a] = low.r[a] + move[a];
        q[a] = p[a] - from_high[a];
        first[a] = fmin(f->line[a], f->line[a + 2]) - fmax(p[a], q[a]);
        last[a] = fmax(f->line[a], f->line[a + 2]) - fmin(p[a], q[a]);
    }
    struct image_range k = shape_images(c, first, last);
    for (int64_t v = k.first[1]; v <= k.last[1]; v++) {
        for (int64_t u = k.first[0]; u <= k.last[0]; u++) {
            double by[2] = {(double)u * c->size[0], (double)v * c->size[1]};
            double from[2] = {p[0] + by[0], p[1] + by[1]}, to[2] = {q[0] + by[0], q[1] + by[1]};
            if (segments_cross(f->line, from, to))
                return true;
        }
    }
    return false;
}

bool flaws_miss(const struct config *c, struct link_end a, struct link_end b, const double apart[2])
{
    bool ordered = a.id < b.id;
    struct link_end low = ordered ? a : b, high = ordered ? b : a;
    double from_high[2] = {ordered ? apart[0] : -apart[0], ordered ? apart[1] : -apart[1]};
    const struct body_config *body = &c->bodies[low.body];
    if (low.body == high.body && body->missing_links > 0.0 &&
        random_uniform(body->seed, (uint64_t)low.id << 32 | high.id, RANDOM_LINK) < body->missing_links)
        return true;
    for (size_t k = 0; k < c->n_flaws; k++) {
        if (flaw_cuts(c, &c->flaws[k], low, high, from_high))
            return true;
    }
    return false;
}
