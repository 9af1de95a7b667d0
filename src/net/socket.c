/* TCP sockets with deadlines.
 *
 * Descriptors are non-blocking: a read or write is tried first and polled for only where it would block,
 * which is one system call where data has come already. A deadline is a point in time, so that a peer that
 * sends single bytes cannot extend it. After EINTR a wait only reads the clock again, because a signal that
 * asks the process to end makes the deadline's cancel descriptor readable, which no race can lose. */
#include "dm2/net/socket.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dm2/base/clock.h"

#ifdef IOV_MAX
enum { IOV_MOST = IOV_MAX };
#else
enum { IOV_MOST = 16 }; /* _XOPEN_IOV_MAX, what POSIX promises */
#endif

enum { LISTEN_BACKLOG = 128 };

static const double LOOK_SECONDS = 5e-5; /* about the time that a process takes to wake up */

struct deadline deadline_in(double seconds, int cancel)
{
    return (struct deadline){.at = clock_now() + seconds, .cancel = cancel};
}

void socket_ignore_sigpipe(void)
{
    struct sigaction ignore;
    memset(&ignore, 0, sizeof ignore);
    ignore.sa_handler = SIG_IGN;
    sigemptyset(&ignore.sa_mask);
    (void)sigaction(SIGPIPE, &ignore, NULL);
}

int socket_poll(struct pollfd *polls, nfds_t n, int timeout, double look)
{
    if (timeout != 0 && look > 0.0) {
        double end = clock_now() + (timeout > 0 ? fmin(look, 1e-3 * timeout) : look);
        do {
            int ready = poll(polls, n, 0);
            if (ready != 0)
                return ready;
            (void)sched_yield();
        } while (clock_now() < end);
    }
    return poll(polls, n, timeout);
}

enum dm2_status socket_wait(int fd, short events, struct deadline until, struct dm2_error *err)
{
    for (;;) {
        struct pollfd wait[2] = {{.fd = fd, .events = events}, {.fd = until.cancel, .events = POLLIN}};
        double left = until.at - clock_now();
        int timeout = left <= 0 ? 0 : left > 1e6 ? 1000000000 : (int)ceil(left * 1000);
        int ready = socket_poll(wait, until.cancel >= 0 ? 2 : 1, timeout, LOOK_SECONDS);
        if (ready < 0 && errno != EINTR && errno != EAGAIN)
            return dm2_fail(err, DM2_NET, "poll: %s", strerror(errno));
        if (ready > 0 && until.cancel >= 0 && wait[1].revents != 0)
            return dm2_fail(err, DM2_INTERRUPTED, "asked to end by a signal");
        if (ready > 0 && wait[0].revents != 0)
            return DM2_OK; /* also after errors and hang-ups, which the next read or write reports */
        if (ready == 0 && left <= 0)
            return dm2_fail(err, DM2_TIMEOUT, "no answer in time");
    }
}

static int set_options(int fd)
{
    int flags = fcntl(fd, F_GETFL), on = 1;
    if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) < 0 || fcntl(fd, F_SETFD, FD_CLOEXEC) < 0)
        return -1;
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on); /* may fail for a listener */
    return 0;
}

static void name_address(const struct sockaddr *address, socklen_t length, char out[SOCKET_NAME])
{
    char host[256], port[32];
    if (getnameinfo(address, length, host, sizeof host, port, sizeof port, NI_NUMERICHOST | NI_NUMERICSERV) !=
        0)
        (void)snprintf(out, SOCKET_NAME, "unknown");
    else
        (void)snprintf(out, SOCKET_NAME, strchr(host, ':') != NULL ? "[%s]:%s" : "%s:%s", host, port);
}

static enum dm2_status resolve_host(const char *host, int port, int flags, struct addrinfo **out,
                                    struct dm2_error *err)
{
    struct addrinfo hints;
    char service[16];
    memset(&hints, 0, sizeof hints);
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = flags | AI_NUMERICSERV;
    (void)snprintf(service, sizeof service, "%d", port);
    int failure = getaddrinfo(host, service, &hints, out);
    if (failure != 0)
        return dm2_fail(err, DM2_NET,
                        "the host '%s' is not known (%s): check its spelling, or write its address", host,
                        failure == EAI_SYSTEM ? strerror(errno) : gai_strerror(failure));
    return DM2_OK;
}

enum dm2_status socket_listen(const char *address, int port, int *fd, char bound[SOCKET_NAME],
                              struct dm2_error *err)
{
    struct addrinfo *found = NULL;
    enum dm2_status status = resolve_host(address, port, AI_PASSIVE, &found, err);
    *fd = -1;
    if (status != DM2_OK)
        return status;
    int failure = 0;
    for (struct addrinfo *a = found; a != NULL && *fd < 0; a = a->ai_next) {
        int s = socket(a->ai_family, a->ai_socktype, a->ai_protocol), on = 1;
        if (s >= 0 && set_options(s) == 0 && setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
            bind(s, a->ai_addr, a->ai_addrlen) == 0 && listen(s, LISTEN_BACKLOG) == 0) {
            *fd = s;
        } else {
            failure = errno;
            socket_close(s);
        }
    }
    freeaddrinfo(found);
    if (*fd < 0)
        return dm2_fail(
            err, DM2_NET, "cannot listen on %s port %d: %s%s", address, port, strerror(failure),
            failure == EADDRINUSE ? "; another server may be running there, --port 0 picks a free port" : "");
    struct sockaddr_storage name;
    socklen_t length = sizeof name;
    if (getsockname(*fd, (struct sockaddr *)&name, &length) != 0)
        (void)snprintf(bound, SOCKET_NAME, "%s:%d", address, port);
    else
        name_address((struct sockaddr *)&name, length, bound);
    return DM2_OK;
}

static int is_loopback(const struct sockaddr *address)
{
    if (address->sa_family == AF_INET) {
        struct sockaddr_in in;
        memcpy(&in, address, sizeof in);
        return ntohl(in.sin_addr.s_addr) >> 24 == 127;
    }
    if (address->sa_family == AF_INET6) {
        struct sockaddr_in6 in6;
        memcpy(&in6, address, sizeof in6);
        return IN6_IS_ADDR_LOOPBACK(&in6.sin6_addr) ||
               (IN6_IS_ADDR_V4MAPPED(&in6.sin6_addr) && in6.sin6_addr.s6_addr[12] == 127);
    }
    return 0;
}

enum dm2_status socket_is_loopback(const char *address, int *loopback, struct dm2_error *err)
{
    struct addrinfo *found = NULL;
    enum dm2_status status = resolve_host(address, 0, AI_PASSIVE, &found, err);
    if (status != DM2_OK)
        return status;
    *loopback = 1;
    for (struct addrinfo *a = found; a != NULL; a = a->ai_next)
        *loopback &= is_loopback(a->ai_addr);
    freeaddrinfo(found);
    return DM2_OK;
}

enum dm2_status socket_accept(int listener, struct deadline until, int *fd, char peer[SOCKET_NAME],
                              struct dm2_error *err)
{
    *fd = -1;
    enum dm2_status status = socket_wait(listener, POLLIN, until, err);
    if (status != DM2_OK)
        return status;
    struct sockaddr_storage name;
    socklen_t length = sizeof name;
    int s = accept(listener, (struct sockaddr *)&name, &length);
    if (s < 0) {
        if (errno == EBADF || errno == EINVAL || errno == ENOTSOCK)
            return dm2_fail(err, DM2_NET, "cannot take a connection: %s", strerror(errno));
        return DM2_OK; /* the connection was closed, or there is no descriptor or memory for it */
    }
    if (set_options(s) != 0) {
        socket_close(s);
        return DM2_OK;
    }
    name_address((struct sockaddr *)&name, length, peer);
    *fd = s;
    return DM2_OK;
}

/* Connects to one address. DM2_OK with *fd >= 0, or with *fd = -1 and *failure = errno; otherwise as
 * socket_wait. */
static enum dm2_status connect_address(const struct addrinfo *a, struct deadline until, int *fd, int *failure,
                                       struct dm2_error *err)
{
    int s = socket(a->ai_family, a->ai_socktype, a->ai_protocol);
    enum dm2_status status = DM2_OK;
    *fd = -1;
    *failure = 0;
    if (s < 0 || set_options(s) != 0) {
        *failure = errno;
    } else if (connect(s, a->ai_addr, a->ai_addrlen) != 0) {
        *failure = errno;
        if (*failure == EINPROGRESS || *failure == EINTR) {
            socklen_t length = sizeof *failure;
            status = socket_wait(s, POLLOUT, until, err);
            if (status == DM2_OK && getsockopt(s, SOL_SOCKET, SO_ERROR, failure, &length) != 0)
                *failure = errno;
        }
    }
    if (status == DM2_OK && *failure == 0)
        *fd = s;
    else
        socket_close(s);
    return status;
}

enum dm2_status socket_connect(const char *host, int port, struct deadline until, int *fd,
                               struct dm2_error *err)
{
    struct addrinfo *found = NULL;
    enum dm2_status status = resolve_host(host, port, 0, &found, err);
    int failure = 0;
    *fd = -1;
    if (status != DM2_OK)
        return status;
    for (struct addrinfo *a = found; a != NULL && *fd < 0 && status == DM2_OK; a = a->ai_next)
        status = connect_address(a, until, fd, &failure, err);
    freeaddrinfo(found);
    if (status == DM2_TIMEOUT)
        return dm2_fail(err, DM2_TIMEOUT,
                        "%s:%d does not answer: is the machine up, and does a firewall let the port through?",
                        host, port);
    if (status != DM2_OK)
        return status;
    if (*fd < 0)
        return dm2_fail(
            err, DM2_NET, "%s:%d: %s%s", host, port, strerror(failure),
            failure == ECONNREFUSED ? "; no dm2-server listens there: start one (dm2-server --port N)" : "");
    return DM2_OK;
}

enum dm2_status socket_read_some(int fd, void *out, size_t n, size_t *got, int *closed, struct dm2_error *err)
{
    *got = 0;
    *closed = 0;
    ssize_t k;
    do
        k = read(fd, out, n);
    while (k < 0 && errno == EINTR);
    if (k > 0)
        *got = (size_t)k;
    else if (k == 0 && n > 0)
        *closed = 1;
    else if (k < 0 && errno != EAGAIN && errno != EWOULDBLOCK)
        return dm2_fail(err, DM2_NET, "the connection broke: %s", strerror(errno));
    return DM2_OK;
}

enum dm2_status socket_peek(int fd, void *out, size_t n, size_t *got, int *closed, struct dm2_error *err)
{
    ssize_t k;
    do
        k = recv(fd, out, n, MSG_PEEK);
    while (k < 0 && errno == EINTR);
    *got = k > 0 ? (size_t)k : 0;
    *closed = k == 0 && n > 0;
    if (k < 0 && errno != EAGAIN && errno != EWOULDBLOCK)
        return dm2_fail(err, DM2_NET, "the connection broke: %s", strerror(errno));
    return DM2_OK;
}

enum dm2_status socket_write_some(int fd, const struct iovec *iov, size_t n_iov, size_t *put,
                                  struct dm2_error *err)
{
    *put = 0;
    ssize_t k;
    do
        k = writev(fd, iov, n_iov > IOV_MOST ? (int)IOV_MOST : (int)n_iov);
    while (k < 0 && errno == EINTR);
    if (k >= 0)
        *put = (size_t)k;
    else if (errno != EAGAIN && errno != EWOULDBLOCK)
        return dm2_fail(err, DM2_NET, "the connection broke: %s", strerror(errno));
    return DM2_OK;
}

enum dm2_status socket_write_all(int fd, struct iovec *iov, size_t n_iov, struct deadline until,
                                 struct dm2_error *err)
{
    for (;;) {
        while (n_iov > 0 && iov->iov_len == 0) {
            iov++;
            n_iov--;
        }
        if (n_iov == 0)
            return DM2_OK;
        size_t put;
        enum dm2_status status = socket_write_some(fd, iov, n_iov, &put, err);
        if (status == DM2_OK && put == 0)
            status = socket_wait(fd, POLLOUT, until, err);
        if (status != DM2_OK)
            return status;
        for (; put > 0 && put >= iov->iov_len; n_iov--)
            put -= (iov++)->iov_len;
        if (put > 0) {
            iov->iov_base = (char *)iov->iov_base + put;
            iov->iov_len -= put;
        }
    }
}

void socket_close(int fd)
{
    if (fd >= 0)
        (void)close(fd);
}
