/* What is wrong with a deck, gathered so that all of it is told in one go: places in texts, errors and
 * warnings, and the report that shows each with its line and a caret. */
#ifndef DM2_DECK_FINDINGS_H
#define DM2_DECK_FINDINGS_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/deck/deck.h"

/* At most so many errors are kept, and so many warnings. */
enum { FINDINGS_MAX = 20 };

/* A stretch of one text. `text` below source->n_texts is a file of the deck; from there on it is a
 * definition of the command line. */
struct deck_place {
    int text;
    size_t offset, length;
};

struct finding {
    bool is_error;
    struct deck_place place;
    char message[400];
};

struct findings {
    const struct deck_source *source; /* borrowed */
    struct finding items[2 * FINDINGS_MAX];
    size_t n;
    int n_errors, n_warnings; /* kept ones */
    bool more_errors;         /* there were more than FINDINGS_MAX */
    bool no_memory;           /* an allocation failed: whatever else was found is incomplete */
};

void findings_start(struct findings *f, const struct deck_source *source);

/* Add one finding; the same message at the same place counts once. The message is a sentence without its
 * full stop; bytes that a terminal could misread are replaced when it is rendered. */
void findings_error(struct findings *f, struct deck_place place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void findings_warn(struct findings *f, struct deck_place place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The report, sorted by place; malloc'd, NULL where memory lacks. */
char *findings_render(struct findings *f);

/* A place as a text that outlives the deck, for config_fail (dm2/deck/config.h): "file:line:column", and
 * below it the line and a caret, as in the report; malloc'd, NULL where memory lacks. */
char *findings_place(const struct findings *f, struct deck_place place);

/* The bytes at a place; not NUL-terminated, place.length of them. */
const char *place_bytes(const struct deck_source *source, struct deck_place place);

/* Is the text at `place` exactly `word`? */
bool place_is(const struct deck_source *source, struct deck_place place, const char *word);

/* For messages: the text at the place, cut to 40 bytes. Returns `out`. */
struct place_text {
    char text[44];
};
const char *place_text(const struct deck_source *source, struct deck_place place, struct place_text *out);

/* The place from the start of `a` to the end of `b`, both of one text. */
struct deck_place place_span(struct deck_place a, struct deck_place b);

#endif
