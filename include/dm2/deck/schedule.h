/* Which steps of a run have output. The steps follow from the checked config alone, so that client, servers
 * and dm2-seq agree on them without a message.
 *
 * Step 0 is the initial state, step c->steps the final one. No function fails. */
#ifndef DM2_DECK_SCHEDULE_H
#define DM2_DECK_SCHEDULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/deck/config.h"

/* Whether `step` has a row in history.csv: every output.history_every steps (0: none), and the last one. */
bool schedule_history(const struct config *c, int64_t step);

/* Whether the deck asks for a snapshot of the state at `step`: every output.snapshot_every steps (0: none),
 * and the steps of output.snapshot_at. */
bool schedule_snapshot(const struct config *c, int64_t step);

/* Whether c->profiles[which] has rows at `step`: every `every` steps of the profile, and the last one. */
bool schedule_profile(const struct config *c, size_t which, int64_t step);

/* Whether the time step is compared with the limit that holds at `step`: at step 0 and at rows of the
 * history, at least 10 steps apart. */
bool schedule_limit(const struct config *c, int64_t step);

/* Whether the elements are measured at `step`, at step 0 and because a row of the history, a snapshot or
 * a profile is due. */
bool schedule_measure(const struct config *c, int64_t step);

/* Whether a checkpoint is due at `step`: every `every` steps (0: never), but neither at step 0 nor at the
 * last. */
bool schedule_checkpoint(const struct config *c, int64_t every, int64_t step);

#endif
