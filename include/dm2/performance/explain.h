/* Explanation of a finished run: the predicted time, the measured time, and the causes of the difference.
 *
 *     predicted = W/P + max(0, m_N g p + b_N - H W/P)
 *     measured  = predicted + computing + imbalance + migration + relay + waiting
 *
 * P is N, or the number of processors where there are fewer. W is the time that all servers together compute:
 * T_seq, corrected for caches (perf_k_at). H is the share of W/P that the servers compute while messages are
 * on the way; H = 0 where client and servers share processors, because handling a message then takes time
 * from computing. The second line is exact, because `waiting` is the remainder. There is one b_N, not two as
 * in eqs. (18)-(20), because the boundary and the migrants of a step are in one message. */
#ifndef DM2_PERFORMANCE_EXPLAIN_H
#define DM2_PERFORMANCE_EXPLAIN_H

#include <stdbool.h>
#include <stddef.h>

/* One server; seconds and counts per time step. */
struct explain_server {
    double computing; /* forces, integration, rebuilds */
    double ahead;     /* part of `computing` while messages were on the way */
    double packing;   /* packing and unpacking */
    double mirrored;  /* elements that the server mirrors, as known before the run */
    double migrants;  /* elements that the server sends away */
};

struct explain_input {
    int servers;    /* N */
    int processors; /* processors of all servers together; N where each has its own */
    double t_seq;   /* s */
    double work;    /* W, s */
    double m, b;    /* m_N, b_N */
    bool apart;     /* the client has a processor of its own */
    double g, g_migrant;
    double measured; /* s per step */
    double relay;    /* routing and sending by the client, s per step */
    double redone;   /* exchanges with a second round trip, per step */
    const struct explain_server *server;
};

enum explain_cause {
    EXPLAIN_COMPUTING, /* mean computing of the servers, less W/P: other programs, a deck with other costs */
    EXPLAIN_IMBALANCE, /* computing of the slowest server, less the mean */
    EXPLAIN_MIGRATION, /* bytes of migrants, and second round trips */
    EXPLAIN_RELAY,     /* packing, unpacking, routing */
    EXPLAIN_WAITING,   /* the remainder: waiting for messages, another server slowest from step to step */
    EXPLAIN_CAUSES
};

struct explanation {
    double computing, predicted, measured; /* s per step */
    double communication;                  /* communication that computing does not hide, s per step */
    double share[EXPLAIN_CAUSES];          /* parts of measured - predicted, s */
    enum explain_cause largest;            /* the largest part with the sign of the difference */
    double speedup, efficiency;            /* t_seq/measured; speedup/N */
};

/* Explains a run. servers >= 1, processors >= 1, measured > 0. */
struct explanation explain_run(const struct explain_input *in);

/* The name of a cause, "imbalance" for instance; a constant. */
const char *explain_cause_name(enum explain_cause cause);

#endif
