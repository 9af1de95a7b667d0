/* The client's role: it drives the servers through a run, relays their segments and compiles the results
 * (paper, section 5.1 and Fig. 7). It never parses a particle, except for the states that it writes out. */
#ifndef DM2_DIST_CLIENT_H
#define DM2_DIST_CLIENT_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/dist/auth.h"
#include "dm2/dist/decomposition.h"
#include "dm2/dist/hosts.h"
#include "dm2/dist/report.h"
#include "dm2/sim/deck.h"
#include "dm2/sim/model.h"
#include "dm2/sim/results.h"

/* What a program may want to show while it runs. Any may be NULL. */
struct client_events {
    void *context;
    void (*step)(void *context, int64_t step, int slowest, double busy); /* the busiest server, its seconds */
    void (*hash)(void *context, int64_t step, uint64_t hash);
    void (*note)(void *context, const char *line); /* something that takes long */
};

struct client_options {
    const struct endpoint *servers; /* one per rank of the decomposition */
    const char *deck_path; /* as the user wrote it: the name under which servers look for their copy */
    const char *version;   /* of the program */
    double timeout;        /* seconds of a server's silence */
    bool send_deck;        /* send the texts at once */
    int64_t hash_every;    /* 0: never */
    int cancel;            /* readable when the process is asked to end; -1: none */
    const struct auth_key *key; /* to be proved to every server, and by it; NULL: none */
    struct client_events events;
};

struct client_job {
    const struct deck_source *source;
    const struct config *config;
    const struct model *model;
    const struct decomposition *decomposition;
    struct results *results; /* opened; this function adds to it, the caller closes or aborts it */
};

/* Runs the job to its end: rows of history, snapshots, the final state. *report is filled on success, its
 * servers array is malloc'd for the caller. Failures name the server (host:port), the step, the reason and
 * what to do: DM2_NET, DM2_TIMEOUT, DM2_PROTOCOL, DM2_NUMERIC, DM2_MEMORY, DM2_IO, DM2_INTERRUPTED.
 * Connections are closed in any case. */
enum dm2_status client_run(const struct client_job *job, const struct client_options *options,
                           struct run_report *report, struct dm2_error *err);

#endif
