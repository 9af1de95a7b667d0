/* Where connections wait until the server has time for them, and where it says what it does, also while it is
 * busy (docs/protocol.md: STATUS).
 *
 * A server serves one session at a time. Connections that come meanwhile are taken and looked at: where there
 * is a key, everybody proves it first (dm2/cluster/auth.h); one that asks for the status is answered on the
 * spot, one of a client waits for its turn, one that says nothing for too long or is none of dm2's is closed.
 * At most LOBBY_MOST are inside, the others are left in the listen backlog; in a full lobby those who may be
 * strangers have LOBBY_GRACE seconds, then the next one comes in. While the server is busy at most
 * LOBBY_CLIENTS of them are clients: further ones are sent away. Nothing here waits for anybody: a session is
 * not held up by those who stand outside. */
#ifndef DM2_CLUSTER_LOBBY_H
#define DM2_CLUSTER_LOBBY_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/server.h"
#include "dm2/net/frame.h"
#include "dm2/net/socket.h"

enum { LOBBY_MOST = 16, LOBBY_CLIENTS = 12 }; /* the others' places are for who asks for the status */
#define LOBBY_GRACE 1.0                       /* seconds */

enum visitor_kind {
    VISITOR_NEW,    /* has not said yet what it wants */
    VISITOR_CLIENT, /* waits for its turn; it has proved the key, or nothing has been read from it */
    VISITOR_ASKS,   /* its STATUS message is on its way in (without a key), */
    VISITOR_PROVES  /* or the proof that it has the key */
};

struct visitor {
    struct channel channel; /* its name is the peer */
    enum visitor_kind kind;
    enum auth_role role; /* of one that proves */
    bool partial;        /* has sent too little to tell: looked at again soon */
    bool verified;       /* a client that has proved the key, or whose first message is there to its end */
    bool closed;         /* a client that has closed */
    double came, until;  /* times of clock_now(): all that it wants must have been said by the latter */
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
    double accept_after; /* a time of clock_now(): no connection is taken before, since one could not be */
    struct bytes_writer out;
};

void lobby_open(struct lobby *l, int listener, const struct server_options *options, server_log log,
                void *log_context);
/* Closes all connections in it. */
void lobby_close(struct lobby *l);

/* One more connection, which is taken over; fewer than LOBBY_MOST are inside. */
void lobby_enter(struct lobby *l, int fd, const char *peer);

/* Waits until a client's turn can come, and hands its channel over, with the session's keys where there are
 * some. DM2_TIMEOUT, DM2_INTERRUPTED; DM2_NET where the listener broke; DM2_PROTOCOL where there is none (-1)
 * and nobody is left inside. */
enum dm2_status lobby_next(struct lobby *l, struct deadline until, struct channel *out,
                           struct dm2_error *err);

/* Looks after the lobby once, without waiting: for who computes and has no time. */
void lobby_look(struct lobby *l);

/* Looks after the lobby until `fd` can be read. False: the deadline has come, the process is asked to end, or
 * something broke; the next wait for fd finds out which. */
bool lobby_wait(struct lobby *l, int fd, struct deadline until);

#endif
