/* The findings about a deck: errors and warnings with their places in the texts, collected over all passes,
 * and the report that shows each with its line and a caret. */
#ifndef DM2_DECK_FINDINGS_H
#define DM2_DECK_FINDINGS_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/deck/deck.h"

/* The most errors that are kept, and the most warnings. */
enum { FINDINGS_MAX = 20 };

/* A range of bytes of one text. `text` below source->n_texts is a file of the deck; source->n_texts + i is
 * the i-th definition of the command line. */
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
    int n_errors, n_warnings; /* of those that were kept */
    bool more_errors;         /* there were more than FINDINGS_MAX errors */
    bool no_memory;           /* an allocation failed, so that the findings are incomplete */
};

void findings_start(struct findings *f, const struct deck_source *source);

/* Add one finding. The same message at the same place is added once. The message is a sentence without its
 * full stop. findings_render replaces bytes that a terminal could misread. */
void findings_error(struct findings *f, struct deck_place place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void findings_warn(struct findings *f, struct deck_place place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The report, sorted by place. The caller frees the text. NULL: no memory. */
char *findings_render(struct findings *f);

/* A place as a text that outlives the deck, for config_fail (dm2/deck/config.h): "file:line:column", then the
 * line and a caret as in the report. The caller frees the text. NULL: no memory. */
char *findings_place(const struct findings *f, struct deck_place place);

/* The place.length bytes at a place, without a NUL after them; owned by the source. */
const char *place_bytes(const struct deck_source *source, struct deck_place place);

/* True if the text at `place` is exactly `word`. */
bool place_is(const struct deck_source *source, struct deck_place place, const char *word);

/* The text at the place for a message, cut to 40 bytes. Returns `out->text`. */
struct place_text {
    char text[44];
};
const char *place_text(const struct deck_source *source, struct deck_place place, struct place_text *out);

/* The place from the start of `a` to the end of `b`; both are in one text. */
struct deck_place place_span(struct deck_place a, struct deck_place b);

#endif
