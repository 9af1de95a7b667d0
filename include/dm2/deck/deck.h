/* Reading a deck: the input file that client and servers share (paper, section 5.1). docs/deck.md has
 * the language and every keyword. */
#ifndef DM2_DECK_DECK_H
#define DM2_DECK_DECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/deck/config.h"

/* One text of a deck. The main file is first; the files it includes follow in the order of their first
 * inclusion. `name` is what messages call it. */
struct deck_text {
    char *name;
    char *text; /* NUL-terminated; a NUL byte inside the file is an error when it is read */
    size_t length;
};

/* A deck as it travels: every text it needs, and the command line's changes to it. */
struct deck_source {
    struct deck_text *texts;
    size_t n_texts;
    char **defines; /* "name=value", from -D */
    size_t n_defines;
    int64_t steps; /* from --steps; -1: as the deck says */
};

/* Reads `path` and whatever it includes from disk. On failure *err says which file and why and *out is
 * empty. Free with deck_source_free. DM2_IO, DM2_DECK, DM2_MEMORY. */
enum dm2_status deck_source_read(const char *path, struct deck_source *out, struct dm2_error *err);
/* The same with a say in what is included: a file for which `may` is false (its name is as it would be
 * opened) is not opened, and the deck not read, DM2_IO. */
enum dm2_status deck_source_read_some(const char *path, bool (*may)(void *context, const char *name),
                                      void *context, struct deck_source *out, struct dm2_error *err);
void deck_source_free(struct deck_source *source);

/* Every finding in a deck. The report is the finished text: per finding `file:line:column: error: ...` or
 * `warning: ...`, the line, and a caret; at most 20 errors, then "too many errors". */
struct deck_report {
    const char *text; /* NUL-terminated, never NULL after deck_load */
    char *owned;      /* the same where deck_report_free frees the text; NULL: a constant */
    int n_errors, n_warnings;
};
void deck_report_free(struct deck_report *report);

/* Parses, evaluates and validates. On DM2_OK *out is complete (config_free it) and the report holds at most
 * warnings; on DM2_DECK the report says why and *out is empty. Touches no file. */
enum dm2_status deck_load(const struct deck_source *source, struct config *out, struct deck_report *report);

#endif
