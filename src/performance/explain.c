/* Comparison of the predicted with the measured time of a run, and the causes of the difference. */
#include "dm2/performance/explain.h"

#include <math.h>

const char *explain_cause_name(enum explain_cause cause)
{
    static const char *const names[EXPLAIN_CAUSES] = {"computing", "imbalance", "migration", "relay",
                                                      "waiting"};
    return names[cause];
}

/* The largest part that has the sign of the difference. */
static enum explain_cause find_largest(const struct explanation *e)
{
    double sign = e->measured < e->predicted ? -1 : 1;
    enum explain_cause largest = EXPLAIN_WAITING;
    for (int k = 0; k < EXPLAIN_CAUSES; k++)
        if (sign * e->share[k] > sign * e->share[largest])
            largest = (enum explain_cause)k;
    return largest;
}

struct explanation explain_run(const struct explain_input *in)
{
    struct explanation e = {.measured = in->measured};
    struct explain_server mean = {0};
    double most = 0;
    for (int k = 0; k < in->servers; k++) {
        const struct explain_server *s = &in->server[k];
        mean.computing += s->computing / in->servers;
        mean.ahead += s->ahead / in->servers;
        mean.packing += s->packing / in->servers;
        mean.mirrored += s->mirrored / in->servers;
        mean.migrants += s->migrants / in->servers;
        most = fmax(most, s->computing);
    }
    int processors = in->processors < in->servers ? in->processors : in->servers;
    e.computing = in->work / processors;
    double hides = in->apart && mean.computing > 0 ? mean.ahead / mean.computing : 0;
    e.communication = fmax(0, in->m * in->g * mean.mirrored + in->b - hides * e.computing);
    e.predicted = e.computing + e.communication;
    e.share[EXPLAIN_COMPUTING] = mean.computing - e.computing;
    e.share[EXPLAIN_IMBALANCE] = most - mean.computing;
    e.share[EXPLAIN_MIGRATION] = in->m * in->g_migrant * mean.migrants + in->redone * in->b;
    e.share[EXPLAIN_RELAY] = mean.packing + in->relay;
    double rest = e.measured - e.predicted;
    for (int k = 0; k < EXPLAIN_WAITING; k++)
        rest -= e.share[k];
    e.share[EXPLAIN_WAITING] = rest;
    e.largest = find_largest(&e);
    e.speedup = in->t_seq / e.measured;
    e.efficiency = e.speedup / in->servers;
    return e;
}
