/* Cuts a state into STATE messages, and selects the share of a state that one rank needs. */
#ifndef DM2_CLUSTER_STATE_PARTS_H
#define DM2_CLUSTER_STATE_PARTS_H

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/cluster/decomposition.h"
#include "dm2/cluster/messages.h"
#include "dm2/engine/element.h"
#include "dm2/engine/section.h"

/* A state that is being sent. Set head.step, head.purpose and the arrays of `state` first. */
struct state_parts {
    struct state_message head;
    struct state_view state;                /* with arrays of elements and pairs */
    const struct element_measure *measured; /* [n_elements], for a snapshot; NULL: none */
    const struct pair_measure *forces;      /* [n_pairs], likewise */
    size_t elements_done, pairs_done, sections_done[SECTION_COUNT]; /* written so far */
};

/* Replaces the content of `out` by the next part, of at most LIMIT_STATE bytes. False: the last part has been
 * written before, `out` is unchanged. A lack of memory sets out->failed. */
bool state_parts_next(struct state_parts *parts, struct bytes_writer *out);

/* The share of a state that one rank needs. */
struct state_share {
    struct element *elements;
    struct pair_record *pairs;
    size_t n_elements, n_pairs;
    struct section_array sections[SECTION_COUNT];
};

/* Selects the share of a state that subdomain_restore needs on `rank`: the elements that the rank owns or
 * mirrors, the pairs with an element that the rank owns, the records of owned elements and of the run. The
 * caller frees *out with state_share_free, also after a failure. DM2_MEMORY. */
enum dm2_status state_parts_share(const struct decomposition *d, int rank, const struct state_view *state,
                                  struct state_share *out, struct dm2_error *err);
void state_share_free(struct state_share *share);

/* The share as a state of `step`, which borrows the arrays. */
struct state_view state_share_view(const struct state_share *share, int64_t step);

#endif
