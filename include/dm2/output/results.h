/* The run directory: what a run leaves on disk (docs: README, "The run directory").
 *
 *   history.csv            one row per measured step, units in the heading
 *   profile-NAME.csv       of each profile of the deck, one row per bin and measured step (engine/profile.h)
 *   fragments.csv          one row per snapshot: the number of fragments (output/fragments.h)
 *   cracks.csv             one row per link that broke (dm2/engine/crack.h); absent where none broke
 *   final.dm2              the state after the last step (dm2/output/state.h)
 *   checkpoint.dm2         the newest checkpoint, a state as well; checkpoint.prev.dm2 is the one before
 *   snapshots/state-*.vtp  states at the steps that the deck names, with series.pvd (ParaView), and/or
 *   snapshots/state-*.xyz  in extended XYZ (OVITO) (output/snapshot.h)
 *   schedule.csv           at which steps the tables have rows (output/schedule_book.h)
 *   deck.dm2               the deck as one text, which gives the same bytes
 *   run.log, timing.csv    texts that the program writes with results_log and results_text
 *
 * Every file is written under a temporary name (its own with ".part" at the end), brought to disk and
 * renamed, so a file under its final name is always whole. The tables that grow with the run, history.csv,
 * profile-NAME.csv, fragments.csv and cracks.csv, get their final names in results_close only: a run that
 * ends early leaves neither a history nor a final state, only the snapshots that it completed. A run that has
 * written a checkpoint leaves its tables under their temporary names as well. They are on disk up to the
 * checkpoint's step before the checkpoint is, and results_go_on takes them over. The bytes of all files
 * but run.log and timing.csv depend on the deck and the results alone.
 *
 * Every function that returns a status: DM2_IO with the path and the system's reason, or DM2_MEMORY. After a
 * failure call results_abort. A full disk is reported as DM2_IO, and so is a file size limit (RLIMIT_FSIZE)
 * where the program ignores SIGXFSZ, which every program here does at its start. */
#ifndef DM2_OUTPUT_RESULTS_H
#define DM2_OUTPUT_RESULTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "dm2/engine/crack.h"
#include "dm2/engine/element.h"
#include "dm2/engine/measures.h"
#include "dm2/engine/profile.h"
#include "dm2/engine/section.h"
#include "dm2/engine/wall_outline.h"
#include "dm2/output/state.h"

struct results;

/* Makes the directory and its parents, or takes one that is there, and locks it (dm2/output/run_directory.h);
 * `command` stands in the lock. Until results_begin or results_go_on, *out has the lock alone and is for
 * results_directory, results_warning and results_abort. After a failure *out is NULL. */
enum dm2_status results_claim(const char *directory, const char *command, struct results **out,
                              struct dm2_error *err);

/* Begins a run in the directory. One that is not empty is an error unless `overwrite`; then the files named
 * above that an earlier run left in the directory are removed, and nothing else. `config` and `origin` are
 * borrowed for the life of r; `scales` is model_scales() of its model; `origin` goes into states. Writes
 * schedule.csv, opens history.csv and the tables of profiles and writes their headings. The caller ends r
 * with results_close or results_abort, the latter also after a failure. */
enum dm2_status results_begin(struct results *r, bool overwrite, const struct config *config,
                              struct measure_scales scales, const struct state_origin *origin,
                              struct dm2_error *err);

/* results_claim, then results_begin; after a failure *out is NULL. */
enum dm2_status results_open(const char *directory, bool overwrite, const struct config *config,
                             struct measure_scales scales, const struct state_origin *origin,
                             struct results **out, struct dm2_error *err);

/* results_begin for a run that goes on from a state, read from the file `path`. The tables beside
 * the state are taken over up to that step, as schedule.csv says which rows they have: rows of later steps
 * are dropped, and no row is missing or doubled. Where the state lies in the run's directory, the run goes on
 * there and the state becomes its checkpoint.dm2 (adopt.h); else the directory is prepared as by
 * results_begin and the rows are copied into it, while snapshots stay with the state. DM2_PROTOCOL where the
 * tables lack rows from before the step, DM2_DECK where they have other columns than the deck asks for; the
 * message says which and the remedy, and nothing is touched. */
enum dm2_status results_go_on(struct results *r, bool overwrite, const char *path, const struct state *state,
                              const struct config *config, struct measure_scales scales,
                              const struct state_origin *origin, struct dm2_error *err);

/* Brings the tables to disk, then writes the state as checkpoint.dm2 and keeps the previous checkpoint as
 * checkpoint.prev.dm2. The rows up to state->step - 1 must have been added. The file gets the run's
 * origin. */
enum dm2_status results_checkpoint(struct results *r, const struct state_view *state, struct dm2_error *err);

/* The step of the newest checkpoint in the directory that this run wrote or continues from; -1: none. */
int64_t results_checkpoint_step(const struct results *r);

/* The directory, for messages. */
const char *results_directory(const struct results *r);

/* What the user is to know of the opened directory, a sentence; empty: nothing. */
const char *results_warning(const struct results *r);

/* What the rows of history.csv say about the energy book (output/energy_book.h), a line each without newline.
 */
enum { RESULTS_LINE = 400 };
struct results_verdict {
    char energy[RESULTS_LINE];  /* "energy: ...": by how much `total` drifted */
    char warning[RESULTS_LINE]; /* "warning: ...", with what to do; empty: none */
    char stop[RESULTS_LINE];    /* "stop: ...": which block `stop` ended the run; empty: none */
};
void results_verdict(const struct results *r, struct results_verdict *out);

/* True once, with a warning for the user, when dt has come near the limit that holds now. To be called after
 * results_history. */
bool results_warns(struct results *r, char line[RESULTS_LINE]);

/* Whether a block `stop` of the deck has held at a row so far, and the step *end at which the run ends then:
 * the row's step and 3, which may be beyond the run's steps. True from results_continue on where the rows
 * before the checkpoint decided. */
bool results_stopped(const struct results *r, int64_t *end);

/* Whether the rows of history.csv in `directory` let a block `stop` of the deck end the run at `step`. A
 * table that cannot be read lets none. */
bool results_ended_by_stop(const char *directory, const struct config *config, int64_t step);

/* results_history, results_profile and results_snapshot ignore a step that is already in the run directory,
 * because a run that went back to an earlier state repeats such steps with the same numbers.
 *
 * Appends the row of one step to history.csv. The column `total` = kinetic + potential + elastic + thermal +
 * chemical + phase + damped - work is constant under exact integration; the sum is exact until it is rounded
 * once. The column `drift` is the change of `total` over the energies that moved. Also DM2_NUMERIC where the
 * drift is beyond 50 %: then the run ends, and a final.dm2 of this run is removed. */
enum dm2_status results_history(struct results *r, int64_t step, const struct measures *m,
                                struct dm2_error *err);

/* Appends the rows of one step to the table of config->profiles[which]; `bins` has one sum per bin. */
enum dm2_status results_profile(struct results *r, size_t which, int64_t step, const struct profile_bin *bins,
                                struct dm2_error *err);

/* Appends the links that broke in the evaluation of `step` to cracks.csv, and sorts the list. A step that has
 * rows, or is before one, is ignored. */
enum dm2_status results_cracks(struct results *r, int64_t step, struct crack_list *list,
                               struct dm2_error *err);

/* The walls of a state, for a snapshot. */
struct snapshot_walls {
    struct section_array forces; /* of SECTION_WFOR, sorted */
    struct wall_outlines outlines;
};

/* Writes the state at `step` in each format that the deck asks for, and its fragments to fragments.csv.
 * `elements` in id order, `measured` beside `elements`, `pairs` by (id_a, id_b), `forces` beside
 * `pairs`; walls NULL: there are none. Also DM2_NUMERIC where a pair names an absent element. */
enum dm2_status results_snapshot(struct results *r, int64_t step, const struct element *elements,
                                 const struct element_measure *measured, size_t n_elements,
                                 const struct pair_record *pairs, const struct pair_measure *forces,
                                 size_t n_pairs, const struct snapshot_walls *walls, struct dm2_error *err);

/* Writes final.dm2, with the run's origin. */
enum dm2_status results_final(struct results *r, const struct state_view *state, struct dm2_error *err);

/* Adds a text to run.log, which keeps the texts of earlier sessions. */
enum dm2_status results_log(struct results *r, const char *text, size_t length, struct dm2_error *err);

/* Writes or replaces a text of the run: `name` is "run.log", "timing.csv" or "deck.dm2". */
enum dm2_status results_text(struct results *r, const char *name, const char *text, size_t length,
                             struct dm2_error *err);

/* Gives the tables their final names and frees r, also after a failure (as results_abort does). */
enum dm2_status results_close(struct results *r, struct dm2_error *err);

/* Removes incomplete files, except tables that a checkpoint needs, and without a checkpoint the texts, too;
 * removes the directory where results_claim made it and it is empty; frees r (NULL is
 * accepted). Errors are ignored, because the run has failed already. */
void results_abort(struct results *r);

#endif
