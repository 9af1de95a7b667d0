/* Cuts a state into STATE messages, and selects the share of a state that one rank needs. */
#ifndef DM2_CLUSTER_STATE_PARTS_H
#define DM2_CLUSTER_STATE_PARTS_H

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/cluster/decomposition.h"
#include "dm2/cluster/messages.h"
#include "dm2/engine/element.h"

/* A state that is being sent. Set head.step, head.purpose, the arrays and their lengths first. */
struct state_parts {
    struct state_message head;
    const struct element *elements;
    const struct element_measure *measured; /* [n_elements], for a snapshot; NULL: none */
    const struct pair_record *pairs;
    size_t n_elements, n_pairs;
    size_t elements_done, pairs_done; /* written so far */
};

/* Replaces the content of `out` by the next part, of at most LIMIT_STATE bytes. False: the last part has been
 * written before, `out` is unchanged. A lack of memory sets out->failed. */
bool state_parts_next(struct state_parts *parts, struct bytes_writer *out);

/* Selects the share of a state that subdomain_restore needs on `rank`: the elements that the rank owns or
 * mirrors, and the pairs with an element that the rank owns. The ids of elements[n_elements] are 0 ..
 * n_elements-1, in this order. The caller frees both arrays, *out and *pairs_out. DM2_MEMORY. */
enum dm2_status state_parts_share(const struct decomposition *d, int rank, const struct element *elements,
                                  size_t n_elements, const struct pair_record *pairs, size_t n_pairs,
                                  struct element **out, size_t *n_out, struct pair_record **pairs_out,
                                  size_t *n_pairs_out, struct dm2_error *err);

#endif
