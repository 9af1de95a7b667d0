/* Where connections wait until the server has time for them, and where it says what it does, also while it is busy
 * (docs/protocol.md: STATUS).
 *
 * A server serves one session at a time. Connections that come meanwhile are taken and looked at: one that asks for the
 * status is answered on the spot, one of a client waits for its turn, one that says nothing for too long or is none of
 * dm2's is closed. At most LOBBY_MOST are inside, the others are left in the listen backlog. While the server is busy at
 * most LOBBY_CLIENTS of them are clients: further ones are sent away. Nothing here waits for anybody: a session is not held
 * up by those who stand outside. */
#ifndef DM2_DIST_LOBBY_H
#define DM2_DIST_LOBBY_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/dist/auth.h"
#include "dm2/dist/server.h"
#include "dm2/net/frame.h"
#include "dm2/net/socket.h"

enum { LOBBY_MOST = 16, LOBBY_CLIENTS = 12 }; /* the others' places are for who asks for the status */

enum visitor_kind {
    VISITOR_NEW,    /* has not said yet what it wants */
    VISITOR_CLIENT, /* waits for its turn; nothing has been read from it */
    VISITOR_ASKS,   /* its STATUS message is on its way in, */
    VISITOR_PROVES  /* or the proof that it has the key */
};

struct visitor {
    struct channel channel; /* its name is the peer */
    enum visitor_kind kind;
    bool vague;   /* has sent too little to tell: looked at again soon */
    bool whole;   /* a client's first message is there to its end */
    bool gone;    /* a client that has closed */
    double until; /* a time of clock_now(): all that it wants must have been said by then */
    struct auth_nonces nonces;
};

/* What the server does while it is busy. */
struct lobby_business {
    const char *peer; /* NULL: nothing */
    double since;     /* clock_now() */
    const struct session_summary *session;
};

struct lobby {
    const struct server_options *options;
    int listener; /* not owned */
    server_log log;
    void *log_context;
    struct lobby_business business;
    struct visitor visitors[LOBBY_MOST]; /* in the order in which they came */
    size_t n;
    double deaf_until; /* a time of clock_now(): no connection is taken before, since one could not be */
    struct bytes_writer out;
};

void lobby_open(struct lobby *l, int listener, const struct server_options *options, server_log log, void *log_context);
/* Closes all connections in it. */
void lobby_close(struct lobby *l);

/* Waits until a client's turn can come, and hands its descriptor and name over. DM2_TIMEOUT, DM2_INTERRUPTED; DM2_NET where the
 * listener broke. */
enum dm2_status lobby_next(struct lobby *l, struct deadline until, int *fd, char peer[SOCKET_NAME],
                           struct dm2_error *err);

/* Looks after the lobby until `fd` can be read. False: the deadline has come, the process is asked to end, or something broke;
 * the next wait for fd finds out which. */
bool lobby_wait(struct lobby *l, int fd, struct deadline until);

#endif
