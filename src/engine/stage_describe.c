/* What a deck has to know of the state that its run begins from, measured from the state's records. */
#include "dm2/engine/stage.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/deck/meaning.h"
#include "moments.h"
#include "motion.h"
#include "tables.h"

static enum dm2_status refuse(const char *path, const char *what, uint32_t id, struct dm2_error *err)
{
    return dm2_fail(err, DM2_PROTOCOL, "%s: element %" PRIu32 " %s", path, id, what);
}

/* The bodies under way: moments and numbers of elements, [n_bodies]. */
struct survey {
    struct moments *moments;
    size_t *n;
};

/* Adds an element to its body. */
static void add_element(struct start_source *s, struct survey *v, const struct element *e)
{
    const struct config *c = &s->before;
    struct body_start *body = &s->bodies[e->body];
    double place[2];
    if (v->n[e->body]++ == 0) {
        moments_start(&v->moments[e->body], c, e->mass);
        *body = (struct body_start){.id_first = e->id,
                                    .grain_first = e->grain,
                                    .grain_end = e->grain + 1,
                                    .low = {INFINITY, INFINITY},
                                    .high = {-INFINITY, -INFINITY},
                                    .least = INFINITY};
    }
    body->id_end = e->id + 1;
    body->grain_first = e->grain < body->grain_first ? e->grain : body->grain_first;
    body->grain_end = e->grain >= body->grain_end ? e->grain + 1 : body->grain_end;
    for (int a = 0; a < 2; a++) {
        place[a] = e->r[a] + (double)e->image[a] * c->size[a];
        body->low[a] = fmin(body->low[a], e->r[a] - e->radius);
        body->high[a] = fmax(body->high[a], e->r[a] + e->radius);
    }
    moments_add(&v->moments[e->body], e->mass, place);
    if (e->radius < body->least || (e->radius == body->least && e->mass < body->lightest)) {
        body->least = e->radius;
        body->lightest = e->mass;
    }
    s->kinds[e->body * config_kinds(c) + e->kind] = true;
    if (c->n_phases + c->n_reactions > 0)
        s->kinds[e->body * config_kinds(c) + e->was] = true;
}

static enum dm2_status survey_elements(const char *path, const struct state_view *state,
                                       struct start_source *s, struct survey *v, struct dm2_error *err)
{
    const struct config *c = &s->before;
    for (size_t k = 0; k < state->n_elements; k++) {
        const struct element *e = &state->elements[k];
        if (e->body >= c->n_bodies || e->kind >= config_kinds(c) || e->was >= config_kinds(c))
            return refuse(path, "is of a body or a kind that the state's deck does not have", e->id, err);
        if (v->n[e->body] > 0 && s->bodies[e->body].id_end != e->id)
            return refuse(path, "does not follow the elements of its body", e->id, err);
        add_element(s, v, e);
    }
    for (size_t b = 0; b < c->n_bodies; b++) {
        if (v->n[b] == 0)
            return dm2_fail(err, DM2_PROTOCOL, "%s: has no element of body '%s'", path, c->bodies[b].name);
        moments_centroid(&v->moments[b], s->bodies[b].centroid);
        s->bodies[b].mass = moments_mass(&v->moments[b]);
    }
    return DM2_OK;
}

/* Where the walls are at the state's step, by their velocities, loads and forces. */
static enum dm2_status find_walls(const struct state_view *state, struct start_source *s,
                                  struct dm2_error *err)
{
    const struct section_array *forced = &state->sections[SECTION_BODY];
    struct model m = {.config = &s->before};
    enum dm2_status status = s->before.n_walls > 0 ? motion_build(&m, err) : DM2_OK;
    for (size_t k = 0; k < s->before.n_walls && status == DM2_OK; k++) {
        struct rigid_motion at;
        motion_at(&m, s->before.n_bodies + k, s->step, &at);
        s->walls[k] = (struct start_wall){{at.dx, at.dy}, at.angle};
        for (size_t i = 0; i < forced->n; i++) {
            const struct body_record *b = section_record(SECTION_BODY, forced, i);
            for (int a = 0; a < 2 && b->mover == s->before.n_bodies + k; a++)
                s->walls[k].moved[a] += b->displacement[a];
        }
    }
    motion_free(&m);
    return status;
}

static enum dm2_status fill_source(const char *path, const struct state_view *state, struct start_source *s,
                                   struct dm2_error *err)
{
    const struct state_origin *origin = state->origin;
    struct dm2_error why = {0};
    enum dm2_status status = meaning_load(origin->text, origin->text_length, &s->before, &why);
    if (status != DM2_OK)
        return dm2_fail(err, status, "%s: %.400s", path, why.text);
    s->before.n_start = origin->n_start;
    s->before.t_start = origin->t_start;
    s->step = state->step;
    s->time = config_time(&s->before, state->step);
    s->dt_before = state->step > origin->n_start ? s->before.dt : 0.0;
    s->n_clock = origin->n_start;
    s->t_clock = origin->t_start;
    s->next_id = origin->next_id;
    s->next_grain = origin->next_grain;
    if (state->step == origin->n_start && s->before.start.on)
        return dm2_fail(err, DM2_DECK,
                        "%s: is the first state of a run that began from another state: begin from that one",
                        path);
    size_t n = s->before.n_bodies;
    struct survey v = {mem_zalloc(n, sizeof *v.moments), mem_zalloc(n, sizeof *v.n)};
    s->bodies = mem_zalloc(n, sizeof *s->bodies);
    s->walls = mem_zalloc(s->before.n_walls, sizeof *s->walls);
    s->kinds = mem_zalloc(n, config_kinds(&s->before) * sizeof *s->kinds);
    if (v.moments == NULL || v.n == NULL || s->bodies == NULL || s->walls == NULL || s->kinds == NULL)
        status = dm2_fail(err, DM2_MEMORY, "no memory for the bodies of a state");
    if (status == DM2_OK)
        status = survey_elements(path, state, s, &v, err);
    if (status == DM2_OK)
        status = find_walls(state, s, err);
    free(v.moments);
    free(v.n);
    return status;
}

enum dm2_status stage_describe(const char *path, const struct state_view *state,
                               const char digest[START_DIGEST], struct bytes_writer *out,
                               struct dm2_error *err)
{
    struct start_source s;
    memset(&s, 0, sizeof s);
    memcpy(s.digest, digest, START_DIGEST - 1);
    enum dm2_status status = fill_source(path, state, &s, err);
    if (status == DM2_OK)
        start_put(out, &s, state->origin->text, state->origin->text_length);
    start_free(&s);
    return status == DM2_OK && out->failed ? dm2_fail(err, DM2_MEMORY, "no memory for the text about a state")
                                           : status;
}
