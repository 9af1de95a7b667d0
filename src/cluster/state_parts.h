/* A state as STATE messages: cut into parts that fit a message, and the share of it that one rank needs. */
#ifndef DM2_CLUSTER_STATE_PARTS_H
#define DM2_CLUSTER_STATE_PARTS_H

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/cluster/decomposition.h"
#include "dm2/cluster/messages.h"
#include "dm2/engine/element.h"

/* A state on its way out. Start with head.step, head.purpose, the arrays and their lengths. */
struct state_parts {
    struct state_message head;
    const struct element *elements;
    const struct element_measure *measured; /* NULL: none */
    const struct pair_record *pairs;
    size_t n_elements, n_pairs;
    size_t elements_done, pairs_done;
};

/* Writes the next part, of at most LIMIT_STATE bytes, in place of what `out` held. False once the last part
 * has been written. */
bool state_parts_next(struct state_parts *parts, struct bytes_writer *out);

/* The elements that `rank` owns or mirrors, and the pairs that touch one that it owns: all that
 * subdomain_restore needs. Elements have ids 0 .. n_elements-1, in this order. Both arrays are malloc'd.
 * DM2_MEMORY. */
enum dm2_status state_share(const struct decomposition *d, int rank, const struct element *elements,
                            size_t n_elements, const struct pair_record *pairs, size_t n_pairs,
                            struct element **out, size_t *n_out, struct pair_record **pairs_out,
                            size_t *n_pairs_out, struct dm2_error *err);

#endif
