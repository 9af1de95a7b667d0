/* Whole files: read in one go; written under a temporary name and renamed when complete.
 *
 * Every failure is DM2_IO with the path and the system's reason, or DM2_MEMORY. A write beyond RLIMIT_FSIZE
 * is such a failure only where SIGXFSZ is ignored. */
#ifndef DM2_BASE_FILE_H
#define DM2_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"

/* A file being written. Errors stick: after the first one nothing more is written, and file_commit reports
 * it. */
struct file_out {
    char *path, *part; /* final and temporary name: path and path.part */
    int fd;
    int error;             /* errno of the first failure, 0 so far */
    unsigned char *buffer; /* bytes not yet written */
    size_t used;
};

/* Creates path.part, replacing what an earlier, killed run left there. On failure *f is empty; file_abandon
 * may be called on it. */
enum dm2_status file_create(struct file_out *f, const char *path, struct dm2_error *err);

/* Append bytes, a text, or a formatted text of at most 1023 bytes (a longer one sticks as EOVERFLOW). */
void file_write(struct file_out *f, const void *bytes, size_t n);
void file_puts(struct file_out *f, const char *text);
void file_printf(struct file_out *f, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Room for n bytes (n <= FILE_RESERVE_MAX) in the buffer, to be filled and then counted with file_filled: for
 * encoders that would otherwise copy. Never NULL. */
enum { FILE_RESERVE_MAX = 4096 };
unsigned char *file_reserve(struct file_out *f, size_t n);
void file_filled(struct file_out *f, size_t n);

/* Hands what is buffered to the system, so that a full disk is noticed now. */
enum dm2_status file_flush(struct file_out *f, struct dm2_error *err);

/* Flushes, fsyncs, closes, renames to the final name and fsyncs the directory. On failure the temporary file
 * is removed and what was under the final name stays as it was. *f is empty afterwards. */
enum dm2_status file_commit(struct file_out *f, struct dm2_error *err);

/* Takes up path.part where an earlier program left it: cuts it to its first `keep` bytes and appends to them.
 */
enum dm2_status file_reopen(struct file_out *f, const char *path, size_t keep, struct dm2_error *err);

/* Flushes and fsyncs what is there so far; the file stays open. */
enum dm2_status file_sync(struct file_out *f, struct dm2_error *err);

/* Closes and leaves the temporary file for file_reopen. Does nothing to an empty or zeroed *f. */
void file_suspend(struct file_out *f);

/* Makes a directory and brings its name to disk; *made: it was not there. What is there already is taken for
 * one. DM2_IO. */
enum dm2_status file_make_directory(const char *path, bool *made, struct dm2_error *err);

/* Renames a file and brings that to disk. */
enum dm2_status file_rename(const char *from, const char *to, struct dm2_error *err);

/* Closes and removes the temporary file. Does nothing to an empty or zeroed *f. */
void file_abandon(struct file_out *f);

/* Writes `n` bytes as the file `path`, atomically. */
enum dm2_status file_replace(const char *path, const void *bytes, size_t n, struct dm2_error *err);

/* Reads a whole regular file of at most `limit` bytes; *bytes is malloc'd and has a NUL behind its *n bytes.
 * A larger file is DM2_IO that names the limit. */
enum dm2_status file_read(const char *path, size_t limit, unsigned char **bytes, size_t *n,
                          struct dm2_error *err);

#endif
