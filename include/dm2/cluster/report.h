/* What a run took, and where: run.log for people, timing.csv for programs. */
#ifndef DM2_CLUSTER_REPORT_H
#define DM2_CLUSTER_REPORT_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/cluster/messages.h"
#include "dm2/net/socket.h"
#include "dm2/output/results.h"

/* One server, or the one subdomain of the sequential program. */
struct server_report {
    char name[SOCKET_NAME];
    size_t cells;
    uint64_t owned, mirrored, bytes; /* at the start */
    struct server_times times;
};

struct run_report {
    const char *program, *version, *deck;
    size_t elements;
    int64_t steps;        /* done */
    double set_up, total; /* seconds, wall clock; total: from connecting to the last result */
    double stepping;      /* seconds of `timed` steps: time steps alone, without set-up and output */
    int64_t timed;
    double wait, relay,
        output; /* the client's own seconds: for servers, routing and sending, compiling and writing */
    uint64_t rebuilds, redone; /* exchanges that renewed owners; of these, asked for afterwards */
    size_t update_bytes;       /* g: bytes per boundary element of an update */
    int losses;                /* of servers, from which the run recovered */
    int64_t copies;            /* of the state, in memory, but for checkpoints; */
    double copying;            /* what their steps took longer than others, seconds */
    int ranks;
    struct server_report *servers; /* ranks of them */
    const char *prediction;        /* lines of text about it for run.log; NULL: none */
};

/* Element-steps per second of the time steps alone; 0 where nothing was timed. */
double report_rate(const struct run_report *report);

/* Writes both files into the run directory. DM2_IO, DM2_MEMORY. */
enum dm2_status report_write(const struct run_report *report, struct results *results, struct dm2_error *err);

#endif
