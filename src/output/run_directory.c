/* The list `known_files` and the names that is_snapshot_file and is_profile_file accept cover every file that
 * a run writes. */
#include "dm2/output/run_directory.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/file.h"
#include "dm2/base/text.h"
#include "run_lock.h"

const char run_directory_snapshots[] = "snapshots";
const char run_directory_series[] = "series.pvd";

static const char *const known_files[] = {
    "history.csv", "fragments.csv", "cracks.csv",     "schedule.csv",        "final.dm2",          "run.log",
    "timing.csv",  "deck.dm2",      "checkpoint.dm2", "checkpoint.prev.dm2", "checkpoint.next.dm2"};

/* Of known_files: the states, and what a run has in its directory from the start. */
static const char *const states[] = {"final.dm2", "checkpoint.dm2", "checkpoint.prev.dm2"};
static const char *const notes[] = {"deck.dm2", "run.log", "schedule.csv"};
enum { STATES = sizeof states / sizeof states[0], NOTES = sizeof notes / sizeof notes[0] };

enum dm2_status run_directory_no_memory(struct dm2_error *err)
{
    return dm2_fail(err, DM2_MEMORY, "no memory for the run directory's names");
}

char *run_directory_default(const char *deck_path)
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

char *run_directory_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *directory = text_join(slash == NULL ? "." : path, "", "");
    if (directory != NULL && slash != NULL)
        directory[slash == path ? 1 : slash - path] = '\0';
    return directory;
}

/* --- the files of an earlier run --- */

static bool has_suffix(const char *name, size_t length, const char *suffix)
{
    size_t n = strlen(suffix);
    return length > n && strcmp(name + length - n, suffix) == 0;
}

/* Whether `name` in the directory of the snapshots is a run's file, or the temporary name of such a file. */
static bool is_snapshot_file(const char *name)
{
    char base[256];
    size_t length = strlen(name);
    if (length >= sizeof base)
        return false;
    memcpy(base, name, length + 1);
    if (has_suffix(base, length, ".part"))
        base[length -= strlen(".part")] = '\0';
    if (strcmp(base, run_directory_series) == 0)
        return true;
    if (strncmp(base, "state-", 6) != 0 ||
        !(has_suffix(base, length, ".vtp") || has_suffix(base, length, ".xyz")))
        return false;
    size_t digits = strspn(base + 6, "0123456789");
    return digits > 0 && 6 + digits + 4 == length;
}

/* Whether `name` in the run directory is the table of a profile, or the temporary name of such a table. */
static bool is_profile_file(const char *name)
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_";
    if (strncmp(name, "profile-", 8) != 0)
        return false;
    size_t n = strspn(name + 8, letters);
    return n > 0 && (strcmp(name + 8 + n, ".csv") == 0 || strcmp(name + 8 + n, ".csv.part") == 0);
}

/* What is done to each file of a run. */
typedef enum dm2_status (*file_action)(const char *path, struct dm2_error *err);

static enum dm2_status check_file(const char *path, struct dm2_error *err)
{
    bool absent;
    return file_check_name(path, &absent, err);
}

static enum dm2_status remove_file(const char *path, struct dm2_error *err)
{
    if (unlink(path) != 0 && errno != ENOENT)
        return dm2_fail(err, DM2_IO, "%s: cannot remove the file of an earlier run: %s", path,
                        strerror(errno));
    return DM2_OK;
}

static enum dm2_status visit_file(const char *directory, const char *name, const char *suffix,
                                  file_action action, struct dm2_error *err)
{
    char *path = text_join(directory, "/", name), *full = path == NULL ? NULL : text_join(path, suffix, "");
    enum dm2_status status = full == NULL ? run_directory_no_memory(err) : action(full, err);
    free(path);
    free(full);
    return status;
}

/* Visits the files of a directory whose names `ours` accepts. An absent directory is empty. */
static enum dm2_status visit_files(const char *path, bool (*ours)(const char *name), file_action action,
                                   struct dm2_error *err)
{
    DIR *dir = opendir(path);
    enum dm2_status status = DM2_OK;
    if (dir == NULL && errno != ENOENT)
        status = dm2_fail(err, DM2_IO, "%s: cannot read the directory: %s", path, strerror(errno));
    const struct dirent *entry;
    while (dir != NULL && status == DM2_OK && (entry = readdir(dir)) != NULL)
        if (ours(entry->d_name))
            status = visit_file(path, entry->d_name, "", action, err);
    if (dir != NULL)
        closedir(dir);
    return status;
}

/* Visits all files that a run has written or may write. */
static enum dm2_status visit_run(const char *directory, file_action action, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (size_t i = 0; status == DM2_OK && i < sizeof known_files / sizeof known_files[0]; i++) {
        status = visit_file(directory, known_files[i], "", action, err);
        if (status == DM2_OK)
            status = visit_file(directory, known_files[i], ".part", action, err);
    }
    if (status == DM2_OK)
        status = visit_files(directory, is_profile_file, action, err);
    char *snapshots = text_join(directory, "/", run_directory_snapshots);
    if (snapshots == NULL)
        return run_directory_no_memory(err);
    if (status == DM2_OK)
        status = file_check_directory(snapshots, err);
    if (status == DM2_OK)
        status = visit_files(snapshots, is_snapshot_file, action, err);
    free(snapshots);
    return status;
}

static enum dm2_status remove_earlier_run(const char *directory, struct dm2_error *err)
{
    enum dm2_status status = visit_run(directory, check_file, err);
    if (status == DM2_OK)
        status = visit_run(directory, remove_file, err);
    char *snapshots = status == DM2_OK ? text_join(directory, "/", run_directory_snapshots) : NULL;
    if (snapshots != NULL)
        (void)rmdir(snapshots); /* a directory with files of other origin stays */
    free(snapshots);
    return status;
}

enum dm2_status run_directory_drop_snapshots(const char *directory, int64_t from, bool series,
                                             struct dm2_error *err)
{
    DIR *dir = opendir(directory);
    enum dm2_status status = DM2_OK;
    if (dir == NULL && errno != ENOENT)
        status = dm2_fail(err, DM2_IO, "%s: cannot read the directory: %s", directory, strerror(errno));
    const struct dirent *entry;
    while (dir != NULL && status == DM2_OK && (entry = readdir(dir)) != NULL) {
        const char *name = entry->d_name;
        bool is_series = strncmp(name, run_directory_series, strlen(run_directory_series)) == 0;
        if (is_snapshot_file(name) && (is_series ? series : strtoll(name + 6, NULL, 10) >= from))
            status = visit_file(directory, name, "", remove_file, err);
    }
    if (dir != NULL)
        closedir(dir);
    return status;
}

/* --- preparing --- */

/* Makes the directory and its parents. *made: the last of them did not exist. */
static enum dm2_status make_directories(const char *directory, bool *made, struct dm2_error *err)
{
    char *path = text_join(directory, "", "");
    if (path == NULL)
        return run_directory_no_memory(err);
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
            break; /* only slashes are left */
    }
    free(path);
    return status;
}

/* Counts one name of the run directory. */
static void count_file(struct run_content *c, const char *name)
{
    bool state = false, note = false, part = has_suffix(name, strlen(name), ".part");
    for (size_t k = 0; k < STATES; k++)
        state |= strcmp(name, states[k]) == 0;
    for (size_t k = 0; k < NOTES; k++)
        note |= strcmp(name, notes[k]) == 0;
    c->files++;
    c->states += state;
    if (!part)
        c->others += !state && !note && strcmp(name, "checkpoint.next.dm2") != 0 &&
                     strcmp(name, run_directory_snapshots) != 0;
    else if (has_suffix(name, strlen(name), ".csv.part"))
        c->tables++;
}

enum dm2_status run_directory_survey(const char *directory, struct run_content *out, struct dm2_error *err)
{
    *out = (struct run_content){0};
    DIR *dir = opendir(directory);
    if (dir == NULL)
        return dm2_fail(err, DM2_IO, "%s: cannot use it as the run directory: %s", directory,
                        strerror(errno));
    const struct dirent *entry;
    errno = 0;
    while ((entry = readdir(dir)) != NULL)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 &&
            strcmp(entry->d_name, run_lock_name) != 0)
            count_file(out, entry->d_name);
    int error = errno;
    closedir(dir);
    if (error != 0)
        return dm2_fail(err, DM2_IO, "%s: cannot read the directory: %s", directory, strerror(error));
    return DM2_OK;
}

enum dm2_status run_directory_check(const char *path, struct dm2_error *err)
{
    return visit_run(path, check_file, err);
}

enum dm2_status run_directory_claim(const char *path, const char *command, bool *made, struct run_lock *lock,
                                    struct dm2_error *err)
{
    struct run_content content;
    enum dm2_status status = make_directories(path, made, err);
    if (status == DM2_OK)
        status = run_directory_survey(path, &content, err); /* is it a directory? */
    return status == DM2_OK ? run_lock_take(lock, path, command, err) : status;
}

enum dm2_status run_directory_clear(const char *path, bool overwrite, struct dm2_error *err)
{
    struct run_content content;
    enum dm2_status status = run_directory_survey(path, &content, err);
    if (status != DM2_OK || content.files == 0)
        return status;
    if (!overwrite)
        return dm2_fail(err, DM2_IO,
                        "%s: the run directory is not empty; %sname another one with -o DIR, or give "
                        "--overwrite to replace the results in it",
                        path, content.states > 0 ? "go on from its state with --restart auto, " : "");
    return remove_earlier_run(path, err);
}

void run_directory_remove_notes(const char *path)
{
    for (size_t k = 0; k < NOTES; k++)
        (void)visit_file(path, notes[k], "", remove_file, NULL);
}
