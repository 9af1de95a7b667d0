/* cracks.csv: a row for each link that broke, by step and then by ids.
 *
 * The table is there from its first row on. Functions that return a status: DM2_IO with the path and the
 * system's reason, DM2_MEMORY. */
#ifndef DM2_OUTPUT_CRACKS_H
#define DM2_OUTPUT_CRACKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/file.h"
#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "dm2/engine/crack.h"

/* The name of the table in the run directory. */
extern const char cracks_table[];

void cracks_put_heading(struct file_out *f);

/* Sorts the cracks of one evaluation, and writes a row for each. */
enum dm2_status cracks_put(struct file_out *f, const struct config *c, int64_t step, struct crack_list *list,
                           struct dm2_error *err);

/* The rows of a run that continues from the state of a step. */
struct crack_rows {
    bool there, whole;   /* the table; under its final name, of a run that ended */
    size_t keep;         /* bytes of the heading and of the rows before the step; 0: there is no such row */
    unsigned char *text; /* the table */
};

/* How many rows the table has at least from behind `from` on and before the step of the state; from < 0:
 * unknown. */
struct crack_count {
    int64_t from, rows;
};

/* Reads the table in `source`, its .part file or the complete file of a run that ended, and touches nothing.
 * DM2_PROTOCOL: a line before `step` is no row, or rows are missing. The caller frees *out with
 * cracks_free, also after a failure. */
enum dm2_status cracks_check(const char *source, int64_t step, const struct crack_count *count,
                             struct crack_rows *out, struct dm2_error *err);

/* Opens the table in `directory` with the rows before the step; `in_place`: `directory` is `source`. Where
 * there are none, *f stays empty, and an old table in place is removed. */
enum dm2_status cracks_take(const struct crack_rows *rows, const char *directory, bool in_place,
                            struct file_out *f, struct dm2_error *err);

void cracks_free(struct crack_rows *rows);

#endif
