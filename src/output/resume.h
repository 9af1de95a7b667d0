/* Taking over the tables of a run that ended early: which part of them was written before a checkpoint. */
#ifndef DM2_OUTPUT_RESUME_H
#define DM2_OUTPUT_RESUME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"

/* What a table must hold: a heading, then `rows` lines for every step at which `due` says so, beginning with
 * the step's number. */
struct resume_plan {
    bool (*due)(const void *context, int64_t step);
    const void *context;
    int64_t rows;
    int64_t step; /* of the checkpoint: earlier steps are kept */
};

/* The bytes of text[0..n) that hold the heading and the rows of the steps before plan->step. DM2_PROTOCOL
 * where one of these rows is missing; `path` is what the message calls the table. */
enum dm2_status resume_keep(const char *path, const unsigned char *text, size_t n,
                            const struct resume_plan *plan, size_t *keep, struct dm2_error *err);

#endif
