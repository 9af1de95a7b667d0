/* Takes over the tables of a run that ended early: the rows from before a checkpoint. */
#ifndef DM2_OUTPUT_RESUME_H
#define DM2_OUTPUT_RESUME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "cracks.h"
#include "history.h"
#include "schedule_book.h"
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

/* A table that is taken over. */
struct resumed_table {
    char name[TABLE_NAME_MAX];
    bool whole;          /* under its final name, of a run that ended */
    size_t keep;         /* bytes: the heading and the rows before the checkpoint */
    unsigned char *text; /* of a table that is copied */
    struct file_out *to;
};

/* The tables of a run that continues from the state of `step` in `source`, which has `links` linked pairs;
 * `in_place` is resume_in_place. */
struct resume {
    const char *source;
    bool in_place;
    int64_t step, links;
    const struct schedule_book *book; /* of `source` */
    size_t n;
    struct resumed_table tables[PROFILE_MAX + 2];
    struct crack_rows crack_rows;
    struct file_out *cracks;
};

/* Reads the tables and touches none. DM2_DECK where columns, bins or profiles are others than those of the
 * deck; DM2_PROTOCOL as resume_keep, or where cracks.csv lacks rows; DM2_IO, DM2_MEMORY. The members of *r up
 * to `book` are given, n is 0; `tables` are those that resume_take opens. */
enum dm2_status resume_check(struct resume *r, const struct config *c, struct history_tables *tables,
                             struct dm2_error *err);

/* Opens the tables in `directory` with the rows before the step: in place the files are cut, else copied. The
 * caller closes the tables, after a failure as well. DM2_IO, DM2_MEMORY. */
enum dm2_status resume_take(const struct resume *r, const char *directory, struct dm2_error *err);

void resume_free(struct resume *r);

/* Adds to *series the steps before `step` whose .vtp snapshots are in `directory`, ascending. DM2_MEMORY. */
enum dm2_status resume_series(const char *directory, const struct schedule_book *book, int64_t step,
                              struct snapshot_steps *series, struct dm2_error *err);

#endif
