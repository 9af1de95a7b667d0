/* Connections that wait until the server has time for them, and the server's answers to STATUS, also while it
 * is busy (docs/protocol.md: STATUS).
 *
 * A server serves one session at a time. A connection that comes meanwhile is a visitor. With a key every
 * visitor proves the key first (dm2/cluster/auth.h). A visitor that asks for the status is answered at once;
 * a visitor that is a client waits for its turn; a visitor that is silent for too long, or whose bytes are
 * not dm2's protocol, is closed.
 *
 * At most LOBBY_MOST visitors are taken; the other connections stay in the listen backlog. In a full lobby a
 * visitor that is not verified (it has not proved the key; without a key, its first message is not complete)
 * has LOBBY_GRACE seconds; then the next connection takes its place. While the server is busy at most
 * LOBBY_CLIENTS visitors are clients; further clients are sent away. No function waits for a visitor, so that
 * visitors do not delay a session. */
#ifndef DM2_CLUSTER_LOBBY_H
#define DM2_CLUSTER_LOBBY_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/messages.h"
#include "dm2/cluster/server.h"
#include "dm2/net/frame.h"
#include "dm2/net/socket.h"

enum { LOBBY_MOST = 16, LOBBY_CLIENTS = 12 }; /* the other places are for visitors that ask for the status */
#define LOBBY_GRACE 1.0                       /* seconds */

enum visitor_kind {
    VISITOR_NEW,    /* its first message is not known yet */
    VISITOR_PLACED, /* its HELLO is due: the first, or after PLACE the one that takes its turn */
    VISITOR_CLIENT, /* waits for its turn; its HELLO is the next message of the channel, or nothing is read */
    VISITOR_ASKS,   /* without a key: its STATUS message is being read */
    VISITOR_PROVES  /* with a key: its PROOF is due */
};

struct visitor {
    struct channel channel; /* its name is the peer */
    enum visitor_kind kind;
    enum auth_role role; /* of a visitor with VISITOR_PROVES */
    bool partial;        /* its bytes do not show the type of its first message yet; peeked at again soon */
    bool verified;       /* a client that has proved the key, or whose first message is complete */
    bool asked;          /* PLACE has been sent */
    bool closed;         /* a client that has ended its stream */
    double came, until;  /* clock_now() of its connection, and by when it must be verified or answered */
    struct auth_nonces nonces;
};

/* The session of a server that is busy. */
struct lobby_business {
    const char *peer; /* the session's client; NULL: the server is free */
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
    double accept_after; /* clock_now() before which no connection is taken, because the last try failed */
    struct bytes_writer out; /* the payload of the next message */
    bool named;              /* `id` is drawn */
    unsigned char id[SERVER_ID];
};

/* An empty lobby. The listener (-1: none) stays the caller's; `log` may be NULL. */
void lobby_open(struct lobby *l, int listener, const struct server_options *options, server_log log,
                void *log_context);

/* Closes the connections of all visitors. */
void lobby_close(struct lobby *l);

/* Makes a connection a visitor; the descriptor is the lobby's from then on. At most LOBBY_MOST - 1 visitors
 * are there before. */
void lobby_enter(struct lobby *l, int fd, const char *peer);

/* Marks the server free and waits until a client's turn comes. *out is the client's channel, with the
 * session's keys where the server has a key, and is the caller's from then on. DM2_TIMEOUT, DM2_INTERRUPTED;
 * DM2_NET where the listener or poll failed; DM2_PROTOCOL where neither listener nor visitor is there. */
enum dm2_status lobby_next(struct lobby *l, struct deadline until, struct channel *out,
                           struct dm2_error *err);

/* Answers visitors once, without waiting, for a server that computes. A failure of listener or poll is left
 * to the next wait. */
void lobby_look(struct lobby *l);

/* Answers visitors until `fd` can be read. False where the deadline has come, the process is asked to end, or
 * listener or poll failed; the caller's next wait for fd tells which. */
bool lobby_wait(struct lobby *l, int fd, struct deadline until);

#endif
