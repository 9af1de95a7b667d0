/* The cost of a message between a client and N servers: timed round trips, and the paper's line m_N x +
 * b_N through them (section 3.3, Fig. 3). */
#ifndef DM2_APP_NETWORK_H
#define DM2_APP_NETWORK_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/cluster/client.h"
#include "dm2/performance/fit.h"

enum { NETWORK_SIZES = 8, NETWORK_TURNS = 400 };

struct network_line {
    int servers;
    int sizes, turns;
    double bytes[NETWORK_SIZES];   /* of the messages */
    double seconds[NETWORK_SIZES]; /* medians of the turns */
    double m, b;                   /* s per byte and s; neither below 0 */
    double residual;               /* standard deviation of the medians about the line, s */
};

/* Room for a measurement of `turns` turns over each size, for client_options.echo. With `quick` the
 * measurement fits beside a run: few sizes, about 0.03 s. The caller frees *probe with network_probe_free.
 * DM2_MEMORY. */
struct network_probe {
    struct client_echo echo;
    uint32_t bytes[NETWORK_SIZES];
};
enum dm2_status network_probe_start(struct network_probe *probe, bool quick, int turns,
                                    struct dm2_error *err);

/* The measurement for client_options.echo; valid while *probe is. */
struct client_echo *network_probe_echo(struct network_probe *probe);
void network_probe_free(struct network_probe *probe);

/* Fits the line through the medians. A slope or an intercept that comes out below 0 by chance becomes 0,
 * and the other is fitted alone. DM2_NUMERIC: no round trip was measured. */
enum dm2_status network_fit(const struct network_probe *probe, int servers, struct network_line *out,
                            struct dm2_error *err);

#endif
