/* The points of loads. A load has the points of one keyword or of one column of a file; both are read to the
 * same numbers, in base units and rounded once, and pass the same checks. */
#include "bind_loads.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/csv.h"
#include "dm2/base/mem.h"
#include "lex.h"
#include "source.h"

struct load_block load_block_start(void)
{
    return (struct load_block){.common = {.mover = MOVER_NONE, .between = {MOVER_NONE, MOVER_NONE}}};
}

static const char *mover_name(const void *context, size_t i)
{
    return config_mover_name(context, i);
}

int binding_mover(struct deck_binding *b, struct deck_place name)
{
    size_t n = config_movers(b->config);
    for (size_t i = 0; i < n; i++)
        if (place_is(b->tree->source, name, config_mover_name(b->config, i)))
            return (int)i;
    struct word_list known = {mover_name, b->config, n};
    struct place_text text;
    struct word_hint hint;
    if (!b->tree->incomplete)
        findings_error(b->findings, name, "there is no body '%s'%s", place_text(b->tree->source, name, &text),
                       words_hint(&known, place_bytes(b->tree->source, name), name.length, &hint));
    return -1;
}

static const struct deck_key *key_of(enum load_quantity quantity)
{
    return &schema_block(BLOCK_LOAD)->keys[quantity];
}

struct deck_place load_place(const struct deck_binding *b, size_t load)
{
    size_t block = b->blocks[BLOCK_LOAD][load];
    const char *key = key_of(b->config->loads[load].quantity)->name;
    return binding_place(b, block, binding_given(b, block, key) ? key : "file", 0);
}

/* False: no memory. */
static bool hold_points(struct deck_binding *b, size_t n, struct load_points *out)
{
    *out = (struct load_points){n, mem_zalloc(n, sizeof(double)), mem_zalloc(n, sizeof(double))};
    if (out->time != NULL && out->value != NULL)
        return true;
    b->findings->no_memory = true;
    return false;
}

static void drop_points(struct load_points *points)
{
    free(points->time);
    free(points->value);
    *points = (struct load_points){0};
}

static bool check_number_of_points(struct deck_binding *b, struct deck_place place, const char *name,
                                   size_t n)
{
    if (n >= 2 && n <= LOAD_POINTS_MAX)
        return true;
    findings_error(b->findings, place, "'%s' is 2 to %d points, found %zu", name, (int)LOAD_POINTS_MAX, n);
    return false;
}

/* Do the times ascend up to point k? `place` is that of point k. */
static bool check_ascent(struct deck_binding *b, struct deck_place place, const struct load_points *points,
                         size_t k)
{
    struct number_text before, now;
    if (k == 0 || points->time[k] > points->time[k - 1])
        return true;
    findings_error(b->findings, place, "times ascend: after %s us comes %s us",
                   number_text(points->time[k - 1], &before), number_text(points->time[k], &now));
    return false;
}

bool load_read_points(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                      struct load_points *out)
{
    static const struct deck_key time_key = {
        .name = "time", .dim = {0, 0, 1, 0, 0}, .low = -HUGE_VAL, .high = HUGE_VAL};
    if (entry->n % 2 != 0) {
        findings_error(b->findings, entry->key,
                       "'%s' is points, each a time and a value: found %zu values, one is without its pair",
                       key->name, entry->n);
        return false;
    }
    if (!check_number_of_points(b, entry->key, key->name, entry->n / 2) || !hold_points(b, entry->n / 2, out))
        return false;
    bool ok = true;
    for (size_t k = 0; k < out->n && ok; k++) {
        ok = value_read_real(b, &time_key, entry, 2 * k, &out->time[k]) &&
             value_read_real(b, key, entry, 2 * k + 1, &out->value[k]) &&
             check_ascent(b, b->tree->nodes[b->tree->values[entry->first + 2 * k]].place, out, k);
    }
    if (!ok)
        drop_points(out);
    return ok;
}

/* --- files --- */

/* A table that is being read: the file's text, and the place of its name in the deck. */
struct table {
    struct deck_binding *b;
    struct deck_place name;
    int text;
    struct csv csv;
};

/* The place of a line of the file, from 1. */
static struct deck_place line_place(const struct table *t, size_t line)
{
    const struct deck_text *text = &t->b->tree->source->texts[t->text];
    size_t from = 0;
    for (size_t k = 1; k < line; k++) {
        const char *end = memchr(text->text + from, '\n', text->length - from);
        if (end == NULL)
            break;
        from = (size_t)(end - text->text) + 1;
    }
    return (struct deck_place){t->text, from, strcspn(text->text + from, "\r\n")};
}

/* "cm/us", "1/us", "g cm2/us2": a product over products. False: an unknown unit. */
static bool find_units(const char *words, size_t length, struct unit *out)
{
    int power = 1;
    *out = (struct unit){.factor = 1.0};
    for (size_t from = 0, i = 0; i <= length; i++) {
        struct unit one;
        if (i < length && words[i] != '/' && words[i] != ' ' && words[i] != '*')
            continue;
        bool unity = i - from == 1 && words[from] == '1' && from == 0;
        if (i > from && !unity &&
            (!unit_find(words + from, i - from, &one) || !unit_times(*out, one, power, out)))
            return false;
        if (i < length && words[i] == '/')
            power = -1;
        from = i + 1;
    }
    return true;
}

/* The unit of a column from its heading: "velocity_y [cm/us]"; of a heading without a unit the base unit. */
static bool heading_unit(struct table *t, const char *heading, const struct deck_key *key, struct unit *out)
{
    const char *open = strchr(heading, '['), *close = open == NULL ? NULL : strchr(open, ']');
    struct dimension_text want, found;
    *out = (struct unit){.dim = key->dim, .factor = 1.0};
    if (open == NULL)
        return true;
    bool known = close != NULL && find_units(open + 1, (size_t)(close - open) - 1, out);
    if (known && dimension_equal(out->dim, key->dim))
        return true;
    if (known)
        findings_error(t->b->findings, line_place(t, 1), "the column '%s' is %s, '%s' is %s", heading,
                       dimension_name(out->dim, &found), key->name, dimension_name(key->dim, &want));
    else
        findings_error(t->b->findings, line_place(t, 1), "the unit of the column '%s' is unknown; '%s' is %s",
                       heading, key->name, dimension_name(key->dim, &want));
    return false;
}

/* The field without the blanks before and behind it: its beginning, and its length in *length. */
static const char *trimmed(const char *field, size_t *length)
{
    static const char blanks[] = " \t";
    field += strspn(field, blanks);
    size_t n = strlen(field);
    while (n > 0 && strchr(blanks, field[n - 1]) != NULL)
        n--;
    *length = n;
    return field;
}

static bool read_field(struct table *t, const struct deck_key *key, size_t row, size_t column,
                       const struct unit *unit, double *out)
{
    size_t length;
    const char *field = trimmed(csv_field(&t->csv, row, column), &length);
    double value;
    bool number = number_parse(field, length, &value) && isfinite(value);
    bool minus = *field == '-';
    size_t sign = minus || *field == '+' ? 1 : 0;
    value = number ? unit_value(field + sign, length - sign, *unit) : value;
    value = minus ? -value : value;
    if (!number || !isfinite(value)) {
        findings_error(t->b->findings, line_place(t, t->csv.lines[row]),
                       "'%.60s' in the column '%s' is no number", field, csv_heading(&t->csv, column));
        return false;
    }
    if (value < key->low) {
        struct number_text low;
        findings_error(t->b->findings, line_place(t, t->csv.lines[row]), "'%s' is at least %s, this is %.60s",
                       key->name, number_text(key->low, &low), field);
        return false;
    }
    *out = value;
    return true;
}

/* Is the heading this name, with or without a unit behind it? */
static bool is_headed(const char *heading, const char *name)
{
    size_t all, n;
    heading = trimmed(heading, &all);
    const char *close = strchr(heading, ']');
    if (close != NULL && close + 1 != heading + all)
        return false;
    n = strcspn(heading, "[");
    n = n < all ? n : all;
    while (n > 0 && heading[n - 1] == ' ')
        n--;
    return strlen(name) == n && memcmp(heading, name, n) == 0;
}

static const char *column_name(const void *context, size_t i)
{
    (void)context;
    return i < LOAD_QUANTITIES ? key_of((enum load_quantity)i)->name : "time";
}

/* The quantity of each column, LOAD_QUANTITIES for the time. False: a column is neither or comes twice, the
 * time or all quantities are missing. */
static bool find_columns(struct table *t, size_t columns[LOAD_QUANTITIES + 1])
{
    struct word_list known = {column_name, NULL, LOAD_QUANTITIES + 1};
    struct word_hint hint;
    size_t found = 0;
    for (size_t q = 0; q <= LOAD_QUANTITIES; q++)
        columns[q] = t->csv.n_columns;
    for (size_t c = 0; c < t->csv.n_columns; c++) {
        size_t length, q = 0;
        const char *heading = trimmed(csv_heading(&t->csv, c), &length);
        while (q <= LOAD_QUANTITIES && !is_headed(heading, column_name(NULL, q)))
            q++;
        if (q > LOAD_QUANTITIES || columns[q] < t->csv.n_columns) {
            findings_error(t->b->findings, line_place(t, 1),
                           q > LOAD_QUANTITIES ? "the column '%s' is neither the time nor a quantity%s"
                                               : "there is a column '%s' before%.0s",
                           heading, words_hint(&known, heading, strcspn(heading, " ["), &hint));
            return false;
        }
        columns[q] = c;
        found += q < LOAD_QUANTITIES ? 1 : 0;
    }
    if (columns[LOAD_QUANTITIES] == t->csv.n_columns || found == 0)
        findings_error(t->b->findings, line_place(t, 1),
                       "a table of a load has a column 'time [us]' and a column for each quantity, such as "
                       "'velocity_y [cm/us]'; found no %s",
                       found == 0 ? "quantity" : "time");
    return columns[LOAD_QUANTITIES] < t->csv.n_columns && found > 0;
}

static bool read_column(struct table *t, enum load_quantity q, const size_t *columns, struct load_points *out)
{
    static const struct deck_key time_key = {
        .name = "time", .dim = {0, 0, 1, 0, 0}, .low = -HUGE_VAL, .high = HUGE_VAL};
    struct unit time_unit, unit;
    bool ok = heading_unit(t, csv_heading(&t->csv, columns[LOAD_QUANTITIES]), &time_key, &time_unit) &&
              heading_unit(t, csv_heading(&t->csv, columns[q]), key_of(q), &unit) &&
              check_number_of_points(t->b, t->name, "file", t->csv.n_rows) &&
              hold_points(t->b, t->csv.n_rows, out);
    for (size_t k = 0; ok && k < out->n; k++)
        ok = read_field(t, &time_key, k, columns[LOAD_QUANTITIES], &time_unit, &out->time[k]) &&
             read_field(t, key_of(q), k, columns[q], &unit, &out->value[k]) &&
             (k == 0 || out->time[k] > out->time[k - 1] ||
              check_ascent(t->b, line_place(t, t->csv.lines[k]), out, k));
    if (!ok)
        drop_points(out);
    return ok;
}

/* Opens the table that `file` names. False: a finding was added. */
static bool open_table(struct table *t)
{
    const struct deck_source *source = t->b->tree->source;
    struct dm2_error err = {0};
    struct place_text shown;
    bool valid;
    t->text = deck_source_find(source, (size_t)t->name.text, place_bytes(source, t->name) + 1,
                               t->name.length - 2, &valid);
    if (!valid || t->text < 0) {
        findings_error(
            t->b->findings, t->name,
            valid ? "the file %s is not among the deck's texts"
                  : "the file %s must lie beside the deck or below: neither an absolute path nor '..'",
            place_text(source, t->name, &shown));
        return false;
    }
    if (!lex_check_ascii(t->b->findings, t->text))
        return false;
    const struct deck_text *text = &source->texts[t->text];
    if (csv_parse(text->name, text->text, text->length, &t->csv, &err) == DM2_OK)
        return true;
    unsigned long line = 1;
    size_t prefix = strlen(text->name);
    const char *message = err.text;
    int used = 0;
    if (strncmp(message, text->name, prefix) == 0 &&
        sscanf(message + prefix, ":%lu: %n", &line, &used) == 1 && used > 0)
        message += prefix + (size_t)used;
    findings_error(t->b->findings, line_place(t, line), "%s", message);
    return false;
}

/* The deck as one text (deck_source_flatten) has the points of all tables in it and must read as a deck. */
static bool check_room(struct deck_binding *b, struct deck_place place, size_t points)
{
    enum { TOKENS = 6, BYTES = 2 * NUMBER_TEXT_MAX + 6 }; /* of a point, with signs, commas and line ends */
    size_t before = b->table_points, room = b->tree->room_tokens / TOKENS;
    if (room > b->tree->room_bytes / BYTES)
        room = b->tree->room_bytes / BYTES;
    b->table_points += points;
    if (before > room || b->table_points <= room)
        return true;
    findings_error(
        b->findings, place,
        "the tables of all loads have at most %zu points together beside this deck's text, because "
        "the run's deck.dm2 has them in it: thin this table out",
        room);
    return false;
}

/* Reads the columns of the file into the points of the block. */
static void read_file(struct deck_binding *b, size_t block, struct load_block *read)
{
    struct table t = {.b = b, .name = binding_place(b, block, "file", 0)};
    size_t columns[LOAD_QUANTITIES + 1];
    for (int q = 0; q < LOAD_QUANTITIES; q++) {
        const char *key = key_of((enum load_quantity)q)->name;
        if (binding_given(b, block, key)) {
            findings_error(b->findings, binding_place(b, block, key, 0),
                           "give points or 'file', not both: the load '%s' has a file", read->common.name);
            return;
        }
    }
    if (!open_table(&t))
        return;
    bool ok = find_columns(&t, columns);
    for (int q = 0; q < LOAD_QUANTITIES && ok; q++)
        if (columns[q] < t.csv.n_columns)
            ok = read_column(&t, (enum load_quantity)q, columns, &read->points[q]) &&
                 check_room(b, t.name, read->points[q].n);
    csv_free(&t.csv);
}

/* --- loads --- */

bool load_bind(struct deck_binding *b, size_t block, struct load_block *read)
{
    struct config *c = b->config;
    bool any = binding_given(b, block, "file");
    if (any)
        read_file(b, block, read);
    for (int q = 0; q < LOAD_QUANTITIES; q++) {
        const char *key = key_of((enum load_quantity)q)->name;
        any = any || binding_given(b, block, key) || binding_bad(b, block, key);
        if (read->points[q].n == 0)
            continue;
        struct load_config *load = &c->loads[c->n_loads];
        *load = read->common;
        load->quantity = (enum load_quantity)q;
        load->n = read->points[q].n;
        load->time = read->points[q].time;
        load->value = read->points[q].value;
        b->blocks[BLOCK_LOAD][c->n_loads++] = block;
        load->mass_place =
            findings_place(b->findings, binding_given(b, block, "mass") ? binding_place(b, block, "mass", 0)
                                                                        : load_place(b, c->n_loads - 1));
    }
    if (!any && !binding_bad(b, block, "file"))
        findings_error(b->findings, binding_place(b, block, "body", 0),
                       "the load '%s' has no quantity: give points, such as 'velocity_y = 0 us 0 cm/us, 1 us "
                       "-0.01 cm/us', or a 'file'",
                       read->common.name);
    return !b->findings->no_memory;
}
