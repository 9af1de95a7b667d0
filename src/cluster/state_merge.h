/* Compiles a whole state from the parts that the servers send: every element once, in id order, and pairs in
 * the order of (id_a, id_b). */
#ifndef DM2_CLUSTER_STATE_MERGE_H
#define DM2_CLUSTER_STATE_MERGE_H

#include <stdbool.h>

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/cluster/messages.h"
#include "dm2/cluster/wire.h"
#include "dm2/engine/element.h"

struct state_merge {
    struct record_limits limits;
    struct element *elements; /* [limits.elements] by id; of a complete state [n_seen], ids ascending */
    struct element_measure *measured; /* beside them; filled for snapshots only */
    unsigned char *seen;              /* [limits.elements] by id: the element has come */
    size_t n_seen;
    struct pair_record *pairs;
    struct pair_measure *forces; /* beside the pairs; filled for snapshots only */
    size_t n_pairs, pairs_cap, forces_cap;
    struct section_array sections[SECTION_COUNT];
};

/* Allocates nothing; state_merge_add allocates with the first part. state_merge_free frees what *m owns. */
void state_merge_open(struct state_merge *m, struct record_limits limits);
void state_merge_free(struct state_merge *m);

/* Forgets all records, for the next state. */
void state_merge_clear(struct state_merge *m);

/* Adds one part: the records that follow `head` in a STATE message, read with a copy of *from. DM2_NUMERIC: a
 * record is invalid, or an element came twice (its id is named); DM2_PROTOCOL: the part is cut or too long,
 * or the state has more than WIRE_PAIRS_MOST pairs per element of the run (checked before memory is allocated
 * for the pairs); DM2_MEMORY. */
enum dm2_status state_merge_add(struct state_merge *m, const struct state_message *head,
                                const struct bytes_reader *from, struct dm2_error *err);

/* Completes the state after its last part: sorts pairs and sections. DM2_PROTOCOL: an element is missing (the
 * first id is named), or a pair or record came twice; DM2_MEMORY. */
enum dm2_status state_merge_finish(struct state_merge *m, struct dm2_error *err);

/* The compiled state as the state of `step`. Its arrays belong to *m and last until *m changes;
 * its origin is NULL. */
struct state_view state_merge_view(const struct state_merge *m, int64_t step);

#endif
