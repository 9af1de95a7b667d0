/* Checks of bodies, voids and flaws: their shapes, the materials and the structure of a body, whether
 * bodies lie in the domain, whether bodies overlap. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/deck/shape.h"
#include "bind_start.h"
#include "check.h"

enum { BOX_WORDS = 4 };

static bool body_shape_known(const struct deck_binding *b, size_t body)
{
    return binding_given(b, b->blocks[BLOCK_BODY][body], "shape");
}

/* The message about an invalid shape; NULL: the shape is valid. */
static const char *shape_problem(const struct shape_config *s)
{
    if (s->kind == SHAPE_RECTANGLE && !(s->box[0] < s->box[2] && s->box[1] < s->box[3]))
        return "a rectangle is x0 y0 x1 y1 with x0 < x1 and y0 < y1";
    if (s->kind == SHAPE_DISC && !(s->radius > 0))
        return "a disc is x y radius with a radius greater than 0";
    if (s->kind == SHAPE_POLYGON && shape_crosses_itself(s))
        return "the edges of this polygon cross or touch one another";
    if (!(shape_area(s) > 0) || !isfinite(shape_area(s)))
        return "the area of this shape is not a positive number";
    return NULL;
}

static bool check_shape(const struct deck_binding *b, size_t i)
{
    struct deck_place place = binding_place(b, b->blocks[BLOCK_BODY][i], "shape", 0);
    const char *problem = shape_problem(&b->config->bodies[i].shape);
    if (problem != NULL)
        findings_error(b->findings, place, "%s", problem);
    return problem == NULL;
}

static void check_mix(const struct deck_binding *b, size_t i)
{
    const struct body_config *body = &b->config->bodies[i];
    size_t block = b->blocks[BLOCK_BODY][i];
    struct number_text t, tm;
    double sum = 0;
    if (binding_missing(b, block, "material") && binding_missing(b, block, "mix"))
        findings_error(b->findings, binding_place(b, block, "material", 0),
                       "the body '%s' lacks 'material' or 'mix'", body->name);
    if (binding_given(b, block, "material") && binding_given(b, block, "mix"))
        findings_error(b->findings, binding_place(b, block, "mix", 0), "give 'material' or 'mix', not both");
    for (size_t m = 0; m < body->n_mix; m++) {
        const struct material_config *material = &b->config->materials[body->mix_material[m]];
        sum += body->mix_fraction[m];
        if (body->temperature >= material->tm)
            findings_error(b->findings, binding_place(b, block, "temperature", 0),
                           "the body '%s' starts at %s K, but its material '%s' melts at %s K", body->name,
                           number_text(body->temperature, &t), material->name,
                           number_text(material->tm, &tm));
    }
    if (body->n_mix > 0 && fabs(sum - 1) > 1e-6)
        findings_error(b->findings, binding_place(b, block, "mix", 0),
                       "the fractions of the mix sum to %.9g, not to 1", sum);
}

/* A fixed body has no velocity, and a body of prescribed motion has no random velocities. */
static void check_motion(const struct deck_binding *b, size_t i)
{
    const struct body_config *body = &b->config->bodies[i];
    size_t block = b->blocks[BLOCK_BODY][i];
    if (body->motion == MOTION_FIXED && (body->velocity[0] != 0 || body->velocity[1] != 0) &&
        binding_given(b, block, "velocity"))
        findings_error(b->findings, binding_place(b, block, "velocity", 0),
                       "the body '%s' is fixed: it has no velocity; 'motion = driven' keeps one", body->name);
    if (body->motion != MOTION_FREE && body->jitter > 0)
        findings_error(b->findings, binding_place(b, block, "jitter", 0),
                       "the motion of the body '%s' is prescribed: it has no random velocities", body->name);
}

static void refuse_meaningless(const struct deck_binding *b, size_t block, const char *key,
                               const char *structure)
{
    if (binding_given(b, block, key))
        findings_error(b->findings, binding_place(b, block, key, 0),
                       "'%s' has no meaning for a body whose structure is %s", key, structure);
}

/* Checks that the keywords which a structure needs are given, and that others are not. */
static void check_structure(const struct deck_binding *b, size_t i)
{
    static const char *const names[] = {"crystal", "polycrystal", "discs", "polygons"};
    const struct body_config *body = &b->config->bodies[i];
    const char *structure = names[body->structure];
    size_t block = b->blocks[BLOCK_BODY][i];
    struct number_text size, spacing;
    bool crystal = body->structure == STRUCTURE_CRYSTAL,
         powder = !crystal && body->structure != STRUCTURE_POLYCRYSTAL;
    if (!crystal && binding_missing(b, block, "grain_size"))
        findings_error(b->findings, binding_place(b, block, "structure", 0),
                       "the body '%s' lacks 'grain_size'", body->name);
    if (powder && binding_missing(b, block, "solid_fraction"))
        findings_error(b->findings, binding_place(b, block, "structure", 0),
                       "the body '%s' lacks 'solid_fraction'", body->name);
    if (powder && body->shape.kind == SHAPE_POLYGON && binding_given(b, block, "shape"))
        findings_error(b->findings, binding_place(b, block, "shape", 0),
                       "a powder fills a rectangle or a disc, not a polygon");
    if (body->grain_size * (1 - body->grain_spread) < 2 * body->radius)
        findings_error(b->findings, binding_place(b, block, "grain_size", 0),
                       "a grain of %s cm is smaller than an element of %s cm",
                       number_text(body->grain_size * (1 - body->grain_spread), &size),
                       number_text(2 * body->radius, &spacing));
    double box[BOX_WORDS], largest = body->grain_size * (1 + body->grain_spread);
    shape_box(&body->shape, box);
    if (powder && body_shape_known(b, i) && (largest > box[2] - box[0] || largest > box[3] - box[1]))
        findings_error(b->findings, binding_place(b, block, "grain_size", 0),
                       "a grain of %s cm does not fit into the body '%s'", number_text(largest, &size),
                       body->name);
    if (crystal)
        refuse_meaningless(b, block, "grain_size", structure);
    if (!powder) {
        refuse_meaningless(b, block, "grain_spread", structure);
        refuse_meaningless(b, block, "solid_fraction", structure);
    }
    if (!crystal) {
        refuse_meaningless(b, block, "origin", structure);
        refuse_meaningless(b, block, "angle", structure);
    }
}

/* Is the text at the place a number without a unit? */
static bool is_plain_number(const struct deck_binding *b, struct deck_place place)
{
    const char *bytes = place_bytes(b->findings->source, place);
    size_t n = 0;
    while (n < place.length && strchr("+-.0123456789eE ", bytes[n]) != NULL)
        n++;
    return n == place.length;
}

/* Asks about an angle beyond a full turn: a plain number is likely one in degrees without the unit. */
static void check_angle(const struct deck_binding *b, size_t i)
{
    static const double turn = 6.283185307179586;
    const struct body_config *body = &b->config->bodies[i];
    struct deck_place place = binding_place(b, b->blocks[BLOCK_BODY][i], "angle", 0);
    struct number_text t;
    if (!(fabs(body->angle) > turn * (1 + 1e-9)))
        return;
    if (is_plain_number(b, place))
        findings_warn(b->findings, place,
                      "the lattice of the body '%s' is turned by %s radians, more than a full turn: %s is a "
                      "number of radians, %s deg is an angle in degrees",
                      body->name, number_text(body->angle, &t), t.text, t.text);
    else
        findings_warn(
            b->findings, place,
            "the lattice of the body '%s' is turned by %.6g deg, more than a full turn: %.6g deg is "
            "the same lattice",
            body->name, body->angle * (360.0 / turn), fmod(body->angle, turn) * (360.0 / turn) + 0.0);
}

static void check_in_domain(const struct deck_binding *b, size_t i)
{
    const struct config *c = b->config;
    double box[BOX_WORDS];
    bool inside = true, outside = false;
    shape_box(&c->bodies[i].shape, box);
    for (int a = 0; a < 2; a++) {
        double low = c->origin[a], high = c->origin[a] + c->size[a];
        if (!isfinite(low) || !isfinite(high))
            return;
        double slack = fmax(0.0, SITE_TOLERANCE * c->bodies[i].spacing); /* 0: the spacing is NaN */
        inside = inside && box[a] >= low - slack && box[a + 2] <= high + slack;
        outside = outside || box[a] >= high || box[a + 2] <= low;
    }
    struct deck_place place = binding_place(b, b->blocks[BLOCK_BODY][i], "shape", 0);
    if (outside)
        findings_error(b->findings, place, "the body '%s' lies outside the domain", c->bodies[i].name);
    else if (!inside)
        findings_warn(b->findings, place, "the body '%s' lies partly outside the domain", c->bodies[i].name);
}

static double estimate_elements(const struct body_config *body)
{
    return shape_area(&body->shape) / (body->spacing * body->row_spacing);
}

struct body_box {
    double box[BOX_WORDS];
    size_t body;
};

static int compare_boxes(const void *a, const void *b)
{
    const struct body_box *x = a, *y = b;
    if (x->box[0] != y->box[0])
        return x->box[0] < y->box[0] ? -1 : 1;
    return x->body < y->body ? -1 : x->body > y->body;
}

/* True if one of the two bodies has a void of its own that overlaps the other body. Elements that overlap in
 * spite of the void are found when they are generated. */
static bool void_makes_room(const struct config *c, size_t i, size_t j)
{
    for (size_t k = 0; k < c->n_voids; k++) {
        int body = c->voids[k].body;
        if (body >= 0 && ((size_t)body == i || (size_t)body == j) &&
            shape_image_overlaps(&c->voids[k].shape, c, &c->bodies[(size_t)body == i ? j : i].shape))
            return true;
    }
    return false;
}

static void check_overlap(const struct deck_binding *b, size_t i, size_t j)
{
    /* The finding is at the later body of the deck. */
    size_t first = i < j ? i : j, second = i < j ? j : i;
    const struct body_config *x = &b->config->bodies[first], *y = &b->config->bodies[second];
    struct deck_place place = binding_place(b, b->blocks[BLOCK_BODY][second], "shape", 0);
    bool bad = binding_bad(b, b->blocks[BLOCK_BODY][i], "velocity") ||
               binding_bad(b, b->blocks[BLOCK_BODY][j], "velocity");
    if (bad || !shape_overlaps(&x->shape, &y->shape) || void_makes_room(b->config, first, second))
        return;
    if (x->velocity[0] != y->velocity[0] || x->velocity[1] != y->velocity[1])
        findings_error(b->findings, place, "the bodies '%s' and '%s' overlap, and their velocities differ",
                       x->name, y->name);
    else
        findings_warn(b->findings, place, "the bodies '%s' and '%s' overlap: elements may lie on one another",
                      x->name, y->name);
}

/* Checks all pairs of bodies that overlap in x, by a sweep from left to right. */
static void check_overlaps(const struct deck_binding *b, struct body_box *boxes, size_t n)
{
    qsort(boxes, n, sizeof *boxes, compare_boxes);
    for (size_t i = 0; i < n; i++)
        for (size_t j = i + 1; j < n && boxes[j].box[0] < boxes[i].box[2] && !b->findings->more_errors; j++)
            check_overlap(b, boxes[i].body, boxes[j].body);
}

/* True if the shape or an image of the shape overlaps body `body`, or any body where `body` is -1. Also true
 * where a shape of a body did not read. */
static bool meets_a_body(const struct deck_binding *b, const struct shape_config *shape, int body)
{
    const struct config *c = b->config;
    for (size_t i = 0; i < c->n_bodies; i++) {
        if (body >= 0 && (size_t)body != i)
            continue;
        if (!body_shape_known(b, i) || shape_image_overlaps(shape, c, &c->bodies[i].shape))
            return true;
    }
    return c->n_bodies == 0;
}

static void check_voids(const struct deck_binding *b)
{
    for (size_t i = 0; i < b->config->n_voids; i++) {
        const struct void_config *v = &b->config->voids[i];
        size_t block = b->blocks[BLOCK_VOID][i];
        if (!binding_given(b, block, "shape") || binding_bad(b, block, "body"))
            continue;
        const char *problem = shape_problem(&v->shape);
        if (problem != NULL)
            findings_error(b->findings, binding_place(b, block, "shape", 0), "%s", problem);
        else if (!meets_a_body(b, &v->shape, v->body))
            findings_error(b->findings, binding_place(b, block, "shape", 0), "the void '%s' lies outside %s",
                           v->name, v->body >= 0 ? "its body" : "every body");
    }
}

/* The line as a thin quadrangle, because shape_overlaps needs an area. */
static struct shape_config line_sliver(const double line[4])
{
    double dx = line[2] - line[0], dy = line[3] - line[1], thin = 1e-9;
    struct shape_config s = {.kind = SHAPE_POLYGON,
                             .n_vertices = 4,
                             .vertex = {{line[0], line[1]},
                                        {line[2], line[3]},
                                        {line[2] - thin * dy, line[3] + thin * dx},
                                        {line[0] - thin * dy, line[1] + thin * dx}}};
    return s;
}

static void check_flaws(const struct deck_binding *b)
{
    for (size_t i = 0; i < b->config->n_flaws; i++) {
        const struct flaw_config *f = &b->config->flaws[i];
        size_t block = b->blocks[BLOCK_FLAW][i];
        struct shape_config s = line_sliver(f->line);
        if (!binding_given(b, block, "line") || binding_bad(b, block, "body"))
            continue;
        if (f->line[0] == f->line[2] && f->line[1] == f->line[3])
            findings_error(b->findings, binding_place(b, block, "line", 0),
                           "a line is x0 y0 x1 y1 between two points");
        else if (!meets_a_body(b, &s, f->body))
            findings_error(b->findings, binding_place(b, block, "line", 0), "the flaw '%s' lies outside %s",
                           f->name, f->body >= 0 ? "its body" : "every body");
    }
}

bool check_bodies(const struct deck_binding *b)
{
    size_t n = 0;
    double elements = 0;
    struct body_box *boxes = mem_zalloc(b->config->n_bodies, sizeof *boxes);
    if (boxes == NULL) {
        b->findings->no_memory = true;
        return false;
    }
    for (size_t i = 0; i < b->config->n_bodies; i++) {
        const struct body_config *body = &b->config->bodies[i];
        check_motion(b, i);
        if (start_is_taken(b, body))
            continue;
        check_mix(b, i);
        check_structure(b, i);
        check_angle(b, i);
        if (!body_shape_known(b, i) || !check_shape(b, i))
            continue;
        check_in_domain(b, i);
        shape_box(&body->shape, boxes[n].box);
        boxes[n++].body = i;
        double own = estimate_elements(body);
        elements += own > 0 ? own : 0;
        if (elements > DECK_MAX_ELEMENTS) {
            findings_error(b->findings, binding_place(b, b->blocks[BLOCK_BODY][i], "spacing", 0),
                           "the deck would have about %.3g elements with the body '%s'; the most is %.3g",
                           elements, body->name, DECK_MAX_ELEMENTS);
            elements = 0;
        }
    }
    check_overlaps(b, boxes, n);
    check_probes(b, n == b->config->n_bodies);
    check_voids(b);
    check_flaws(b);
    free(boxes);
    return true;
}
