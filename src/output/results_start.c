/* The start of a run's results: the claim of the directory, then new tables, or those of the run that goes
 * on. */
#include "results_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/csv.h"
#include "dm2/base/mem.h"
#include "dm2/base/text.h"
#include "dm2/output/run_directory.h"
#include "adopt.h"
#include "resume.h"
#include "schedule_book.h"

enum dm2_status results_claim(const char *directory, const char *command, struct results **out,
                              struct dm2_error *err)
{
    *out = NULL;
    if (directory[0] == '\0')
        return dm2_fail(err, DM2_IO, "the run directory's name is empty; name one with -o DIR");
    struct results *r = mem_zalloc(1, sizeof *r);
    if (r == NULL)
        return run_directory_no_memory(err);
    r->history_step = r->snapshot_step = r->crack_step = r->checkpoint_step = -1;
    r->stops.held = -1;
    for (size_t k = 0; k < PROFILE_MAX; k++)
        r->profile_step[k] = -1;
    r->directory = text_join(directory, "", "");
    enum dm2_status status = r->directory == NULL
                                 ? run_directory_no_memory(err)
                                 : run_directory_claim(directory, command, &r->made_directory, &r->lock, err);
    if (status != DM2_OK) {
        if (r->made_directory)
            (void)rmdir(r->directory);
        results_free(r);
        return status;
    }
    *out = r;
    return DM2_OK;
}

/* Enters the rows of history.csv, those before `step`, which the run continues from. */
static enum dm2_status replay_rows(struct results *r, int64_t step, struct dm2_error *err)
{
    struct csv table;
    enum dm2_status status = csv_read(r->tables.history.part, &table, err);
    if (status != DM2_OK)
        return status;
    status = energy_book_replay(&r->book, &table, err);
    if (status == DM2_OK && r->config->n_stops > 0)
        status = stop_watch_open(&r->stops, r->config, &table, step, err);
    csv_free(&table);
    return status;
}

/* Enters what all rows and states of the run need. */
static void start_results(struct results *r, const struct config *config, struct measure_scales scales,
                          const struct state_origin *origin)
{
    r->config = config;
    r->scales = scales;
    r->origin = origin;
    energy_book_start(&r->book, scales.energy);
}

/* Writes schedule.csv with the deck's schedule from `step` on. */
static enum dm2_status write_schedule(const struct results *r, struct schedule_book *book, int64_t step,
                                      struct dm2_error *err)
{
    char *path = text_join(r->directory, "/", schedule_book_name);
    enum dm2_status status =
        path == NULL ? run_directory_no_memory(err) : schedule_book_change(book, step, r->config, err);
    if (status == DM2_OK)
        status = schedule_book_write(path, book, err);
    free(path);
    return status;
}

static enum dm2_status open_profile(struct results *r, size_t which, struct dm2_error *err)
{
    char name[NAME_MAX_LENGTH + 16];
    (void)snprintf(name, sizeof name, "profile-%s.csv", r->config->profiles[which].name);
    char *path = text_join(r->directory, "/", name);
    if (path == NULL)
        return run_directory_no_memory(err);
    enum dm2_status status = file_create(&r->tables.profiles[which], path, err);
    free(path);
    if (status != DM2_OK)
        return status;
    history_put_profile_heading(&r->tables.profiles[which], &r->config->profiles[which]);
    return file_flush(&r->tables.profiles[which], err);
}

enum dm2_status results_begin(struct results *r, bool overwrite, const struct config *config,
                              struct measure_scales scales, const struct state_origin *origin,
                              struct dm2_error *err)
{
    struct schedule_book book = {0};
    start_results(r, config, scales, origin);
    enum dm2_status status = run_directory_clear(r->directory, overwrite, err);
    r->begun = status == DM2_OK;
    char *path = NULL;
    if (status == DM2_OK && (path = text_join(r->directory, "/", "history.csv")) == NULL)
        status = run_directory_no_memory(err);
    if (status == DM2_OK)
        status = write_schedule(r, &book, config->n_start, err);
    if (status == DM2_OK)
        status = file_create(&r->tables.history, path, err);
    if (status == DM2_OK) {
        history_put_heading(&r->tables.history, config);
        status = file_flush(&r->tables.history, err);
    }
    if (status == DM2_OK && config->n_stops > 0)
        status = replay_rows(r, 0, err);
    for (size_t k = 0; status == DM2_OK && k < config->n_profiles; k++)
        status = open_profile(r, k, err);
    schedule_book_free(&book);
    free(path);
    return status;
}

enum dm2_status results_open(const char *directory, bool overwrite, const struct config *config,
                             struct measure_scales scales, const struct state_origin *origin,
                             struct results **out, struct dm2_error *err)
{
    enum dm2_status status = results_claim(directory, "", out, err);
    if (status == DM2_OK)
        status = results_begin(*out, overwrite, config, scales, origin, err);
    if (status != DM2_OK) {
        results_abort(*out);
        *out = NULL;
    }
    return status;
}

/* --- a run that goes on --- */

/* Reads schedule.csv of the directory `source`; where there is none, the deck's schedule held so far. */
static enum dm2_status read_schedule(const struct results *r, const char *source, struct schedule_book *book,
                                     struct dm2_error *err)
{
    char *path = text_join(source, "/", schedule_book_name);
    enum dm2_status status =
        path == NULL ? run_directory_no_memory(err) : schedule_book_read(path, book, err);
    free(path);
    return status == DM2_OK && book->n == 0 ? schedule_book_change(book, r->config->n_start, r->config, err)
                                            : status;
}

/* Reads run.log of `source`, which the sessions to come add to; an unreadable one is replaced. */
static void read_log(struct results *r, const char *source)
{
    enum { LOG_MAX = 64 << 20 };
    unsigned char *bytes = NULL;
    size_t n = 0;
    char *path = text_join(source, "/", "run.log");
    if (path != NULL && file_read(path, LOG_MAX, &bytes, &n, NULL) == DM2_OK)
        bytes_put_raw(&r->log, bytes, n);
    free(bytes);
    free(path);
}

/* Takes the tables of `plan` over, which are checked first; `state` is the file of the state. */
static enum dm2_status take_over(struct results *r, struct resume *plan, bool overwrite, const char *state,
                                 struct dm2_error *err)
{
    const char *base = strrchr(state, '/');
    bool ended = strcmp(base == NULL ? state : base + 1, "final.dm2") == 0 && plan->step == r->config->steps;
    enum dm2_status status = resume_check(plan, r->config, &r->tables, err);
    if (status == DM2_OK)
        read_log(r, plan->source);
    if (status == DM2_OK && !plan->in_place)
        status = run_directory_clear(r->directory, overwrite, err);
    r->begun = status == DM2_OK;
    if (status == DM2_OK && plan->in_place) {
        r->checkpoint_step = plan->step; /* from here on the tables are kept after a failure */
        status = adopt_state(r->directory, state, ended, err);
    }
    return status == DM2_OK ? resume_take(plan, r->directory, err) : status;
}

/* Drops the snapshots of steps that the run has not come to, which an older schedule may have had. */
static enum dm2_status drop_snapshots(const struct results *r, int64_t step, struct dm2_error *err)
{
    char *directory = text_join(r->directory, "/", run_directory_snapshots);
    char *series = directory == NULL ? NULL : text_join(directory, "/", run_directory_series);
    enum dm2_status status = series == NULL
                                 ? run_directory_no_memory(err)
                                 : run_directory_drop_snapshots(directory, step, r->series.n == 0, err);
    if (status == DM2_OK && r->series.n > 0 && !file_is_absent(series))
        status = results_write_series(r, directory, err);
    free(series);
    free(directory);
    return status;
}

static int64_t count_links(const struct state *s)
{
    int64_t n = 0;
    for (size_t k = 0; k < s->n_pairs; k++)
        n += s->pairs[k].linked;
    return n;
}

enum dm2_status results_go_on(struct results *r, bool overwrite, const char *path, const struct state *state,
                              const struct config *config, struct measure_scales scales,
                              const struct state_origin *origin, struct dm2_error *err)
{
    struct schedule_book book = {0};
    int64_t step = state->step;
    char *source = run_directory_of(path);
    if (source == NULL)
        return run_directory_no_memory(err);
    start_results(r, config, scales, origin);
    struct resume plan = {.source = source,
                          .in_place = resume_in_place(r->directory, source),
                          .step = step,
                          .links = count_links(state),
                          .book = &book};
    enum dm2_status status = plan.in_place ? run_directory_check(r->directory, err) : DM2_OK;
    if (status == DM2_OK)
        status = read_schedule(r, source, &book, err);
    if (status == DM2_OK)
        status = take_over(r, &plan, overwrite, path, err);
    if (status == DM2_OK)
        status = resume_series(r->directory, &book, step, &r->series, err);
    if (status == DM2_OK && plan.in_place)
        status = drop_snapshots(r, step, err);
    if (status == DM2_OK)
        status = write_schedule(r, &book, step, err);
    if (status == DM2_OK)
        status = replay_rows(r, step, err);
    r->history_step = r->snapshot_step = r->crack_step = step - 1;
    for (size_t k = 0; k < PROFILE_MAX; k++)
        r->profile_step[k] = step - 1;
    resume_free(&plan);
    schedule_book_free(&book);
    free(source);
    return status;
}
