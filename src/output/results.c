/* The files of a run, in the order in which a run writes them.
 *
 * The tables grow by rows and are renamed at the end of the run; every other file is written and renamed at
 * once. */
#include "results_parts.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/mem.h"
#include "dm2/base/text.h"
#include "dm2/output/run_directory.h"
#include "cracks.h"
#include "schedule_book.h"

const char *results_directory(const struct results *r)
{
    return r->directory;
}

const char *results_warning(const struct results *r)
{
    return r->lock.warning;
}

/* --- tables --- */

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

/* Adds a step to the series of the snapshots in `directory`. */
static enum dm2_status add_to_series(struct results *r, const char *directory, int64_t step,
                                     struct dm2_error *err)
{
    struct snapshot_steps *series = &r->series;
    int64_t *grown = mem_grown(series->items, &series->cap, series->n, series->n + 1, sizeof *grown);
    if (grown == NULL)
        return run_directory_no_memory(err);
    series->items = grown;
    series->items[series->n++] = step;
    return results_write_series(r, directory, err);
}

enum dm2_status results_write_series(const struct results *r, const char *directory, struct dm2_error *err)
{
    char *path = text_join(directory, "/", run_directory_series);
    if (path == NULL)
        return run_directory_no_memory(err);
    enum dm2_status status = snapshot_write_series(path, r->series.items, r->series.n, r->config, err);
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
            status = add_to_series(r, directory, s->step, err);
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

void results_free(struct results *r)
{
    run_lock_release(&r->lock);
    stop_watch_free(&r->stops);
    bytes_free(&r->log);
    free(r->directory);
    free(r->series.items);
    free(r);
}

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
        results_free(r);
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
    results_free(r);
}
