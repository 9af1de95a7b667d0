/* The keyword `probe` of a block `stop`. */
#ifndef DM2_DECK_BIND_STOPS_H
#define DM2_DECK_BIND_STOPS_H

#include <stdbool.h>

#include "bind.h"

/* Reads the four values of the entry into stop->column, `above` and `value`; probes must be bound. False: a
 * value does not read, or the probe has no such column; a finding was added. */
bool stop_read_probe(struct deck_binding *b, const struct deck_key *key, const struct deck_entry *entry,
                     struct stop_config *stop);

#endif
