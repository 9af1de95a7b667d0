/* The file is removed at the end of a run, so that a run directory holds results alone. Another process may
 * have opened the file just before, and then locks a file without a name: so the name is compared with the
 * file after the lock is taken, and the lock taken anew where they differ. The holder writes who it is into
 * the file, for the message of the next process, because the system names no host. */
#include "run_lock.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "dm2/base/file.h"
#include "dm2/base/text.h"
#include "dm2/output/run_directory.h"

const char run_lock_name[] = ".lock";
static const char FIRST_LINE[] = "dm2 writes in this directory\n";

enum { CONTENT_MAX = 4096 };

static struct flock whole_file(void)
{
    return (struct flock){.l_type = F_WRLCK, .l_whence = SEEK_SET};
}

/* --- the content --- */

/* The local time as "2026-11-29 10:02:11 +0000". */
static void format_now(char *out, size_t size)
{
    time_t now = time(NULL);
    struct tm parts;
    if (localtime_r(&now, &parts) == NULL || strftime(out, size, "%Y-%m-%d %H:%M:%S %z", &parts) == 0)
        out[0] = '\0';
}

/* Writes who holds the lock. Errors are ignored, because the lock holds without the text. */
static void write_content(int fd, const char *command)
{
    char text[CONTENT_MAX], host[256] = "", start[64];
    (void)gethostname(host, sizeof host - 1);
    format_now(start, sizeof start);
    int n = snprintf(text, sizeof text, "%shost: %s\nprocess: %ld\nstart: %s\ncommand: %s\n", FIRST_LINE,
                     host, (long)getpid(), start, command);
    size_t length = n < 0 ? 0 : (size_t)n < sizeof text ? (size_t)n : sizeof text - 1;
    if (ftruncate(fd, 0) != 0 || pwrite(fd, text, length, 0) != (ssize_t)length)
        (void)ftruncate(fd, 0);
}

/* Reads the content, NUL-terminated. False: the file has something else than a holder's text or nothing. */
static bool read_content(int fd, char text[CONTENT_MAX])
{
    ssize_t n = pread(fd, text, CONTENT_MAX - 1, 0);
    text[n < 0 ? 0 : n] = '\0';
    return n <= 0 || strncmp(text, FIRST_LINE, strlen(FIRST_LINE)) == 0;
}

/* Copies the value of the line "name: value" to out[0 .. size); empty: there is no such line. */
static void find_value(const char *text, const char *name, char *out, size_t size)
{
    size_t length = strlen(name);
    const char *line = text;
    out[0] = '\0';
    while (line != NULL && (strncmp(line, name, length) != 0 || strncmp(line + length, ": ", 2) != 0)) {
        line = strchr(line, '\n');
        line = line == NULL ? NULL : line + 1;
    }
    if (line == NULL)
        return;
    line += length + 2;
    (void)snprintf(out, size, "%.*s", (int)strcspn(line, "\n"), line);
    text_make_printable(out, false);
}

/* --- the lock --- */

/* DM2_USAGE, with the process that holds the lock; DM2_OK where the lock has become free meanwhile. */
static enum dm2_status fail_in_use(int fd, const char *directory, struct dm2_error *err)
{
    char text[CONTENT_MAX], host[100], process[32], start[40], now[64], since[32] = "";
    struct flock held = whole_file();
    bool known = fcntl(fd, F_GETLK, &held) == 0;
    if (known && held.l_type == F_UNLCK)
        return DM2_OK;
    (void)read_content(fd, text);
    find_value(text, "host", host, sizeof host);
    find_value(text, "process", process, sizeof process);
    find_value(text, "start", start, sizeof start);
    if (process[0] == '\0' && known && held.l_pid > 0)
        (void)snprintf(process, sizeof process, "%ld", (long)held.l_pid);
    format_now(now, sizeof now);
    if (strlen(start) >= 16) /* of today: the time alone */
        (void)snprintf(since, sizeof since, " since %.16s", start);
    if (since[0] != '\0' && strncmp(start, now, 10) == 0)
        (void)snprintf(since, sizeof since, " since %.5s", start + 11);
    return dm2_fail(err, DM2_USAGE,
                    "%s%s%s%s, writes to %s%s: wait for its end, or name another run directory with -o DIR",
                    host, host[0] == '\0' ? "" : ", ", process[0] == '\0' ? "another process" : "process ",
                    process, directory, since);
}

static bool has_name(int fd, const char *path)
{
    struct stat file, name;
    return fstat(fd, &file) == 0 && lstat(path, &name) == 0 && file.st_dev == name.st_dev &&
           file.st_ino == name.st_ino;
}

/* One try. *again: the file or the lock has changed hands, and another try is due. */
static enum dm2_status try_lock(struct run_lock *lock, const char *directory, bool *again,
                                struct dm2_error *err)
{
    bool absent;
    struct stat info;
    char text[CONTENT_MAX];
    struct flock mine = whole_file();
    enum dm2_status status = file_check_name(lock->path, &absent, err);
    *again = false;
    if (status != DM2_OK)
        return status;
    lock->fd = open(lock->path, O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
    if (lock->fd < 0 || fstat(lock->fd, &info) != 0 || !S_ISREG(info.st_mode))
        return dm2_fail(err, DM2_IO, "%s: cannot open the lock of the run directory: %s", lock->path,
                        lock->fd < 0 ? strerror(errno) : "it is no plain file");
    if (!read_content(lock->fd, text))
        return dm2_fail(err, DM2_USAGE,
                        "%s: is not the lock of a run, whose name it has: move it away, or name another run "
                        "directory with -o DIR",
                        lock->path);
    if (fcntl(lock->fd, F_SETLK, &mine) == 0) {
        *again = !has_name(lock->fd, lock->path);
        return DM2_OK;
    }
    if (errno == EACCES || errno == EAGAIN) {
        *again = true;
        return fail_in_use(lock->fd, directory, err);
    }
    (void)snprintf(lock->warning, sizeof lock->warning,
                   "the run directory cannot be locked (%s): let no other run write in it", strerror(errno));
    return DM2_OK;
}

enum dm2_status run_lock_take(struct run_lock *lock, const char *directory, const char *command,
                              struct dm2_error *err)
{
    enum { TRIES = 100 };
    *lock = (struct run_lock){.fd = -1, .path = text_join(directory, "/", run_lock_name)};
    if (lock->path == NULL)
        return run_directory_no_memory(err);
    enum dm2_status status = DM2_OK;
    bool again = true;
    for (int k = 0; k < TRIES && again && status == DM2_OK; k++) {
        if (lock->fd >= 0)
            (void)close(lock->fd);
        lock->fd = -1;
        status = try_lock(lock, directory, &again, err);
    }
    if (status == DM2_OK && again)
        status =
            dm2_fail(err, DM2_USAGE, "%s: other processes take the run directory again and again", directory);
    if (status == DM2_OK) {
        write_content(lock->fd, command);
        return status;
    }
    if (lock->fd >= 0) /* the file is another's */
        (void)close(lock->fd);
    free(lock->path);
    *lock = (struct run_lock){.fd = -1};
    return status;
}

void run_lock_release(struct run_lock *lock)
{
    if (lock->path == NULL)
        return;
    if (has_name(lock->fd, lock->path))
        (void)unlink(lock->path);
    (void)close(lock->fd);
    free(lock->path);
    *lock = (struct run_lock){.fd = -1};
}
