/* Vertices, directions and laws of walls. */
#include "wall_shape.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"

/* --- laws --- */

/* The law of two elements that mirror each other in a rigid plane. The overlap with the mirror image is twice
 * the overlap with the plane, so that k and alpha are doubled; damping and friction follow k. */
static void make_rigid(struct pair_law *law)
{
    law->k *= 2.0;
    law->shape *= 2.0;
    law->cn *= sqrt(2.0);
    law->ct *= sqrt(2.0);
    law->kt_contact *= 2.0;
}

static enum dm2_status make_laws(const struct model *m, struct wall *w, struct dm2_error *err)
{
    w->laws = mem_zalloc(m->n_kinds, sizeof *w->laws);
    if (w->laws == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the laws of wall '%s'", w->config->name);
    for (size_t a = 0; a < m->n_kinds; a++) {
        size_t b = w->config->material < 0 ? a : (size_t)w->config->material;
        struct kind_name name;
        struct pair_law *law = &w->laws[a];
        *law = *model_law(m, a, b, RELATION_OTHER_BODY);
        if (law->scope != SCOPE_LINKED)
            return config_fail(
                w->config->place, err, DM2_DECK,
                "the wall '%s' acts on elements that touch it, and the interaction of '%s' with "
                "it has scope = all: give them scope = linked",
                w->config->name, config_kind_name(m->config, a, &name));
        if (w->config->rigid)
            make_rigid(law);
        law->link_form = 0.0;
        law->kt_link = law->kt_contact;
        law->cn_mass = law->ct_mass = -1.0;
        double radius = model_law(m, a, a, RELATION_OTHER_BODY)->radius_i;
        law->radius_i = law->radius_j = radius;
        law->bond = radius > 0.0 ? law_bond(law, 2.0 * radius) : (struct bond){0};
    }
    return DM2_OK;
}

/* --- lines --- */

/* Half of the shortest periodic side, cm. */
static double longest_segment(const struct grid *g)
{
    double most = INFINITY;
    for (int a = 0; a < 2; a++)
        if (g->periodic[a] && 0.5 * g->size[a] < most)
            most = 0.5 * g->size[a];
    return most;
}

/* The segments that part k of a line is cut into. */
static size_t count_segments(const double *p, double longest)
{
    double dx = p[2] - p[0], dy = p[3] - p[1];
    return isinf(longest) ? 1 : (size_t)ceil(sqrt(dx * dx + dy * dy) / longest * (1.0 - 1e-12));
}

static size_t count_all_segments(const struct wall_config *c, double longest)
{
    size_t segments = 0;
    for (size_t k = 0; k + 1 < c->n_points; k++)
        segments += count_segments(c->points + 2 * k, longest);
    return segments;
}

size_t walls_count_features(const struct wall_config *c, const struct grid *g)
{
    return c->n_points == 0 ? 1 : 2 * count_all_segments(c, longest_segment(g)) + (c->closed ? 0 : 1);
}

static void find_centre(struct wall *w)
{
    const struct wall_config *c = w->config;
    size_t n = c->n_points - (w->closed ? 1 : 0);
    double sum[2] = {0.0, 0.0};
    for (size_t k = 0; k < n; k++)
        for (size_t a = 0; a < 2; a++)
            sum[a] += c->points[2 * k + a];
    for (size_t a = 0; a < 2; a++)
        w->centre[a] = sum[a] / (double)n;
    for (size_t k = 0; k < n; k++) {
        double dx = c->points[2 * k] - w->centre[0], dy = c->points[2 * k + 1] - w->centre[1];
        w->extent = fmax(w->extent, sqrt(dx * dx + dy * dy));
    }
}

/* Sets the directions behind vertex k and before the next one, of `part`, whose segments are collinear. */
static void place_vertices(struct wall *w, const double *part, size_t n, size_t *at)
{
    double dx = part[2] - part[0], dy = part[3] - part[1], over = 1.0 / sqrt(dx * dx + dy * dy);
    for (size_t s = 0; s < n; s++, ++*at) {
        struct wall_vertex *v = &w->vertex[*at];
        size_t next = *at + 1 == w->n_vertices ? 0 : *at + 1;
        double share = (double)s / (double)n;
        v->p[0] = part[0] + share * dx;
        v->p[1] = part[1] + share * dy;
        v->after[0] = w->vertex[next].before[0] = dx * over;
        v->after[1] = w->vertex[next].before[1] = dy * over;
    }
}

static enum dm2_status make_line(const struct model *m, struct wall *w, struct dm2_error *err)
{
    const struct wall_config *c = w->config;
    double longest = longest_segment(&m->grid);
    size_t segments = count_all_segments(c, longest), at = 0;
    w->closed = c->closed;
    for (int a = 0; a < 2; a++)
        w->seam[a] = c->seam[a];
    w->n_vertices = segments + (w->closed ? 0 : 1);
    w->n_features = walls_count_features(c, &m->grid);
    w->vertex = mem_zalloc(w->n_vertices, sizeof *w->vertex);
    if (w->vertex == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the points of wall '%s'", c->name);
    for (size_t k = 0; k + 1 < c->n_points; k++)
        place_vertices(w, c->points + 2 * k, count_segments(c->points + 2 * k, longest), &at);
    if (!w->closed)
        for (size_t a = 0; a < 2; a++)
            w->vertex[at].p[a] = c->points[2 * (c->n_points - 1) + a];
    find_centre(w);
    return DM2_OK;
}

/* --- all walls --- */

enum dm2_status walls_make(struct model *m, struct dm2_error *err)
{
    const struct config *c = m->config;
    enum dm2_status status = DM2_OK;
    if (c->n_walls == 0)
        return DM2_OK;
    m->walls = mem_zalloc(c->n_walls, sizeof *m->walls);
    if (m->walls == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %zu walls", c->n_walls);
    for (size_t k = 0; k < c->n_walls && status == DM2_OK; k++) {
        struct wall *w = &m->walls[m->n_walls++];
        *w = (struct wall){.config = &c->walls[k], .mover = c->n_bodies + k, .first = m->n_wall_features};
        while (w->temperature_load < c->n_loads &&
               (c->loads[w->temperature_load].mover != w->mover ||
                c->loads[w->temperature_load].quantity != LOAD_TEMPERATURE))
            w->temperature_load++;
        status = make_laws(m, w, err);
        if (status == DM2_OK && c->walls[k].n_points > 0) {
            status = make_line(m, w, err);
        } else {
            w->circle = true;
            w->n_features = 1;
            w->centre[0] = c->walls[k].circle[0];
            w->centre[1] = c->walls[k].circle[1];
            w->radius = c->walls[k].circle[2];
        }
        m->n_wall_features += w->n_features;
    }
    if (status == DM2_OK && m->n_wall_features > UINT32_MAX / 2)
        status = dm2_fail(err, DM2_DECK, "the walls have %zu points and parts: more than can be numbered",
                          m->n_wall_features);
    return status;
}

void walls_unmake(struct model *m)
{
    for (size_t k = 0; k < m->n_walls; k++) {
        free(m->walls[k].vertex);
        free(m->walls[k].laws);
    }
    free(m->walls);
}

const struct wall *walls_of_feature(const struct model *m, size_t feature)
{
    size_t low = 0, high = m->n_walls;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (m->walls[middle].first <= feature)
            low = middle;
        else
            high = middle;
    }
    return &m->walls[low];
}
