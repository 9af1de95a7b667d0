/* Routing makes two passes over the segment headers: the first pass counts segments per destination, then
 * each destination gets its entries in one array of iovecs, and the second pass fills the entries. Sources
 * are taken in ascending order, so that the order of a destination's segments does not depend on the order of
 * arrival. The header of a segment is sent to the receiver unchanged. */
#include "relay.h"

#include <stdint.h>
#include <stdlib.h>

#include "dm2/base/bytes.h"
#include "dm2/base/mem.h"

enum dm2_status relay_open(struct relay *relay, int ranks, struct dm2_error *err)
{
    *relay = (struct relay){.ranks = ranks};
    relay->route = mem_zalloc((size_t)ranks, sizeof *relay->route);
    if (relay->route == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the relay of %d ranks", ranks);
    return DM2_OK;
}

void relay_free(struct relay *relay)
{
    free(relay->route);
    free(relay->iov);
    *relay = (struct relay){0};
}

/* Checks the segments of one rank and adds them to the counts of their destinations. */
static enum dm2_status count_segments(struct relay *relay, int rank, const struct relay_source *source,
                                      struct dm2_error *err)
{
    struct bytes_reader r = bytes_reader_of(source->segments, source->length);
    int last = -1;
    for (uint32_t k = 0; k < source->count; k++) {
        int from = bytes_get_u16(&r), to = bytes_get_u16(&r);
        uint32_t length = bytes_get_u32(&r);
        (void)bytes_get_raw(&r, length);
        if (r.failed)
            return dm2_fail(err, DM2_PROTOCOL, "segment %u of %u is longer than the message", k + 1,
                            source->count);
        if (from != rank || to == rank || to >= relay->ranks || to <= last)
            return dm2_fail(err, DM2_PROTOCOL,
                            "segment %u goes from rank %d to rank %d, after one to rank %d; the sender "
                            "is rank %d of %d",
                            k + 1, from, to, last, rank, relay->ranks);
        last = to;
        relay->route[to].count++;
        relay->route[to].bytes += SEGMENT_HEADER + length;
    }
    if (!bytes_done(&r))
        return dm2_fail(err, DM2_PROTOCOL, "%zu bytes follow the last segment", bytes_remaining(&r));
    return DM2_OK;
}

/* Enters the segments of one rank into the routes of their destinations. */
static void place_segments(struct relay *relay, const struct relay_source *source)
{
    struct bytes_reader r = bytes_reader_of(source->segments, source->length);
    for (uint32_t k = 0; k < source->count; k++) {
        const unsigned char *start = r.data + r.at;
        (void)bytes_get_u16(&r);
        struct relay_route *route = &relay->route[bytes_get_u16(&r)];
        uint32_t length = bytes_get_u32(&r);
        (void)bytes_get_raw(&r, length);
        route->iov[route->n_iov++] =
            (struct iovec){.iov_base = (void *)(uintptr_t)start, .iov_len = SEGMENT_HEADER + (size_t)length};
    }
}

enum dm2_status relay_run(struct relay *relay, const struct relay_source *source, int *culprit,
                          struct dm2_error *err)
{
    size_t total = 0;
    for (int k = 0; k < relay->ranks; k++)
        relay->route[k] = (struct relay_route){0};
    for (int k = 0; k < relay->ranks; k++) {
        enum dm2_status status = count_segments(relay, k, &source[k], err);
        if (status != DM2_OK) {
            *culprit = k;
            return status;
        }
    }
    for (int k = 0; k < relay->ranks; k++)
        total += RELAY_SPARE + relay->route[k].count;
    struct iovec *grown = mem_grown(relay->iov, &relay->iov_cap, 0, total, sizeof *grown);
    if (grown == NULL) {
        *culprit = -1;
        return dm2_fail(err, DM2_MEMORY, "no memory to route %zu segments", total);
    }
    relay->iov = grown;
    struct iovec *next = relay->iov;
    for (int k = 0; k < relay->ranks; k++) {
        relay->route[k].iov = next;
        relay->route[k].n_iov = RELAY_SPARE;
        next += RELAY_SPARE + relay->route[k].count;
    }
    for (int k = 0; k < relay->ranks; k++)
        place_segments(relay, &source[k]);
    return DM2_OK;
}
