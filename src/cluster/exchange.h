/* What a server sends others and takes from them in one exchange, as segments for destinations
 * (cluster/relay.h). How the segments travel is not known here. */
#ifndef DM2_CLUSTER_EXCHANGE_H
#define DM2_CLUSTER_EXCHANGE_H

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/cluster/wire.h"
#include "dm2/engine/subdomain.h"

struct exchange {
    int rank, ranks;
    size_t width; /* doubles per element of an update */
    struct wire_limits limits;
    double *values; /* one segment's doubles */
    size_t values_cap;
    struct parcel *out;  /* ranks of them: what sort_out gave */
    struct parcel *in;   /* ranks of them: what came, the own one among them */
    unsigned char *came; /* by source: its segment is there */
};

/* DM2_MEMORY. */
enum dm2_status exchange_open(struct exchange *x, const struct model *model, int rank, int ranks,
                              struct dm2_error *err);
void exchange_free(struct exchange *x);

/* Appends the segments of an update to w, and their number to *count. */
enum dm2_status exchange_pack_update(struct exchange *x, const struct subdomain *sd, struct bytes_writer *w,
                                     uint32_t *count, struct dm2_error *err);

/* Sorts out and appends the segments of a rebuild; *migrants elements leave in them. To be followed by
 * exchange_take_rebuild, which needs the own parcel that is kept here. */
enum dm2_status exchange_pack_rebuild(struct exchange *x, struct subdomain *sd, struct bytes_writer *w,
                                      uint32_t *count, uint64_t *migrants, struct dm2_error *err);

/* Takes `count` segments that fill the rest of r. DM2_PROTOCOL where they are not what this rank must get. */
enum dm2_status exchange_take_update(struct exchange *x, struct subdomain *sd, struct bytes_reader *r,
                                     uint32_t count, struct dm2_error *err);
enum dm2_status exchange_take_rebuild(struct exchange *x, struct subdomain *sd, struct bytes_reader *r,
                                      uint32_t count, struct dm2_error *err);

#endif
