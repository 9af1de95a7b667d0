/* The block `start` and bodies `from = state`: what a deck takes of the state that its run begins from. */
#ifndef DM2_DECK_BIND_START_H
#define DM2_DECK_BIND_START_H

#include <stdbool.h>

#include "bind.h"

/* Reads the text about the state, where the source has one (dm2/deck/start.h), into b->stage and
 * config->start. False: no memory. */
bool start_open(struct deck_binding *b);
void start_close(struct deck_binding *b);

/* Read the values of `state` and of `without` into config->start. False: a finding was added, or there is no
 * memory. */
bool start_read_state(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                      struct config *config);
bool start_read_names(struct deck_binding *b, const struct deck_entry *entry, struct config *config);

/* Makes a body with `from = state`, bound from its block, the body of this name in the state, with the
 * changes of the block. Materials and phases must be bound. A finding where that cannot be. */
void start_take_body(struct deck_binding *b, size_t block, struct body_config *body);

/* Is the body from a state, with nothing to check but its changes? */
bool start_is_taken(const struct deck_binding *b, const struct body_config *body);

/* After all blocks are bound: compares the deck with the state, sets n_start, t_start and dt_before. */
void start_finish(struct deck_binding *b);

#endif
