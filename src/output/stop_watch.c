/* Rows are compared as numbers of their texts, which read back as the doubles that were written. */
#include "stop_watch.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/base/text.h"

/* --- rows --- */

/* The number in this column of a row; NaN, which holds no condition, where the row is shorter. */
static double number_at(const char *text, size_t length, size_t column)
{
    char number[NUMBER_TEXT_MAX + 1];
    const char *end = text + length;
    for (; column > 0; column--) {
        const char *comma = memchr(text, ',', (size_t)(end - text));
        if (comma == NULL)
            return (double)NAN;
        text = comma + 1;
    }
    size_t n = 0;
    while (text + n < end && n + 1 < sizeof number && text[n] != ',' && text[n] != '\n')
        n++;
    memcpy(number, text, n);
    number[n] = '\0';
    return strtod(number, NULL);
}

static bool holds_at(const struct stop_config *c, const struct stop_series *s, const char *text,
                     size_t length)
{
    if (!isnan(c->unbalanced) && !(number_at(text, length, s->unbalanced) < c->unbalanced))
        return false;
    if (!isnan(c->kinetic) && !(number_at(text, length, s->kinetic) < c->kinetic))
        return false;
    if (c->column[0] == '\0')
        return true;
    double value = number_at(text, length, s->probe);
    return c->above ? value > c->value : value < c->value;
}

/* Adds a row to the series of all blocks; the first block whose time is over ends the run, unless the run has
 * passed this end before `step`. */
static void add_row(struct stop_watch *watch, int64_t row, const char *text, size_t length, int64_t step)
{
    for (size_t k = 0; k < watch->config->n_stops; k++) {
        const struct stop_config *c = &watch->config->stops[k];
        struct stop_series *s = &watch->series[k];
        if (!holds_at(c, s, text, length)) {
            s->since = -1;
            continue;
        }
        if (s->since < 0)
            s->since = row;
        /* `after` may be a multiple of dt that division rounds up. */
        bool over = (double)(row - s->since) >= c->after / watch->config->dt - 1e-6;
        if (over && watch->held < 0 && row + STOP_LAG >= step) {
            watch->held = row;
            watch->block = k;
        }
    }
}

bool results_ended_by_stop(const char *directory, const struct config *config, int64_t step)
{
    struct csv table;
    struct stop_watch watch = {.held = -1};
    char *path = text_join(directory, "/", "history.csv");
    bool ended = false;
    if (config->n_stops > 0 && path != NULL && csv_read(path, &table, NULL) == DM2_OK) {
        ended = stop_watch_open(&watch, config, &table, step, NULL) == DM2_OK && watch.held >= 0 &&
                watch.held + STOP_LAG == step;
        stop_watch_free(&watch);
        csv_free(&table);
    }
    free(path);
    return ended;
}

void stop_watch_row(struct stop_watch *watch, int64_t step, const char *text, size_t length)
{
    add_row(watch, step, text, length, step);
}

/* --- opening --- */

static enum dm2_status find_columns(struct stop_watch *watch, const struct csv *table, struct dm2_error *err)
{
    for (size_t k = 0; k < watch->config->n_stops; k++) {
        const struct stop_config *c = &watch->config->stops[k];
        struct stop_series *s = &watch->series[k];
        s->since = -1;
        enum dm2_status status = DM2_OK;
        if (!isnan(c->unbalanced))
            status = csv_column(table, "unbalanced", &s->unbalanced, err);
        if (status == DM2_OK && !isnan(c->kinetic))
            status = csv_column(table, "kinetic", &s->kinetic, err);
        if (status == DM2_OK && c->column[0] != '\0')
            status = csv_column(table, c->column, &s->probe, err);
        if (status != DM2_OK)
            return status;
    }
    return DM2_OK;
}

/* Takes row r of the table as one line of text. */
static enum dm2_status replay_row(struct stop_watch *watch, const struct csv *table, size_t r, int64_t step,
                                  struct dm2_error *err)
{
    size_t length = 0, room = 0;
    for (size_t c = 0; c < table->n_columns; c++)
        room += strlen(csv_field(table, r, c)) + 1;
    char *text = mem_alloc(room + 1, 1);
    if (text == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for a row of the history");
    for (size_t c = 0; c < table->n_columns; c++)
        length += (size_t)snprintf(text + length, room + 1 - length, "%s,", csv_field(table, r, c));
    add_row(watch, strtoll(text, NULL, 10), text, length, step);
    free(text);
    return DM2_OK;
}

enum dm2_status stop_watch_open(struct stop_watch *watch, const struct config *config,
                                const struct csv *table, int64_t step, struct dm2_error *err)
{
    *watch = (struct stop_watch){
        .config = config, .series = mem_zalloc(config->n_stops, sizeof *watch->series), .held = -1};
    if (watch->series == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the blocks 'stop'");
    enum dm2_status status = find_columns(watch, table, err);
    for (size_t r = 0; r < table->n_rows && status == DM2_OK; r++)
        status = replay_row(watch, table, r, step, err);
    return status;
}

void stop_watch_free(struct stop_watch *watch)
{
    free(watch->series);
    *watch = (struct stop_watch){.held = -1};
}

/* --- what held --- */

/* Appends a condition to `line`. */
static void add_condition(char *line, const char *name, const char *side, double value)
{
    char number[NUMBER_TEXT_MAX + 1];
    size_t used = strlen(line);
    number[number_format(value, number)] = '\0';
    (void)snprintf(line + used, RESULTS_LINE - used, "%s%s %s %s", used == 0 ? "stop: " : " with ", name,
                   side, number);
}

void stop_watch_describe(const struct stop_watch *watch, char *line)
{
    char number[NUMBER_TEXT_MAX + 1];
    line[0] = '\0';
    if (watch->held < 0)
        return;
    const struct stop_config *c = &watch->config->stops[watch->block];
    if (!isnan(c->unbalanced))
        add_condition(line, "unbalanced", "below", c->unbalanced);
    if (!isnan(c->kinetic))
        add_condition(line, "kinetic", "below", c->kinetic);
    if (c->column[0] != '\0')
        add_condition(line, c->column, c->above ? "above" : "below", c->value);
    if (c->after > 0.0) {
        size_t used = strlen(line);
        number[number_format(c->after, number)] = '\0';
        (void)snprintf(line + used, RESULTS_LINE - used, " for %s us", number);
    }
    size_t used = strlen(line);
    int64_t end = watch->held + STOP_LAG, steps = watch->config->steps;
    (void)snprintf(line + used, RESULTS_LINE - used, " at row %" PRId64 ": the run ends at step %" PRId64,
                   watch->held, end < steps ? end : steps);
}
