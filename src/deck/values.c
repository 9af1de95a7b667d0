/* Reading of the values of one entry, by their type in the schema. A value that does not read gives one
 * finding, marks its entry bad, and is NaN (a real) or the default (any other type), so that later checks
 * report nothing about the value. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "bind.h"
#include "bind_loads.h"
#include "bind_start.h"
#include "bind_stops.h"
#include "expr.h"

/* Every whole number up to 2^53 is exact as a double. */
#define WHOLE_MAX 9007199254740992.0

const char *number_text(double value, struct number_text *out)
{
    (void)number_format(value, out->text);
    return out->text;
}

static const struct deck_node *node_at(const struct deck_binding *b, const struct deck_entry *entry, size_t i)
{
    return &b->tree->nodes[b->tree->values[entry->first + i]];
}

/* The place of a value that should be a word, without quotes. */
static struct deck_place word_at(const struct deck_binding *b, const struct deck_entry *entry, size_t i)
{
    const struct deck_node *node = node_at(b, entry, i);
    struct deck_place place = node->place;
    if (node->kind == NODE_STRING) {
        place.offset++;
        place.length -= 2;
    }
    return place;
}

struct deck_place value_word(const struct deck_binding *b, const struct deck_entry *entry, size_t i)
{
    return word_at(b, entry, i);
}

static bool check_count(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                        size_t want)
{
    if (entry->n == want)
        return true;
    struct deck_place place = entry->n > want ? node_at(b, entry, want)->place : entry->key;
    findings_error(b->findings, place, "'%s' takes %zu value%s, found %zu", key->name, want,
                   want == 1 ? "" : "s", entry->n);
    return false;
}

static void limits_text(const struct deck_key *key, char *out, size_t size)
{
    struct number_text low, high;
    struct dimension_text unit;
    const char *u = dimension_is_plain(key->dim) ? "" : dimension_unit(key->dim, &unit);
    const char *blank = u[0] == '\0' ? "" : " ";
    if (isinf(key->high))
        (void)snprintf(out, size, key->low_open ? "greater than %s%s%s" : "at least %s%s%s",
                       number_text(key->low, &low), blank, u);
    else
        (void)snprintf(out, size, "%s %s and %s %s%s%s", key->low_open ? "above" : "at least",
                       number_text(key->low, &low), key->high_open ? "below" : "at most",
                       number_text(key->high, &high), blank, u);
}

static bool check_within(struct deck_binding *b, const struct deck_key *key, struct deck_place place,
                         double value)
{
    bool low = key->low_open ? value > key->low : value >= key->low;
    bool high = key->high_open ? value < key->high : value <= key->high;
    bool plain = dimension_is_plain(key->dim);
    char limits[120];
    struct number_text text;
    struct dimension_text unit;
    if (isinf(key->low) || (low && high))
        return true;
    limits_text(key, limits, sizeof limits);
    findings_error(b->findings, place, "'%s' must be %s, but is %s%s%s", key->name, limits,
                   number_text(value, &text), plain ? "" : " ", plain ? "" : dimension_unit(key->dim, &unit));
    return false;
}

bool value_read_real(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                     size_t i, double *out)
{
    struct quantity q;
    struct dimension_text want, found;
    struct deck_place place = node_at(b, entry, i)->place;
    if (!expr_eval(b->tree, b->tree->values[entry->first + i], b->findings, &q))
        return false;
    if (!dimension_is_plain(q.dim) && !dimension_equal(q.dim, key->dim)) {
        findings_error(b->findings, place, "'%s' is %s, this is %s", key->name,
                       dimension_name(key->dim, &want), dimension_name(q.dim, &found));
        return false;
    }
    if (!check_within(b, key, place, q.value))
        return false;
    *out = q.value;
    return true;
}

static bool read_whole(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                       size_t i, int64_t *out)
{
    double value;
    struct number_text text;
    if (!value_read_real(b, key, entry, i, &value))
        return false;
    if (value != floor(value) || value > WHOLE_MAX) {
        findings_error(b->findings, node_at(b, entry, i)->place,
                       "'%s' is a whole number up to 2^53, this is %s", key->name, number_text(value, &text));
        return false;
    }
    *out = (int64_t)value;
    return true;
}

enum { CHOICES_MOST = 32 };
struct choices {
    char words[CHOICES_MOST][32];
};

static const char *choice_name(const void *context, size_t i)
{
    return ((const struct choices *)context)->words[i];
}

/* The index of a word in key->choices; -1: none, a finding was added. */
static int read_choice(struct deck_binding *b, const struct deck_key *key, struct deck_place word)
{
    const char *bytes = place_bytes(b->tree->source, word);
    int choice = schema_find_choice(key->choices, bytes, word.length);
    if (choice >= 0)
        return choice;
    struct choices all;
    struct word_list known = {choice_name, &all, 0};
    for (const char *c = key->choices; known.n < CHOICES_MOST; known.n++) {
        size_t n = strcspn(c, "|");
        (void)snprintf(all.words[known.n], sizeof all.words[0], "%.*s", (int)n, c);
        if (c[n] == '\0') {
            known.n++;
            break;
        }
        c += n + 1;
    }
    struct place_text text;
    struct word_hint hint;
    findings_error(b->findings, word, "'%s' is no value of '%s'%s", place_text(b->tree->source, word, &text),
                   key->name, words_hint(&known, bytes, word.length, &hint));
    return -1;
}

int value_read_choice(struct deck_binding *b, const struct deck_key *key, struct deck_place word)
{
    return read_choice(b, key, word);
}

/* Makes the values of a keyword unknown. */
static void forget_reals(const struct deck_key *key, double *out)
{
    for (int i = 0; i < key->count; i++)
        out[i] = (double)NAN;
}

static bool read_reals(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                       double *out)
{
    bool ok = true;
    forget_reals(key, out);
    if (!check_count(b, key, entry, (size_t)key->count))
        return false;
    for (int i = 0; i < key->count; i++)
        ok = value_read_real(b, key, entry, (size_t)i, &out[i]) && ok;
    return ok;
}

static bool read_words(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                       void *at)
{
    bool ok = true;
    if (!check_count(b, key, entry, (size_t)key->count))
        return false;
    for (int i = 0; i < key->count; i++) {
        int choice = read_choice(b, key, word_at(b, entry, (size_t)i));
        ok = ok && choice >= 0;
        if (choice >= 0 && key->type == VALUE_CHOICE)
            ((int *)at)[i] = choice;
        else if (choice >= 0)
            ((bool *)at)[i] = choice == 1;
    }
    return ok;
}

/* --- shapes --- */

static bool shape_count(struct deck_binding *b, const struct deck_entry *entry, const char *what, size_t want)
{
    if (entry->n - 1 == want)
        return true;
    findings_error(b->findings, node_at(b, entry, entry->n - 1 > want ? want + 1 : 0)->place,
                   "%s, found %zu number%s", what, entry->n - 1, entry->n == 2 ? "" : "s");
    return false;
}

static bool read_polygon(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                         struct shape_config *shape)
{
    size_t n = entry->n - 1;
    struct deck_place word = node_at(b, entry, 0)->place;
    if (n % 2 != 0 || n < 6 || n > 2 * POLYGON_MAX) {
        findings_error(b->findings, word,
                       n % 2 != 0 ? "a polygon is x y pairs: found %zu numbers, one is without its pair"
                       : n < 6    ? "a polygon has at least 3 vertices: found %zu numbers"
                                  : "a polygon has at most 64 vertices: found %zu numbers",
                       n);
        return false;
    }
    bool ok = true;
    for (size_t i = 0; i < n; i++)
        ok = value_read_real(b, key, entry, i + 1, &shape->vertex[i / 2][i % 2]) && ok;
    shape->n_vertices = n / 2;
    return ok;
}

static bool read_shape(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                       struct shape_config *shape)
{
    static const struct deck_key which = {.name = "shape", .choices = "rectangle|disc|polygon"};
    int kind = read_choice(b, &which, word_at(b, entry, 0));
    bool ok = true;
    if (kind < 0)
        return false;
    shape->kind = (enum shape_kind)kind;
    if (kind == SHAPE_POLYGON)
        return read_polygon(b, key, entry, shape);
    if (!shape_count(b, entry,
                     kind == SHAPE_RECTANGLE ? "a rectangle is x0 y0 x1 y1" : "a disc is x y radius",
                     kind == SHAPE_RECTANGLE ? 4 : 3))
        return false;
    for (size_t i = 0; i + 1 < entry->n; i++) {
        double *at = kind == SHAPE_RECTANGLE ? &shape->box[i] : i < 2 ? &shape->centre[i] : &shape->radius;
        ok = value_read_real(b, key, entry, i + 1, at) && ok;
    }
    return ok;
}

/* --- materials --- */

static const char *material_name(const void *context, size_t i)
{
    return ((const struct config *)context)->materials[i].name;
}

int binding_material(struct deck_binding *b, struct deck_place name)
{
    const char *bytes = place_bytes(b->tree->source, name);
    for (size_t i = 0; i < b->config->n_materials; i++)
        if (place_is(b->tree->source, name, b->config->materials[i].name))
            return (int)i;
    struct word_list known = {material_name, b->config, b->config->n_materials};
    struct place_text text;
    struct word_hint hint;
    if (!b->tree->incomplete)
        findings_error(b->findings, name, "there is no material '%s'%s",
                       place_text(b->tree->source, name, &text),
                       words_hint(&known, bytes, name.length, &hint));
    return -1;
}

static bool read_materials(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                           int *out)
{
    bool ok = true;
    if (!check_count(b, key, entry, (size_t)key->count))
        return false;
    for (int i = 0; i < key->count; i++) {
        out[i] = binding_material(b, word_at(b, entry, (size_t)i));
        ok = ok && out[i] >= 0;
    }
    return ok;
}

static bool read_name(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                      char *out)
{
    struct place_text text;
    if (!check_count(b, key, entry, 1))
        return false;
    struct deck_place word = word_at(b, entry, 0);
    if (word.length > NAME_MAX_LENGTH) {
        findings_error(b->findings, word, "a name has at most %d letters, not %s", NAME_MAX_LENGTH,
                       place_text(b->tree->source, word, &text));
        return false;
    }
    memcpy(out, place_bytes(b->tree->source, word), word.length);
    out[word.length] = '\0';
    return true;
}

static const char *body_name(const void *context, size_t i)
{
    return ((const struct config *)context)->bodies[i].name;
}

int binding_body(struct deck_binding *b, struct deck_place name)
{
    const char *bytes = place_bytes(b->tree->source, name);
    for (size_t i = 0; i < b->config->n_bodies; i++)
        if (place_is(b->tree->source, name, b->config->bodies[i].name))
            return (int)i;
    struct word_list known = {body_name, b->config, b->config->n_bodies};
    struct place_text text;
    struct word_hint hint;
    if (!b->tree->incomplete)
        findings_error(b->findings, name, "there is no body '%s'%s", place_text(b->tree->source, name, &text),
                       words_hint(&known, bytes, name.length, &hint));
    return -1;
}

static bool read_movers(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                        size_t *out)
{
    bool ok = true;
    if (!check_count(b, key, entry, (size_t)key->count))
        return false;
    for (int i = 0; i < key->count; i++) {
        int mover = binding_mover(b, word_at(b, entry, (size_t)i));
        ok = ok && mover >= 0;
        if (mover >= 0)
            out[i] = (size_t)mover;
    }
    return ok;
}

/* The value is read by bind_loads, because the columns of a file fill several loads. */
static bool read_file_name(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry)
{
    if (!check_count(b, key, entry, 1))
        return false;
    if (node_at(b, entry, 0)->kind == NODE_STRING)
        return true;
    findings_error(b->findings, node_at(b, entry, 0)->place, "'%s' is a file name in quotes", key->name);
    return false;
}

static bool read_body(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                      int *out)
{
    if (!check_count(b, key, entry, 1))
        return false;
    *out = binding_body(b, word_at(b, entry, 0));
    return *out >= 0;
}

static bool read_mover(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                       int *out)
{
    if (!check_count(b, key, entry, 1))
        return false;
    *out = binding_mover(b, word_at(b, entry, 0));
    return *out >= 0;
}

static bool read_mix(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                     struct body_config *body)
{
    if (entry->n % 2 != 0 || entry->n > 2 * MIX_MAX) {
        bool unit = false;
        for (size_t i = 0; i < entry->n; i++)
            unit = unit || !dimension_is_plain(node_at(b, entry, i)->number.dim);
        findings_error(b->findings, entry->key,
                       "'mix' is at most %d materials, each with its fraction: found %zu "
                       "values%s",
                       MIX_MAX, entry->n,
                       unit ? "; a material's name was read as a unit: put commas, Ni 0.5, W 0.5" : "");
        return false;
    }
    bool ok = true;
    struct place_text text;
    for (size_t i = 0; i < entry->n / 2; i++) {
        struct deck_place name = word_at(b, entry, 2 * i);
        body->mix_material[i] = binding_material(b, name);
        ok = value_read_real(b, key, entry, 2 * i + 1, &body->mix_fraction[i]) && ok &&
             body->mix_material[i] >= 0;
        for (size_t j = 0; j < i; j++) {
            if (body->mix_material[j] == body->mix_material[i] && body->mix_material[i] >= 0) {
                findings_error(b->findings, name, "'%s' is in the mix twice",
                               place_text(b->tree->source, name, &text));
                ok = false;
            }
        }
    }
    body->n_mix = ok ? entry->n / 2 : 0;
    return ok;
}

static bool read_material(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                          struct body_config *body)
{
    if (!check_count(b, key, entry, 1))
        return false;
    body->mix_material[0] = binding_material(b, word_at(b, entry, 0));
    body->mix_fraction[0] = 1;
    body->n_mix = body->mix_material[0] >= 0 ? 1 : 0;
    return body->n_mix == 1;
}

/* --- output --- */

static int compare_steps(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return x < y ? -1 : x > y;
}

static bool read_steps(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                       struct output_config *output)
{
    bool ok = true;
    free(output->snapshot_at);
    output->n_snapshot_at = 0;
    output->snapshot_at = mem_zalloc(entry->n, sizeof(int64_t));
    if (output->snapshot_at == NULL) {
        b->findings->no_memory = true;
        return false;
    }
    for (size_t i = 0; i < entry->n; i++)
        ok = read_whole(b, key, entry, i, &output->snapshot_at[i]) && ok;
    qsort(output->snapshot_at, entry->n, sizeof(int64_t), compare_steps);
    for (size_t i = 0; i < entry->n; i++)
        if (i == 0 || output->snapshot_at[i] != output->snapshot_at[i - 1])
            output->snapshot_at[output->n_snapshot_at++] = output->snapshot_at[i];
    return ok;
}

static bool read_formats(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                         struct output_config *output)
{
    bool given[2] = {false, false};
    for (size_t i = 0; i < entry->n; i++) {
        int format = read_choice(b, key, word_at(b, entry, i));
        if (format < 0)
            return false;
        given[format] = true;
    }
    output->vtp = given[0];
    output->xyz = given[1];
    return true;
}

static bool read_value(struct deck_binding *b, const struct deck_key *key, struct deck_entry *entry,
                       void *base)
{
    void *at = (char *)base + key->offset;
    struct config *config = base;
    switch (key->type) {
    case VALUE_REAL:
        return read_reals(b, key, entry, at);
    case VALUE_WHOLE:
        return check_count(b, key, entry, 1) && read_whole(b, key, entry, 0, at);
    case VALUE_CHOICE:
    case VALUE_FLAG:
        return read_words(b, key, entry, at);
    case VALUE_SHAPE:
        return read_shape(b, key, entry, at);
    case VALUE_MATERIAL:
        return read_material(b, key, entry, base);
    case VALUE_MATERIALS:
        return read_materials(b, key, entry, at);
    case VALUE_NAME:
        return read_name(b, key, entry, at);
    case VALUE_BODY:
        return read_body(b, key, entry, at);
    case VALUE_MOVER:
        return read_mover(b, key, entry, at);
    case VALUE_MOVERS:
        return read_movers(b, key, entry, at);
    case VALUE_FILE:
        return read_file_name(b, key, entry);
    case VALUE_POINTS:
        return load_read_points(b, key, entry, at);
    case VALUE_SET:
    case VALUE_BODIES:
        return value_read_list(b, key, entry, at);
    case VALUE_MIX:
        return read_mix(b, key, entry, base);
    case VALUE_LIMIT:
        return stop_read_probe(b, key, entry, base);
    case VALUE_STEPS:
        return read_steps(b, key, entry, &config->output);
    case VALUE_FORMATS:
        return read_formats(b, key, entry, &config->output);
    case VALUE_LINE:
        return walls_read_points(b, key, entry, base);
    case VALUE_STATE:
        return start_read_state(b, key, entry, base);
    case VALUE_NAMES:
        return start_read_names(b, entry, base);
    }
    return false;
}

bool value_read(struct deck_binding *b, const struct deck_key *key, struct deck_entry *entry, void *base)
{
    bool ok = !entry->bad && read_value(b, key, entry, base);
    if (!ok && key->type == VALUE_REAL)
        forget_reals(key, (double *)(void *)((char *)base + key->offset));
    entry->bad = !ok;
    return ok;
}
