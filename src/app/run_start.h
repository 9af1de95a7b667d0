/* The state of another deck that a run begins from: of `start { state = FILE }` or --start FILE. */
#ifndef DM2_APP_RUN_START_H
#define DM2_APP_RUN_START_H

#include "run.h"

/* Before the deck is bound: reads the state into run->from, and adds the text about the state to the source.
 * Nothing where the run begins from none. DM2_DECK where the file cannot be read or used, with its name and
 * the reason; DM2_MEMORY. */
enum dm2_status run_start_read(const struct run_options *o, struct run *run, struct dm2_error *err);

/* After the model is built: makes run->from the first state of the run, run->state. DM2_DECK where an element
 * of the state cannot be one of the deck, or where a new one is pressed into it; DM2_MEMORY. */
enum dm2_status run_start_take(struct run *run, struct dm2_error *err);

#endif
