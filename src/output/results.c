/* The run directory.
 *
 * It holds a few tables, history.csv.part among them, that grow by some rows per measured step and are
 * renamed at the very end; everything else is written and renamed in one go. The list `known_files` is what a
 * run may leave behind: `overwrite` removes these and nothing else, so that a directory never mixes two runs.
 * Each row is handed to the system at once: somebody may be watching, and a full disk should stop the run
 * now. */
#include "dm2/output/results.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dm2/base/csv.h"
#include "dm2/base/exact.h"
#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/base/text.h"
#include "dm2/deck/schedule.h"
#include "dm2/output/state.h"
#include "fragments.h"
#include "resume.h"
#include "snapshot.h"

struct results {
    char *directory;
    bool made_directory, made_snapshots;
    const struct config *config;
    struct measure_scales scales;
    uint8_t digest[RESULTS_DIGEST_BYTES];
    struct file_out history, fragments; /* tables that grow; the second is opened with its first row */
    struct file_out profiles[PROFILE_MAX];
    int64_t history_step, snapshot_step,
        profile_step[PROFILE_MAX]; /* the newest that are written; -1: none */
    int64_t checkpoint_step;       /* of the newest one; -1: none */
    int64_t *snapshot_steps;       /* those written, for the series file */
    size_t n_snapshots, cap_snapshots;
};

static const char *const known_files[] = {
    "history.csv", "fragments.csv",  "final.dm2",           "run.log",
    "timing.csv",  "checkpoint.dm2", "checkpoint.prev.dm2", "checkpoint.next.dm2"};
static const char snapshots_name[] = "snapshots";
static const char series_name[] = "series.pvd";

static enum dm2_status no_memory(struct dm2_error *err)
{
    return dm2_fail(err, DM2_MEMORY, "no memory for the run directory's names");
}

char *results_default_directory(const char *deck_path)
{
    static const char suffix[] = ".run";
    const char *slash = strrchr(deck_path, '/');
    const char *base = slash == NULL ? deck_path : slash + 1;
    const char *dot = strrchr(base, '.');
    size_t length = dot == NULL || dot == base ? strlen(base) : (size_t)(dot - base);
    char *name = malloc(length + sizeof suffix);
    if (name != NULL) {
        memcpy(name, base, length);
        memcpy(name + length, suffix, sizeof suffix);
    }
    return name;
}

const char *results_directory(const struct results *r)
{
    return r->directory;
}

/* --- the directory --- */

static bool has_suffix(const char *name, size_t length, const char *suffix)
{
    size_t n = strlen(suffix);
    return length > n && strcmp(name + length - n, suffix) == 0;
}

/* Whether a run writes a file of this name, or its temporary one, into `snapshots/`. */
static bool is_snapshot_file(const char *name)
{
    char base[256];
    size_t length = strlen(name);
    if (length >= sizeof base)
        return false;
    memcpy(base, name, length + 1);
    if (has_suffix(base, length, ".part"))
        base[length -= strlen(".part")] = '\0';
    if (strcmp(base, series_name) == 0)
        return true;
    if (strncmp(base, "state-", 6) != 0 ||
        !(has_suffix(base, length, ".vtp") || has_suffix(base, length, ".xyz")))
        return false;
    size_t digits = strspn(base + 6, "0123456789");
    return digits > 0 && 6 + digits + 4 == length;
}

/* The same for the table of a profile. */
static bool is_profile_file(const char *name)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";
    if (strncmp(name, "profile-", 8) != 0)
        return false;
    size_t n = strspn(name + 8, letters);
    return n > 0 && (strcmp(name + 8 + n, ".csv") == 0 || strcmp(name + 8 + n, ".csv.part") == 0);
}

static enum dm2_status remove_file(const char *directory, const char *name, const char *suffix,
                                   struct dm2_error *err)
{
    char *path = text_join(directory, "/", name), *full = path == NULL ? NULL : text_join(path, suffix, "");
    enum dm2_status status = DM2_OK;
    if (full == NULL)
        status = no_memory(err);
    else if (unlink(full) != 0 && errno != ENOENT)
        status =
            dm2_fail(err, DM2_IO, "%s: cannot remove the file of an earlier run: %s", full, strerror(errno));
    free(path);
    free(full);
    return status;
}

/* Removes the files of a directory whose names are ours. */
static enum dm2_status remove_files(const char *path, bool (*ours)(const char *name), struct dm2_error *err)
{
    DIR *dir = opendir(path);
    enum dm2_status status = DM2_OK;
    if (dir == NULL && errno != ENOENT)
        status = dm2_fail(err, DM2_IO, "%s: cannot read the directory: %s", path, strerror(errno));
    const struct dirent *entry;
    while (dir != NULL && status == DM2_OK && (entry = readdir(dir)) != NULL)
        if (ours(entry->d_name))
            status = remove_file(path, entry->d_name, "", err);
    if (dir != NULL)
        closedir(dir);
    return status;
}

static enum dm2_status remove_snapshots(const char *directory, struct dm2_error *err)
{
    char *path = text_join(directory, "/", snapshots_name);
    if (path == NULL)
        return no_memory(err);
    enum dm2_status status = remove_files(path, is_snapshot_file, err);
    (void)rmdir(path); /* stays where it holds what is not ours */
    free(path);
    return status;
}

static enum dm2_status remove_earlier_run(const char *directory, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (size_t i = 0; status == DM2_OK && i < sizeof known_files / sizeof known_files[0]; i++) {
        status = remove_file(directory, known_files[i], "", err);
        if (status == DM2_OK)
            status = remove_file(directory, known_files[i], ".part", err);
    }
    if (status == DM2_OK)
        status = remove_files(directory, is_profile_file, err);
    return status == DM2_OK ? remove_snapshots(directory, err) : status;
}

/* Makes the directory and its parents. *made: the last of them was not there. */
static enum dm2_status make_directories(const char *directory, bool *made, struct dm2_error *err)
{
    char *path = text_join(directory, "", "");
    if (path == NULL)
        return no_memory(err);
    *made = false;
    enum dm2_status status = DM2_OK;
    for (char *at = path; status == DM2_OK && *at != '\0';) {
        at += strspn(at, "/");
        at += strcspn(at, "/");
        char after = *at;
        *at = '\0';
        status = file_make_directory(path, made, err);
        *at = after;
        if (after == '/' && at[strspn(at, "/")] == '\0')
            break; /* slashes at the end */
    }
    free(path);
    return status;
}

static enum dm2_status is_empty(const char *directory, bool *empty, struct dm2_error *err)
{
    DIR *dir = opendir(directory);
    if (dir == NULL)
        return dm2_fail(err, DM2_IO, "%s: cannot use it as the run directory: %s", directory,
                        strerror(errno));
    const struct dirent *entry;
    *empty = true;
    errno = 0;
    while ((entry = readdir(dir)) != NULL)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            *empty = false;
    int error = errno;
    closedir(dir);
    if (error != 0)
        return dm2_fail(err, DM2_IO, "%s: cannot read the directory: %s", directory, strerror(error));
    return DM2_OK;
}

static enum dm2_status prepare_directory(struct results *r, bool overwrite, struct dm2_error *err)
{
    bool empty = true;
    enum dm2_status status = make_directories(r->directory, &r->made_directory, err);
    if (status == DM2_OK)
        status = is_empty(r->directory, &empty, err);
    if (status != DM2_OK || empty)
        return status;
    if (!overwrite)
        return dm2_fail(err, DM2_IO,
                        "%s: the run directory is not empty; name another one with -o DIR, or give "
                        "--overwrite to replace "
                        "the results in it",
                        r->directory);
    return remove_earlier_run(r->directory, err);
}

/* --- history.csv --- */

/* Writes a header field, quoted where CSV asks for it. */
static void write_heading(struct file_out *f, const char *name, const char *unit)
{
    char text[128], quoted[256];
    (void)snprintf(text, sizeof text, unit[0] == '\0' ? "%s" : "%s [%s]", name, unit);
    (void)csv_quote(text, quoted, sizeof quoted);
    file_puts(f, quoted);
}

static void write_header(struct results *r)
{
    static const char *const columns[][2] = {
        {"step", ""},
        {"time", "us"},
        {"kinetic", "g cm2/us2"},
        {"potential", "g cm2/us2"},
        {"elastic", "g cm2/us2"},
        {"thermal", "g cm2/us2"},
        {"chemical", "g cm2/us2"},
        {"phase", "g cm2/us2"},
        {"work", "g cm2/us2"},
        {"total", "g cm2/us2"},
        {"momentum_x", "g cm/us"},
        {"momentum_y", "g cm/us"},
        {"angular_momentum", "g cm2/us"},
        {"elements", ""},
        {"links", ""},
        {"contacts", ""},
        {"temperature_max", "K"},
        {"pressure_min", "Mbar"},
        {"pressure_max", "Mbar"},
    };
    static const char *const probe_columns[][2] = {
        {"x", "cm"}, {"y", "cm"}, {"vx", "cm/us"}, {"vy", "cm/us"}};
    struct file_out *f = &r->history;
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        file_puts(f, i == 0 ? "" : ",");
        write_heading(f, columns[i][0], columns[i][1]);
    }
    for (size_t p = 0; p < r->config->n_probes; p++) {
        for (int i = 0; i < 4; i++) {
            char name[64];
            (void)snprintf(name, sizeof name, "%s_%s", r->config->probes[p].name, probe_columns[i][0]);
            file_puts(f, ",");
            write_heading(f, name, probe_columns[i][1]);
        }
    }
    file_puts(f, "\n");
}

static void add_number(struct file_out *f, double x)
{
    char text[NUMBER_TEXT_MAX + 1] = ",";
    size_t length = number_format(x, text + 1);
    file_write(f, text, length + 1);
}

/* kinetic + potential + elastic + thermal + chemical + phase - work, without a rounding between. */
static struct exact_sum conserved(const struct measures *m)
{
    struct exact_sum sum = m->work;
    sum.lo = ~sum.lo + 1u;
    sum.hi = (int64_t)(~(uint64_t)sum.hi + (sum.lo == 0 ? 1u : 0u));
    exact_merge(&sum, &m->kinetic);
    exact_merge(&sum, &m->potential);
    exact_merge(&sum, &m->elastic);
    exact_merge(&sum, &m->thermal);
    exact_merge(&sum, &m->chemical);
    exact_merge(&sum, &m->phase);
    return sum;
}

static void write_probe(struct results *r, const struct probe_sums *probe)
{
    double count = (double)probe->count; /* 0: the mean of nothing prints as nan */
    for (int a = 0; a < 2; a++)
        add_number(&r->history, exact_value(&probe->r[a], r->scales.length) / count);
    for (int a = 0; a < 2; a++)
        add_number(&r->history, exact_value(&probe->v[a], r->scales.velocity) / count);
}

enum dm2_status results_history(struct results *r, int64_t step, const struct measures *m,
                                struct dm2_error *err)
{
    struct file_out *f = &r->history;
    if (step <= r->history_step)
        return DM2_OK;
    r->history_step = step;
    struct exact_sum total = conserved(m);
    const struct exact_sum *energies[] = {&m->kinetic,  &m->potential, &m->elastic, &m->thermal,
                                          &m->chemical, &m->phase,     &m->work,    &total};
    file_printf(f, "%" PRId64, step);
    add_number(f, (double)step * r->config->dt);
    for (size_t i = 0; i < sizeof energies / sizeof energies[0]; i++)
        add_number(f, exact_value(energies[i], r->scales.energy));
    for (int a = 0; a < 2; a++)
        add_number(f, exact_value(&m->momentum[a], r->scales.momentum));
    add_number(f, exact_value(&m->angular, r->scales.momentum));
    file_printf(f, ",%" PRIu64 ",%" PRIu64 ",%" PRIu64, m->elements, m->links, m->contacts);
    add_number(f, m->t_max);
    add_number(f, m->p_min);
    add_number(f, m->p_max);
    for (size_t p = 0; p < r->config->n_probes; p++)
        write_probe(r, &m->probe[p]);
    file_puts(f, "\n");
    return file_flush(f, err);
}

/* --- profile-NAME.csv --- */

static void write_profile_header(struct file_out *f, const struct profile_config *c)
{
    static const char *const columns[][2] = {
        {"elements", ""},      {"density", "g/cm3"},  {"vx", "cm/us"},       {"vy", "cm/us"},
        {"stress_xx", "Mbar"}, {"stress_yy", "Mbar"}, {"stress_xy", "Mbar"}, {"temperature", "K"}};
    file_printf(f, "step,time [us],%s [cm]", c->axis == AXIS_X ? "x" : "y");
    for (size_t i = 0; i < sizeof columns / sizeof columns[0]; i++) {
        file_puts(f, ",");
        write_heading(f, columns[i][0], columns[i][1]);
    }
    file_puts(f, "\n");
}

static enum dm2_status open_profile(struct results *r, size_t which, struct dm2_error *err)
{
    char name[NAME_MAX_LENGTH + 16];
    (void)snprintf(name, sizeof name, "profile-%s.csv", r->config->profiles[which].name);
    char *path = text_join(r->directory, "/", name);
    if (path == NULL)
        return no_memory(err);
    enum dm2_status status = file_create(&r->profiles[which], path, err);
    free(path);
    if (status != DM2_OK)
        return status;
    write_profile_header(&r->profiles[which], &r->config->profiles[which]);
    return file_flush(&r->profiles[which], err);
}

enum dm2_status results_profile(struct results *r, size_t which, int64_t step, const struct profile_bin *bins,
                                struct dm2_error *err)
{
    const struct profile_config *c = &r->config->profiles[which];
    struct file_out *f = &r->profiles[which];
    if (step <= r->profile_step[which])
        return DM2_OK;
    r->profile_step[which] = step;
    for (size_t k = 0; k < (size_t)c->bins; k++) {
        struct profile_means m = profile_means(&bins[k], c, r->config, &r->scales);
        file_printf(f, "%" PRId64, step);
        add_number(f, (double)step * r->config->dt);
        add_number(f, profile_centre(c, k));
        file_printf(f, ",%" PRIu64, bins[k].elements);
        const double means[] = {m.density,   m.velocity[0], m.velocity[1], m.stress[0],
                                m.stress[1], m.stress[2],   m.temperature};
        for (size_t i = 0; i < sizeof means / sizeof means[0]; i++)
            add_number(f, means[i]);
        file_puts(f, "\n");
    }
    return file_flush(f, err);
}

/* --- states --- */

static enum dm2_status write_one(const char *directory, const char *suffix, const struct snapshot *s,
                                 struct dm2_error *err)
{
    char name[SNAPSHOT_NAME_MAX];
    snapshot_file_name(s->step, suffix, name);
    char *path = text_join(directory, "/", name);
    if (path == NULL)
        return no_memory(err);
    enum dm2_status status =
        strcmp(suffix, "vtp") == 0 ? snapshot_write_vtp(path, s, err) : snapshot_write_xyz(path, s, err);
    free(path);
    return status;
}

static enum dm2_status write_series(struct results *r, const char *directory, int64_t step,
                                    struct dm2_error *err)
{
    void *steps = r->snapshot_steps;
    if (mem_grow(&steps, &r->cap_snapshots, r->n_snapshots, r->n_snapshots + 1, sizeof *r->snapshot_steps) !=
        0)
        return no_memory(err);
    r->snapshot_steps = steps;
    r->snapshot_steps[r->n_snapshots++] = step;
    char *path = text_join(directory, "/", series_name);
    if (path == NULL)
        return no_memory(err);
    enum dm2_status status =
        snapshot_write_series(path, r->snapshot_steps, r->n_snapshots, r->config->dt, err);
    free(path);
    return status;
}

/* Adds a row to fragments.csv. */
static enum dm2_status write_fragments(struct results *r, int64_t step, const struct fragment_counts *counts,
                                       struct dm2_error *err)
{
    struct file_out *f = &r->fragments;
    if (f->path == NULL) {
        char *path = text_join(r->directory, "/", "fragments.csv");
        enum dm2_status status = path == NULL ? no_memory(err) : file_create(f, path, err);
        free(path);
        if (status != DM2_OK)
            return status;
        file_puts(f, "step,time [us],fragments,single,largest\n");
    }
    file_printf(f, "%" PRId64, step);
    add_number(f, (double)step * r->config->dt);
    file_printf(f, ",%zu,%zu,%zu\n", counts->fragments, counts->single, counts->largest);
    return file_flush(f, err);
}

static enum dm2_status write_snapshot(struct results *r, const struct snapshot *s, struct dm2_error *err)
{
    char *directory = text_join(r->directory, "/", snapshots_name);
    if (directory == NULL)
        return no_memory(err);
    bool made;
    enum dm2_status status = file_make_directory(directory, &made, err);
    r->made_snapshots |= made;
    if (status == DM2_OK && r->config->output.vtp) {
        status = write_one(directory, "vtp", s, err);
        if (status == DM2_OK)
            status = write_series(r, directory, s->step, err);
    }
    if (status == DM2_OK && r->config->output.xyz)
        status = write_one(directory, "xyz", s, err);
    free(directory);
    return status;
}

enum dm2_status results_snapshot(struct results *r, int64_t step, const struct element *elements,
                                 const struct element_measure *measured, size_t n_elements,
                                 const struct pair_record *pairs, size_t n_pairs, struct dm2_error *err)
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
        status = write_snapshot(
            r, &(struct snapshot){r->config, step, elements, measured, n_elements, pairs, n_pairs, fragment},
            err);
    if (status == DM2_OK)
        r->snapshot_step = step;
    free(fragment);
    return status;
}

/* The state as one of this run. */
static enum dm2_status write_state(const struct results *r, const char *path, const struct state_view *state,
                                   struct dm2_error *err)
{
    struct state_view s = *state;
    s.digest = r->digest;
    return state_write(path, &s, err);
}

enum dm2_status results_final(struct results *r, const struct state_view *state, struct dm2_error *err)
{
    char *path = text_join(r->directory, "/", "final.dm2");
    if (path == NULL)
        return no_memory(err);
    enum dm2_status status = write_state(r, path, state, err);
    free(path);
    return status;
}

enum dm2_status results_text(struct results *r, const char *name, const char *text, size_t length,
                             struct dm2_error *err)
{
    assert(strcmp(name, "run.log") == 0 || strcmp(name, "timing.csv") == 0);
    char *path = text_join(r->directory, "/", name);
    if (path == NULL)
        return no_memory(err);
    enum dm2_status status = file_replace(path, text, length, err);
    free(path);
    return status;
}

/* --- begin and end --- */

static void free_results(struct results *r)
{
    free(r->directory);
    free(r->snapshot_steps);
    free(r);
}

/* An object for the run, without its directory. */
static enum dm2_status start(const char *directory, const struct config *config, struct measure_scales scales,
                             const uint8_t digest[RESULTS_DIGEST_BYTES], struct results **out,
                             struct dm2_error *err)
{
    *out = NULL;
    if (directory[0] == '\0')
        return dm2_fail(err, DM2_IO, "the run directory's name is empty; name one with -o DIR");
    struct results *r = mem_zalloc(1, sizeof *r);
    if (r == NULL)
        return no_memory(err);
    r->config = config;
    r->scales = scales;
    r->history_step = r->snapshot_step = r->checkpoint_step = -1;
    for (size_t k = 0; k < PROFILE_MAX; k++)
        r->profile_step[k] = -1;
    memcpy(r->digest, digest, sizeof r->digest);
    r->directory = text_join(directory, "", "");
    if (r->directory == NULL) {
        free_results(r);
        return no_memory(err);
    }
    *out = r;
    return DM2_OK;
}

enum dm2_status results_open(const char *directory, bool overwrite, const struct config *config,
                             struct measure_scales scales, const uint8_t digest[RESULTS_DIGEST_BYTES],
                             struct results **out, struct dm2_error *err)
{
    struct results *r;
    enum dm2_status status = start(directory, config, scales, digest, &r, err);
    *out = NULL;
    if (status != DM2_OK)
        return status;
    status = prepare_directory(r, overwrite, err);
    char *path = NULL;
    if (status == DM2_OK && (path = text_join(directory, "/", "history.csv")) == NULL)
        status = no_memory(err);
    if (status == DM2_OK)
        status = file_create(&r->history, path, err);
    if (status == DM2_OK) {
        write_header(r);
        status = file_flush(&r->history, err);
    }
    free(path);
    for (size_t k = 0; status == DM2_OK && k < config->n_profiles; k++)
        status = open_profile(r, k, err);
    if (status != DM2_OK) {
        results_abort(r);
        return status;
    }
    *out = r;
    return DM2_OK;
}

/* --- checkpoints --- */

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

/* Takes one table over from the directory `source`: its .part file, or the file of a run that came to its
 * end. */
static enum dm2_status continue_table(const struct results *r, const char *source, bool here,
                                      const char *name, const struct resume_plan *plan, struct file_out *f,
                                      struct dm2_error *err)
{
    unsigned char *text = NULL;
    size_t n = 0, keep = 0;
    char *from = text_join(source, "/", name), *part = from == NULL ? NULL : text_join(from, ".part", "");
    char *to = text_join(r->directory, "/", name);
    enum dm2_status status = part == NULL || to == NULL ? no_memory(err) : DM2_OK;
    bool whole = status == DM2_OK && access(part, F_OK) != 0;
    if (status == DM2_OK)
        status = file_read(whole ? from : part, SIZE_MAX / 4, &text, &n, err);
    if (status == DM2_OK)
        status = resume_keep(whole ? from : part, text, n, plan, &keep, err);
    if (status == DM2_OK && here && whole)
        status = file_rename(from, part, err);
    if (status == DM2_OK && here) {
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

static enum dm2_status continue_tables(struct results *r, const char *source, bool here, int64_t step,
                                       struct dm2_error *err)
{
    const struct config *c = r->config;
    struct resume_plan plan = {.due = history_due, .context = c, .rows = 1, .step = step};
    enum dm2_status status = continue_table(r, source, here, "history.csv", &plan, &r->history, err);
    for (size_t k = 0; k < c->n_profiles && status == DM2_OK; k++) {
        char name[NAME_MAX_LENGTH + 16];
        struct profile_due which = {c, k};
        plan = (struct resume_plan){
            .due = profile_due, .context = &which, .rows = c->profiles[k].bins, .step = step};
        (void)snprintf(name, sizeof name, "profile-%s.csv", c->profiles[k].name);
        status = continue_table(r, source, here, name, &plan, &r->profiles[k], err);
    }
    bool fragments = false;
    for (int64_t s = 0; s < step && !fragments; s++)
        fragments = schedule_snapshot(c, s);
    plan = (struct resume_plan){.due = snapshot_due, .context = c, .rows = 1, .step = step};
    if (status == DM2_OK && fragments)
        status = continue_table(r, source, here, "fragments.csv", &plan, &r->fragments, err);
    return status;
}

/* The snapshots of earlier steps that are in the directory stay in the series. */
static enum dm2_status continue_series(struct results *r, int64_t step, struct dm2_error *err)
{
    char *directory = text_join(r->directory, "/", snapshots_name);
    enum dm2_status status = directory == NULL ? no_memory(err) : DM2_OK;
    for (int64_t s = 0; s < step && status == DM2_OK && r->config->output.vtp; s++) {
        char name[SNAPSHOT_NAME_MAX];
        if (!schedule_snapshot(r->config, s))
            continue;
        snapshot_file_name(s, "vtp", name);
        char *path = text_join(directory, "/", name);
        void *steps = r->snapshot_steps;
        if (path == NULL || mem_grow(&steps, &r->cap_snapshots, r->n_snapshots, r->n_snapshots + 1,
                                     sizeof *r->snapshot_steps) != 0)
            status = no_memory(err);
        else
            r->snapshot_steps = steps;
        if (status == DM2_OK && access(path, F_OK) == 0)
            r->snapshot_steps[r->n_snapshots++] = s;
        free(path);
    }
    free(directory);
    return status;
}

static bool same_directory(const char *a, const char *b)
{
    struct stat one, other;
    return stat(a, &one) == 0 && stat(b, &other) == 0 && one.st_dev == other.st_dev &&
           one.st_ino == other.st_ino;
}

enum dm2_status results_continue(const char *directory, bool overwrite, const char *source, int64_t step,
                                 const struct config *config, struct measure_scales scales,
                                 const uint8_t digest[RESULTS_DIGEST_BYTES], struct results **out,
                                 struct dm2_error *err)
{
    struct results *r;
    enum dm2_status status = start(directory, config, scales, digest, &r, err);
    *out = NULL;
    if (status != DM2_OK)
        return status;
    bool here = same_directory(directory, source);
    if (here)
        r->checkpoint_step = step;
    else
        status = prepare_directory(r, overwrite, err);
    if (status == DM2_OK)
        status = continue_tables(r, source, here, step, err);
    if (status == DM2_OK)
        status = continue_series(r, step, err);
    r->history_step = r->snapshot_step = step - 1;
    for (size_t k = 0; k < PROFILE_MAX; k++)
        r->profile_step[k] = step - 1;
    if (status != DM2_OK) {
        results_abort(r);
        return status;
    }
    *out = r;
    return DM2_OK;
}

int64_t results_checkpoint_step(const struct results *r)
{
    return r->checkpoint_step;
}

static enum dm2_status sync_tables(struct results *r, struct dm2_error *err)
{
    enum dm2_status status = file_sync(&r->history, err);
    for (size_t k = 0; status == DM2_OK && k < r->config->n_profiles; k++)
        status = file_sync(&r->profiles[k], err);
    if (status == DM2_OK && r->fragments.path != NULL)
        status = file_sync(&r->fragments, err);
    return status;
}

enum dm2_status results_checkpoint(struct results *r, const struct state_view *state, struct dm2_error *err)
{
    char *now = text_join(r->directory, "/", "checkpoint.dm2");
    char *next = text_join(r->directory, "/", "checkpoint.next.dm2");
    char *before = text_join(r->directory, "/", "checkpoint.prev.dm2");
    enum dm2_status status =
        now == NULL || next == NULL || before == NULL ? no_memory(err) : sync_tables(r, err);
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
    enum dm2_status status = file_flush(&r->history, err); /* a failure of old gives no table its name */
    for (size_t k = 0; status == DM2_OK && k < r->config->n_profiles; k++)
        status = file_commit(&r->profiles[k], err);
    if (status == DM2_OK && r->fragments.path != NULL)
        status = file_commit(&r->fragments, err);
    if (status == DM2_OK)
        status = file_commit(&r->history, err);
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
    leave(&r->history);
    leave(&r->fragments);
    for (size_t k = 0; k < PROFILE_MAX; k++)
        leave(&r->profiles[k]);
    char *snapshots = text_join(r->directory, "/", snapshots_name);
    if (snapshots != NULL && r->made_snapshots)
        (void)rmdir(snapshots); /* both fail where something complete is inside, as they should */
    free(snapshots);
    if (r->made_directory)
        (void)rmdir(r->directory);
    free_results(r);
}
