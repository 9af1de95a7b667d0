/* A link is a segment from centre to centre. Two segments cross where the ends of each lie on different sides
 * of the other. An end on the line counts as left of the line, so that a line through a row of centres cuts
 * the links on the right side of the row and leaves the links on the left side. The two ends are taken in the
 * order of their ids, so that every server that sees the link decides with the same numbers. */
#include "flaws.h"

#include "dm2/base/random.h"

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

/* Does the flaw cut the link? from_high is the vector from `high` to `low`. A link across a periodic side is
 * tested as seen from either end. */
static bool flaw_cuts(const struct flaw_config *f, struct link_end low, struct link_end high,
                      const double from_high[2])
{
    double low_image[2], high_image[2];
    if (f->body >= 0 && (f->body != low.body || f->body != high.body))
        return false;
    for (int a = 0; a < 2; a++) {
        high_image[a] = low.r[a] - from_high[a];
        low_image[a] = high.r[a] + from_high[a];
    }
    return segments_cross(f->line, low.r, high_image) || segments_cross(f->line, low_image, high.r);
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
        if (flaw_cuts(&c->flaws[k], low, high, from_high))
            return true;
    }
    return false;
}
