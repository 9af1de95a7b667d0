/* The run directory itself: its default name, and preparing it for a run.
 *
 * Files of an earlier run are recognised by name. `overwrite` removes these files and nothing else, so that a
 * directory never mixes two runs and never loses a file that no run wrote. */
#ifndef DM2_OUTPUT_RUN_DIRECTORY_H
#define DM2_OUTPUT_RUN_DIRECTORY_H

#include <stdbool.h>

#include "dm2/base/status.h"

/* Names below the run directory: the directory of the snapshots, and the series file in it. */
extern const char run_directory_snapshots[], run_directory_series[];

/* The directory of a run whose command line names none: the deck's base name without its last suffix, and
 * ".run", in the current directory ("input/plate-impact.dm2" gives "plate-impact.run"). malloc'd, the caller
 * frees it; NULL: no memory. */
char *run_directory_default(const char *deck_path);

struct run_lock;

/* Makes the directory `path` and its parents, or takes an empty one, and locks it. *made: the directory did
 * not exist. A directory that is not empty is an error unless `overwrite`; then the files of an earlier run
 * are removed. DM2_USAGE where another process has the lock, or where a name of a run's file is no plain
 * file; then nothing is removed. DM2_IO with the path and the system's reason, or DM2_MEMORY. The caller
 * releases *lock, also after a failure. */
enum dm2_status run_directory_prepare(const char *path, bool overwrite, bool *made, struct run_lock *lock,
                                      struct dm2_error *err);

/* Locks a run directory in which a run continues, and checks the names of its files: DM2_USAGE as above. */
enum dm2_status run_directory_retake(const char *path, struct run_lock *lock, struct dm2_error *err);

/* DM2_MEMORY, for a path in the run directory that does not fit into memory. */
enum dm2_status run_directory_no_memory(struct dm2_error *err);

#endif
