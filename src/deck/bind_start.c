/* Names connect the deck with the state: of bodies, walls, materials, phases. What the elements of the state
 * are made of stays as it is; everything else is the deck's. */
#include "bind_start.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/deck/start.h"

/* --- the text about the state --- */

bool start_open(struct deck_binding *b)
{
    const struct deck_text *text = deck_source_start(b->tree->source);
    struct dm2_error err = {0};
    b->config->start.on = text != NULL || b->tree->source->meaning;
    if (text == NULL) {
        b->config->start.on &= b->single[BLOCK_START] < b->tree->n_blocks;
        return true;
    }
    struct start_source *s = mem_zalloc(1, sizeof *s);
    enum dm2_status status = s == NULL ? DM2_MEMORY : start_get(text->text, text->length, s, &err);
    if (status != DM2_OK) {
        free(s);
        if (status != DM2_MEMORY)
            findings_error(b->findings, b->tree->end, "%.300s", err.text);
        return status != DM2_MEMORY;
    }
    b->stage = s;
    memcpy(b->config->start.state, s->digest, sizeof s->digest);
    b->config->start.next_id = s->next_id;
    b->config->start.next_grain = s->next_grain;
    return true;
}

void start_close(struct deck_binding *b)
{
    if (b->stage != NULL)
        start_free(b->stage);
    free(b->stage);
    b->stage = NULL;
}

bool start_read_state(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                      struct config *config)
{
    static const char prefix[] = "sha256_";
    const struct deck_node *node = entry->n == 1 ? &b->tree->nodes[b->tree->values[entry->first]] : NULL;
    if (node == NULL || (node->kind != NODE_STRING && !b->tree->source->meaning)) {
        findings_error(b->findings, node == NULL ? entry->key : node->place,
                       "'%s' is the name of one file in quotes", key->name);
        return false;
    }
    const char *word = place_bytes(b->tree->source, node->place);
    if (b->tree->source->meaning) {
        if (node->place.length != sizeof prefix - 1 + START_DIGEST - 1 ||
            memcmp(word, prefix, sizeof prefix - 1) != 0) {
            findings_error(b->findings, node->place, "this is no digest of a state");
            return false;
        }
        memcpy(config->start.state, word + sizeof prefix - 1, START_DIGEST - 1);
        return true;
    }
    if (b->stage != NULL || b->findings->n_errors > 0)
        return true;
    findings_error(
        b->findings, node->place,
        "the state cannot be read by this name: a file beside or below the deck is expected, without "
        "'..', or --start FILE");
    return false;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(a, b);
}

bool start_read_names(struct deck_binding *b, const struct deck_entry *entry, struct config *config)
{
    struct start_config *start = &config->start;
    free(start->without);
    start->n_without = 0;
    start->without = mem_zalloc(entry->n, sizeof *start->without);
    if (start->without == NULL) {
        b->findings->no_memory = true;
        return false;
    }
    for (size_t k = 0; k < entry->n; k++) {
        struct deck_place word = value_word(b, entry, k);
        const char *bytes = place_bytes(b->tree->source, word);
        if (word.length > NAME_MAX_LENGTH || word.length == 0) {
            findings_error(b->findings, word, "a name has at most %d letters", NAME_MAX_LENGTH);
            return false;
        }
        memcpy(start->without[start->n_without++], bytes, word.length);
    }
    qsort(start->without, start->n_without, sizeof *start->without, compare_names);
    return true;
}

/* --- names --- */

static bool is_left_out(const struct config *c, const char *name)
{
    return c->start.n_without > 0 && bsearch(name, c->start.without, c->start.n_without,
                                             sizeof *c->start.without, compare_names) != NULL;
}

static size_t find_body(const struct config *c, const char *name)
{
    size_t k = 0;
    while (k < c->n_bodies && strcmp(c->bodies[k].name, name) != 0)
        k++;
    return k;
}

static size_t find_wall(const struct config *c, const char *name)
{
    size_t k = 0;
    while (k < c->n_walls && strcmp(c->walls[k].name, name) != 0)
        k++;
    return k;
}

static int find_material(const struct config *c, const char *name)
{
    for (size_t k = 0; k < c->n_materials; k++)
        if (strcmp(c->materials[k].name, name) == 0)
            return (int)k;
    return -1;
}

/* The kind of `now` with the name of a kind of `before`; config_kinds(now): none. */
static size_t find_kind(const struct config *now, const struct config *before, size_t kind)
{
    struct kind_name wanted, name;
    (void)config_kind_name(before, kind, &wanted);
    size_t k = 0;
    while (k < config_kinds(now) && strcmp(config_kind_name(now, k, &name), wanted.text) != 0)
        k++;
    return k;
}

/* The names of the bodies of a config, as far as they fit. */
static const char *list_bodies(const struct config *c, char *out, size_t size)
{
    size_t used = 0;
    out[0] = '\0';
    for (size_t k = 0; k < c->n_bodies && used + 1 < size; k++) {
        int n = snprintf(out + used, size - used, "%s%s", k == 0 ? "" : ", ", c->bodies[k].name);
        used += n > 0 ? (size_t)n : 0;
    }
    return out;
}

/* --- bodies --- */

bool start_is_taken(const struct deck_binding *b, const struct body_config *body)
{
    return body->from_state && !b->tree->source->meaning;
}

static void refuse_other_keys(const struct deck_binding *b, size_t block, const char *name)
{
    static const char *const may[] = {"from", "motion", "velocity", "spin"};
    const struct block_schema *schema = schema_block(BLOCK_BODY);
    for (size_t k = 0; k < schema->n_keys; k++) {
        bool allowed = false;
        for (size_t i = 0; i < sizeof may / sizeof may[0]; i++)
            allowed |= strcmp(schema->keys[k].name, may[i]) == 0;
        if (!allowed && binding_given(b, block, schema->keys[k].name))
            findings_error(
                b->findings, binding_place(b, block, schema->keys[k].name, 0),
                "the elements of '%s' are there already, and only 'motion', 'velocity' and 'spin' can "
                "change: leave '%s' out",
                name, schema->keys[k].name);
    }
}

/* Gives the body the materials of the deck in place of those of the state. */
static void take_materials(struct deck_binding *b, size_t block, size_t was, struct body_config *body)
{
    const struct config *before = &b->stage->before, *c = b->config;
    const bool *kinds = b->stage->kinds + was * config_kinds(before);
    struct deck_place place = binding_place(b, block, "from", 0);
    for (size_t m = 0; m < body->n_mix; m++) {
        const char *name = before->materials[body->mix_material[m]].name;
        int material = find_material(c, name);
        if (material < 0) {
            findings_error(b->findings, place,
                           "the body '%s' of the state is of material '%s', which the deck does not have",
                           body->name, name);
            body->n_mix = 0;
            return;
        }
        body->mix_material[m] = material;
    }
    for (size_t k = 0; k < config_kinds(before); k++) {
        struct kind_name name;
        if (kinds[k] && find_kind(c, before, k) == config_kinds(c))
            findings_error(
                b->findings, place,
                "the body '%s' of the state has elements that are '%s', which the deck does not have",
                body->name, config_kind_name(before, k, &name));
    }
}

/* The changes of the block; `given` has the values that were given there. */
static void take_changes(struct deck_binding *b, size_t block, const struct body_config *given,
                         struct body_config *body)
{
    bool velocity = binding_given(b, block, "velocity"), spin = binding_given(b, block, "spin");
    if (binding_given(b, block, "motion") && given->motion != body->motion) {
        body->motion = given->motion;
        body->velocity[0] = body->velocity[1] = body->spin = 0.0;
        body->jitter = given->motion == MOTION_FREE ? body->jitter : 0.0;
    }
    if (velocity) {
        memcpy(body->velocity, given->velocity, sizeof body->velocity);
        body->pushed = body->motion == MOTION_FREE;
    }
    if (spin && body->motion == MOTION_FREE)
        findings_error(
            b->findings, binding_place(b, block, "spin", 0),
            "the elements of '%s' are there already, and a free body keeps its spin: leave 'spin' out",
            body->name);
    if (spin)
        body->spin = given->spin;
}

void start_take_body(struct deck_binding *b, size_t block, struct body_config *body)
{
    struct deck_place place = b->tree->names[b->tree->blocks[block].first_name],
                      from = binding_place(b, block, "from", 0);
    const struct body_config given = *body;
    name_text name = "";
    char names[200];
    memcpy(name, place_bytes(b->tree->source, place), place.length);
    body->n_mix = 0;
    if (b->stage == NULL) {
        if (b->findings->n_errors == 0)
            findings_error(
                b->findings, from,
                "there is no state to take '%s' from: name one by a block 'start { state = \"FILE\" }' "
                "or by --start FILE",
                name);
        return;
    }
    const struct config *before = &b->stage->before;
    size_t was = find_body(before, name);
    if (was == before->n_bodies) {
        findings_error(b->findings, from, "the state has no body '%s'; it has %s", name,
                       list_bodies(before, names, sizeof names));
        return;
    }
    refuse_other_keys(b, block, name);
    *body = before->bodies[was];
    body->packing_place = NULL;
    body->from_state = true;
    body->pushed = false;
    body->start = b->stage->bodies[was];
    take_materials(b, block, was, body);
    take_changes(b, block, &given, body);
    memset(body->name, 0, sizeof body->name); /* name_things copies names into zeros */
}

static void check_taken(const struct deck_binding *b, struct deck_place place)
{
    const struct config *before = &b->stage->before, *c = b->config;
    for (size_t k = 0; k < before->n_bodies; k++) {
        const char *name = before->bodies[k].name;
        size_t now = find_body(c, name);
        bool taken = now < c->n_bodies && c->bodies[now].from_state;
        if (taken && is_left_out(c, name))
            findings_error(b->findings, place,
                           "the body '%s' of the state is taken, and left out by 'without'", name);
        else if (!taken && !is_left_out(c, name))
            findings_error(
                b->findings, place,
                "the state has body %s: take it with `body %s { from = state }` or leave it out with "
                "`without = %s`",
                name, name, name);
    }
    for (size_t k = 0; k < c->start.n_without; k++)
        if (find_body(before, c->start.without[k]) == before->n_bodies &&
            find_wall(before, c->start.without[k]) == before->n_walls)
            findings_error(b->findings, place, "the state has no body and no wall '%s'", c->start.without[k]);
}

/* --- walls --- */

static bool same_points(const struct wall_config *a, const struct wall_config *b)
{
    return a->n_points == b->n_points &&
           (a->n_points > 0 ? memcmp(a->points, b->points, a->n_points * 2 * sizeof(double)) == 0
                            : memcmp(a->circle, b->circle, sizeof a->circle) == 0);
}

/* Every wall of the state is in the deck or left out. A wall of a deck is where the deck says. */
static void check_walls_taken(const struct deck_binding *b, struct deck_place place)
{
    const struct config *before = &b->stage->before, *c = b->config;
    for (size_t k = 0; k < before->n_walls; k++) {
        const struct wall_config *wall = &before->walls[k];
        const struct start_wall *now = &b->stage->walls[k];
        size_t which = find_wall(c, wall->name);
        if (which == c->n_walls && !is_left_out(c, wall->name))
            findings_error(
                b->findings, place,
                "the state has wall %s: give it in a block `wall %s` or leave it out with `without = "
                "%s`",
                wall->name, wall->name, wall->name);
        if (which == c->n_walls || !same_points(wall, &c->walls[which]))
            continue;
        bool turned = now->angle != 0.0 && wall->n_points > 0;
        if (now->moved[0] != 0.0 || now->moved[1] != 0.0 || turned)
            findings_error(
                b->findings, b->tree->blocks[b->blocks[BLOCK_WALL][which]].word,
                "the wall '%s' has moved by (%g, %g) cm and turned by %g rad since it was here: give "
                "its points as they are now, or as you want them",
                wall->name, now->moved[0], now->moved[1], now->angle);
    }
}

/* --- what elements are made of --- */

/* A NaN is a constant that is not given. */
static bool same_constant(double a, double b)
{
    return a == b || (isnan(a) && isnan(b));
}

static void check_constant(const struct deck_binding *b, size_t block, const char *key, const char *name,
                           double was, double is)
{
    char before[32] = "not given", now[32] = "not given";
    if (same_constant(was, is))
        return;
    if (!isnan(was))
        (void)snprintf(before, sizeof before, "%.10g", was);
    if (!isnan(is))
        (void)snprintf(now, sizeof now, "%.10g", is);
    findings_error(b->findings, binding_place(b, block, key, 0),
                   "'%s' of '%s' was %s in the state, is %s: elements that are there keep it", key, name,
                   before, now);
}

/* The temperatures of elements follow from their heat by t0 and cp, their masses from rho0 or mass. */
static void check_kinds(const struct deck_binding *b)
{
    const struct config *before = &b->stage->before, *c = b->config;
    for (size_t k = 0; k < config_kinds(before); k++) {
        size_t now = find_kind(c, before, k);
        struct kind_name name;
        if (now == config_kinds(c))
            continue;
        bool phase = k >= before->n_materials;
        const struct material_config *was =
            phase ? &before->phases[k - before->n_materials].state : &before->materials[k];
        const struct material_config *is =
            phase ? &c->phases[now - c->n_materials].state : &c->materials[now];
        size_t block = phase ? b->blocks[BLOCK_PHASE][now - c->n_materials] : b->blocks[BLOCK_MATERIAL][now];
        (void)config_kind_name(c, now, &name);
        check_constant(b, block, "rho0", name.text, was->rho0, is->rho0);
        check_constant(b, block, "cp", name.text, was->cp, is->cp);
        if (!phase) {
            check_constant(b, block, "mass", name.text, was->mass, is->mass);
            check_constant(b, block, "t0", name.text, was->t0, is->t0);
        }
    }
}

/* The shares of reactants in the elements are those of the state's reaction. */
static void check_reaction(const struct deck_binding *b, struct deck_place place)
{
    const struct config *before = &b->stage->before, *c = b->config;
    bool same = before->n_reactions == c->n_reactions;
    for (int k = 0; k < 2 && same && c->n_reactions > 0; k++) {
        int was = before->reactions[0].reactant[k], is = c->reactions[0].reactant[k];
        same = was < 0 || is < 0 || strcmp(before->materials[was].name, c->materials[is].name) == 0;
    }
    if (!same)
        findings_error(b->findings, place,
                       "the elements of the state hold the reactants of its reaction: the deck is to have a "
                       "reaction of the same reactants, or none where the state has none");
}

/* --- domain and time --- */

/* Places of elements and their numbers of turns are those of the state's domain where that is periodic. */
static void check_domain(const struct deck_binding *b)
{
    const struct config *before = &b->stage->before, *c = b->config;
    size_t block = b->single[BLOCK_DOMAIN];
    for (int a = 0; a < 2; a++) {
        if (before->periodic[a] != c->periodic[a])
            findings_error(b->findings, binding_place(b, block, "boundary", (size_t)a),
                           "the domain of the state is %s in %c: its elements are placed so",
                           before->periodic[a] ? "periodic" : "free", "xy"[a]);
        else if (c->periodic[a] && (before->origin[a] != c->origin[a] || before->size[a] != c->size[a]))
            findings_error(
                b->findings, binding_place(b, block, "size", (size_t)a),
                "the domain of the state is periodic in %c from %.10g to %.10g cm: its elements are "
                "placed so",
                "xy"[a], before -> origin[a], before -> origin[a] + before -> size[a]);
    }
}

static void set_times(struct deck_binding *b)
{
    struct config *c = b->config;
    const struct start_source *s = b->stage;
    if (c->start.time == START_KEEP_TIME) {
        c->n_start = s->step;
        c->t_start = s->time;
        c->same_clock = c->dt == s->before.dt;
        c->n_clock = s->n_clock;
        c->t_clock = s->t_clock;
    }
    c->dt_before = c->start.velocity == START_AT_REST ? 0.0 : s->dt_before;
    if (c->steps < c->n_start && c->steps >= 0)
        findings_error(
            b->findings, binding_place(b, b->single[BLOCK_TIME], "steps", 0),
            "the run begins with step %lld of its state (time = keep): 'steps' is the number of its "
            "last step, at least that",
            (long long)c->n_start);
}

void start_finish(struct deck_binding *b)
{
    size_t block = b->single[BLOCK_START];
    struct deck_place place = binding_place(b, block, "without", 0);
    if (b->stage == NULL) {
        if (block < b->tree->n_blocks && !b->config->start.on && binding_missing(b, block, "state") &&
            b->findings->n_errors == 0)
            findings_error(
                b->findings, place,
                "the block 'start' lacks 'state': name the file of a state here, or by --start FILE");
        return;
    }
    check_taken(b, place);
    check_walls_taken(b, place);
    check_kinds(b);
    check_reaction(b, place);
    check_domain(b);
    set_times(b);
}
