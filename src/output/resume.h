/* Takes over the tables of a run that ended early: the rows from before a checkpoint. */
#ifndef DM2_OUTPUT_RESUME_H
#define DM2_OUTPUT_RESUME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "history.h"
#include "snapshot.h"

/* The expected content of a table: a heading, then `rows` lines for every step at which `due` is true, each
 * line beginning with the step's number. */
struct resume_plan {
    bool (*due)(const void *context, int64_t step);
    const void *context;
    int64_t rows;
    int64_t step; /* of the checkpoint; rows of earlier steps are kept */
};

/* Sets *keep to the number of bytes of text[0..n) that hold the heading and the rows of the steps before
 * plan->step. DM2_PROTOCOL where one of these rows is missing; `path` names the table in the message. */
enum dm2_status resume_keep(const char *path, const unsigned char *text, size_t n,
                            const struct resume_plan *plan, size_t *keep, struct dm2_error *err);

/* Whether the run continues in the directory of its checkpoint: the two paths name one directory. */
bool resume_in_place(const char *directory, const char *source);

/* Opens the run's tables in `directory` with the rows before `step` of the tables in `source`, be these
 * complete or (".part") not. `in_place` is resume_in_place(directory, source): then the files are cut, else
 * copied. The caller closes the tables, after a failure as well. DM2_IO, DM2_MEMORY, and DM2_PROTOCOL as
 * resume_keep. */
enum dm2_status resume_tables(const char *directory, const char *source, const struct config *c, int64_t step,
                              bool in_place, struct history_tables *tables, struct dm2_error *err);

/* Adds to *series the steps before `step` whose .vtp snapshots are in `directory`, ascending. DM2_MEMORY. */
enum dm2_status resume_series(const char *directory, const struct config *c, int64_t step,
                              struct snapshot_steps *series, struct dm2_error *err);

#endif
