/* The first and the last line of a main: standard input, output and error, and the stack. */
#ifndef DM2_APP_PROCESS_H
#define DM2_APP_PROCESS_H

#include <stdbool.h>

/* First call of every main. Opens /dev/null in place of each of the descriptors 0, 1, 2 that is closed: 0 for
 * writing, 1 and 2 for reading, so that their use still fails. SIGPIPE is ignored from here on, so that a
 * write to a closed pipe fails with EPIPE. A limit of the stack below 256 KiB (ulimit -s) is raised. Ends the
 * program with status 1, and a line on standard error, where /dev/null does not open or the limit stays. */
void process_start(void);

/* Whether standard output was closed at process_start. */
bool process_output_closed(void);

/* Last call of every main: flushes standard output and returns the exit status of the program. `code` is the
 * status so far. Where output is lost that the user asked for (`asked`), a line on standard error says so,
 * and 0 becomes 1. */
int process_finish(const char *program, int code, bool asked);

#endif
