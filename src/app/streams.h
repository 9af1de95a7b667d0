/* Standard input, output and error of a program: open from the first line of main, checked at its last. */
#ifndef DM2_APP_STREAMS_H
#define DM2_APP_STREAMS_H

#include <stdbool.h>

/* First call of every main. Opens /dev/null in place of each of the descriptors 0, 1, 2 that is closed: 0 for
 * writing, 1 and 2 for reading, so that their use still fails. SIGPIPE is ignored from here on, so that a
 * write to a closed pipe fails with EPIPE. Ends the program with status 1 where /dev/null does not open. */
void streams_start(void);

/* Whether standard output was closed at streams_start. */
bool streams_output_closed(void);

/* Last call of every main: flushes standard output and returns the exit status of the program. `code` is the
 * status so far. Where output is lost that the user asked for (`asked`), a line on standard error says so,
 * and 0 becomes 1. */
int streams_finish(const char *program, int code, bool asked);

#endif
