/* Binding of loads: points from the deck or from a file. */
#ifndef DM2_DECK_BIND_LOADS_H
#define DM2_DECK_BIND_LOADS_H

#include "bind.h"

/* The most blocks `load` of a deck. */
enum { LOAD_MAX = 1000 };

/* The points of one quantity. */
struct load_points {
    size_t n;
    double *time, *value; /* [n], malloc'd */
};

/* What one block `load` fills: the values that its loads share, and the points of each quantity. */
struct load_block {
    struct load_config common;
    struct load_points points[LOAD_QUANTITIES];
};

/* A load_block without values. */
struct load_block load_block_start(void);

/* Reads pairs of a time and a value. False: a finding was added. */
bool load_read_points(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                      struct load_points *out);

/* Adds the loads of one block `load` to config->loads, of which `block` is the block. A block with
 * findings adds the loads that read. Frees what the block has and the loads do not take. False: no memory. */
bool load_bind(struct deck_binding *b, size_t block, struct load_block *read);

/* The place of a load: of its quantity's keyword, or of `file`. */
struct deck_place load_place(const struct deck_binding *b, size_t load);

#endif
