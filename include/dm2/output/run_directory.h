/* The run directory itself: its default name, and preparing it for a run.
 *
 * Files of an earlier run are recognised by name. `overwrite` removes these files and nothing else, so that a
 * directory never mixes two runs and never loses a file that no run wrote. */
#ifndef DM2_OUTPUT_RUN_DIRECTORY_H
#define DM2_OUTPUT_RUN_DIRECTORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"

/* Names below the run directory: the directory of the snapshots, and the series file in it. */
extern const char run_directory_snapshots[], run_directory_series[];

/* The directory of a run whose command line names none: the deck's base name without its last suffix, and
 * ".run", in the current directory ("input/plate-impact.dm2" gives "plate-impact.run"). malloc'd, the caller
 * frees it; NULL: no memory. */
char *run_directory_default(const char *deck_path);

/* The directory of a file: "a/b" gives "a", "b" gives ".". malloc'd, the caller frees it; NULL: no memory. */
char *run_directory_of(const char *path);

struct run_lock;

/* Makes the directory `path` and its parents, or takes one that is there, and locks it; `command` stands in
 * the lock. *made: the directory did not exist, also after a failure. DM2_USAGE where another process has the
 * lock; DM2_IO with the path and the system's reason, or DM2_MEMORY. The caller releases *lock. */
enum dm2_status run_directory_claim(const char *path, const char *command, bool *made, struct run_lock *lock,
                                    struct dm2_error *err);

/* How many names a run directory has, apart from its lock. */
struct run_content {
    size_t files;  /* all */
    size_t states; /* final.dm2, checkpoint.dm2, checkpoint.prev.dm2 */
    size_t tables; /* of a run that has not ended: NAME.csv.part */
    size_t others; /* all but these, .part, checkpoint.next.dm2, deck.dm2, run.log, schedule.csv, snapshots */
};

/* DM2_IO: the directory cannot be read. */
enum dm2_status run_directory_survey(const char *directory, struct run_content *out, struct dm2_error *err);

/* Empties a claimed directory for a run that begins. A directory with files is an error (DM2_IO) unless
 * `overwrite`; then the files of an earlier run are removed. DM2_USAGE where a name of a run's file is no
 * plain file; then nothing is removed. */
enum dm2_status run_directory_clear(const char *path, bool overwrite, struct dm2_error *err);

/* Removes the snapshots of steps from `from` on in the directory of the snapshots, and with `series` the
 * series file. An absent directory has none. DM2_IO. */
enum dm2_status run_directory_drop_snapshots(const char *directory, int64_t from, bool series,
                                             struct dm2_error *err);

/* Checks the names of the files of a run that goes on: DM2_USAGE as above. */
enum dm2_status run_directory_check(const char *path, struct dm2_error *err);

/* Removes deck.dm2, run.log and schedule.csv, of a run without a result. */
void run_directory_remove_notes(const char *path);

/* DM2_MEMORY, for a path in the run directory that does not fit into memory. */
enum dm2_status run_directory_no_memory(struct dm2_error *err);

#endif
