/* The live line of a run: step, percentage, element-steps per second, time left, the slowest server. On
 * standard error. */
#ifndef DM2_APP_PROGRESS_H
#define DM2_APP_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum progress_mode { PROGRESS_AUTO, PROGRESS_ALWAYS, PROGRESS_NEVER };

struct progress {
    bool on, tty;
    int64_t steps;
    size_t elements;
    double start, shown; /* clock_now() at the start of the steps and at the last line */
    size_t width;        /* columns of the newest line */
};

/* Starts the live line of a run of `steps` steps: PROGRESS_AUTO shows it on a terminal only,
 * PROGRESS_ALWAYS prints plain lines to other outputs. */
void progress_start(struct progress *p, enum progress_mode mode, int64_t steps, size_t elements);

/* Reports a step: prints at most five times a second on a terminal, once a second elsewhere, and after the
 * last step. `slowest` names a server, or is NULL. */
void progress_step(struct progress *p, int64_t step, const char *slowest);

/* Ends the line, so that other text can follow. */
void progress_end(struct progress *p);

#endif
