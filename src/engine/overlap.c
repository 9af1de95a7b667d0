/* The parts of a system merge to the same overlap in any order, because the deepest pair is the least by
 * ratio, then ids. */
#include "dm2/engine/overlap.h"

#include <stdio.h>

static bool is_deeper(const struct overlap *a, const struct overlap *b)
{
    if (a->ratio != b->ratio)
        return a->ratio < b->ratio;
    return a->id[0] != b->id[0] ? a->id[0] < b->id[0] : a->id[1] < b->id[1];
}

void overlap_merge(struct overlap *o, const struct overlap *part)
{
    uint64_t pairs = o->pairs + part->pairs;
    if (part->pairs > 0 && (o->pairs == 0 || is_deeper(part, o)))
        *o = *part;
    o->pairs = pairs;
}

static const char *body_name(const struct config *c, uint16_t body)
{
    return body < c->n_bodies ? c->bodies[body].name : "?";
}

enum dm2_status overlap_check(const struct overlap *o, const struct config *c, struct dm2_error *err)
{
    if (o->pairs == 0 || o->ratio >= OVERLAP_MOST)
        return DM2_OK;
    return dm2_fail(
        err, DM2_DECK,
        "elements %u of '%s' at (%.6g, %.6g) cm and %u of '%s' at (%.6g, %.6g) cm start closer than "
        "half their contact distance, at %.3g of it: the bodies overlap, a spacing is too small for "
        "its radius, or a period is no whole number of spacings",
        o->id[0], body_name(c, o->body[0]), o->r[0][0], o->r[0][1], o->id[1], body_name(c, o->body[1]),
        o->r[1][0], o->r[1][1], o->ratio);
}

bool overlap_describe(const struct overlap *o, const struct config *c, char line[OVERLAP_LINE])
{
    line[0] = '\0';
    if (o->pairs == 0)
        return false;
    char count[80];
    if (o->pairs == 1)
        (void)snprintf(count, sizeof count, "a pair of elements starts");
    else
        (void)snprintf(count, sizeof count, "%llu pairs of elements start", (unsigned long long)o->pairs);
    (void)snprintf(line, OVERLAP_LINE,
                   "warning: %s pressed into each other; the deepest, elements %u of '%s' at (%.6g, %.6g) cm "
                   "and %u of '%s' at (%.6g, %.6g) cm, stand at %.3g of their contact distance: move a body, "
                   "or make a period a whole number of spacings",
                   count, o->id[0], body_name(c, o->body[0]), o->r[0][0], o->r[0][1], o->id[1],
                   body_name(c, o->body[1]), o->r[1][0], o->r[1][1], o->ratio);
    return true;
}
