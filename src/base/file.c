/* Whole files, replaced atomically.
 *
 * A file is written as path.part with write(2) and a buffer of the module's own, because stdio would hide
 * which call failed and with which errno. A file under its final name is complete, because file_commit keeps
 * the order flush, fsync, close, rename, fsync of the directory. The first error sticks in the struct, so
 * that encoders write without checks and the check in file_commit names the first cause. */
#include "dm2/base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dm2/base/text.h"

enum { BUFFER_BYTES = 1 << 16 };

static void clear(struct file_out *f)
{
    free(f->path);
    free(f->part);
    free(f->buffer);
    memset(f, 0, sizeof *f);
    f->fd = -1;
}

/* What a name is that is no plain file. */
static const char *kind_of(mode_t mode)
{
    return S_ISLNK(mode)                    ? "a symbolic link"
           : S_ISFIFO(mode)                 ? "a FIFO"
           : S_ISDIR(mode)                  ? "a directory"
           : S_ISCHR(mode) || S_ISBLK(mode) ? "a device"
                                            : "a socket";
}

enum dm2_status file_check_name(const char *path, bool *absent, struct dm2_error *err)
{
    struct stat info;
    *absent = lstat(path, &info) != 0;
    if (*absent || S_ISREG(info.st_mode))
        return DM2_OK;
    return dm2_fail(
        err, DM2_USAGE,
        "%s: is %s, and results are written to plain files alone: name another file, or move it away", path,
        kind_of(info.st_mode));
}

enum dm2_status file_check_directory(const char *path, struct dm2_error *err)
{
    struct stat info;
    if (lstat(path, &info) != 0 || S_ISDIR(info.st_mode))
        return DM2_OK;
    return dm2_fail(err, DM2_USAGE, "%s: is %s, and a directory is expected: move it away", path,
                    S_ISREG(info.st_mode) ? "a file" : kind_of(info.st_mode));
}

static enum dm2_status fail_at(const struct file_out *f, const char *what, int error, struct dm2_error *err)
{
    return dm2_fail(err, DM2_IO, "%s: cannot %s: %s", f->path, what, strerror(error));
}

/* Allocates the names and the buffer of *f. */
static enum dm2_status prepare(struct file_out *f, const char *path, struct dm2_error *err)
{
    memset(f, 0, sizeof *f);
    f->fd = -1;
    f->path = text_join(path, "", "");
    f->part = text_join(path, ".part", "");
    f->buffer = malloc(BUFFER_BYTES);
    if (f->path != NULL && f->part != NULL && f->buffer != NULL)
        return DM2_OK;
    clear(f);
    return dm2_fail(err, DM2_MEMORY, "%s: no memory for the file's buffer", path);
}

enum dm2_status file_create(struct file_out *f, const char *path, struct dm2_error *err)
{
    bool absent;
    enum dm2_status prepared = file_check_name(path, &absent, err);
    if (prepared == DM2_OK)
        prepared = prepare(f, path, err);
    else
        memset(f, 0, sizeof *f);
    if (prepared != DM2_OK)
        return prepared;
    f->is_new = absent;
    if (unlink(f->part) != 0 && errno != ENOENT) {
        enum dm2_status status = fail_at(f, "replace its .part file", errno, err);
        clear(f);
        return status;
    }
    /* O_EXCL: open fails on whatever another program puts there meanwhile. */
    f->fd = open(f->part, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (f->fd < 0) {
        enum dm2_status status = fail_at(f, "create", errno, err);
        clear(f);
        return status;
    }
    return DM2_OK;
}

enum dm2_status file_create_output(struct file_out *f, struct dm2_error *err)
{
    enum dm2_status status = prepare(f, "standard output", err);
    free(f->part);
    f->part = NULL;
    f->fd = status == DM2_OK ? STDOUT_FILENO : -1;
    return status;
}

enum dm2_status file_create_text(struct file_out *f, struct dm2_error *err)
{
    enum dm2_status status = prepare(f, "a text in memory", err);
    free(f->part);
    f->part = NULL;
    return status;
}

enum dm2_status file_reopen(struct file_out *f, const char *path, size_t keep, struct dm2_error *err)
{
    bool absent;
    memset(f, 0, sizeof *f);
    enum dm2_status status = file_check_name(path, &absent, err);
    if (status == DM2_OK)
        status = prepare(f, path, err);
    if (status != DM2_OK)
        return status;
    f->is_new = absent;
    status = file_check_name(f->part, &absent, err);
    if (status != DM2_OK) {
        clear(f);
        return status;
    }
    f->fd = open(f->part, O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (f->fd < 0 || ftruncate(f->fd, (off_t)keep) != 0 || lseek(f->fd, 0, SEEK_END) != (off_t)keep) {
        status = fail_at(f, "take up its .part file", errno, err);
        file_suspend(f);
    }
    return status;
}

static void write_through(struct file_out *f, const unsigned char *bytes, size_t n)
{
    while (n > 0 && f->error == 0) {
        ssize_t wrote = write(f->fd, bytes, n);
        if (wrote < 0) {
            f->error = errno == EINTR ? 0 : errno;
        } else {
            bytes += wrote;
            n -= (size_t)wrote;
        }
    }
}

static void empty_buffer(struct file_out *f)
{
    write_through(f, f->buffer, f->used);
    f->used = 0;
}

void file_write(struct file_out *f, const void *bytes, size_t n)
{
    if (n > BUFFER_BYTES - f->used)
        empty_buffer(f);
    if (n >= BUFFER_BYTES) {
        write_through(f, bytes, n);
        return;
    }
    memcpy(f->buffer + f->used, bytes, n);
    f->used += n;
}

void file_puts(struct file_out *f, const char *text)
{
    file_write(f, text, strlen(text));
}

void file_printf(struct file_out *f, const char *format, ...)
{
    char text[1024];
    va_list args;
    va_start(args, format);
    int length = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (length < 0 || (size_t)length >= sizeof text)
        f->error = f->error == 0 ? EOVERFLOW : f->error;
    else
        file_write(f, text, (size_t)length);
}

unsigned char *file_reserve(struct file_out *f, size_t n)
{
    if (n > BUFFER_BYTES - f->used)
        empty_buffer(f);
    return f->buffer + f->used;
}

void file_filled(struct file_out *f, size_t n)
{
    f->used += n;
}

enum dm2_status file_flush(struct file_out *f, struct dm2_error *err)
{
    empty_buffer(f);
    return f->error == 0 ? DM2_OK : fail_at(f, "write", f->error, err);
}

/* Makes a rename to `path`, or a new directory `path`, durable. Returns an errno, 0 for success. Some file
 * systems cannot fsync a directory and return EINVAL, which is ignored. */
static int sync_directory_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    size_t length = slash == NULL ? 1 : slash == path ? 1 : (size_t)(slash - path);
    char *directory = malloc(length + 1);
    if (directory == NULL)
        return ENOMEM;
    memcpy(directory, slash == NULL ? "." : path, length);
    directory[length] = '\0';
    int fd = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    free(directory);
    if (fd < 0)
        return errno == EACCES ? 0 : errno; /* writable but not readable: no descriptor to fsync */
    int error = fsync(fd) != 0 && errno != EINVAL ? errno : 0;
    close(fd);
    return error;
}

/* Gives the temporary file its final name. A name that was new at the start is made by link, which never
 * replaces what another program has put there since; where the file system has no links, and for a name that
 * was a file at the start, by rename, which follows no link. */
static enum dm2_status give_name(struct file_out *f, struct dm2_error *err)
{
    bool absent;
    enum dm2_status status = file_check_name(f->path, &absent, err);
    if (status != DM2_OK)
        return status;
    if (f->is_new) {
        if (link(f->part, f->path) == 0)
            return unlink(f->part) == 0 ? DM2_OK : fail_at(f, "remove its .part file", errno, err);
        if (errno == EEXIST)
            return dm2_fail(
                err, DM2_IO,
                "%s: has come into being while it was written here, and is not replaced: move it away",
                f->path);
        if (errno != EPERM && errno != EOPNOTSUPP && errno != ENOTSUP && errno != ENOSYS && errno != EMLINK)
            return fail_at(f, "rename its .part file", errno, err);
    }
    return rename(f->part, f->path) == 0 ? DM2_OK : fail_at(f, "rename its .part file", errno, err);
}

enum dm2_status file_commit(struct file_out *f, struct dm2_error *err)
{
    enum dm2_status status = file_flush(f, err);
    if (status != DM2_OK || f->part == NULL) {
        file_abandon(f);
        return status;
    }
    if (fsync(f->fd) != 0) {
        status = fail_at(f, "bring to disk", errno, err);
        file_abandon(f);
        return status;
    }
    int closed = close(f->fd);
    f->fd = -1;
    if (closed != 0) {
        status = fail_at(f, "close", errno, err);
        file_abandon(f);
        return status;
    }
    status = give_name(f, err);
    if (status != DM2_OK) {
        file_abandon(f);
        return status;
    }
    int error = sync_directory_of(f->path);
    if (error != 0)
        status = fail_at(f, "bring its directory to disk", error, err);
    clear(f);
    return status;
}

enum dm2_status file_sync(struct file_out *f, struct dm2_error *err)
{
    enum dm2_status status = file_flush(f, err);
    if (status == DM2_OK && fsync(f->fd) != 0)
        status = fail_at(f, "bring to disk", errno, err);
    return status;
}

void file_suspend(struct file_out *f)
{
    if (f->path == NULL)
        return;
    if (f->fd >= 0) {
        empty_buffer(f);
        close(f->fd);
    }
    clear(f);
}

enum dm2_status file_rename(const char *from, const char *to, struct dm2_error *err)
{
    bool absent;
    enum dm2_status status = file_check_name(from, &absent, err);
    if (status == DM2_OK)
        status = file_check_name(to, &absent, err);
    if (status != DM2_OK)
        return status;
    if (rename(from, to) != 0)
        return dm2_fail(err, DM2_IO, "%s: cannot rename it to %s: %s", from, to, strerror(errno));
    int error = sync_directory_of(to);
    return error == 0
               ? DM2_OK
               : dm2_fail(err, DM2_IO, "%s: cannot bring its directory to disk: %s", to, strerror(error));
}

enum dm2_status file_make_directory(const char *path, bool *made, struct dm2_error *err)
{
    *made = mkdir(path, 0777) == 0;
    if (!*made && errno != EEXIST)
        return dm2_fail(err, DM2_IO, "%s: cannot make the directory: %s", path, strerror(errno));
    int error = *made ? sync_directory_of(path) : 0;
    if (error == 0)
        return DM2_OK;
    *made = false;
    (void)rmdir(path);
    return dm2_fail(err, DM2_IO, "%s: cannot bring the new directory to disk: %s", path, strerror(error));
}

bool file_is_absent(const char *path)
{
    return access(path, F_OK) != 0 && (errno == ENOENT || errno == ENOTDIR);
}

char *file_follow_links(char *path)
{
    enum { LINKS_MOST = 40 };
    char target[4096];
    for (int k = 0; path != NULL && k < LINKS_MOST; k++) {
        ssize_t n = readlink(path, target, sizeof target - 1);
        if (n < 0)
            return path;
        target[n] = '\0';
        const char *slash = target[0] == '/' ? NULL : strrchr(path, '/');
        size_t folder = slash == NULL ? 0 : (size_t)(slash - path) + 1;
        char *next = malloc(folder + (size_t)n + 1);
        if (next != NULL) {
            memcpy(next, path, folder);
            memcpy(next + folder, target, (size_t)n + 1);
        }
        free(path);
        path = next;
    }
    free(path);
    return NULL;
}

bool file_lies_below(const char *path, const char *folder)
{
    enum { DEPTH_MOST = 1000 };
    static const char up[] = "/..";
    struct stat top, at = {0}, next;
    char *real = file_follow_links(text_join(path, "", ""));
    char *slash = real == NULL ? NULL : strrchr(real, '/');
    size_t used = slash == NULL ? 1 : (size_t)(slash - real) + 1;
    char *climb = real == NULL ? NULL : malloc(used + DEPTH_MOST * (sizeof up - 1) + 1);
    bool found = false;
    if (climb != NULL && stat(folder, &top) == 0) {
        memcpy(climb, slash == NULL ? "." : real, used);
        climb[used] = '\0';
        bool higher = stat(climb, &at) == 0;
        for (int k = 0; higher && k < DEPTH_MOST; k++) {
            found = at.st_dev == top.st_dev && at.st_ino == top.st_ino;
            memcpy(climb + used, up, sizeof up);
            used += sizeof up - 1;
            higher = !found && stat(climb, &next) == 0 &&
                     (next.st_dev != at.st_dev || next.st_ino != at.st_ino); /* "/.." is "/" */
            at = next;
        }
    }
    free(climb);
    free(real);
    return found;
}

void file_abandon(struct file_out *f)
{
    if (f->path == NULL)
        return;
    if (f->part != NULL) {
        if (f->fd >= 0)
            close(f->fd);
        unlink(f->part);
    }
    clear(f);
}

enum dm2_status file_replace(const char *path, const void *bytes, size_t n, struct dm2_error *err)
{
    struct file_out f;
    enum dm2_status status = file_create(&f, path, err);
    if (status != DM2_OK)
        return status;
    file_write(&f, bytes, n);
    return file_commit(&f, err);
}

static enum dm2_status read_open(int fd, const char *path, size_t limit, unsigned char **bytes, size_t *n,
                                 struct dm2_error *err)
{
    struct stat info;
    if (fstat(fd, &info) != 0)
        return dm2_fail(err, DM2_IO, "%s: cannot read: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode))
        return dm2_fail(err, DM2_IO, "%s: is not a regular file", path);
    if (info.st_size < 0 || (uintmax_t)info.st_size > limit)
        return dm2_fail(err, DM2_IO, "%s: has %jd bytes, more than the %zu that this program reads", path,
                        (intmax_t)info.st_size, limit);
    size_t size = (size_t)info.st_size;
    unsigned char *block = size < SIZE_MAX ? malloc(size + 1) : NULL;
    if (block == NULL)
        return dm2_fail(err, DM2_MEMORY, "%s: no memory for its %zu bytes", path, size);
    size_t have = 0;
    while (have < size) {
        ssize_t got = read(fd, block + have, size - have);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0) {
            int error = errno;
            free(block);
            return dm2_fail(err, DM2_IO, "%s: cannot read: %s", path, strerror(error));
        }
        if (got == 0)
            break; /* the file shrank meanwhile: its decoder finds the early end */
        have += (size_t)got;
    }
    block[have] = '\0';
    *bytes = block;
    *n = have;
    return DM2_OK;
}

enum dm2_status file_read(const char *path, size_t limit, unsigned char **bytes, size_t *n,
                          struct dm2_error *err)
{
    *bytes = NULL;
    *n = 0;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        return dm2_fail(err, DM2_IO, "%s: cannot open: %s", path, strerror(errno));
    enum dm2_status status = read_open(fd, path, limit, bytes, n, err);
    close(fd);
    return status;
}
