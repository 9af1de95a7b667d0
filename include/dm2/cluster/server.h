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
    const char *deck_dir; /* decks named by clients are looked for below it */
    const char *version;  /* of the program, for HELLO */
    double handshake; /* seconds in which a client must have proved the key, and, when its turn has come, said
                         HELLO */
    double timeout;   /* seconds of silence after which a client is given up; a longer one of the client's
                         counts twice, up to ten times this one */
    int cancel;       /* readable when the process is asked to end; -1: none */
    const struct auth_key *key;     /* that a client must have; NULL: none */
    const struct allow_list *allow; /* who may connect; NULL: everybody */
    uint64_t max_elements;          /* of a deck, which also limit its cells and sites; */
    int64_t max_steps;              /* and its time steps; 0: any */
};

/* What a session came to. */
struct session_summary {
    char deck[200];
    int rank, ranks;
    int64_t steps;   /* done */
    uint64_t echoes; /* round trips of bytes that mean nothing */
    bool measured;   /* they were all that the session was for */
    double seconds;
};

/* Serves one session on a connected descriptor, which it closes. A failure is told to the client as far as it
 * still listens; *err has it for the log, one line. DM2_PROTOCOL where it was refused, DM2_INTERRUPTED when
 * asked to end. */
enum dm2_status server_session(int fd, const char *peer, const struct server_options *options,
                               struct session_summary *summary, struct dm2_error *err);

enum server_event {
    SERVER_CONNECTED, /* a client is there */
    SERVER_DONE,      /* its session came to its end, */
    SERVER_FAILED     /* or did not */
};

/* A line of the log: who, and what happened. */
typedef void (*server_log)(void *context, enum server_event event, const char *peer, const char *line);

/* Serves until asked to end (DM2_INTERRUPTED), or with `once` for one session, which it waits for `timeout`
 * seconds: DM2_OK, the session's own failure, or DM2_TIMEOUT. Whatever a client does, the next one is served.
 * DM2_NET: the listener itself broke. */
enum dm2_status server_serve(int listener, const struct server_options *options, bool once, server_log log,
                             void *context, struct dm2_error *err);

#endif
