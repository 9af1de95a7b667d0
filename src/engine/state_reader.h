/* The state of a subdomain, record by record in the order of a state file, without a copy of it: some 40
 * bytes per element say where each record is. */
#ifndef DM2_ENGINE_STATE_READER_H
#define DM2_ENGINE_STATE_READER_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/element.h"
#include "lists.h"
#include "particles.h"

/* An entry of the near list and the slot of its row. */
struct reader_pair {
    uint32_t row, entry;
};

struct state_reader {
    const struct particles *p;
    const struct lists *lists;
    size_t n_elements, n_pairs;
    uint32_t *slot; /* [n_elements] of owned elements, ids ascending */
    struct reader_pair
        *pair; /* [n_pairs] of those with memory whose lower id is owned, (id_a, id_b) ascending */
};

/* Finds the order; p and lists are borrowed until state_reader_free and must not change. With `pairs` false
 * n_pairs is 0. DM2_MEMORY. */
enum dm2_status state_reader_open(struct state_reader *r, const struct particles *p,
                                  const struct lists *lists, bool pairs, struct dm2_error *err);
void state_reader_free(struct state_reader *r);

/* The k-th element, the k-th pair. */
void state_reader_element(const struct state_reader *r, size_t k, struct element *out);
void state_reader_pair(const struct state_reader *r, size_t k, struct pair_record *out);

#endif
