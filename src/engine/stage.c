/* The first state of a run that begins from a state. Ids and grains stay, so that elements stay in order;
 * bodies, kinds, walls and features get the numbers of the new deck by their names. */
#include "dm2/engine/stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "generate.h"
#include "stage_parts.h"
#include "tables.h"
#include "wall_shape.h"

enum { ABSENT = 0xffff };

/* The new numbers of what the old deck numbered; ABSENT: not in the deck. */
struct renumbering {
    const struct model *m;
    const struct start_source *from;
    uint16_t *body, *kind;
    int probe[REGION_MAX]; /* of each bit of a region's probe: the bit in the state that stays; -1: none */
};

static enum dm2_status no_memory(size_t n, struct dm2_error *err)
{
    return dm2_fail(err, DM2_MEMORY, "no memory for the %zu elements of a state to start from", n);
}

static bool number_anew(struct renumbering *r)
{
    const struct config *before = &r->from->before, *c = r->m->config;
    r->body = mem_zalloc(before->n_bodies, sizeof *r->body);
    r->kind = mem_zalloc(config_kinds(before), sizeof *r->kind);
    if (r->body == NULL || r->kind == NULL)
        return false;
    for (size_t k = 0; k < before->n_bodies; k++) {
        r->body[k] = ABSENT;
        for (size_t b = 0; b < c->n_bodies; b++)
            if (c->bodies[b].from_state && strcmp(c->bodies[b].name, before->bodies[k].name) == 0)
                r->body[k] = (uint16_t)b;
    }
    for (size_t k = 0; k < config_kinds(before); k++) {
        struct kind_name was, is;
        r->kind[k] = ABSENT;
        (void)config_kind_name(before, k, &was);
        for (size_t i = 0; i < config_kinds(c); i++)
            if (strcmp(config_kind_name(c, i, &is), was.text) == 0)
                r->kind[k] = (uint16_t)i;
    }
    return true;
}

/* A region keeps its elements where time goes on and the probe is the one of the state. */
static void number_probes(struct renumbering *r)
{
    const struct config *before = &r->from->before, *c = r->m->config;
    for (int k = 0; k < REGION_MAX; k++)
        r->probe[k] = -1;
    for (size_t i = 0; i < c->n_probes && c->start.time == START_KEEP_TIME; i++)
        for (size_t k = 0; k < before->n_probes; k++) {
            const struct probe_config *is = &c->probes[i], *was = &before->probes[k];
            if (is->mover < 0 && was->mover < 0 && strcmp(is->name, was->name) == 0 &&
                memcmp(is->box, was->box, sizeof is->box) == 0)
                r->probe[is->bit] = was->bit;
        }
}

/* The probes of an element that was in the probes `was`. */
static uint8_t take_probes(const struct renumbering *r, const struct element *e, uint8_t was, double spacing)
{
    unsigned mask = generate_probes(r->m->config, e->r, spacing);
    for (int k = 0; k < REGION_MAX; k++)
        if (r->probe[k] >= 0)
            mask = (mask & ~(1u << k)) | (was >> r->probe[k] & 1u) << k;
    return (uint8_t)mask;
}

/* --- elements --- */

/* The velocity and the spin with which an element of a body begins. */
static void set_velocity(const struct renumbering *r, enum motion_kind was, struct element *e)
{
    const struct model *m = r->m;
    const struct body_config *body = &m->config->bodies[e->body];
    bool rests = m->config->start.velocity == START_AT_REST && !body->pushed;
    struct rigid_motion start;
    if (body->motion == MOTION_FREE && !body->pushed && !rests)
        return;
    if (body->motion != MOTION_DRIVEN) {
        for (int a = 0; a < 2; a++)
            e->v[a] = body->pushed ? body->velocity[a] : 0.0;
        e->w = 0.0;
        return;
    }
    if (m->placed[e->body] && was == MOTION_DRIVEN && !rests)
        return; /* its velocity of the half step before, which pairs see at the first step */
    motion_at(m, e->body, m->config->n_start, &start);
    e->v[0] = m->placed[e->body] ? start.vx - start.spin * e->home[1] : body->velocity[0];
    e->v[1] = m->placed[e->body] ? start.vy + start.spin * e->home[0] : body->velocity[1];
    e->w = start.spin;
}

/* Makes an element of the state, whose body is in the deck, one of the run. */
static void take_element(const struct renumbering *r, struct element *e)
{
    const struct model *m = r->m;
    const struct config *before = &r->from->before, *c = m->config;
    enum motion_kind was = before->bodies[e->body].motion;
    bool changed_kinds = before->n_phases + before->n_reactions > 0;
    e->was = m->has_kinds ? r->kind[changed_kinds ? e->was : e->kind] : 0;
    e->kind = r->kind[e->kind];
    e->body = r->body[e->body];
    const struct body_config *body = &c->bodies[e->body];
    e->flags = body->motion == MOTION_FREE ? 0 : ELEMENT_FIXED_MOTION;
    e->probes = take_probes(r, e, e->probes, body->spacing);
    if (m->placed[e->body])
        for (int a = 0; a < 2; a++)
            e->home[a] = e->r[a] + (double)e->image[a] * c->size[a] - body->start.centroid[a];
    set_velocity(r, was, e);
    if (c->start.time == START_AT_ZERO) {
        e->work = e->moved = e->damped = 0.0;
        memset(e->strain, 0, sizeof e->strain);
    }
    if (!m->has_strain)
        memset(e->strain, 0, sizeof e->strain);
    if (!m->has_damping)
        e->damped = 0.0;
    if (c->start.links != START_KEEP_LINKS)
        e->bonds = 0;
}

/* Keeps the elements of the bodies that are taken. */
static void take_elements(const struct renumbering *r, struct stage_records *s)
{
    size_t n = 0;
    for (size_t k = 0; k < s->n_elements; k++)
        if (r->body[s->elements[k].body] != ABSENT) {
            s->elements[n] = s->elements[k];
            take_element(r, &s->elements[n++]);
        }
    s->n_elements = n;
}

/* --- pairs --- */

/* Keeps the memory of pairs of which both elements stay. Pairs that are not linked and do not touch have
 * none: such records are of pairs that parted in the last move. */
static enum dm2_status take_pairs(const struct renumbering *r, struct stage_records *s, struct dm2_error *err)
{
    const struct record_limits limits = record_limits_of(r->m);
    size_t n = 0;
    for (size_t k = 0; k < s->n_pairs; k++) {
        struct pair_record p = s->pairs[k];
        size_t a = element_find(s->elements, s->n_elements, p.id_a),
               b = element_find(s->elements, s->n_elements, p.id_b);
        char text[RECORD_FAULT_TEXT];
        if (a == s->n_elements || b == s->n_elements)
            continue;
        if (r->m->config->start.links != START_KEEP_LINKS && p.linked != 0) {
            p.linked = 0;
            p.stretch = p.spring = 0.0;
        }
        bool reaches = record_pair_reaches(&s->elements[a], &s->elements[b], &limits, text);
        if (!reaches && p.linked != 0)
            return dm2_fail(err, DM2_DECK,
                            "the link of elements %u and %u of the state cannot stay: it %s; give a larger "
                            "'link_break', or `start { links = none }`",
                            p.id_a, p.id_b, text);
        if (reaches && (p.linked != 0 || p.stretch != 0.0 || p.spring != 0.0))
            s->pairs[n++] = p;
    }
    s->n_pairs = n;
    return DM2_OK;
}

/* --- sections --- */

static bool take_homes(const struct renumbering *r, struct stage_records *s)
{
    s->sections[SECTION_HOME].n = 0;
    for (size_t k = 0; k < s->n_elements; k++) {
        const struct element *e = &s->elements[k];
        struct home_record home = {e->id, {e->home[0], e->home[1]}};
        if (r->m->placed[e->body] && !section_append(SECTION_HOME, &s->sections[SECTION_HOME], &home, 1))
            return false;
    }
    return true;
}

/* The record of a mover of the state; NULL: none. */
static const struct body_record *find_record(const struct section_array *bodies, size_t mover)
{
    for (size_t k = 0; k < bodies->n; k++) {
        const struct body_record *b = section_record(SECTION_BODY, bodies, k);
        if (b->mover == mover)
            return b;
    }
    return NULL;
}

static bool is_force(const struct config *c, size_t mover, int axis, const char **name)
{
    const struct load_config *force = config_load(c, mover, axis == 0 ? LOAD_FORCE_X : LOAD_FORCE_Y),
                             *stress = config_load(c, mover, axis == 0 ? LOAD_STRESS_XX : LOAD_STRESS_YY);
    const struct load_config *load = force != NULL ? force : stress;
    *name = load != NULL ? load->name : "";
    return load != NULL;
}

/* The velocity along an axis, cm/us, of a mover that was under no force there: that of its first element, or
 * what the deck gives. */
static double begin_velocity(const struct renumbering *r, const struct stage_records *s, size_t mover,
                             int axis)
{
    const struct config *c = r->m->config;
    if (mover >= c->n_bodies)
        return c->walls[mover - c->n_bodies].velocity[axis];
    const struct body_config *body = &c->bodies[mover];
    return body->from_state
               ? s->elements[element_find(s->elements, s->n_elements, body->start.id_first)].v[axis]
               : body->velocity[axis];
}

/* The record of a body or wall under force: of the state's one of this name its velocity, and under a load of
 * the same name what the mean error has built up. */
static void begin_forced(const struct renumbering *r, const struct stage_records *s,
                         const struct section_array *before, size_t mover, struct body_record *out)
{
    const struct config *c = r->m->config, *was = &r->from->before;
    bool new = mover < c->n_bodies && !c->bodies[mover].from_state;
    size_t old = new ? config_movers(was) : 0;
    while (old < config_movers(was) && strcmp(config_mover_name(was, old), config_mover_name(c, mover)) != 0)
        old++;
    const struct body_record *record = find_record(before, old);
    *out = (struct body_record){.mover = (uint16_t)mover};
    for (int a = 0; a < 2; a++) {
        const char *name, *old_name;
        if (mover < c->n_bodies)
            out->centroid[a] = r->m->centroids[2 * mover + (size_t)a];
        if (!is_force(c, mover, a, &name))
            continue;
        bool same = record != NULL && is_force(was, old, a, &old_name);
        out->velocity[a] = same ? record->velocity[a] : begin_velocity(r, s, mover, a);
        if (c->start.velocity == START_AT_REST && old < config_movers(was))
            out->velocity[a] = 0.0;
        if (same && strcmp(name, old_name) == 0)
            out->integral[a] = record->integral[a];
    }
}

static bool take_bodies(const struct renumbering *r, struct stage_records *s)
{
    struct section_array before = s->sections[SECTION_BODY], now = {.n = 0};
    bool ok = true;
    for (size_t k = 0; k < config_movers(r->m->config) && r->m->n_forced > 0 && ok; k++) {
        struct body_record record;
        if (r->m->forced_of[k] == 0)
            continue;
        begin_forced(r, s, &before, k, &record);
        ok = section_append(SECTION_BODY, &now, &record, 1);
    }
    free(before.records);
    s->sections[SECTION_BODY] = now;
    return ok;
}

/* The new number of the first feature of each wall of the state that is where it was, UINT32_MAX: none; the
 * old number in first[]. */
static void find_features(const struct renumbering *r, uint32_t *first, uint32_t *now)
{
    const struct config *before = &r->from->before, *c = r->m->config;
    struct grid grid = {.size = {before->size[0], before->size[1]},
                        .periodic = {before->periodic[0], before->periodic[1]}};
    uint32_t next = 0;
    for (size_t k = 0; k < before->n_walls; k++) {
        const struct wall_config *w = &before->walls[k];
        first[k] = next;
        now[k] = UINT32_MAX;
        next += (uint32_t)walls_count_features(w, &grid);
        for (size_t i = 0; i < c->n_walls; i++) {
            const struct wall_config *is = &c->walls[i];
            bool same = strcmp(is->name, w->name) == 0 && is->n_points == w->n_points &&
                        r->m->walls[i].n_features == next - first[k] &&
                        (w->n_points > 0 ? memcmp(is->points, w->points, 2 * w->n_points * sizeof(double))
                                         : memcmp(is->circle, w->circle, sizeof w->circle)) == 0;
            if (same)
                now[k] = (uint32_t)r->m->walls[i].first;
        }
    }
    first[before->n_walls] = next;
}

/* Keeps the memory of contacts of elements that stay with walls that stay. */
static enum dm2_status take_wall_contacts(const struct renumbering *r, struct stage_records *s,
                                          struct dm2_error *err)
{
    struct section_array *a = &s->sections[SECTION_WCON];
    size_t n = 0, walls = r->from->before.n_walls;
    uint32_t *first = mem_zalloc(walls + 1, sizeof *first), *now = mem_zalloc(walls + 1, sizeof *now);
    if (first == NULL || now == NULL) {
        free(first);
        free(now);
        return no_memory(s->n_elements, err);
    }
    find_features(r, first, now);
    for (size_t k = 0; k < a->n; k++) {
        struct wall_contact c = *(struct wall_contact *)section_record(SECTION_WCON, a, k);
        size_t w = 0;
        while (w < walls && c.feature >= first[w + 1])
            w++;
        if (w == walls || now[w] == UINT32_MAX ||
            element_find(s->elements, s->n_elements, c.id) == s->n_elements)
            continue;
        c.feature = now[w] + (c.feature - first[w]);
        memcpy(section_record(SECTION_WCON, a, n++), &c, sizeof c);
    }
    a->n = n;
    free(first);
    free(now);
    return section_sort(SECTION_WCON, a, err);
}

enum dm2_status stage_begin(const struct model *model, const struct start_source *from,
                            struct stage_records *records, struct dm2_error *err)
{
    struct renumbering r = {.m = model, .from = from};
    enum dm2_status status = number_anew(&r) ? DM2_OK : no_memory(records->n_elements, err);
    if (status == DM2_OK) {
        number_probes(&r);
        take_elements(&r, records);
        status = take_pairs(&r, records, err);
    }
    if (status == DM2_OK && model->config->start.links == START_FORM_LINKS)
        status = stage_form_links(model, records, err);
    if (status == DM2_OK && (!take_homes(&r, records) || !take_bodies(&r, records)))
        status = no_memory(records->n_elements, err);
    if (status == DM2_OK)
        status = take_wall_contacts(&r, records, err);
    free(r.body);
    free(r.kind);
    return status == DM2_OK ? stage_add_new(model, records, err) : status;
}
