/* schedule.csv says which steps have rows, so the table is compared with these steps line by line: a row that
 * is missing, cut short, of another step or doubled is found anywhere in the table. The text behind the last
 * row that is due before the checkpoint was written after the checkpoint, and the continued run writes these
 * rows again. All tables are checked before the first one is touched. */
#include "resume.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dm2/base/csv.h"
#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/base/text.h"
#include "dm2/output/run_directory.h"

/* --- which rows are kept --- */

/* The length of the first line of text[0..n) with its newline; 0 where the text has no newline. */
static size_t line_length(const unsigned char *text, size_t n)
{
    const unsigned char *end = memchr(text, '\n', n);
    return end == NULL ? 0 : (size_t)(end - text) + 1;
}

static bool is_of_step(const unsigned char *line, size_t length, int64_t step)
{
    char prefix[32];
    int n = snprintf(prefix, sizeof prefix, "%" PRId64 ",", step);
    return length > (size_t)n && memcmp(line, prefix, (size_t)n) == 0;
}

enum dm2_status resume_keep(const char *path, const unsigned char *text, size_t n,
                            const struct resume_plan *plan, size_t *keep, struct dm2_error *err)
{
    size_t at = line_length(text, n);
    if (at == 0)
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s: has no heading: it is not the table that the checkpoint needs", path);
    for (int64_t step = 0; step < plan->step; step++) {
        for (int64_t row = 0; row < plan->rows && plan->due(plan->context, step); row++) {
            size_t length = line_length(text + at, n - at);
            if (!is_of_step(text + at, length, step))
                return dm2_fail(
                    err, DM2_PROTOCOL,
                    "%s: the row of step %" PRId64 " is missing, which the run wrote before its checkpoint "
                    "of step %" PRId64 ": bring the tables of the run directory and its schedule.csv along "
                    "with its checkpoint",
                    path, step, plan->step);
            at += length;
        }
    }
    *keep = at;
    return DM2_OK;
}

/* --- the columns --- */

/* Compares the heading of a table with the one that the deck asks for; `which` is the profile, or n_profiles
 * for history.csv. */
static enum dm2_status check_heading(const char *path, const unsigned char *text, size_t n,
                                     const struct config *c, size_t which, struct dm2_error *err)
{
    struct file_out heading;
    enum dm2_status status = file_create_text(&heading, err);
    if (status != DM2_OK)
        return status;
    if (which < c->n_profiles)
        history_put_profile_heading(&heading, &c->profiles[which]);
    else
        history_put_heading(&heading, c);
    bool same = n >= heading.used && memcmp(text, heading.buffer, heading.used) == 0;
    file_abandon(&heading);
    return same ? DM2_OK
                : dm2_fail(
                      err, DM2_DECK,
                      "%s: has other columns than the deck asks for now: give the deck its probes and the "
                      "axes of its profiles back, or run it anew in another directory (-o DIR)",
                      path);
}

/* Compares the bins of the first profile in the table, whose centres are the third column, with those that
 * the deck asks for. */
static enum dm2_status check_bins(const char *path, const unsigned char *text, size_t keep,
                                  const struct profile_config *p, struct dm2_error *err)
{
    size_t at = line_length(text, keep), bin = 0;
    for (; at < keep && bin < (size_t)p->bins; bin++) {
        char want[NUMBER_TEXT_MAX];
        size_t length = number_format(profile_centre(p, bin), want), line = line_length(text + at, keep - at);
        const unsigned char *field = text + at, *end = text + at + line;
        for (int comma = 0; comma < 2 && field < end; field++)
            comma += *field == ',';
        if ((size_t)(end - field) <= length || memcmp(field, want, length) != 0 || field[length] != ',')
            return dm2_fail(err, DM2_DECK,
                            "%s: its bins are others than those of the profile '%s' now: give the deck its "
                            "bins and range back, or run it anew in another directory (-o DIR)",
                            path, p->name);
        at += line;
    }
    return DM2_OK;
}

/* --- the files --- */

bool resume_in_place(const char *directory, const char *source)
{
    struct stat one, other;
    return stat(directory, &one) == 0 && stat(source, &other) == 0 && one.st_dev == other.st_dev &&
           one.st_ino == other.st_ino;
}

struct table_due {
    const struct schedule_book *book;
    const char *table;
};

static bool is_due(const void *context, int64_t step)
{
    const struct table_due *t = context;
    return schedule_book_due(t->book, t->table, step);
}

/* Whether the table has rows before `step`. */
static bool has_rows(const struct schedule_book *book, const char *table, int64_t step)
{
    for (int64_t s = 0; s < step; s++)
        if (schedule_book_due(book, table, s))
            return true;
    return false;
}

/* Sets *count to the rows that cracks.csv has at least beside the kept rows of history.csv: the links of the
 * first row that are not in the state. */
static enum dm2_status count_cracks(const struct resume *r, const char *path, const unsigned char *text,
                                    size_t keep, struct crack_count *count, struct dm2_error *err)
{
    size_t head = line_length(text, keep), first = line_length(text + head, keep - head), step, links;
    struct csv row;
    double *steps = NULL, *before = NULL;
    if (first == 0)
        return DM2_OK;
    enum dm2_status status = csv_parse(path, (const char *)text, head + first, &row, err);
    if (status != DM2_OK)
        return status;
    if (csv_column(&row, "step", &step, NULL) == DM2_OK &&
        csv_column(&row, "links", &links, NULL) == DM2_OK) {
        status = csv_numbers(&row, step, &steps, err);
        if (status == DM2_OK)
            status = csv_numbers(&row, links, &before, err);
        if (status == DM2_OK && !(*before >= 0.0 && *before <= 0x1p53))
            status =
                dm2_fail(err, DM2_PROTOCOL,
                         "%s: its first row has %g links, which is no count: bring the tables of the run "
                         "directory along with its checkpoint",
                         path, *before);
        if (status == DM2_OK)
            *count = (struct crack_count){.from = (int64_t)*steps, .rows = (int64_t)*before - r->links};
    }
    free(steps);
    free(before);
    csv_free(&row);
    return status;
}

/* Adds the table `name` in r->source to *r: its .part file, or the complete file of a run that ended. Keeps
 * the text of a table that is to be copied. `which`: the profile; n_profiles: history.csv, which says how
 * many rows cracks.csv has; above: fragments.csv. */
static enum dm2_status check_table(struct resume *r, const struct config *c, const char *name, size_t which,
                                   struct file_out *to, struct crack_count *cracks, struct dm2_error *err)
{
    struct resumed_table *t = &r->tables[r->n];
    const struct table_due due = {r->book, name};
    const struct resume_plan plan = {.due = is_due,
                                     .context = &due,
                                     .rows = which < c->n_profiles ? c->profiles[which].bins : 1,
                                     .step = r->step};
    unsigned char *text = NULL;
    size_t n = 0;
    *t = (struct resumed_table){.to = to};
    (void)snprintf(t->name, sizeof t->name, "%s", name);
    char *from = text_join(r->source, "/", name), *part = from == NULL ? NULL : text_join(from, ".part", "");
    enum dm2_status status = part == NULL ? run_directory_no_memory(err) : DM2_OK;
    t->whole = status == DM2_OK && access(part, F_OK) != 0;
    const char *path = t->whole ? from : part;
    if (status == DM2_OK)
        status = file_read(path, SIZE_MAX / 4, &text, &n, err);
    if (status == DM2_OK && which <= c->n_profiles)
        status = check_heading(path, text, n, c, which, err);
    if (status == DM2_OK && which < c->n_profiles)
        status = check_bins(path, text, n, &c->profiles[which], err);
    if (status == DM2_OK)
        status = resume_keep(path, text, n, &plan, &t->keep, err);
    if (status == DM2_OK && which == c->n_profiles)
        status = count_cracks(r, path, text, t->keep, cracks, err);
    if (status == DM2_OK && !r->in_place) {
        t->text = text;
        text = NULL;
    }
    r->n++;
    free(text);
    free(from);
    free(part);
    return status;
}

/* A profile that the run had and the deck lacks, or the other way round: its rows would end or begin within
 * the table. */
static enum dm2_status check_profiles(const struct resume *r, const struct config *c, struct dm2_error *err)
{
    for (size_t k = 0; k < r->book->n; k++) {
        const char *table = r->book->lines[k].table;
        bool known = strncmp(table, "profile-", 8) != 0 || r->book->lines[k].from >= r->step;
        for (size_t p = 0; p < c->n_profiles && !known; p++) {
            char name[TABLE_NAME_MAX];
            schedule_book_profile(c, p, name);
            known = strcmp(name, table) == 0;
        }
        if (!known)
            return dm2_fail(err, DM2_DECK,
                            "%s/%s: the deck has no such profile now: give the profile back, or run the deck "
                            "anew in another directory (-o DIR)",
                            r->source, table);
    }
    return DM2_OK;
}

enum dm2_status resume_check(struct resume *r, const struct config *c, struct history_tables *tables,
                             struct dm2_error *err)
{
    struct crack_count cracks = {.from = -1};
    r->cracks = &tables->cracks;
    enum dm2_status status = check_profiles(r, c, err);
    if (status == DM2_OK)
        status = check_table(r, c, "history.csv", c->n_profiles, &tables->history, &cracks, err);
    for (size_t k = 0; k < c->n_profiles && status == DM2_OK; k++) {
        char name[TABLE_NAME_MAX];
        schedule_book_profile(c, k, name);
        if (schedule_book_line(r->book, name, r->step) == NULL)
            return dm2_fail(
                err, DM2_DECK,
                "%s: has no rows of the profile '%s', which is new in the deck: take it out, or run "
                "the deck anew in another directory (-o DIR)",
                r->source, c->profiles[k].name);
        status = check_table(r, c, name, k, &tables->profiles[k], &cracks, err);
    }
    if (status == DM2_OK && has_rows(r->book, "fragments.csv", r->step))
        status = check_table(r, c, "fragments.csv", c->n_profiles + 1, &tables->fragments, &cracks, err);
    return status == DM2_OK ? cracks_check(r->source, r->step, &cracks, &r->crack_rows, err) : status;
}

/* Opens one table in `directory`: cut in place, or written anew. */
static enum dm2_status take_table(const struct resume *r, const char *directory,
                                  const struct resumed_table *t, struct dm2_error *err)
{
    char *to = text_join(directory, "/", t->name), *part = to == NULL ? NULL : text_join(to, ".part", "");
    enum dm2_status status = part == NULL ? run_directory_no_memory(err) : DM2_OK;
    if (status == DM2_OK && r->in_place && t->whole)
        status = file_rename(to, part, err);
    if (status == DM2_OK && r->in_place) {
        status = file_reopen(t->to, to, t->keep, err);
    } else if (status == DM2_OK) {
        status = file_create(t->to, to, err);
        if (status == DM2_OK) {
            file_write(t->to, t->text, t->keep);
            status = file_flush(t->to, err);
        }
    }
    free(to);
    free(part);
    return status;
}

enum dm2_status resume_take(const struct resume *r, const char *directory, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < r->n && status == DM2_OK; k++)
        status = take_table(r, directory, &r->tables[k], err);
    return status == DM2_OK ? cracks_take(&r->crack_rows, directory, r->in_place, r->cracks, err) : status;
}

void resume_free(struct resume *r)
{
    for (size_t k = 0; k < r->n; k++)
        free(r->tables[k].text);
    r->n = 0;
    cracks_free(&r->crack_rows);
}

enum dm2_status resume_series(const char *directory, const struct schedule_book *book, int64_t step,
                              struct snapshot_steps *series, struct dm2_error *err)
{
    char *snapshots = text_join(directory, "/", run_directory_snapshots);
    enum dm2_status status = snapshots == NULL ? run_directory_no_memory(err) : DM2_OK;
    for (int64_t s = 0; s < step && status == DM2_OK; s++) {
        char name[SNAPSHOT_NAME_MAX];
        if (!schedule_book_due(book, "fragments.csv", s))
            continue;
        snapshot_file_name(s, "vtp", name);
        char *path = text_join(snapshots, "/", name);
        int64_t *grown =
            path == NULL ? NULL
                         : mem_grown(series->items, &series->cap, series->n, series->n + 1, sizeof *grown);
        if (grown == NULL)
            status = run_directory_no_memory(err);
        else
            series->items = grown;
        if (status == DM2_OK && access(path, F_OK) == 0)
            series->items[series->n++] = s;
        free(path);
    }
    free(snapshots);
    return status;
}
