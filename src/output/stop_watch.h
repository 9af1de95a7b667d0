/* The blocks `stop` of a deck, watched row by row of history.csv.
 *
 * A condition reads the text of a row, so that a run that continues, which reads the rows before its
 * checkpoint, comes to the same decision without any state. */
#ifndef DM2_OUTPUT_STOP_WATCH_H
#define DM2_OUTPUT_STOP_WATCH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/csv.h"
#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "dm2/output/results.h"

/* A run whose block `stop` holds at row n ends at state n + STOP_LAG. */
enum { STOP_LAG = 3 };

/* One block. */
struct stop_series {
    size_t unbalanced, kinetic, probe; /* columns */
    int64_t since; /* first step of the unbroken series of rows in which it held; -1: none */
};

struct stop_watch {
    const struct config *config; /* borrowed */
    struct stop_series *series;  /* [config->n_stops] */
    int64_t held;                /* the row at which a block ended the run; -1: none */
    size_t block;                /* this block */
};

/* Finds the columns in the heading of `table`, history.csv, and takes its rows, which are those before
 * `step`, the step that the run continues from: a block that held at a row which would have ended the run
 * before `step` did not end it, because the deck had another block then. DM2_MEMORY; DM2_PROTOCOL: a column
 * is absent. */
enum dm2_status stop_watch_open(struct stop_watch *watch, const struct config *config,
                                const struct csv *table, int64_t step, struct dm2_error *err);
void stop_watch_free(struct stop_watch *watch);

/* Takes the row `text` of `step`, `length` bytes. */
void stop_watch_row(struct stop_watch *watch, int64_t step, const char *text, size_t length);

/* Says which block ended the run at which row, in RESULTS_LINE bytes; "" where none did. */
void stop_watch_describe(const struct stop_watch *watch, char *line);

#endif
