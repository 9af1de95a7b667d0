/* Reading of a deck, the input file that client and servers share (paper, section 5.1). docs/deck.md
 * describes the language and every keyword. */
#ifndef DM2_DECK_DECK_H
#define DM2_DECK_DECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/deck/config.h"

/* One text of a deck. The main file is first; the included files follow in the order of their first
 * inclusion. `name` is the name in messages. */
struct deck_text {
    char *name;
    char *text; /* NUL-terminated; a NUL byte in the file itself is an error of the deck */
    size_t length;
};

/* The most definitions of the command line. */
enum { DECK_MAX_DEFINES = 1000 };

/* A deck as client and servers exchange it: all texts, and the options of the command line that change the
 * deck. */
struct deck_source {
    struct deck_text *texts;
    size_t n_texts;
    char **defines; /* "name=value", from -D */
    size_t n_defines;
    int64_t steps; /* from --steps; -1: `steps` of the deck holds */
    char *state;   /* the file that `start { state = "FILE" }` names, as it would be opened; NULL: none, or a
                      deck that was not read from disk */
    bool meaning;  /* the text is a meaning: bodies from a state are whole, and no state is needed */
};

/* Directories in which an included file is looked for that is not beside the including one. */
struct deck_roots {
    char **items;
    size_t n;
};

/* Reads `path` and the files that it includes from disk; `roots` may be NULL. *out is freed by
 * deck_source_free; on failure *out is empty and *err names the file, the reason, and for a file that is in
 * none of the directories these. A text from a root is named ROOT//PATH. DM2_IO, DM2_DECK, DM2_MEMORY. */
enum dm2_status deck_source_read(const char *path, const struct deck_roots *roots, struct deck_source *out,
                                 struct dm2_error *err);
/* The same without roots, but an included file is opened only if `may` is true for its name as it would be
 * opened. DM2_IO where `may` is false. */
enum dm2_status deck_source_read_some(const char *path, bool (*may)(void *context, const char *name),
                                      void *context, struct deck_source *out, struct dm2_error *err);
void deck_source_free(struct deck_source *source);

/* Writes a deck that loads as one text without other files and options to *out: included texts, and the
 * points of tables, between `# begin "f"` and `# end "f"`, the values of -D and of --steps in their places,
 * the old ones in comments. `config` is that of the source, and of the text. `out` starts as {0}; the caller
 * frees it with bytes_free, also after a failure: DM2_MEMORY. */
enum dm2_status deck_source_flatten(const struct deck_source *source, const struct config *config,
                                    struct bytes_writer *out, struct dm2_error *err);

/* All findings in a deck as one text: for each finding `file:line:column: error: ...` or `warning: ...`, the
 * line, and a caret; at most 20 errors, then "too many errors". */
struct deck_report {
    const char *text; /* NUL-terminated, never NULL after deck_load */
    char *owned;      /* the same text where deck_report_free frees it; NULL: a constant */
    int n_errors, n_warnings;
};
void deck_report_free(struct deck_report *report);

/* Parses, evaluates and checks a deck, without access to files. DM2_OK: *out is complete, freed by
 * config_free, and the report has at most warnings. DM2_DECK: the report has the errors and *out is empty.
 * DM2_MEMORY: *out is empty. deck_report_free frees the report in all cases. */
enum dm2_status deck_load(const struct deck_source *source, struct config *out, struct deck_report *report);

#endif
