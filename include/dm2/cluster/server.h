/* The server's role: an iterative daemon that serves one client's session after another (paper, section 3.1
 * and Fig. 7). */
#ifndef DM2_CLUSTER_SERVER_H
#define DM2_CLUSTER_SERVER_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/net/allow.h"

struct server_options {
    const char *deck_dir; /* directory below which decks are found by name */
    const char *version;  /* of the program, for WELCOME */
    double handshake;     /* seconds in which a client must prove the key, and, in its turn, send HELLO */
    double timeout; /* seconds of silence after which a session ends; of a client with a longer timeout, twice
                       that timeout, but at most ten times this one */
    int cancel;     /* descriptor, readable when the process is asked to end; -1: none */
    const struct auth_key *key;     /* that clients must prove; NULL: none */
    const struct allow_list *allow; /* addresses that may connect; NULL: all */
    uint64_t max_elements;          /* of a deck; bounds its cells and lattice sites, too; 0: any number */
    int64_t max_steps;              /* time steps of a deck; 0: any number */
};

/* The result of a session. */
struct session_summary {
    char deck[200];  /* name of the deck; empty: not known yet */
    int rank, ranks; /* rank -1: not known yet */
    int64_t steps;   /* done */
    uint64_t echoes; /* ECHO messages sent back */
    bool measured;   /* the session was for ECHO alone */
    double seconds;
};

/* Serves one session on a connected descriptor and closes the descriptor. The client gets ERROR where the
 * connection still works; *err has one line for the log. DM2_PROTOCOL where the client was refused or broke
 * the protocol, DM2_INTERRUPTED when the process is asked to end, DM2_NET, DM2_TIMEOUT, DM2_DECK,
 * DM2_NUMERIC, DM2_MEMORY. */
enum dm2_status server_session(int fd, const char *peer, const struct server_options *options,
                               struct session_summary *summary, struct dm2_error *err);

enum server_event {
    SERVER_CONNECTED, /* a client is served, or has asked for the status */
    SERVER_DONE,      /* a session came to its end */
    SERVER_FAILED     /* a session failed, or a connection was refused */
};

/* Takes one line of the log, about `peer`. */
typedef void (*server_log)(void *context, enum server_event event, const char *peer, const char *line);

/* Serves sessions until the process is asked to end: DM2_INTERRUPTED. With `once`, waits options->timeout
 * seconds for one session: DM2_OK, the session's failure, or DM2_TIMEOUT. Without `once` a session that fails
 * does not end the server. DM2_NET where the listener failed. */
enum dm2_status server_serve(int listener, const struct server_options *options, bool once, server_log log,
                             void *context, struct dm2_error *err);

#endif
