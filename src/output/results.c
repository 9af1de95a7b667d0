/* The files of a run, in the order in which a run writes them.
 *
 * The tables grow by rows and are renamed at the end of the run; every other file is written and renamed at
 * once. */
#include "dm2/output/results.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/bytes.h"
#include "dm2/base/csv.h"
#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/text.h"
#include "dm2/output/run_directory.h"
#include "dm2/output/state.h"
#include "adopt.h"
#include "cracks.h"
#include "energy_book.h"
#include "fragments.h"
#include "history.h"
#include "resume.h"
#include "run_lock.h"
#include "schedule_book.h"
#include "snapshot.h"
#include "stop_watch.h"

struct results {
    char *directory;
    bool made_directory, made_snapshots; /* by this run */
    bool begun;                          /* files of this run are in the directory */
    struct run_lock lock;
    struct bytes_writer log; /* run.log */
    const struct config *config;
    struct measure_scales scales;
    const struct state_origin *origin;
    struct history_tables tables;
    struct energy_book book; /* of the rows of tables.history */
    struct stop_watch stops; /* likewise; not open in a deck without blocks `stop` */
    bool made_final;         /* final.dm2, by this run */
    /* The newest steps that are written; -1: none. */
    int64_t history_step, snapshot_step, profile_step[PROFILE_MAX], crack_step, checkpoint_step;
    struct snapshot_steps series; /* the snapshots that are written, for series.pvd */
};

const char *results_directory(const struct results *r)
{
    return r->directory;
}

const char *results_warning(const struct results *r)
{
    return r->lock.warning;
}

/* --- tables --- */

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

/* A run that ends early leaves no final state (dm2/output/results.h). */
static void remove_final(const struct results *r)
{
    char *path = r->made_final ? text_join(r->directory, "/", "final.dm2") : NULL;
    if (path != NULL)
        (void)unlink(path);
    free(path);
}

enum dm2_status results_history(struct results *r, int64_t step, const struct measures *m,
                                struct dm2_error *err)
{
    if (step <= r->history_step)
        return DM2_OK;
    r->history_step = step;
    struct book_row row = history_book_row(&r->scales, step, m);
    double drift = energy_book_add(&r->book, &row);
    struct file_out *f = &r->tables.history;
    history_put_row(f, r->config, &r->scales, step, m, drift);
    if (r->config->n_stops > 0)
        stop_watch_row(&r->stops, step, (const char *)f->buffer, f->used);
    enum dm2_status status = file_flush(f, err);
    if (status == DM2_OK)
        status = energy_book_check(&r->book, r->config->dt, err);
    if (status != DM2_OK)
        remove_final(r);
    return status;
}

bool results_stopped(const struct results *r, int64_t *end)
{
    *end = r->stops.held + STOP_LAG;
    return r->stops.held >= 0;
}

bool results_warns(struct results *r, char line[RESULTS_LINE])
{
    return energy_book_warns(&r->book, r->config->dt, line);
}

void results_verdict(const struct results *r, struct results_verdict *out)
{
    energy_book_verdict(&r->book, r->config->dt, out);
    stop_watch_describe(&r->stops, out->stop);
}

enum dm2_status results_profile(struct results *r, size_t which, int64_t step, const struct profile_bin *bins,
                                struct dm2_error *err)
{
    if (step <= r->profile_step[which])
        return DM2_OK;
    r->profile_step[which] = step;
    return history_put_profile(&r->tables.profiles[which], r->config, &r->scales, which, step, bins, err);
}

enum dm2_status results_cracks(struct results *r, int64_t step, struct crack_list *list,
                               struct dm2_error *err)
{
    struct file_out *f = &r->tables.cracks;
    if (step <= r->crack_step || list->n == 0)
        return DM2_OK;
    r->crack_step = step;
    if (f->path == NULL) {
        char *path = text_join(r->directory, "/", cracks_table);
        enum dm2_status status = path == NULL ? run_directory_no_memory(err) : file_create(f, path, err);
        free(path);
        if (status != DM2_OK)
            return status;
        cracks_put_heading(f);
    }
    return cracks_put(f, r->config, step, list, err);
}

/* --- states --- */

static enum dm2_status write_snapshot_file(const char *directory, const char *suffix,
                                           const struct snapshot *s, struct dm2_error *err)
{
    char name[SNAPSHOT_NAME_MAX];
    snapshot_file_name(s->step, suffix, name);
    char *path = text_join(directory, "/", name);
    if (path == NULL)
        return run_directory_no_memory(err);
    enum dm2_status status =
        strcmp(suffix, "vtp") == 0 ? snapshot_write_vtp(path, s, err) : snapshot_write_xyz(path, s, err);
    free(path);
    return status;
}

static enum dm2_status write_series(struct results *r, const char *directory, int64_t step,
                                    struct dm2_error *err)
{
    struct snapshot_steps *series = &r->series;
    int64_t *grown = mem_grown(series->items, &series->cap, series->n, series->n + 1, sizeof *grown);
    if (grown == NULL)
        return run_directory_no_memory(err);
    series->items = grown;
    series->items[series->n++] = step;
    char *path = text_join(directory, "/", run_directory_series);
    if (path == NULL)
        return run_directory_no_memory(err);
    enum dm2_status status = snapshot_write_series(path, series->items, series->n, r->config, err);
    free(path);
    return status;
}

/* Adds a row to fragments.csv, which its first row creates. */
static enum dm2_status write_fragments(struct results *r, int64_t step, const struct fragment_counts *counts,
                                       struct dm2_error *err)
{
    struct file_out *f = &r->tables.fragments;
    if (f->path == NULL) {
        char *path = text_join(r->directory, "/", "fragments.csv");
        enum dm2_status status = path == NULL ? run_directory_no_memory(err) : file_create(f, path, err);
        free(path);
        if (status != DM2_OK)
            return status;
        history_put_fragments_heading(f);
    }
    return history_put_fragments(f, r->config, step, counts, err);
}

static enum dm2_status write_snapshot(struct results *r, const struct snapshot *s, struct dm2_error *err)
{
    char *directory = text_join(r->directory, "/", run_directory_snapshots);
    if (directory == NULL)
        return run_directory_no_memory(err);
    bool made;
    enum dm2_status status = file_make_directory(directory, &made, err);
    r->made_snapshots |= made;
    if (status == DM2_OK && !made)
        status = file_check_directory(directory, err);
    if (status == DM2_OK && r->config->output.vtp) {
        status = write_snapshot_file(directory, "vtp", s, err);
        if (status == DM2_OK)
            status = write_series(r, directory, s->step, err);
    }
    if (status == DM2_OK && r->config->output.xyz)
        status = write_snapshot_file(directory, "xyz", s, err);
    free(directory);
    return status;
}

enum dm2_status results_snapshot(struct results *r, int64_t step, const struct element *elements,
                                 const struct element_measure *measured, size_t n_elements,
                                 const struct pair_record *pairs, const struct pair_measure *forces,
                                 size_t n_pairs, const struct snapshot_walls *walls, struct dm2_error *err)
{
    struct fragment_counts counts;
    if (step <= r->snapshot_step)
        return DM2_OK;
    uint32_t *fragment = mem_alloc(n_elements, sizeof *fragment);
    if (fragment == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the fragments of %zu elements", n_elements);
    enum dm2_status status = fragments_find(elements, n_elements, pairs, n_pairs, fragment, &counts, err);
    if (status == DM2_OK)
        status = write_fragments(r, step, &counts, err);
    if (status == DM2_OK)
        status = write_snapshot(r,
                                &(struct snapshot){r->config, step, elements, measured, n_elements, pairs,
                                                   forces, n_pairs, fragment, walls},
                                err);
    if (status == DM2_OK)
        r->snapshot_step = step;
    free(fragment);
    return status;
}

/* Writes the state with this run's origin. */
static enum dm2_status write_state(const struct results *r, const char *path, const struct state_view *state,
                                   struct dm2_error *err)
{
    struct state_view s = *state;
    s.origin = r->origin;
    return state_write(path, &s, err);
}

/* Adds a line to schedule.csv where a block `stop` has ended the run at `step`. */
static enum dm2_status note_stop(const struct results *r, int64_t step, struct dm2_error *err)
{
    struct schedule_book book = {0};
    int64_t end;
    if (!results_stopped(r, &end) || end != step)
        return DM2_OK;
    char *path = text_join(r->directory, "/", schedule_book_name);
    enum dm2_status status =
        path == NULL ? run_directory_no_memory(err) : schedule_book_read(path, &book, err);
    const struct schedule_line *line = schedule_book_line(&book, "stop", step);
    if (status == DM2_OK && (line == NULL || line->from != step)) {
        status = schedule_book_stop(&book, step, err);
        if (status == DM2_OK)
            status = schedule_book_write(path, &book, err);
    }
    schedule_book_free(&book);
    free(path);
    return status;
}

enum dm2_status results_final(struct results *r, const struct state_view *state, struct dm2_error *err)
{
    char *path = text_join(r->directory, "/", "final.dm2");
    if (path == NULL)
        return run_directory_no_memory(err);
    enum dm2_status status = note_stop(r, state->step, err);
    if (status == DM2_OK)
        status = write_state(r, path, state, err);
    r->made_final |= status == DM2_OK;
    free(path);
    return status;
}

enum dm2_status results_text(struct results *r, const char *name, const char *text, size_t length,
                             struct dm2_error *err)
{
    assert(strcmp(name, "run.log") == 0 || strcmp(name, "timing.csv") == 0 || strcmp(name, "deck.dm2") == 0);
    char *path = text_join(r->directory, "/", name);
    if (path == NULL)
        return run_directory_no_memory(err);
    enum dm2_status status = file_replace(path, text, length, err);
    free(path);
    return status;
}

enum dm2_status results_log(struct results *r, const char *text, size_t length, struct dm2_error *err)
{
    bytes_put_raw(&r->log, text, length);
    return r->log.failed ? dm2_fail(err, DM2_MEMORY, "no memory for the run's log")
                         : results_text(r, "run.log", (const char *)r->log.data, r->log.length, err);
}

/* --- the begin --- */

static void free_results(struct results *r)
{
    run_lock_release(&r->lock);
    stop_watch_free(&r->stops);
    bytes_free(&r->log);
    free(r->directory);
    free(r->series.items);
    free(r);
}

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
        free_results(r);
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

/* --- checkpoints --- */

int64_t results_checkpoint_step(const struct results *r)
{
    return r->checkpoint_step;
}

static enum dm2_status sync_tables(struct results *r, struct dm2_error *err)
{
    enum dm2_status status = file_sync(&r->tables.history, err);
    for (size_t k = 0; status == DM2_OK && k < r->config->n_profiles; k++)
        status = file_sync(&r->tables.profiles[k], err);
    if (status == DM2_OK && r->tables.fragments.path != NULL)
        status = file_sync(&r->tables.fragments, err);
    if (status == DM2_OK && r->tables.cracks.path != NULL)
        status = file_sync(&r->tables.cracks, err);
    return status;
}

enum dm2_status results_checkpoint(struct results *r, const struct state_view *state, struct dm2_error *err)
{
    char *now = text_join(r->directory, "/", "checkpoint.dm2");
    char *next = text_join(r->directory, "/", "checkpoint.next.dm2");
    char *before = text_join(r->directory, "/", "checkpoint.prev.dm2");
    enum dm2_status status =
        now == NULL || next == NULL || before == NULL ? run_directory_no_memory(err) : sync_tables(r, err);
    if (status == DM2_OK)
        status = write_state(r, next, state, err);
    if (status == DM2_OK && access(now, F_OK) == 0)
        status = file_rename(now, before, err);
    if (status == DM2_OK)
        status = file_rename(next, now, err);
    if (status == DM2_OK)
        r->checkpoint_step = state->step;
    free(now);
    free(next);
    free(before);
    return status;
}

/* --- the end --- */

enum dm2_status results_close(struct results *r, struct dm2_error *err)
{
    enum dm2_status status =
        file_flush(&r->tables.history, err); /* after an earlier failure no table gets its name */
    for (size_t k = 0; status == DM2_OK && k < r->config->n_profiles; k++)
        status = file_commit(&r->tables.profiles[k], err);
    if (status == DM2_OK && r->tables.fragments.path != NULL)
        status = file_commit(&r->tables.fragments, err);
    if (status == DM2_OK && r->tables.cracks.path != NULL)
        status = file_commit(&r->tables.cracks, err);
    if (status == DM2_OK)
        status = file_commit(&r->tables.history, err);
    if (status != DM2_OK)
        results_abort(r);
    else
        free_results(r);
    return status;
}

void results_abort(struct results *r)
{
    if (r == NULL)
        return;
    void (*leave)(struct file_out *) = r->checkpoint_step >= 0 ? file_suspend : file_abandon;
    leave(&r->tables.history);
    leave(&r->tables.fragments);
    leave(&r->tables.cracks);
    for (size_t k = 0; k < PROFILE_MAX; k++)
        leave(&r->tables.profiles[k]);
    char *snapshots = text_join(r->directory, "/", run_directory_snapshots);
    if (snapshots != NULL && r->made_snapshots)
        (void)rmdir(snapshots); /* both rmdir fail on a directory that holds complete files, as they should */
    free(snapshots);
    if (r->begun && r->checkpoint_step < 0)
        run_directory_remove_notes(r->directory);
    run_lock_release(&r->lock);
    if (r->made_directory)
        (void)rmdir(r->directory);
    free_results(r);
}
