/* The file is written whole at each change, in the order of its lines. */
#include "schedule_book.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/csv.h"
#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/output/run_directory.h"

const char schedule_book_name[] = "schedule.csv";

static const char *const columns[] = {"from_step", "table", "every", "also"};
enum { FROM, TABLE, EVERY, ALSO, COLUMNS };

void schedule_book_free(struct schedule_book *b)
{
    for (size_t k = 0; k < b->n; k++)
        free(b->lines[k].also);
    free(b->lines);
    *b = (struct schedule_book){0};
}

/* Appends a line with a copy of also[0 .. n). */
static enum dm2_status add_line(struct schedule_book *b, int64_t from, const char *table, int64_t every,
                                const int64_t *also, size_t n, struct dm2_error *err)
{
    struct schedule_line *grown = mem_grown(b->lines, &b->cap, b->n, b->n + 1, sizeof *grown);
    if (grown == NULL)
        return run_directory_no_memory(err);
    b->lines = grown;
    struct schedule_line *line = &b->lines[b->n];
    *line = (struct schedule_line){
        .from = from, .every = every, .n_also = n, .also = mem_alloc(n, sizeof *line->also)};
    if (line->also == NULL)
        return run_directory_no_memory(err);
    if (n > 0)
        memcpy(line->also, also, n * sizeof *also);
    (void)snprintf(line->table, sizeof line->table, "%s", table);
    b->n++;
    return DM2_OK;
}

/* --- reading --- */

/* A step from the begin of a text; -1: none. *end: behind the step. */
static int64_t read_step(const char *text, const char **end)
{
    int64_t step = 0;
    *end = text;
    for (; **end >= '0' && **end <= '9'; ++*end) {
        if (step > (INT64_MAX - 9) / 10)
            return -1;
        step = 10 * step + (**end - '0');
    }
    return *end == text ? -1 : step;
}

/* Reads steps, ascending, with a blank between. *out is malloc'd; NULL: not such a list, or no memory. */
static int64_t *read_steps(const char *text, size_t *n)
{
    size_t most = 1;
    for (const char *c = text; *c != '\0'; c++)
        most += *c == ' ';
    int64_t *steps = mem_alloc(most, sizeof *steps);
    *n = 0;
    for (const char *at = text; steps != NULL && *at != '\0'; at += *at == ' ') {
        steps[*n] = read_step(at, &at);
        if (steps[*n] < 0 || (*n > 0 && steps[*n] <= steps[*n - 1]) || (*at != '\0' && *at != ' ')) {
            free(steps);
            return NULL;
        }
        ++*n;
    }
    return steps;
}

static enum dm2_status read_row(const struct csv *csv, size_t row, struct schedule_book *out,
                                struct dm2_error *err)
{
    const char *end, *table = csv_field(csv, row, TABLE);
    int64_t from = read_step(csv_field(csv, row, FROM), &end);
    bool ok = from >= 0 && *end == '\0' && strlen(table) < TABLE_NAME_MAX;
    int64_t every = read_step(csv_field(csv, row, EVERY), &end);
    ok = ok && every >= 0 && *end == '\0';
    size_t n;
    int64_t *also = read_steps(csv_field(csv, row, ALSO), &n);
    const struct schedule_line *before = ok ? schedule_book_line(out, table, INT64_MAX) : NULL;
    ok = ok && also != NULL && (before == NULL || before->from < from);
    enum dm2_status status =
        ok ? add_line(out, from, table, every, also, n, err)
           : dm2_fail(
                 err, DM2_PROTOCOL,
                 "%s:%zu: is no line of a schedule: a step, a table, an interval and ascending steps are "
                 "expected, with the lines of a table in the order of their steps",
                 csv->path, csv->lines[row]);
    free(also);
    return status;
}

enum dm2_status schedule_book_read(const char *path, struct schedule_book *out, struct dm2_error *err)
{
    struct csv csv;
    *out = (struct schedule_book){0};
    if (file_is_absent(path))
        return DM2_OK;
    enum dm2_status status = csv_read(path, &csv, err);
    if (status != DM2_OK)
        return status;
    bool known = csv.n_columns == COLUMNS;
    for (size_t k = 0; known && k < COLUMNS; k++)
        known = strcmp(csv_heading(&csv, k), columns[k]) == 0;
    if (!known)
        status = dm2_fail(err, DM2_PROTOCOL, "%s: has not the columns of a schedule", path);
    for (size_t row = 0; row < csv.n_rows && status == DM2_OK; row++)
        status = read_row(&csv, row, out, err);
    csv_free(&csv);
    return status;
}

/* --- questions --- */

const struct schedule_line *schedule_book_line(const struct schedule_book *b, const char *table, int64_t step)
{
    for (size_t k = b->n; k-- > 0;)
        if (b->lines[k].from <= step && strcmp(b->lines[k].table, table) == 0)
            return &b->lines[k];
    return NULL;
}

static int compare_steps(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

bool schedule_book_due(const struct schedule_book *b, const char *table, int64_t step)
{
    const struct schedule_line *line = schedule_book_line(b, table, step);
    return line != NULL && ((line->every > 0 && step % line->every == 0) ||
                            (line->n_also > 0 &&
                             bsearch(&step, line->also, line->n_also, sizeof step, compare_steps) != NULL));
}

/* --- changes --- */

void schedule_book_profile(const struct config *c, size_t which, char out[TABLE_NAME_MAX])
{
    (void)snprintf(out, TABLE_NAME_MAX, "profile-%s.csv", c->profiles[which].name);
}

/* Adds a line unless the last line of the table says the same. */
static enum dm2_status change_table(struct schedule_book *b, int64_t from, const char *table, int64_t every,
                                    const int64_t *also, size_t n, struct dm2_error *err)
{
    const struct schedule_line *line = schedule_book_line(b, table, INT64_MAX);
    bool same = line == NULL ? every == 0 && n == 0
                             : line->every == every && line->n_also == n &&
                                   (n == 0 || memcmp(line->also, also, n * sizeof *also) == 0);
    return same ? DM2_OK : add_line(b, from, table, every, also, n, err);
}

enum dm2_status schedule_book_change(struct schedule_book *b, int64_t from, const struct config *c,
                                     struct dm2_error *err)
{
    size_t kept = 0;
    for (size_t k = 0; k < b->n; k++)
        if (b->lines[k].from < from)
            b->lines[kept++] = b->lines[k];
        else
            free(b->lines[k].also);
    b->n = kept;
    const struct output_config *o = &c->output;
    enum dm2_status status = change_table(b, from, "history.csv", o->history_every, NULL, 0, err);
    for (size_t k = 0; k < c->n_profiles && status == DM2_OK; k++) {
        char name[TABLE_NAME_MAX];
        schedule_book_profile(c, k, name);
        status = change_table(b, from, name, c->profiles[k].every, NULL, 0, err);
    }
    return status == DM2_OK ? change_table(b, from, "fragments.csv", o->snapshot_every, o->snapshot_at,
                                           o->n_snapshot_at, err)
                            : status;
}

enum dm2_status schedule_book_stop(struct schedule_book *b, int64_t step, struct dm2_error *err)
{
    return add_line(b, step, "stop", 0, NULL, 0, err);
}

enum dm2_status schedule_book_write(const char *path, const struct schedule_book *b, struct dm2_error *err)
{
    struct file_out f;
    enum dm2_status status = file_create(&f, path, err);
    if (status != DM2_OK)
        return status;
    for (size_t k = 0; k < COLUMNS; k++)
        file_printf(&f, "%s%s", k == 0 ? "" : ",", columns[k]);
    file_puts(&f, "\n");
    for (size_t k = 0; k < b->n; k++) {
        const struct schedule_line *line = &b->lines[k];
        file_printf(&f, "%" PRId64 ",%s,%" PRId64 ",", line->from, line->table, line->every);
        for (size_t i = 0; i < line->n_also; i++)
            file_printf(&f, "%s%" PRId64, i == 0 ? "" : " ", line->also[i]);
        file_puts(&f, "\n");
    }
    return file_commit(&f, err);
}
