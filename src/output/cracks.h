/* cracks.csv: a row for each link that broke, by step and then by ids.
 *
 * The table is there from its first row on. Functions that return a status: DM2_IO with the path and the
 * system's reason, DM2_MEMORY. */
#ifndef DM2_OUTPUT_CRACKS_H
#define DM2_OUTPUT_CRACKS_H

#include <stdbool.h>
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

/* Opens the table in `directory` with the rows before `step` of the table in `source`: its .part file, or the
 * complete file of a run that ended. Where no such row is there, *f stays empty, and `in_place` (`directory`
 * is `source`) an old table is removed. DM2_PROTOCOL: a line before `step` is no row. */
enum dm2_status cracks_resume(const char *directory, const char *source, int64_t step, bool in_place,
                              struct file_out *f, struct dm2_error *err);

#endif
