/* Whole files: read at once; written under a temporary name and renamed when complete.
 *
 * Files are written to plain files and new names alone: a symbolic link, a FIFO, a device or a directory of
 * the name is DM2_USAGE, at the begin and before the end, and stays as it is.
 *
 * Every failure is DM2_IO with the path and the system's reason, or DM2_MEMORY. A write beyond RLIMIT_FSIZE
 * fails with DM2_IO only where SIGXFSZ is ignored; otherwise the signal ends the program. */
#ifndef DM2_BASE_FILE_H
#define DM2_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"

/* A file being written. Errors stick: after the first error nothing more is written, and file_commit reports
 * that error. */
struct file_out {
    char *path, *part; /* final and temporary name: path and path.part; part NULL: standard output */
    bool is_new;       /* there was no file of the final name at the start */
    int fd;
    int error;             /* errno of the first failure, 0 so far */
    unsigned char *buffer; /* bytes not yet written */
    size_t used;
};

/* Whether `path` may be written: no name yet (*absent), or a plain file; else DM2_USAGE, which says what the
 * name is. */
enum dm2_status file_check_name(const char *path, bool *absent, struct dm2_error *err);

/* DM2_USAGE where `path` is there and no directory, a link to one included. */
enum dm2_status file_check_directory(const char *path, struct dm2_error *err);

/* Creates path.part, and replaces a path.part that an earlier, killed run left. On failure *f is empty;
 * file_abandon may be called on an empty *f. */
enum dm2_status file_create(struct file_out *f, const char *path, struct dm2_error *err);

/* Lets *f write to standard output; file_commit flushes alone. */
enum dm2_status file_create_output(struct file_out *f, struct dm2_error *err);

/* Lets *f collect at most 65,536 bytes in f->buffer[0 .. f->used), for a comparison; file_abandon ends it. */
enum dm2_status file_create_text(struct file_out *f, struct dm2_error *err);

/* Append bytes, a text, or a formatted text of at most 1023 bytes (a longer text sticks as EOVERFLOW). */
void file_write(struct file_out *f, const void *bytes, size_t n);
void file_puts(struct file_out *f, const char *text);
void file_printf(struct file_out *f, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Room for n bytes (n <= FILE_RESERVE_MAX) in the buffer, never NULL. The caller fills at most n bytes and
 * then counts them with file_filled: for encoders that would otherwise copy. */
enum { FILE_RESERVE_MAX = 4096 };
unsigned char *file_reserve(struct file_out *f, size_t n);
void file_filled(struct file_out *f, size_t n);

/* Writes the buffered bytes to the system, so that a full disk is reported now. */
enum dm2_status file_flush(struct file_out *f, struct dm2_error *err);

/* Flushes, fsyncs, closes, renames to the final name and fsyncs the directory. On failure before
 * the rename the temporary file is removed, and a file under the final name is unchanged. A name that was new
 * at file_create and has come into being since is not replaced: DM2_IO. *f is empty afterwards. */
enum dm2_status file_commit(struct file_out *f, struct dm2_error *err);

/* Opens path.part as an earlier program left it, cuts it to its first `keep` bytes and lets *f append. */
enum dm2_status file_reopen(struct file_out *f, const char *path, size_t keep, struct dm2_error *err);

/* Flushes and fsyncs; the file stays open. */
enum dm2_status file_sync(struct file_out *f, struct dm2_error *err);

/* Flushes, closes and leaves the temporary file for file_reopen. Does nothing to an empty or zeroed *f. */
void file_suspend(struct file_out *f);

/* Makes a directory and brings its name to disk; *made is true where the directory is new. A name that exists
 * already is taken for a directory. DM2_IO. */
enum dm2_status file_make_directory(const char *path, bool *made, struct dm2_error *err);

/* Renames a file and brings the new name to disk. */
enum dm2_status file_rename(const char *from, const char *to, struct dm2_error *err);

/* Whether the system says that there is no file `path`. */
bool file_is_absent(const char *path);

/* Takes the malloc'd name of a file, or NULL, and returns the name that its symbolic links lead to, which the
 * caller frees; links of folders on the way are left to the system. NULL: more than 40 links, or no memory.
 */
char *file_follow_links(char *path);

/* Whether the file that the system opens as `path` lies in `folder` or below, all symbolic links followed:
 * the directory of the file is followed upwards by "..", and compared by device and inode. False also where
 * a directory on the way cannot be searched, and without memory. */
bool file_lies_below(const char *path, const char *folder);

/* Closes and removes the temporary file. Does nothing to an empty or zeroed *f. */
void file_abandon(struct file_out *f);

/* Writes `n` bytes as the file `path`, atomically. */
enum dm2_status file_replace(const char *path, const void *bytes, size_t n, struct dm2_error *err);

/* Reads a whole regular file of at most `limit` bytes; *bytes is malloc'd, has a NUL behind its *n bytes and
 * belongs to the caller. DM2_IO also for a larger file, with the limit, and for a file that is not regular;
 * then *bytes is NULL. */
enum dm2_status file_read(const char *path, size_t limit, unsigned char **bytes, size_t *n,
                          struct dm2_error *err);

#endif
