/* The state from which a run continues in its directory becomes the directory's newest checkpoint. */
#ifndef DM2_OUTPUT_ADOPT_H
#define DM2_OUTPUT_ADOPT_H

#include <stdbool.h>

#include "dm2/base/status.h"

/* Gives the state file `state` in `directory` the name checkpoint.dm2, by renaming a state of the run
 * (final.dm2, checkpoint.prev.dm2) and by copying any other file, and removes the states that the run has not
 * come to now. To be called before the tables lose the rows from the state's step on, so that a state leads
 * on at every instant. `ended`: the state is the last one of the run, whose tables have not got their names,
 * and keeps its own. DM2_IO, DM2_MEMORY. */
enum dm2_status adopt_state(const char *directory, const char *state, bool ended, struct dm2_error *err);

#endif
