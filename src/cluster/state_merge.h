/* Compiling a whole state from the parts that the servers send: every element once, in id order, pairs by
 * (id, id). */
#ifndef DM2_CLUSTER_STATE_MERGE_H
#define DM2_CLUSTER_STATE_MERGE_H

#include <stdbool.h>

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/cluster/messages.h"
#include "dm2/cluster/wire.h"
#include "dm2/engine/element.h"

struct state_merge {
    struct wire_limits limits;
    struct element *elements;         /* limits.elements of them, by id */
    struct element_measure *measured; /* beside them; used for snapshots */
    unsigned char *seen;              /* by id */
    size_t n_seen;
    struct pair_record *pairs;
    size_t n_pairs, pairs_cap;
};

/* Takes no memory yet: the first part does. */
void state_merge_open(struct state_merge *m, struct wire_limits limits);
void state_merge_free(struct state_merge *m);

/* Empties it for the next state. */
void state_merge_clear(struct state_merge *m);

/* Adds a part: what follows a STATE message's head. DM2_PROTOCOL: a record that cannot be, or an element that
 * came before (its id is named), or more than WIRE_PAIRS_MOST pairs per element of the run, which is found
 * before memory is taken for them; DM2_MEMORY. */
enum dm2_status state_merge_add(struct state_merge *m, const struct state_message *head,
                                struct bytes_reader *r, struct dm2_error *err);

/* All parts are there: sorts the pairs. DM2_PROTOCOL: an element is missing (the first id is named), or a
 * pair came twice. */
enum dm2_status state_merge_finish(struct state_merge *m, struct dm2_error *err);

/* The state of `step` that was compiled. Its arrays belong to *m and last until the next call with it. */
struct state_view state_merge_view(const struct state_merge *m, int64_t step);

#endif
