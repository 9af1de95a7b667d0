/* Checks of walls: fixed and driven bodies, which are rows of elements. A row is no plane: an element that is
 * larger than those of the row touches several of them at once, and a row whose spacing fits that of a
 * crystal holds the crystal by its dips (docs/physics.md, section 11). */
#include <math.h>

#include "check.h"

enum { SIZES_MAX = 16 }; /* sizes of free elements that a wall is compared with */

/* The free bodies of the deck, one for each size and spacing of elements. */
struct free_sizes {
    const struct body_config *body[SIZES_MAX];
    size_t n;
};

static bool has_structure(const struct body_config *body)
{
    return body->structure == STRUCTURE_POLYCRYSTAL || body->structure == STRUCTURE_DISCS ||
           body->structure == STRUCTURE_POLYGONS;
}

static void find_free_sizes(const struct config *c, struct free_sizes *out)
{
    out->n = 0;
    for (size_t i = 0; i < c->n_bodies && out->n < SIZES_MAX; i++) {
        const struct body_config *body = &c->bodies[i];
        bool known = body->motion != MOTION_FREE || !(body->radius > 0.0);
        for (size_t k = 0; k < out->n && !known; k++)
            known = !(body->radius < out->body[k]->radius || body->radius > out->body[k]->radius ||
                      body->spacing < out->body[k]->spacing || body->spacing > out->body[k]->spacing) &&
                    has_structure(body) == has_structure(out->body[k]);
        if (!known)
            out->body[out->n++] = body;
    }
}

/* Elements smaller than half of what can touch them: one contact is then several pairs. */
static void warn_fine(const struct deck_binding *b, size_t wall, const struct body_config *other)
{
    const struct body_config *body = &b->config->bodies[wall];
    findings_warn(
        b->findings, binding_place(b, b->blocks[BLOCK_BODY][wall], "spacing", 0),
        "the elements of the wall '%s', %.4g cm, are smaller than half of those of '%s', %.4g cm, which "
        "can touch several of them at once: stiffness, damping and heat of these pairs add up, so "
        "that they depend on the size of the wall's elements; compare with a wall of larger elements",
        body->name, 2.0 * body->radius, other->name, 2.0 * other->radius);
}

/* A spacing that goes a whole number of times, 2 or more, into that of a crystal. */
static void warn_commensurate(const struct deck_binding *b, size_t wall, const struct body_config *other)
{
    const struct body_config *body = &b->config->bodies[wall];
    double ratio = other->spacing / body->spacing, whole = round(ratio);
    if (has_structure(body) || has_structure(other) || !(ratio > 1.5) || !(fabs(ratio - whole) < 0.02))
        return;
    findings_warn(
        b->findings, binding_place(b, b->blocks[BLOCK_BODY][wall], "spacing", 0),
        "the spacing of '%s' is %g times that of the wall '%s', so that all elements of a row can sit "
        "in dips of the wall at once: without friction the wall holds them up to the slope "
        "s/(2 (R + r)) = %.2g; choose a spacing that does not fit, such as %.4g cm",
        other->name, whole, body->name, body->spacing / (2.0 * (other->radius + body->radius)),
        other->spacing / (whole + 0.37));
}

void check_walls(const struct deck_binding *b)
{
    const struct config *c = b->config;
    struct free_sizes sizes;
    find_free_sizes(c, &sizes);
    for (size_t i = 0; i < c->n_bodies; i++) {
        const struct body_config *largest = NULL;
        if (c->bodies[i].motion == MOTION_FREE || !(c->bodies[i].radius > 0.0))
            continue;
        for (size_t k = 0; k < sizes.n; k++)
            if (largest == NULL || sizes.body[k]->radius > largest->radius)
                largest = sizes.body[k];
        /* The margin keeps walls of just half the size out, whatever the rounding of the deck's numbers. */
        if (largest != NULL && c->bodies[i].radius < 0.5 * largest->radius * (1.0 - 1e-9))
            warn_fine(b, i, largest);
        for (size_t k = 0; k < sizes.n; k++)
            warn_commensurate(b, i, sizes.body[k]);
    }
}
