/* Linked into a program in front of the system's calls (-Wl,--wrap). DM2_FAIL=CLASS:N makes the Nth call of a
 * class fail, once; CLASS is memory, open, lock (of a file), write, fsync, rename (also link), read, socket
 * (also accept, connect, pipe, fork), poll or writev. The call that fails creates the file DM2_FAIL_MARK. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

void *__real_malloc(size_t n);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *p, size_t n);
int __real_posix_memalign(void **p, size_t alignment, size_t n);
int __real_open(const char *path, int flags, ...);
ssize_t __real_write(int fd, const void *data, size_t n);
int __real_fsync(int fd);
int __real_rename(const char *from, const char *to);
int __real_fcntl(int fd, int command, ...);
int __real_link(const char *from, const char *to);
ssize_t __real_read(int fd, void *data, size_t n);
ssize_t __real_writev(int fd, const struct iovec *iov, int n);
int __real_poll(struct pollfd *polls, nfds_t n, int timeout);
int __real_socket(int domain, int type, int protocol);
int __real_accept(int fd, struct sockaddr *address, socklen_t *length);
int __real_connect(int fd, const struct sockaddr *address, socklen_t length);
int __real_pipe(int fd[2]);
pid_t __real_fork(void);

void *__wrap_malloc(size_t n);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *p, size_t n);
int __wrap_posix_memalign(void **p, size_t alignment, size_t n);
int __wrap_open(const char *path, int flags, ...);
ssize_t __wrap_write(int fd, const void *data, size_t n);
int __wrap_fsync(int fd);
int __wrap_rename(const char *from, const char *to);
int __wrap_link(const char *from, const char *to);
int __wrap_fcntl(int fd, int command, ...);
ssize_t __wrap_read(int fd, void *data, size_t n);
ssize_t __wrap_writev(int fd, const struct iovec *iov, int n);
int __wrap_poll(struct pollfd *polls, nfds_t n, int timeout);
int __wrap_socket(int domain, int type, int protocol);
int __wrap_accept(int fd, struct sockaddr *address, socklen_t *length);
int __wrap_connect(int fd, const struct sockaddr *address, socklen_t length);
int __wrap_pipe(int fd[2]);
pid_t __wrap_fork(void);

static long calls;

/* Counts the calls of the class that DM2_FAIL names; true for the Nth. */
static int must_fail(const char *class)
{
    const char *plan = getenv("DM2_FAIL");
    size_t n = strlen(class);
    if (plan == NULL || strncmp(plan, class, n) != 0 || plan[n] != ':')
        return 0;
    long want = strtol(plan + n + 1, NULL, 10);
    if (++calls != want)
        return 0;
    const char *mark = getenv("DM2_FAIL_MARK");
    int fd = mark == NULL ? -1 : __real_open(mark, O_WRONLY | O_CREAT, 0600);
    if (fd >= 0)
        (void)close(fd);
    return 1;
}

void *__wrap_malloc(size_t n)
{
    return must_fail("memory") ? NULL : __real_malloc(n);
}

void *__wrap_calloc(size_t n, size_t size)
{
    return must_fail("memory") ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *p, size_t n)
{
    return must_fail("memory") ? NULL : __real_realloc(p, n);
}

int __wrap_posix_memalign(void **p, size_t alignment, size_t n)
{
    return must_fail("memory") ? ENOMEM : __real_posix_memalign(p, alignment, n);
}

int __wrap_open(const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    int mode = (flags & O_CREAT) != 0 ? va_arg(args, int) : 0;
    va_end(args);
    if (must_fail("open")) {
        errno = EMFILE;
        return -1;
    }
    return __real_open(path, flags, mode);
}

ssize_t __wrap_write(int fd, const void *data, size_t n)
{
    if (must_fail("write")) {
        errno = ENOSPC;
        return -1;
    }
    return __real_write(fd, data, n);
}

int __wrap_fsync(int fd)
{
    if (must_fail("fsync")) {
        errno = EIO;
        return -1;
    }
    return __real_fsync(fd);
}

int __wrap_rename(const char *from, const char *to)
{
    if (must_fail("rename")) {
        errno = EACCES;
        return -1;
    }
    return __real_rename(from, to);
}

/* Every argument of fcntl that the programs use fits into a pointer. */
int __wrap_fcntl(int fd, int command, ...)
{
    va_list args;
    va_start(args, command);
    void *argument = va_arg(args, void *);
    va_end(args);
    if (command == F_SETLK && must_fail("lock")) {
        errno = ENOLCK;
        return -1;
    }
    return __real_fcntl(fd, command, argument);
}

int __wrap_link(const char *from, const char *to)
{
    if (must_fail("rename")) {
        errno = EACCES;
        return -1;
    }
    return __real_link(from, to);
}

ssize_t __wrap_read(int fd, void *data, size_t n)
{
    if (must_fail("read")) {
        errno = EIO;
        return -1;
    }
    return __real_read(fd, data, n);
}

ssize_t __wrap_writev(int fd, const struct iovec *iov, int n)
{
    if (must_fail("writev")) {
        errno = ECONNRESET;
        return -1;
    }
    return __real_writev(fd, iov, n);
}

int __wrap_poll(struct pollfd *polls, nfds_t n, int timeout)
{
    if (must_fail("poll")) {
        errno = ENOMEM;
        return -1;
    }
    return __real_poll(polls, n, timeout);
}

int __wrap_socket(int domain, int type, int protocol)
{
    if (must_fail("socket")) {
        errno = EMFILE;
        return -1;
    }
    return __real_socket(domain, type, protocol);
}

int __wrap_accept(int fd, struct sockaddr *address, socklen_t *length)
{
    if (must_fail("socket")) {
        errno = ECONNABORTED;
        return -1;
    }
    return __real_accept(fd, address, length);
}

int __wrap_connect(int fd, const struct sockaddr *address, socklen_t length)
{
    if (must_fail("socket")) {
        errno = ENETUNREACH;
        return -1;
    }
    return __real_connect(fd, address, length);
}

int __wrap_pipe(int fd[2])
{
    if (must_fail("socket")) {
        errno = EMFILE;
        return -1;
    }
    return __real_pipe(fd);
}

pid_t __wrap_fork(void)
{
    if (must_fail("socket")) {
        errno = EAGAIN;
        return -1;
    }
    return __real_fork();
}
