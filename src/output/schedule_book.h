/* schedule.csv: at which steps the tables of a run directory have rows.
 *
 *   from_step,table,every,also
 *   0,history.csv,150,
 *   0,fragments.csv,0,10 25
 *   400,history.csv,200,
 *
 * A line per table and change of schedule: from `from_step` on, until the next line of the table, the table
 * has rows at the multiples of `every` (0: none) and at the steps of `also`. An uninterrupted run and one
 * that was interrupted have the same lines. "403,stop,0," says that a block `stop` ended the run at this
 * step. The row of the last step of a run is not in the file, because a run that goes on from its last state
 * drops that row. */
#ifndef DM2_OUTPUT_SCHEDULE_BOOK_H
#define DM2_OUTPUT_SCHEDULE_BOOK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"

extern const char schedule_book_name[]; /* "schedule.csv" */

enum { TABLE_NAME_MAX = NAME_MAX_LENGTH + 16 };

struct schedule_line {
    int64_t from, every;
    char table[TABLE_NAME_MAX];
    size_t n_also;
    int64_t *also; /* ascending */
};

/* Zeroed: empty. Lines of one table ascend in `from`. */
struct schedule_book {
    struct schedule_line *lines;
    size_t n, cap;
};

/* The name of the table of c->profiles[which]. */
void schedule_book_profile(const struct config *c, size_t which, char out[TABLE_NAME_MAX]);

/* Reads the file; *out is empty where there is no file. DM2_PROTOCOL with path:line, DM2_IO, DM2_MEMORY. The
 * caller frees *out, also after a failure. */
enum dm2_status schedule_book_read(const char *path, struct schedule_book *out, struct dm2_error *err);
void schedule_book_free(struct schedule_book *b);

/* Drops the lines from step `from` on and adds a line for each table whose schedule in `c` differs from the
 * last line that is left. DM2_MEMORY. */
enum dm2_status schedule_book_change(struct schedule_book *b, int64_t from, const struct config *c,
                                     struct dm2_error *err);

/* Adds the line "step,stop,0,": a block `stop` of the deck ended the run. DM2_MEMORY. */
enum dm2_status schedule_book_stop(struct schedule_book *b, int64_t step, struct dm2_error *err);

/* The line of a table that holds at `step`; NULL: the table has no rows there. */
const struct schedule_line *schedule_book_line(const struct schedule_book *b, const char *table,
                                               int64_t step);

/* Whether the table has rows at `step`. */
bool schedule_book_due(const struct schedule_book *b, const char *table, int64_t step);

/* Writes the file. DM2_IO, DM2_MEMORY. */
enum dm2_status schedule_book_write(const char *path, const struct schedule_book *b, struct dm2_error *err);

#endif
