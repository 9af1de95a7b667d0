/* The file is removed at the end of a run, so that a run directory holds results alone. Another process may
 * have opened the file just before, and then locks a file without a name: so the name is compared with the
 * file after the lock is taken, and the lock taken anew where they differ. */
#include "run_lock.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dm2/base/file.h"
#include "dm2/base/text.h"
#include "dm2/output/run_directory.h"

const char run_lock_name[] = ".lock";

static struct flock whole_file(void)
{
    return (struct flock){.l_type = F_WRLCK, .l_whence = SEEK_SET};
}

/* DM2_USAGE, with the process that holds the lock; DM2_OK where the lock has become free meanwhile. */
static enum dm2_status fail_in_use(int fd, const char *directory, struct dm2_error *err)
{
    char holder[40] = "another process";
    struct flock held = whole_file();
    if (fcntl(fd, F_GETLK, &held) == 0) {
        if (held.l_type == F_UNLCK)
            return DM2_OK;
        if (held.l_pid > 0)
            (void)snprintf(holder, sizeof holder, "process %ld", (long)held.l_pid);
    }
    return dm2_fail(
        err, DM2_USAGE,
        "%s: the run directory is in use by %s: wait for its end, or name another one with -o DIR", directory,
        holder);
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
    struct flock mine = whole_file();
    enum dm2_status status = file_check_name(lock->path, &absent, err);
    *again = false;
    if (status != DM2_OK)
        return status;
    lock->fd = open(lock->path, O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
    if (lock->fd < 0 || fstat(lock->fd, &info) != 0 || !S_ISREG(info.st_mode))
        return dm2_fail(err, DM2_IO, "%s: cannot open the lock of the run directory: %s", lock->path,
                        lock->fd < 0 ? strerror(errno) : "it is no plain file");
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

enum dm2_status run_lock_take(struct run_lock *lock, const char *directory, struct dm2_error *err)
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
    if (status != DM2_OK) { /* the file is another's */
        if (lock->fd >= 0)
            (void)close(lock->fd);
        free(lock->path);
        *lock = (struct run_lock){.fd = -1};
    }
    return status;
}

void run_lock_release(struct run_lock *lock)
{
    if (lock->path == NULL)
        return;
    struct stat info;
    if (fstat(lock->fd, &info) == 0 && info.st_size == 0 && has_name(lock->fd, lock->path))
        (void)unlink(lock->path);
    (void)close(lock->fd);
    free(lock->path);
    *lock = (struct run_lock){.fd = -1};
}
