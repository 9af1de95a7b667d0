/* The segments (cluster/relay.h) that a server packs for the other ranks and takes from them in one exchange.
 * server_steps.c sends and receives them. */
#ifndef DM2_CLUSTER_EXCHANGE_H
#define DM2_CLUSTER_EXCHANGE_H

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/cluster/wire.h"
#include "dm2/engine/subdomain.h"

struct exchange {
    int rank, ranks;
    size_t width; /* doubles per element of an update */
    struct record_limits limits;
    double *values; /* those of one segment */
    size_t values_cap;
    struct parcel *out;  /* by destination: the parcels of subdomain_sort_out */
    struct parcel *in;   /* room for `ranks` parcels: those that came, then the own one */
    unsigned char *came; /* by source: its segment has come */
};

/* DM2_MEMORY; then x holds nothing. */
enum dm2_status exchange_open(struct exchange *x, const struct model *model, int rank, int ranks,
                              struct dm2_error *err);
void exchange_free(struct exchange *x);

/* Appends the segments of an update to w and sets *count to their number. DM2_MEMORY. */
enum dm2_status exchange_pack_update(struct exchange *x, const struct subdomain *sd, struct bytes_writer *w,
                                     uint32_t *count, struct dm2_error *err);

/* Sorts the elements by owner and appends the *count segments of a rebuild, in which *migrants elements
 * leave. exchange_take_rebuild must follow, because x keeps the own parcel for it. DM2_MEMORY; otherwise as
 * subdomain_sort_out. */
enum dm2_status exchange_pack_rebuild(struct exchange *x, struct subdomain *sd, struct bytes_writer *w,
                                      uint32_t *count, uint64_t *migrants, struct dm2_error *err);

/* Takes `count` segments, which must fill the rest of r. DM2_PROTOCOL where a segment is missing, cut,
 * doubled, for another rank or of a wrong length; DM2_NUMERIC: a value cannot be; DM2_MEMORY; otherwise as
 * subdomain_take_update and subdomain_take_in. */
enum dm2_status exchange_take_update(struct exchange *x, struct subdomain *sd, struct bytes_reader *r,
                                     uint32_t count, struct dm2_error *err);
enum dm2_status exchange_take_rebuild(struct exchange *x, struct subdomain *sd, struct bytes_reader *r,
                                      uint32_t count, struct dm2_error *err);

#endif
