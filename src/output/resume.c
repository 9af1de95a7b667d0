/* The deck determines the steps that have rows, so the table is compared with these steps line by line: a row
 * that is missing, cut short, of another step or doubled is found anywhere in the table. The text behind the
 * last row that is due before the checkpoint was written after the checkpoint, and the continued run writes
 * these rows again. */
#include "resume.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/text.h"
#include "dm2/deck/schedule.h"
#include "dm2/output/run_directory.h"
#include "cracks.h"

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
                    "of step %" PRId64 ": bring the tables of the run directory along with its checkpoint, "
                    "and give the same --steps",
                    path, step, plan->step);
            at += length;
        }
    }
    *keep = at;
    return DM2_OK;
}

/* --- the files --- */

bool resume_in_place(const char *directory, const char *source)
{
    struct stat one, other;
    return stat(directory, &one) == 0 && stat(source, &other) == 0 && one.st_dev == other.st_dev &&
           one.st_ino == other.st_ino;
}

struct profile_due {
    const struct config *config;
    size_t which;
};

static bool history_due(const void *context, int64_t step)
{
    return schedule_history(context, step);
}

static bool snapshot_due(const void *context, int64_t step)
{
    return schedule_snapshot(context, step);
}

static bool profile_due(const void *context, int64_t step)
{
    const struct profile_due *p = context;
    return schedule_profile(p->config, p->which, step);
}

/* Opens one table in `directory` with the rows of the table in `source`: its .part file, or the complete file
 * of a run that ended. */
static enum dm2_status continue_table(const char *directory, const char *source, bool in_place,
                                      const char *name, const struct resume_plan *plan, struct file_out *f,
                                      struct dm2_error *err)
{
    unsigned char *text = NULL;
    size_t n = 0, keep = 0;
    char *from = text_join(source, "/", name), *part = from == NULL ? NULL : text_join(from, ".part", "");
    char *to = text_join(directory, "/", name);
    enum dm2_status status = part == NULL || to == NULL ? run_directory_no_memory(err) : DM2_OK;
    bool whole = status == DM2_OK && access(part, F_OK) != 0;
    if (status == DM2_OK)
        status = file_read(whole ? from : part, SIZE_MAX / 4, &text, &n, err);
    if (status == DM2_OK)
        status = resume_keep(whole ? from : part, text, n, plan, &keep, err);
    if (status == DM2_OK && in_place && whole)
        status = file_rename(from, part, err);
    if (status == DM2_OK && in_place) {
        status = file_reopen(f, to, keep, err);
    } else if (status == DM2_OK) {
        status = file_create(f, to, err);
        if (status == DM2_OK) {
            file_write(f, text, keep);
            status = file_flush(f, err);
        }
    }
    free(text);
    free(from);
    free(part);
    free(to);
    return status;
}

enum dm2_status resume_tables(const char *directory, const char *source, const struct config *c, int64_t step,
                              bool in_place, struct history_tables *tables, struct dm2_error *err)
{
    struct resume_plan plan = {.due = history_due, .context = c, .rows = 1, .step = step};
    enum dm2_status status =
        continue_table(directory, source, in_place, "history.csv", &plan, &tables->history, err);
    for (size_t k = 0; k < c->n_profiles && status == DM2_OK; k++) {
        char name[NAME_MAX_LENGTH + 16];
        struct profile_due which = {c, k};
        plan = (struct resume_plan){
            .due = profile_due, .context = &which, .rows = c->profiles[k].bins, .step = step};
        (void)snprintf(name, sizeof name, "profile-%s.csv", c->profiles[k].name);
        status = continue_table(directory, source, in_place, name, &plan, &tables->profiles[k], err);
    }
    bool fragments = false;
    for (int64_t s = 0; s < step && !fragments; s++)
        fragments = schedule_snapshot(c, s);
    plan = (struct resume_plan){.due = snapshot_due, .context = c, .rows = 1, .step = step};
    if (status == DM2_OK && fragments)
        status = continue_table(directory, source, in_place, "fragments.csv", &plan, &tables->fragments, err);
    if (status == DM2_OK)
        status = cracks_resume(directory, source, step, in_place, &tables->cracks, err);
    return status;
}

enum dm2_status resume_series(const char *directory, const struct config *c, int64_t step,
                              struct snapshot_steps *series, struct dm2_error *err)
{
    char *snapshots = text_join(directory, "/", run_directory_snapshots);
    enum dm2_status status = snapshots == NULL ? run_directory_no_memory(err) : DM2_OK;
    for (int64_t s = 0; s < step && status == DM2_OK && c->output.vtp; s++) {
        char name[SNAPSHOT_NAME_MAX];
        if (!schedule_snapshot(c, s))
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
