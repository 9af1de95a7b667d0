/* Where a program finds the programs and the data that belong to it. */
#ifndef DM2_APP_PLACES_H
#define DM2_APP_PLACES_H

#include "dm2/base/status.h"
#include "dm2/deck/deck.h"

/* The path of the program `name` beside `argv0`, the path by which the caller was started; else beside the
 * program that a link argv0 leads to; else the bare name for a search on PATH. malloc'd, the caller frees it;
 * NULL: no memory. */
char *places_program(const char *argv0, const char *name);

/* The directories in which files that a deck includes are looked for behind the deck's own: those of the
 * variable DM2_PATH (separated by colons), PREFIX/share/dm2 of the installation, share/dm2 beside the
 * directory of the program, and of both also `input`; last `input` beside the directory of the program, as
 * in a source tree. DM2_MEMORY. places_free_roots frees *out, also after a failure. */
enum dm2_status places_roots(const char *argv0, struct deck_roots *out, struct dm2_error *err);
void places_free_roots(struct deck_roots *roots);

#endif
