/* Suggestions: the known word nearest to an unknown word. */
#ifndef DM2_BASE_WORDS_H
#define DM2_BASE_WORDS_H

#include <stdbool.h>
#include <stddef.h>

/* A set of candidates: `name(context, i)` is the i-th of n, NUL-terminated. */
struct word_list {
    const char *(*name)(const void *context, size_t i);
    const void *context;
    size_t n;
};

struct word_hint {
    char text[240];
};

/* Writes to *out the part of a message that follows "is not known": "; did you mean 'velocity'?" where a
 * candidate is near, else "; known: a, b, c" (cut to the size of the text), or "" for an empty list. Returns
 * out->text. */
const char *words_hint(const struct word_list *known, const char *word, size_t length, struct word_hint *out);

/* The number of letters to change, insert, remove or swap with their neighbour that turns a into b, times
 * WORDS_LETTER; a letter of the wrong case counts 1. Words of more than 40 letters have a distance beyond all
 * others. */
enum { WORDS_LETTER = 8 };
int words_distance(const char *a, size_t n_a, const char *b, size_t n_b);

/* Is `word` near enough to `known` for a suggestion? */
bool words_near(const char *word, size_t length, const char *known);

#endif
