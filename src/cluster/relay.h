/* The relay: from what every rank sent to what every rank gets, without touching a particle (paper,
 * section 5.1: the client's buffers; Fig. 8).
 *
 * A segment is what one rank sends another in one exchange: source u16, destination u16, length u32, then
 * that many bytes. A rank's segments come one after another, destinations ascending. Routing copies nothing:
 * for each destination it lists where its segments lie in the buffers that they were received in. No sockets
 * in here. */
#ifndef DM2_CLUSTER_RELAY_H
#define DM2_CLUSTER_RELAY_H

#include <stddef.h>
#include <stdint.h>
#include <sys/uio.h>

#include "dm2/base/status.h"

enum { SEGMENT_HEADER = 8 };

/* What one rank sent: `count` segments in `length` bytes. */
struct relay_source {
    const unsigned char *segments;
    size_t length;
    uint32_t count;
};

struct relay_route {
    struct iovec *iov; /* RELAY_SPARE entries that are the caller's to fill, then one per segment, by source
                          ascending */
    size_t n_iov;      /* with the spare ones */
    uint32_t count;    /* segments */
    size_t bytes;      /* of the segments */
};

enum { RELAY_SPARE = 2 };

struct relay {
    int ranks;
    struct relay_route
        *route; /* per destination; valid until the next call and as long as the sources' buffers */
    struct iovec *iov;
    size_t iov_cap;
};

/* DM2_MEMORY. */
enum dm2_status relay_open(struct relay *relay, int ranks, struct dm2_error *err);
void relay_free(struct relay *relay);

/* Routes one exchange; source[k] is what rank k sent. DM2_PROTOCOL where a rank's segments do not fill its
 * bytes, name another source, go to itself, to no rank, or twice to the same; *culprit is that rank then.
 * DM2_MEMORY. */
enum dm2_status relay_run(struct relay *relay, const struct relay_source *source, int *culprit,
                          struct dm2_error *err);

#endif
