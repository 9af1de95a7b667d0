/* The state of a subdomain, record by record in the order of a state file, without a copy of the state: an
 * index of some 40 bytes per element finds each record. */
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

enum reader_pairs {
    READER_NONE,
    READER_MEMORY, /* the pairs with memory, for a state */
    READER_ACTING  /* the pairs that touch or are linked, for a snapshot */
};

struct state_reader {
    const struct particles *p;
    const struct lists *lists;
    size_t n_elements, n_pairs;
    uint32_t *slot; /* [n_elements] slots of owned elements, ids ascending */
    enum reader_pairs which;
    struct reader_pair *pair; /* [n_pairs] with owned lower id, (id_a, id_b) ascending */
};

/* Builds the index; p and lists are borrowed and must not change until state_reader_free. READER_ACTING needs
 * lists->forces. DM2_MEMORY; then *r has no records and need not be freed. */
enum dm2_status state_reader_open(struct state_reader *r, const struct particles *p,
                                  const struct lists *lists, enum reader_pairs which, struct dm2_error *err);
void state_reader_free(struct state_reader *r);

/* Copies element k < n_elements, pair k < n_pairs. */
void state_reader_element(const struct state_reader *r, size_t k, struct element *out);
void state_reader_pair(const struct state_reader *r, size_t k, struct pair_record *out);

/* The force of pair k of READER_ACTING; over_force: of struct fixed_scales. */
void state_reader_force(const struct state_reader *r, double over_force, size_t k, struct pair_measure *out);

#endif
