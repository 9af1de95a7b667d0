/* What a run directory tells of each session that wrote in it: run.log's head, and how the session ended; and
 * the command that goes on. */
#ifndef DM2_APP_SESSION_H
#define DM2_APP_SESSION_H

#include "dm2/base/bytes.h"
#include "run.h"

/* The words of the command line in the form that a shell reads back, NUL-terminated, NULL without memory. The
 * caller frees the text. */
char *session_command(const struct run_options *o);

/* Writes deck.dm2, the deck as one text, and adds the head of this session to run.log: command, release,
 * fingerprint, host, start, the deck's digest, the state that the run goes on from. DM2_IO, DM2_MEMORY. */
enum dm2_status session_begin(const struct run_options *o, const struct run *run, struct results *results,
                              struct dm2_error *err);

/* The SHA-256 of a file in hexadecimal; false, and "": the file cannot be read. */
bool session_digest(const char *path, char out[SHA256_TEXT]);

/* Adds to run.log that the run is done, when, and the digest of final.dm2. DM2_IO, DM2_MEMORY. */
enum dm2_status session_end(struct results *results, struct dm2_error *err);

/* After a run that ended early by *why: adds when, why and the digest of the checkpoint to run.log, and
 * prints on standard error the command line that goes on, if there is a state to go on from. To be called
 * before results_abort; `results` may be NULL. */
void session_fail(const struct run_options *o, struct results *results, const struct dm2_error *why);

/* Adds to the text of an interrupted run that the same command with --restart auto goes on. */
void session_explain(const struct run_options *o, enum dm2_status status, struct dm2_error *err);

#endif
