/* The relay routes the segments of one exchange from every rank to every rank, without decoding elements
 * (paper, section 5.1: the client's buffers; Fig. 8).
 *
 * A segment is the data that one rank sends another rank in one exchange: source u16, destination u16, length
 * u32, then `length` bytes. The segments of a rank follow each other, destinations ascending. Routing copies
 * no segment: each destination gets a list of the segments in the buffers that received them. The module
 * knows no sockets. */
#ifndef DM2_CLUSTER_RELAY_H
#define DM2_CLUSTER_RELAY_H

#include <stddef.h>
#include <stdint.h>
#include <sys/uio.h>

#include "dm2/base/status.h"

enum { SEGMENT_HEADER = 8 };

/* The segments that one rank sent: `count` segments in `length` bytes. */
struct relay_source {
    const unsigned char *segments;
    size_t length;
    uint32_t count;
};

/* The segments for one rank. */
struct relay_route {
    struct iovec *iov; /* RELAY_SPARE entries for the caller, then one per segment, sources ascending */
    size_t n_iov;      /* number of entries, the RELAY_SPARE ones included */
    uint32_t count;    /* number of segments */
    size_t bytes;      /* length of all segments, headers included */
};

enum { RELAY_SPARE = 2 };

struct relay {
    int ranks;
    /* [ranks] by destination; valid until the next call, and as long as the sources' buffers. */
    struct relay_route *route;
    struct iovec *iov; /* the entries of all routes */
    size_t iov_cap;
};

/* For `ranks` ranks; relay_free frees what *relay owns. DM2_MEMORY. */
enum dm2_status relay_open(struct relay *relay, int ranks, struct dm2_error *err);
void relay_free(struct relay *relay);

/* Routes one exchange; source[ranks] holds the segments that each rank sent. DM2_PROTOCOL: the segments of a
 * rank do not fill its bytes, name another source, or go to itself, to no rank, or not to ascending ranks;
 * *culprit is that rank. DM2_MEMORY: *culprit is -1. */
enum dm2_status relay_run(struct relay *relay, const struct relay_source *source, int *culprit,
                          struct dm2_error *err);

#endif
