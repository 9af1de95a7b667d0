/* TCP sockets with deadlines: resolve, listen, accept, connect, and reads and writes that end.
 *
 * Every descriptor is non-blocking and closed on exec; a stream has TCP_NODELAY, because a message is one
 * write. Every wait ends at its deadline or when the process is asked to end. The process must ignore SIGPIPE
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

/* The end of a wait. */
struct deadline {
    double at;  /* a time of clock_now() */
    int cancel; /* becomes readable when the process is asked to end; -1: none */
};

/* Event of poll: the peer has ended its stream, even where bytes of the stream wait to be read. Linux has
 * this event but hides its name, POLLRDHUP, from POSIX programs; elsewhere poll reports broken connections
 * alone. */
#if defined(__linux__) && !defined(__sparc__)
enum { SOCKET_ENDED = 0x2000 };
#else
enum { SOCKET_ENDED = 0 };
#endif

/* The deadline `seconds` from now. */
struct deadline deadline_in(double seconds, int cancel);

/* From then on a write to a closed connection is an error code, not a signal. */
void socket_ignore_sigpipe(void);

/* poll(), but before poll() sleeps it is repeated without waiting for up to `look` seconds, and other
 * processes run in between, because a message of a time step mostly comes sooner than a sleeping process
 * wakes up. Other arguments, return value and errno as of poll(). */
int socket_poll(struct pollfd *polls, nfds_t n, int timeout, double look);

/* Waits until `fd` is ready for `events` (POLLIN, POLLOUT) or broken. DM2_TIMEOUT, DM2_INTERRUPTED, DM2_NET;
 * *err does not name the peer. */
enum dm2_status socket_wait(int fd, short events, struct deadline until, struct dm2_error *err);

/* Listens on a numeric address or a host name; port 0 picks a free port. *fd is the caller's to close;
 * `bound` gets "addr:port" with the port in use. DM2_NET where the address does not resolve or the port is
 * taken. */
enum dm2_status socket_listen(const char *address, int port, int *fd, char bound[SOCKET_NAME],
                              struct dm2_error *err);

/* Sets *loopback to whether `address` names this machine alone (127.0.0.0/8, ::1, and names that resolve to
 * nothing else). DM2_NET where the address does not resolve. */
enum dm2_status socket_is_loopback(const char *address, int *loopback, struct dm2_error *err);

/* Takes the next connection; `peer` gets "addr:port", *fd is the caller's to close. DM2_OK and *fd = -1 where
 * the connection was closed before it could be taken, or this machine lacks descriptors or memory, because
 * the listener still works then; in the second case the connection still waits, so the caller should pause
 * before the next try. DM2_TIMEOUT, DM2_INTERRUPTED, DM2_NET. */
enum dm2_status socket_accept(int listener, struct deadline until, int *fd, char peer[SOCKET_NAME],
                              struct dm2_error *err);

/* Connects to the first of the host's addresses that answers; *fd is the caller's to close. DM2_NET where the
 * host is unknown, unreachable, or refuses; DM2_TIMEOUT; DM2_INTERRUPTED. The text names host and port, with
 * advice. */
enum dm2_status socket_connect(const char *host, int port, struct deadline until, int *fd,
                               struct dm2_error *err);

/* Takes up to n of the bytes that have come: *got = 0 and DM2_OK where none have; *closed = 1 where the peer
 * has ended its stream. DM2_NET where the connection broke. */
enum dm2_status socket_read_some(int fd, void *out, size_t n, size_t *got, int *closed,
                                 struct dm2_error *err);

/* As socket_read_some, but the bytes stay for the next read. */
enum dm2_status socket_peek(int fd, void *out, size_t n, size_t *got, int *closed, struct dm2_error *err);

/* Writes as many bytes as the connection takes now, *put of them, perhaps 0. DM2_NET where the connection
 * broke. */
enum dm2_status socket_write_some(int fd, const struct iovec *iov, size_t n_iov, size_t *put,
                                  struct dm2_error *err);

/* Writes all bytes, in order. The contents of the iovecs are undefined afterwards. DM2_NET, DM2_TIMEOUT,
 * DM2_INTERRUPTED. */
enum dm2_status socket_write_all(int fd, struct iovec *iov, size_t n_iov, struct deadline until,
                                 struct dm2_error *err);

/* Closes fd, which may be -1; errors are ignored. */
void socket_close(int fd);

#endif
