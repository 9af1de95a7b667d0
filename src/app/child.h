/* Runs other programs of dm2. */
#ifndef DM2_APP_CHILD_H
#define DM2_APP_CHILD_H

#include "dm2/base/status.h"

/* Runs `argv` (argv[0] is the path, NULL at the end) with standard input and output on /dev/null, and
 * waits for its end. A readable `cancel` sends the child SIGTERM first: DM2_INTERRUPTED. Where its exit
 * status is not 0: DM2_DECK for 2, DM2_NET for 3, so that the caller ends with the same status, else
 * DM2_IO; the child has written the reason to standard error. DM2_IO, too, where the program did not
 * start. */
enum dm2_status child_run(char *const argv[], int cancel, struct dm2_error *err);

#endif
