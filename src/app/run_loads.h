/* What a user is told about the bodies that move by forces before a run. */
#ifndef DM2_APP_RUN_LOADS_H
#define DM2_APP_RUN_LOADS_H

#include <stdio.h>

#include "dm2/engine/model.h"

/* A line of `--check` for each load: mass, omega dt, damping and greatest velocity. */
void run_loads_print(FILE *to, const struct model *model);

/* Warns on standard error of each mass whose motion reacts too fast to follow soft ground. */
void run_loads_warn(const char *program, const struct model *model);

#endif
