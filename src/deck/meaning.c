/* The config as text, by the schema.
 *
 * Each kind of block is a list of items, each with a head ("body lid") and the struct that its keywords fill;
 * one function writes the lines of an item. A line is taken back where its value turns out to be unset. */
#include "dm2/deck/meaning.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/bytes.h"
#include "dm2/base/mem.h"
#include "bind.h"
#include "bind_loads.h"
#include "interaction_rule.h"
#include "schema.h"

struct writer {
    const struct config *config;
    unsigned parts;
    struct bytes_writer bytes;
};

static void put_text(struct writer *w, const char *text)
{
    bytes_put_raw(&w->bytes, text, strlen(text));
}

static bool put_word(struct writer *w, const char *word)
{
    put_text(w, " ");
    put_text(w, word);
    return true;
}

/* An unset number is "-". */
static bool put_number(struct writer *w, double x)
{
    struct number_text text;
    (void)put_word(w, isnan(x) ? "-" : number_text(x, &text));
    return !isnan(x);
}

static bool put_whole(struct writer *w, int64_t n)
{
    char text[24];
    (void)snprintf(text, sizeof text, "%lld", (long long)n);
    return put_word(w, text) && n >= 0;
}

static bool put_choice(struct writer *w, const char *choices, int which)
{
    for (; which > 0; which--)
        choices += strcspn(choices, "|") + 1;
    put_text(w, " ");
    bytes_put_raw(&w->bytes, choices, strcspn(choices, "|"));
    return true;
}

static bool put_material(struct writer *w, int material)
{
    return put_word(w, material < 0 ? "-" : w->config->materials[material].name) && material >= 0;
}

static bool put_shape(struct writer *w, const struct shape_config *s)
{
    static const char *const names[] = {"rectangle", "disc", "polygon"};
    (void)put_word(w, names[s->kind]);
    for (int k = 0; k < 4 && s->kind == SHAPE_RECTANGLE; k++)
        (void)put_number(w, s->box[k]);
    for (int k = 0; k < 3 && s->kind == SHAPE_DISC; k++)
        (void)put_number(w, k < 2 ? s->centre[k] : s->radius);
    for (size_t k = 0; k < 2 * s->n_vertices && s->kind == SHAPE_POLYGON; k++)
        (void)put_number(w, s->vertex[k / 2][k % 2]);
    return true;
}

/* `material = A` and `mix = A 1` mean the same and are the former. */
static bool is_one_material(const struct body_config *body)
{
    return body->n_mix == 1 && body->mix_fraction[0] == 1.0;
}

static bool put_mix(struct writer *w, const struct body_config *body)
{
    for (size_t k = 0; k < body->n_mix; k++) {
        (void)put_material(w, body->mix_material[k]);
        (void)put_number(w, body->mix_fraction[k]);
    }
    return !is_one_material(body);
}

static bool put_line(struct writer *w, const struct wall_config *wall)
{
    for (size_t k = 0; k < 2 * wall->n_points; k++)
        (void)put_number(w, wall->points[k]);
    return wall->n_points > 0;
}

/* --- values --- */

static bool put_reals(struct writer *w, const struct deck_key *key, const void *at)
{
    bool set = false;
    for (int k = 0; k < key->count; k++)
        set |= put_number(w, ((const double *)at)[k]);
    return set;
}

static bool put_words(struct writer *w, const struct deck_key *key, const void *at)
{
    for (int k = 0; k < key->count; k++)
        (void)put_choice(w, key->choices,
                         key->type == VALUE_CHOICE ? ((const int *)at)[k] : ((const bool *)at)[k]);
    return true;
}

static bool put_steps(struct writer *w, const struct output_config *o)
{
    for (size_t k = 0; k < o->n_snapshot_at; k++)
        (void)put_whole(w, o->snapshot_at[k]);
    return o->n_snapshot_at > 0;
}

static bool put_formats(struct writer *w, const struct output_config *o)
{
    if (o->vtp)
        (void)put_word(w, "vtp");
    if (o->xyz)
        (void)put_word(w, "xyz");
    return true;
}

static bool put_bodies(struct writer *w, const bool *bodies)
{
    for (size_t k = 0; bodies != NULL && k < w->config->n_bodies; k++)
        if (bodies[k])
            (void)put_word(w, w->config->bodies[k].name);
    return bodies != NULL;
}

static bool put_movers(struct writer *w, const struct deck_key *key, const size_t *movers)
{
    for (int k = 0; k < key->count && movers[k] != MOVER_NONE; k++)
        (void)put_word(w, config_mover_name(w->config, movers[k]));
    return movers[0] != MOVER_NONE;
}

static bool put_points(struct writer *w, const struct load_points *points)
{
    for (size_t k = 0; k < points->n; k++) {
        (void)put_number(w, points->time[k]);
        (void)put_number(w, points->value[k]);
    }
    return points->n > 0;
}

static bool put_set(struct writer *w, const struct deck_key *key, uint32_t set)
{
    for (int k = 0; k < 32; k++)
        if (set >> k & 1u)
            (void)put_choice(w, key->choices, k);
    return set != 0;
}

static bool put_limit(struct writer *w, const struct stop_config *stop)
{
    (void)put_word(w, stop->column);
    (void)put_word(w, stop->above ? "above" : "below");
    (void)put_number(w, stop->value);
    return *stop->column != '\0';
}

/* Writes the value of a keyword of the struct `base`. False: the value is unset. */
static bool put_value(struct writer *w, const struct deck_key *key, const void *base)
{
    const void *at = (const char *)base + key->offset;
    switch (key->type) {
    case VALUE_REAL:
        return put_reals(w, key, at);
    case VALUE_WHOLE:
        return put_whole(w, *(const int64_t *)at);
    case VALUE_CHOICE:
    case VALUE_FLAG:
        return put_words(w, key, at);
    case VALUE_SHAPE:
        return put_shape(w, at);
    case VALUE_MATERIAL: /* of a body */
        return put_material(w, ((const struct body_config *)base)->mix_material[0]) && is_one_material(base);
    case VALUE_MIX:
        return put_mix(w, base);
    case VALUE_MATERIALS:
        for (int k = 0; k < key->count; k++)
            (void)put_material(w, ((const int *)at)[k]);
        return *(const int *)at >= 0;
    case VALUE_NAME:
        return put_word(w, at) && *(const char *)at != '\0';
    case VALUE_BODY: {
        int body = *(const int *)at;
        return body >= 0 && put_word(w, w->config->bodies[body].name);
    }
    case VALUE_MOVER: {
        int mover = *(const int *)at;
        return mover >= 0 && put_word(w, config_mover_name(w->config, (size_t)mover));
    }
    case VALUE_BODIES:
        return put_bodies(w, *(const bool *const *)at);
    case VALUE_MOVERS:
        return put_movers(w, key, at);
    case VALUE_POINTS:
        return put_points(w, at);
    case VALUE_FILE: /* its values are those of the points */
        return false;
    case VALUE_SET:
        return put_set(w, key, *(const uint32_t *)at);
    case VALUE_LIMIT:
        return put_limit(w, base);
    case VALUE_STEPS:
        return put_steps(w, &w->config->output);
    case VALUE_FORMATS:
        return put_formats(w, &w->config->output);
    case VALUE_LINE:
        return put_line(w, base);
    case VALUE_STATE: /* a word, because a digest may begin with a digit */
        put_text(w, " sha256_");
        put_text(w, w->config->start.state);
        return true;
    case VALUE_NAMES:
        for (size_t k = 0; k < w->config->start.n_without; k++)
            (void)put_word(w, w->config->start.without[k]);
        return w->config->start.n_without > 0;
    }
    return false;
}

/* --- items --- */

/* Writes the lines of the keywords in `set` (bit i: the i-th) of an item. */
static void put_item(struct writer *w, enum block_kind kind, const char *head, const void *base, uint32_t set)
{
    const struct block_schema *schema = schema_block(kind);
    for (size_t k = 0; k < schema->n_keys; k++) {
        const struct deck_key *key = &schema->keys[k];
        size_t length = w->bytes.length;
        if ((w->parts >> key->part & 1u) == 0 || (set >> k & 1u) == 0)
            continue;
        put_text(w, head);
        put_text(w, ": ");
        put_text(w, key->name);
        if (put_value(w, key, base))
            put_text(w, "\n");
        else if (!w->bytes.failed)
            w->bytes.length = length;
    }
}

struct head {
    char text[3 * NAME_MAX_LENGTH + 40];
};

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* The keywords of an item that are written: the region of a probe of a body or wall is only where the body
 * started, and where a body comes from is told of those from a state alone. */
static uint32_t keywords_of(enum block_kind kind, const void *item)
{
    if (kind == BLOCK_BODY)
        return ((const struct body_config *)item)->from_state
                   ? UINT32_MAX
                   : ~(1u << schema_find_key(schema_block(kind), "from", strlen("from")));
    bool of_body = kind == BLOCK_PROBE && ((const struct probe_config *)item)->mover >= 0;
    return of_body ? ~(1u << schema_find_key(schema_block(kind), "region", strlen("region"))) : UINT32_MAX;
}

/* Blocks that fill an array whose items begin with their name. */
static void put_things(struct writer *w, enum block_kind kind, bool numbered)
{
    const struct deck_things *things = binding_things(kind);
    const char *items;
    size_t n;
    memcpy(&items, (const char *)w->config + things->items, sizeof items);
    memcpy(&n, (const char *)w->config + things->count, sizeof n);
    const char **order = mem_zalloc(n, sizeof *order);
    w->bytes.failed |= order == NULL;
    for (size_t k = 0; k < n && order != NULL; k++)
        order[k] = items + k * things->size;
    if (n > 1 && order != NULL && !numbered)
        qsort(order, n, sizeof *order, compare_names);
    for (size_t k = 0; k < n && order != NULL; k++) {
        struct head head;
        (void)snprintf(head.text, sizeof head.text, "%s %s", schema_block(kind)->name, order[k]);
        put_item(w, kind, head.text, order[k], keywords_of(kind, order[k]));
    }
    free(order);
}

static void put_phases(struct writer *w)
{
    for (size_t k = 0; k < w->config->n_phases; k++) {
        const struct phase_config *phase = &w->config->phases[k];
        struct head head;
        (void)snprintf(head.text, sizeof head.text, "phase %s %s", w->config->materials[phase->material].name,
                       phase->name);
        put_item(w, BLOCK_PHASE, head.text, phase, UINT32_MAX);
    }
}

/* The loads that came from one block are neighbours in the config. */
static void put_loads(struct writer *w)
{
    const struct config *c = w->config;
    for (size_t i = 0; i < c->n_loads;) {
        struct load_block block = load_block_start();
        struct head head;
        block.common = c->loads[i];
        (void)snprintf(head.text, sizeof head.text, "load %s", c->loads[i].name);
        for (; i < c->n_loads && strcmp(c->loads[i].name, block.common.name) == 0; i++)
            block.points[c->loads[i].quantity] =
                (struct load_points){c->loads[i].n, c->loads[i].time, c->loads[i].value};
        put_item(w, BLOCK_LOAD, head.text, &block, UINT32_MAX);
    }
}

/* --- interactions --- */

static int compare_int(int a, int b)
{
    return a < b ? -1 : a > b;
}

/* From the least to the most specific; then by relation and materials. */
static int compare_rules(const void *a, const void *b)
{
    const struct interaction_rule *x = *(const struct interaction_rule *const *)a,
                                  *y = *(const struct interaction_rule *const *)b;
    int order = compare_int((x->material[0] >= 0) * 2 + (x->relation >= 0),
                            (y->material[0] >= 0) * 2 + (y->relation >= 0));
    for (int k = 0; k < 3 && order == 0; k++)
        order = k == 0 ? compare_int(x->relation, y->relation)
                       : compare_int(x->material[k - 1], y->material[k - 1]);
    return order;
}

/* The rule for all pairs has the defaults of the keywords that it does not set; that of `linked` depends on
 * the relation and stays unset. */
static void put_common_rule(struct writer *w, const struct interaction_rule *rule)
{
    const struct block_schema *schema = schema_block(BLOCK_INTERACTION);
    struct interaction_config all;
    memset(&all, 0, sizeof all);
    schema_defaults(schema, &all);
    uint32_t set = ~(1u << schema_find_key(schema, "linked", strlen("linked")));
    for (size_t k = 0; k < schema->n_keys && rule != NULL; k++)
        if (rule->set >> k & 1u)
            memcpy((char *)&all + schema->keys[k].offset, (const char *)&rule->value + schema->keys[k].offset,
                   schema_size(&schema->keys[k]));
    put_item(w, BLOCK_INTERACTION, "interaction", &all, rule == NULL ? set : set | rule->set);
}

static void put_rule(struct writer *w, const struct interaction_rule *rule)
{
    static const char *const relations[] = {"", " grain", " body"};
    struct head head;
    int n = snprintf(head.text, sizeof head.text, "%s%s", rule->relation < 0 ? "interaction" : "interface",
                     rule->relation < 0 ? "" : relations[rule->relation]);
    if (rule->material[0] >= 0)
        (void)snprintf(head.text + n, sizeof head.text - (size_t)n, " %s %s",
                       w->config->materials[rule->material[0]].name,
                       w->config->materials[rule->material[1]].name);
    put_item(w, BLOCK_INTERACTION, head.text, &rule->value, rule->set);
}

static void put_rules(struct writer *w)
{
    const struct config *c = w->config;
    const struct interaction_rule **order = mem_zalloc(c->n_rules, sizeof *order);
    w->bytes.failed |= order == NULL;
    for (size_t k = 0; k < c->n_rules && order != NULL; k++)
        order[k] = &c->rules[k];
    if (c->n_rules > 1 && order != NULL)
        qsort(order, c->n_rules, sizeof *order, compare_rules);
    size_t first = order != NULL && c->n_rules > 0 && order[0]->relation < 0 && order[0]->material[0] < 0;
    put_common_rule(w, first > 0 ? order[0] : NULL);
    for (size_t k = first; k < c->n_rules && order != NULL; k++)
        put_rule(w, order[k]);
    free(order);
}

/* --- a deck --- */

static void put_deck(struct writer *w)
{
    const struct config *c = w->config;
    put_item(w, BLOCK_DOMAIN, "domain", c, UINT32_MAX);
    put_item(w, BLOCK_TIME, "time", c, UINT32_MAX);
    if (c->start.on)
        put_item(w, BLOCK_START, "start", c, UINT32_MAX);
    put_things(w, BLOCK_MATERIAL, true);
    put_phases(w);
    put_things(w, BLOCK_REACTION, true);
    put_rules(w);
    put_things(w, BLOCK_BODY, true);
    put_loads(w);
    put_things(w, BLOCK_VOID, false);
    put_things(w, BLOCK_FLAW, false);
    put_things(w, BLOCK_WALL, true);
    put_things(w, BLOCK_PROBE, true);
    put_things(w, BLOCK_PROFILE, false);
    for (size_t k = 0; k < c->n_stops; k++)
        put_item(w, BLOCK_STOP, "stop", &c->stops[k], UINT32_MAX);
    put_item(w, BLOCK_OUTPUT, "output", c, UINT32_MAX);
}

enum dm2_status meaning_build(const struct config *config, unsigned parts, struct deck_meaning *out,
                              struct dm2_error *err)
{
    struct writer w = {.config = config, .parts = parts};
    put_deck(&w);
    size_t length = w.bytes.length;
    bytes_put_u8(&w.bytes, 0);
    *out = (struct deck_meaning){.text = NULL};
    if (w.bytes.failed) {
        bytes_free(&w.bytes);
        return dm2_fail(err, DM2_MEMORY, "no memory for the meaning of the deck");
    }
    out->text = mem_zalloc(length + 1, 1);
    if (out->text != NULL) {
        struct sha256 s;
        memcpy(out->text, w.bytes.data, length + 1);
        out->length = length;
        sha256_start(&s);
        sha256_add(&s, out->text, length);
        sha256_finish(&s, out->digest);
    }
    bytes_free(&w.bytes);
    return out->text != NULL ? DM2_OK : dm2_fail(err, DM2_MEMORY, "no memory for the meaning of the deck");
}

void meaning_free(struct deck_meaning *meaning)
{
    free(meaning->text);
    *meaning = (struct deck_meaning){.text = NULL};
}
