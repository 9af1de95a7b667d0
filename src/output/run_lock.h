/* The lock of a run directory: one process at a time writes in it. */
#ifndef DM2_OUTPUT_RUN_LOCK_H
#define DM2_OUTPUT_RUN_LOCK_H

#include "dm2/base/status.h"

/* A write lock (fcntl) on DIR/.lock. The lock ends with the process, however that ends, and with the closing
 * of any descriptor of the file by the process: the file is opened here and nowhere else. */
struct run_lock {
    int fd;            /* valid where path is not NULL */
    char *path;        /* NULL: not locked */
    char warning[200]; /* why the directory is used without a lock; empty: it is locked */
};

extern const char run_lock_name[];

/* Locks the directory and writes host, process, start and `command` into the file. DM2_USAGE, with the host,
 * the process and the start of the holder, where another one has the lock, or where the name is no plain file
 * or has other content; DM2_IO, DM2_MEMORY. A file system without locks is no failure, but a warning. *lock
 * is zeroed before; run_lock_release frees it. */
enum dm2_status run_lock_take(struct run_lock *lock, const char *directory, const char *command,
                              struct dm2_error *err);

/* Removes the file and unlocks. Does nothing to a zeroed *lock. */
void run_lock_release(struct run_lock *lock);

#endif
