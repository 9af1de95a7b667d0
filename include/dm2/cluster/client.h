/* The client's role: it drives the servers through a run, relays their segments and compiles the results
 * (paper, section 5.1 and Fig. 7). It never parses a particle, except for the states that it writes out. */
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

/* What a program may want to show while it runs. Any may be NULL. */
struct client_events {
    void *context;
    void (*step)(void *context, int64_t step, const char *slowest,
                 double busy); /* the busiest server, its seconds */
    void (*hash)(void *context, int64_t step, uint64_t hash);
    void (*note)(void *context,
                 const char *line); /* something that takes long, or went wrong and is mended */
};

/* Round trips of a message to all servers and back from all (the paper's section 3.3 and Fig. 3). */
struct client_echo {
    const uint32_t *bytes; /* sizes of the message, 1 to ECHO_BYTES_MAX */
    int sizes;
    int repeats;     /* of each size, at most; sizes take turns */
    double budget;   /* seconds after which no further turn begins; the first two take place in any case */
    double *seconds; /* out: repeats * sizes, one turn after another */
    int done;        /* out: turns that took place */
};

enum { ECHO_BYTES_MAX = 4 * 1024 * 1024 };

struct client_options {
    const struct endpoint *servers; /* one per rank of the decomposition, */
    const struct endpoint *spares;  /* and those that stand in for one that is lost */
    size_t n_spares;
    /* Not NULL: starts all servers anew, after the loss of one, and writes where they are to servers[0 ..
     * ranks-1]. */
    enum dm2_status (*renew)(void *context, int ranks, struct endpoint *servers, struct dm2_error *err);
    void *renew_context;
    bool recover;       /* goes on after the loss of a server; else gives up at once */
    double reconnect;   /* seconds in which a server that was lost may come back */
    int64_t copy_every; /* steps between copies of the state; 0: none; -1: so that they cost at most 2 % */
    int64_t checkpoint_every;   /* steps between checkpoints; 0: none */
    const char *deck_path;      /* as the user wrote it: the name under which servers look for their copy */
    const char *version;        /* of the program */
    double timeout;             /* seconds of a server's silence */
    bool send_deck;             /* send the texts at once */
    int64_t hash_every;         /* 0: never */
    struct client_echo *echo;   /* measured before the run; NULL: nothing is */
    int cancel;                 /* readable when the process is asked to end; -1: none */
    const struct auth_key *key; /* to be proved to every server, and by it; NULL: none */
    struct client_events events;
};

struct client_job {
    const struct deck_source *source;
    const struct config *config;
    const struct model *model;
    const struct decomposition *decomposition;
    const struct state *start; /* to continue from; NULL: from the beginning */
    bool by_particles;         /* how a domain is cut for fewer servers */
    struct results *results;   /* opened; this function adds to it, the caller closes or aborts it */
};

/* Runs the job to its end: rows of history, snapshots, the final state. *report is filled on success, its
 * servers array is malloc'd for the caller. Failures name the server (host:port), the step, the reason and
 * what to do: DM2_NET, DM2_TIMEOUT, DM2_PROTOCOL, DM2_NUMERIC, DM2_MEMORY, DM2_IO, DM2_INTERRUPTED.
 * Connections are closed in any case.
 *
 * With `recover`, a server that is lost once all have been ready (it closes, is silent, sends what cannot be)
 * ends no run: it may come back within `reconnect` seconds, else a spare takes its place, else the domain is
 * cut anew for those that remain, and the run goes on from the last copy; what it writes is the same to the
 * byte. When nobody remains or a signal asks for the end, the state in hand is left as a checkpoint. */
enum dm2_status client_run(const struct client_job *job, const struct client_options *options,
                           struct run_report *report, struct dm2_error *err);

/* A session for options->echo alone, with `ranks` servers; needs of the options what a connection needs. */
enum dm2_status client_measure_network(const struct client_options *options, int ranks,
                                       struct dm2_error *err);

#endif
