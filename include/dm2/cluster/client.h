/* The client drives the servers through a run, relays their segments and compiles their results (paper,
 * section 5.1 and Fig. 7). The client decodes elements in states only; the segments of an exchange pass
 * through as bytes. */
#ifndef DM2_CLUSTER_CLIENT_H
#define DM2_CLUSTER_CLIENT_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/decomposition.h"
#include "dm2/cluster/hosts.h"
#include "dm2/cluster/report.h"
#include "dm2/deck/deck.h"
#include "dm2/engine/model.h"
#include "dm2/output/results.h"
#include "dm2/output/state.h"

/* Calls that inform the user during a run; each may be NULL. */
struct client_events {
    void *context;
    /* After each step: the server that worked longest (NULL: the only server), and its seconds of work. */
    void (*step)(void *context, int64_t step, const char *slowest, double busy);
    void (*hash)(void *context, int64_t step, uint64_t hash);
    /* A server that does not answer soon, or the loss of a server from which the run recovers. */
    void (*note)(void *context, const char *line);
};

/* Round trips of a message to all servers and back from all (the paper's section 3.3 and Fig. 3). */
struct client_echo {
    const uint32_t *bytes; /* sizes of the message, 1 to ECHO_BYTES_MAX */
    int sizes;
    int repeats;     /* turns at most; each turn sends one message of every size */
    double budget;   /* seconds after which no turn begins, except the first two */
    double *seconds; /* out: [repeats * sizes], one turn after another */
    int done;        /* out: number of turns */
};

enum { ECHO_BYTES_MAX = 4 * 1024 * 1024 };

struct client_options {
    const struct endpoint *servers; /* [ranks of the decomposition] */
    const struct endpoint *spares;  /* [n_spares] each replaces a lost server */
    size_t n_spares;
    /* Not NULL: after the loss of a server, starts all servers anew and writes their addresses to
     * servers[0 .. ranks-1]. */
    enum dm2_status (*renew)(void *context, int ranks, struct endpoint *servers, struct dm2_error *err);
    void *renew_context;
    bool recover;               /* the run continues after the loss of a server; false: the run ends */
    double reconnect;           /* seconds in which a lost server may come back */
    int64_t copy_every;         /* steps between copies of the state; 0: none; -1: at most 2 % of the time */
    int64_t checkpoint_every;   /* steps between checkpoints; 0: none */
    const char *deck_path;      /* as the user wrote it: servers look for their copy under this name */
    const char *version;        /* of the program */
    double timeout;             /* seconds without a byte from a server until the server counts as lost */
    bool send_deck;             /* sends the deck's texts without asking for the server's copy first */
    int64_t hash_every;         /* 0: never */
    struct client_echo *echo;   /* round trips measured before the run; NULL: none */
    int cancel;                 /* readable when the process is asked to end; -1: none */
    const struct auth_key *key; /* each side proves the key to the other side; NULL: none */
    struct client_events events;
};

struct client_job {
    const struct deck_source *source;
    struct config *config; /* of the model; its steps become fewer where a block `stop` ends the run */
    const struct model *model;
    const struct decomposition *decomposition;
    const struct state *start; /* the state to continue from; NULL: the run starts at step 0 */
    bool by_particles;         /* for fewer servers the domain is bisected by elements; false: by cells */
    struct results *results;   /* open; client_run adds to the results, the caller closes or aborts them */
};

/* Runs the job to its end and writes its results: rows of the history, profiles, snapshots, checkpoints, the
 * final state. *report is filled on success; the caller frees its array `servers`. A failure names the server
 * (host:port), the step, the reason and the remedy: DM2_NET, DM2_TIMEOUT, DM2_PROTOCOL, DM2_NUMERIC, DM2_DECK
 * (too long to be sent), DM2_MEMORY, DM2_IO, DM2_INTERRUPTED, the status of a server's ERROR message. All
 * connections are closed when the function returns.
 *
 * A server is lost when its connection closes, when the server is silent, or when its messages are wrong.
 * With `recover`, the run survives such a loss once all servers have been ready: the server may come back
 * within `reconnect` seconds, else a spare replaces it, else the domain is cut anew for the remaining
 * servers. The run then continues from the last copy of the state, and its results are the same to the byte.
 * When no server remains or a signal ends the run, the last copy of the state is left as a checkpoint. */
enum dm2_status client_run(const struct client_job *job, const struct client_options *options,
                           struct run_report *report, struct dm2_error *err);

/* Measures round trips (options->echo) with options->servers[0 .. ranks-1] in a session without a deck. Of
 * the other options only timeout, cancel, key, version, recover and events.note are used. Errors as for
 * client_run, without those of results. */
enum dm2_status client_measure_network(const struct client_options *options, int ranks,
                                       struct dm2_error *err);

#endif
