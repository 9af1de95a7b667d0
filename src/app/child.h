/* Other programs of dm2, found and run. */
#ifndef DM2_APP_CHILD_H
#define DM2_APP_CHILD_H

#include "dm2/base/status.h"

/* The path of the program `name` beside `argv0`, the path by which the caller was started, or its bare name
 * for a search on PATH. malloc'd, NULL without memory. */
char *child_path(const char *argv0, const char *name);

/* Runs `argv` (argv[0] is the path, NULL at the end) with nothing on its standard input and output, and waits
 * for its end. When `cancel` becomes readable it is asked to end first: DM2_INTERRUPTED. Its exit status was
 * not 0: DM2_DECK for 2, DM2_NET for 3, so that who started it ends with the same, else DM2_IO; what it said
 * went to standard error. DM2_IO, too, where it did not start. */
enum dm2_status child_run(char *const argv[], int cancel, struct dm2_error *err);

#endif
