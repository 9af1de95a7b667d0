/* TCP sockets with deadlines: resolve, listen, accept, connect, and reads and writes that end.
 *
 * Every descriptor is non-blocking and closed on exec; a stream has TCP_NODELAY, because a message is one
 * write. Every wait ends at its deadline or when the process is asked to end. The process ignores SIGPIPE
 * (socket_ignore_sigpipe). */
#ifndef DM2_NET_SOCKET_H
#define DM2_NET_SOCKET_H

#include <poll.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>
#include <sys/uio.h>

#include "dm2/base/status.h"

enum {
    SOCKET_NAME = 300, /* room for "host:port" */
    SOCKET_PORT_MAX = 65535
};

/* Until when to wait: a time of clock_now(), and a descriptor that becomes readable when the process is asked
 * to end
 * (-1: none). */
struct deadline {
    double at;
    int cancel;
};

/* For poll: the peer has ended its stream, also where bytes of it still wait to be read. Linux has this event
 * and hides it from POSIX programs (POLLRDHUP); elsewhere poll tells of broken connections alone. */
#if defined(__linux__) && !defined(__sparc__)
enum { SOCKET_ENDED = 0x2000 };
#else
enum { SOCKET_ENDED = 0 };
#endif

/* `seconds` from now. */
struct deadline deadline_in(double seconds, int cancel);

/* A write to a closed connection is an error code, not a signal. */
void socket_ignore_sigpipe(void);

/* poll(), except that it looks for up to `look` seconds, letting other processes run in between, before it
 * sleeps: what is awaited in a time step mostly comes sooner than a sleeping process wakes up. Other
 * arguments, return value and errno as poll() has them. */
int socket_poll(struct pollfd *polls, nfds_t n, int timeout, double look);

/* Waits until `fd` can do `events` (POLLIN, POLLOUT). DM2_TIMEOUT, DM2_INTERRUPTED, DM2_NET; *err says only
 * what happened, the caller knows to whom. */
enum dm2_status socket_wait(int fd, short events, struct deadline until, struct dm2_error *err);

/* Listens on a numeric address or a host name; port 0 picks a free one. *bound gets the name "addr:port" with
 * the port that was bound. DM2_NET: the address does not resolve or the port is taken. */
enum dm2_status socket_listen(const char *address, int port, int *fd, char bound[SOCKET_NAME],
                              struct dm2_error *err);

/* Does `address` name this machine alone (127.0.0.0/8, ::1, and names that resolve to nothing else)? */
enum dm2_status socket_is_loopback(const char *address, int *loopback, struct dm2_error *err);

/* Takes the next connection. *peer gets "addr:port". Failures of one connection (it went away before it was
 * taken) and shortages of this machine (descriptors, memory) are not the listener's: such a call gives DM2_OK
 * and *fd = -1. In a shortage the connection is still there: wait a little before the next try. DM2_TIMEOUT,
 * DM2_INTERRUPTED, DM2_NET. */
enum dm2_status socket_accept(int listener, struct deadline until, int *fd, char peer[SOCKET_NAME],
                              struct dm2_error *err);

/* Connects to the first of the host's addresses that answers. DM2_NET: unknown host, refused, unreachable;
 * DM2_TIMEOUT; DM2_INTERRUPTED. The text names host and port and what to do. */
enum dm2_status socket_connect(const char *host, int port, struct deadline until, int *fd,
                               struct dm2_error *err);

/* What is there now, up to n bytes: *got = 0 and DM2_OK where nothing is; *closed where the peer has ended
 * its stream. DM2_NET where the connection broke. */
enum dm2_status socket_read_some(int fd, void *out, size_t n, size_t *got, int *closed,
                                 struct dm2_error *err);

/* What is there now, up to n bytes, without taking it: the next read gets it again. As socket_read_some else.
 */
enum dm2_status socket_peek(int fd, void *out, size_t n, size_t *got, int *closed, struct dm2_error *err);

/* Writes what goes now: *put = 0 where the connection takes nothing. */
enum dm2_status socket_write_some(int fd, const struct iovec *iov, size_t n_iov, size_t *put,
                                  struct dm2_error *err);

/* Writes everything, in order. The iovecs are used up: their contents are undefined afterwards. */
enum dm2_status socket_write_all(int fd, struct iovec *iov, size_t n_iov, struct deadline until,
                                 struct dm2_error *err);

/* Closes; errors have no meaning any more. fd may be -1. */
void socket_close(int fd);

#endif
