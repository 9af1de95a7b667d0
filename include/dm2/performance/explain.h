/* A finished run beside the model: what it should have taken, what it took, and where the difference comes
 * from.
 *
 *     predicted  =  W/P  +  max(0, m_N g p + b_N - H W/P)        P: N, or the processors where there are
 * fewer measured   =  predicted + computing + imbalance + migration + relay + waiting
 *
 * W is what the servers compute together: T_seq, but for what k owes to caches (perf_k_at). H is the share of
 * it that servers do while messages are on the way; 0 where client and servers share processors: there a
 * message is work of the processors that compute. The last line holds exactly: `waiting` is what the others
 * leave. One b_N, not the two of eqs. (18)-(20): here the boundary and the migrants of a step travel in one
 * message. */
#ifndef DM2_PERFORMANCE_EXPLAIN_H
#define DM2_PERFORMANCE_EXPLAIN_H

#include <stdbool.h>
#include <stddef.h>

/* One server; seconds and counts per time step. */
struct explain_server {
    double computing; /* forces, integration, rebuilds */
    double ahead;     /* of these, while messages were on the way */
    double packing;   /* and unpacking */
    double mirrored;  /* elements that it gets, as known before the run */
    double migrants;  /* elements that it sends away */
};

struct explain_input {
    int servers;    /* N */
    int processors; /* that they have together; N where each has its own */
    double t_seq;   /* s */
    double work;    /* W, s */
    double m, b;    /* m_N, b_N */
    bool apart;     /* the client's processor is not one of theirs */
    double g, g_migrant;
    double measured; /* s per step */
    double relay;    /* the client's routing and sending, s per step */
    double redone;   /* exchanges that took a second round trip, per step */
    const struct explain_server *server;
};

enum explain_cause {
    EXPLAIN_COMPUTING, /* servers computed longer, on average, than W/P says: other programs, a deck with
                          other costs */
    EXPLAIN_IMBALANCE, /* the one with the most work against the average */
    EXPLAIN_MIGRATION, /* bytes of migrants, and second round trips */
    EXPLAIN_RELAY,     /* packing, unpacking, routing */
    EXPLAIN_WAITING, /* everything else: waiting for messages, servers that change places from step to step */
    EXPLAIN_CAUSES
};

struct explanation {
    double computing, predicted, measured; /* s per step */
    double communication;                  /* what of it computing does not hide, s per step */
    double share[EXPLAIN_CAUSES];          /* of measured - predicted, s */
    enum explain_cause largest;            /* with the sign of the difference */
    double speedup, efficiency;            /* t_seq/measured; the same by N */
};

/* N >= 1, P >= 1, measured > 0. */
struct explanation explain_run(const struct explain_input *in);

/* "imbalance". */
const char *explain_cause_name(enum explain_cause cause);

#endif
