/* The times and counts of a run: run.log for people, timing.csv for programs. */
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
    uint64_t owned, mirrored, bytes; /* elements owned, elements mirrored, bytes of memory; at the start */
    struct server_times times;
};

struct run_report {
    const char *program, *deck;
    size_t elements;
    int64_t steps;             /* steps done */
    double set_up, total;      /* seconds, wall clock; total: from connecting to the last result */
    double stepping;           /* seconds of `timed` steps, without set-up and output */
    int64_t timed;             /* steps without a snapshot and without a copy */
    double wait;               /* seconds in which the client waited for servers, steps only */
    double relay;              /* seconds for routing and sending */
    double output;             /* seconds for compiling and writing results */
    uint64_t rebuilds, redone; /* rebuilds; rebuilds with a second round trip */
    size_t update_bytes;       /* g: bytes per boundary element of an update */
    int losses;                /* lost servers from which the run recovered */
    int64_t copies;            /* copies of the state in memory, checkpoints excluded */
    double copying;            /* seconds that steps with such a copy took longer than steps without */
    int ranks;
    struct server_report *servers; /* [ranks] */
    const char *prediction;        /* lines for run.log about the predicted times; NULL: none */
};

/* Element-steps per second over the timed steps; 0: no step was timed. */
double report_rate(const struct run_report *report);

/* Adds to run.log and writes timing.csv into the run directory. DM2_IO, DM2_MEMORY. */
enum dm2_status report_write(const struct run_report *report, struct results *results, struct dm2_error *err);

#endif
