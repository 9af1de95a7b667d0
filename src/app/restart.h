/* The state that a run goes on from: of --restart FILE, or found in the run directory (--restart auto). */
#ifndef DM2_APP_RESTART_H
#define DM2_APP_RESTART_H

#include "run.h"

/* Reads the state of --restart FILE into *run. DM2_PROTOCOL or DM2_IO where that state cannot be used, with
 * the reason and the previous checkpoint, if the latter can be used; DM2_MEMORY. */
enum dm2_status restart_read(const struct run_options *o, struct run *run, struct dm2_error *err);

/* --restart auto: locks the run directory (run->results; not with --check) and looks what the directory has:
 *
 *     no state                          the run begins: run->restarted is false, run->anew as found
 *     whole states                      the one of the greatest step is read into *run
 *     ... of the last step, with all
 *     tables under their names          run->complete, and a line that says so
 *
 * A state is whole where magic, length, checksum and fingerprint are right. What the user is to know is
 * printed on standard error. DM2_DECK where the state is of another deck or beyond the last step; DM2_IO with
 * the reason of each state where none is whole; the errors of results_claim; DM2_MEMORY. Nothing in the
 * directory is changed. */
enum dm2_status restart_choose(const struct run_options *o, struct run *run, struct dm2_error *err);

#endif
