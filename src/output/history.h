/* The tables of a run directory that grow by rows: history.csv, profile-NAME.csv and fragments.csv.
 *
 * Each function that writes rows hands them to the system at once, because another program may watch the
 * file, and because a full disk should stop the run early. The text of a row depends on the config and the
 * values alone. Functions that return a status: DM2_IO with the path and the system's reason. */
#ifndef DM2_OUTPUT_HISTORY_H
#define DM2_OUTPUT_HISTORY_H

#include <stdint.h>

#include "dm2/base/file.h"
#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "dm2/engine/measures.h"
#include "dm2/engine/profile.h"
#include "energy_book.h"
#include "fragments.h"

/* The tables of one run; zeroed: none is open. fragments.csv and cracks.csv (cracks.h) are opened with their
 * first rows. */
struct history_tables {
    struct file_out history, fragments, cracks;
    struct file_out profiles[PROFILE_MAX]; /* as in the config */
};

/* The heading of history.csv: the columns of every run, then those of each probe. */
void history_put_heading(struct file_out *f, const struct config *c);

/* The row of one step in history.csv, which stays in the buffer of *f until file_flush; drift: of the energy
 * book (energy_book.h). */
void history_put_row(struct file_out *f, const struct config *c, const struct measure_scales *scales,
                     int64_t step, const struct measures *m, double drift);

/* The numbers of this row that the energy book needs. */
struct book_row history_book_row(const struct measure_scales *scales, int64_t step, const struct measures *m);

/* The heading of a profile's table. */
void history_put_profile_heading(struct file_out *f, const struct profile_config *c);

/* The rows of one step in the table of c->profiles[which], one per bin; `bins` has one sum per bin. */
enum dm2_status history_put_profile(struct file_out *f, const struct config *c,
                                    const struct measure_scales *scales, size_t which, int64_t step,
                                    const struct profile_bin *bins, struct dm2_error *err);

/* The heading of fragments.csv, and the row of the snapshot at `step`. */
void history_put_fragments_heading(struct file_out *f);
enum dm2_status history_put_fragments(struct file_out *f, const struct config *c, int64_t step,
                                      const struct fragment_counts *counts, struct dm2_error *err);

#endif
