/* Walls: the points of their lines, whether a line is closed, and the checks of the blocks `wall`. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "bind_loads.h"
#include "check.h"

enum { POINTS_MAX = 100000 };

/* --- binding --- */

bool walls_read_points(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                       struct wall_config *wall)
{
    if (entry->n % 2 != 0 || entry->n < 4 || entry->n > 2 * (size_t)POINTS_MAX) {
        findings_error(b->findings, entry->key,
                       entry->n % 2 != 0 ? "a line is x y pairs: found %zu numbers, one is without its pair"
                       : entry->n < 4    ? "a line has at least 2 points: found %zu numbers"
                                         : "a line has at most 100000 points: found %zu numbers",
                       entry->n);
        return false;
    }
    wall->points = mem_zalloc(entry->n, sizeof *wall->points);
    if (wall->points == NULL) {
        b->findings->no_memory = true;
        return false;
    }
    bool ok = true;
    for (size_t i = 0; i < entry->n; i++)
        ok = value_read_real(b, key, entry, i, &wall->points[i]) && ok;
    wall->n_points = entry->n / 2;
    return ok;
}

/* The ends meet within a rounding of the deck's numbers; the last point is then put where the first one, or
 * its image, is. */
static void close_line(const struct deck_binding *b, size_t block, struct wall_config *wall)
{
    const struct config *c = b->config;
    wall->place = findings_place(b->findings, binding_place(b, block, "wall", 0));
    if (wall->n_points < 2 || !binding_given(b, block, "line"))
        return;
    double *last = wall->points + 2 * (wall->n_points - 1), off[2];
    const double *first = wall->points;
    wall->closed = true;
    for (int a = 0; a < 2; a++) {
        off[a] = last[a] - first[a];
        if (c->periodic[a] && c->size[a] > 0.0 && fabs(off[a]) > 0.5 * c->size[a]) {
            wall->seam[a] = off[a] > 0.0 ? 1 : -1;
            off[a] -= wall->seam[a] * c->size[a];
        }
        wall->closed = wall->closed && fabs(off[a]) <= 1e-9 * (c->size[0] + c->size[1]);
    }
    if (wall->n_points == 2 && wall->seam[0] == 0 && wall->seam[1] == 0)
        wall->closed = false;
    for (int a = 0; a < 2; a++) {
        wall->seam[a] = wall->closed ? wall->seam[a] : 0;
        if (wall->closed)
            last[a] = first[a] + wall->seam[a] * c->size[a];
    }
}

void walls_finish(struct deck_binding *b)
{
    for (size_t i = 0; i < b->config->n_walls; i++)
        close_line(b, b->blocks[BLOCK_WALL][i], &b->config->walls[i]);
}

/* --- checks --- */

static void refuse_turn(const struct deck_binding *b, struct deck_place place, const struct wall_config *w)
{
    findings_error(b->findings, place,
                   "the line of '%s' closes across a periodic side of the domain, so that it cannot turn: "
                   "leave the spin out, or end the line before the side",
                   w->name);
}

static void check_line(const struct deck_binding *b, size_t block, const struct wall_config *w)
{
    const struct config *c = b->config;
    for (size_t k = 0; k + 1 < w->n_points; k++) {
        const double *p = w->points + 2 * k;
        struct number_text x, y;
        struct deck_place place = binding_place(b, block, "line", 2 * k + 2);
        if (p[0] == p[2] && p[1] == p[3]) {
            findings_error(b->findings, place, "the point (%s, %s) cm comes twice in a row",
                           number_text(p[0], &x), number_text(p[1], &y));
            return;
        }
        for (int a = 0; a < 2; a++) {
            if (!c->periodic[a] || !(fabs(p[2 + a] - p[a]) > c->size[a] * (1.0 + 1e-9)))
                continue;
            findings_error(b->findings, place,
                           "a part of a line is at most as long as the domain along a periodic side, "
                           "%s cm: draw the wall once around and no further",
                           number_text(c->size[a], &x));
            return;
        }
    }
    if ((w->seam[0] != 0 || w->seam[1] != 0) && w->spin != 0.0)
        refuse_turn(b, binding_place(b, block, "spin", 0), w);
}

static void check_circle(const struct deck_binding *b, size_t block, const struct wall_config *w)
{
    const struct config *c = b->config;
    struct number_text radius, size;
    double around = 2.0 * w->circle[2] + 2.0 * config_contact_distance(c);
    if (!(w->circle[2] > 0.0))
        findings_error(b->findings, binding_place(b, block, "circle", 2),
                       "the radius of a circle must be greater than 0 cm, but is %s cm",
                       number_text(w->circle[2], &radius));
    for (int a = 0; a < 2; a++)
        if (c->periodic[a] && around > c->size[a])
            findings_error(b->findings, binding_place(b, block, "circle", 2),
                           "a circle of radius %s cm meets its own image, because the domain is periodic "
                           "with %s cm: with two diameters of an element it has to fit",
                           number_text(w->circle[2], &radius), number_text(c->size[a], &size));
}

static void check_exclusive(const struct deck_binding *b, size_t block, const char *one, const char *other,
                            bool has_one, bool has_other)
{
    if (has_one && has_other)
        findings_error(b->findings, binding_place(b, block, other, 0),
                       "a wall has either `%s` or `%s`: leave one out", one, other);
    else if (!has_one && !has_other && binding_missing(b, block, one) && binding_missing(b, block, other))
        findings_error(b->findings, binding_place(b, block, "wall", 0),
                       "the block 'wall' lacks `%s` or `%s`: give one of them", one, other);
}

/* What loads a wall takes: motions and forces that `velocity`, `spin` and the shape do not contradict, and a
 * temperature. */
static void check_wall_loads(const struct deck_binding *b, size_t mover, size_t block,
                             const struct wall_config *w)
{
    const struct config *c = b->config;
    const bool set[3] = {w->velocity[0] != 0.0, w->velocity[1] != 0.0, w->spin != 0.0};
    for (size_t i = 0; i < c->n_loads; i++) {
        enum load_quantity q = c->loads[i].quantity;
        if (c->loads[i].mover != mover || q == LOAD_TEMPERATURE)
            continue;
        const int motion = q == LOAD_FORCE_X || q == LOAD_STRESS_XX   ? LOAD_VELOCITY_X
                           : q == LOAD_FORCE_Y || q == LOAD_STRESS_YY ? LOAD_VELOCITY_Y
                                                                      : (int)q;
        if (motion > LOAD_SPIN)
            findings_error(b->findings, load_place(b, i),
                           "a wall has no acceleration: a wall takes velocity_x, velocity_y, spin, force_x, "
                           "force_y, stress_xx, stress_yy, temperature");
        else if (set[motion])
            findings_error(b->findings, binding_place(b, block, q == LOAD_SPIN ? "spin" : "velocity", 0),
                           "the load '%s' moves the wall '%s' along the same axis: leave one out",
                           c->loads[i].name, w->name);
        else if (q == LOAD_SPIN && (w->seam[0] != 0 || w->seam[1] != 0))
            refuse_turn(b, binding_place(b, block, "line", 0), w);
    }
}

/* Bodies and walls share their names, because loads and probes name either. */
static void check_name(const struct deck_binding *b, size_t block, const struct wall_config *w)
{
    for (size_t i = 0; i < b->config->n_bodies; i++)
        if (strcmp(b->config->bodies[i].name, w->name) == 0)
            findings_error(b->findings, binding_place(b, block, "wall", 0),
                           "there is a body '%s': walls and bodies have different names", w->name);
}

void check_lines(const struct deck_binding *b)
{
    const struct config *c = b->config;
    for (size_t i = 0; i < c->n_walls; i++) {
        const struct wall_config *w = &c->walls[i];
        size_t block = b->blocks[BLOCK_WALL][i];
        bool line = binding_given(b, block, "line"), circle = binding_given(b, block, "circle");
        bool bad = binding_bad(b, block, "line") || binding_bad(b, block, "circle") ||
                   binding_bad(b, block, "material") || binding_bad(b, block, "rigid");
        check_name(b, block, w);
        check_wall_loads(b, c->n_bodies + i, block, w);
        if (!bad) {
            check_exclusive(b, block, "line", "circle", line, circle);
            check_exclusive(b, block, "material", "rigid", w->material >= 0, w->rigid);
        }
        if (line)
            check_line(b, block, w);
        if (circle)
            check_circle(b, block, w);
    }
}
