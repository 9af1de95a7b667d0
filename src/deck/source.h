/* Names of included files, and the limits of a source. Reading of decks: dm2/deck/deck.h. */
#ifndef DM2_DECK_SOURCE_H
#define DM2_DECK_SOURCE_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/deck/deck.h"

enum { DECK_MAX_BYTES = 48 << 20, DECK_MAX_TEXTS = 64 };

/* The name of the file that the text `includer` includes by `path` (length bytes, without a NUL): relative to
 * the folder of `includer`, without empty components and '.' in `path`, so that a file has one name. The
 * caller frees the name. NULL: the path is empty, is absolute (also behind './'), has a '..' or a control
 * character; or no memory. */
char *deck_source_include(const char *includer, const char *path, size_t length);

/* The index of the text that the text `includer` includes by `path`: the text of that name beside `includer`,
 * else the text that was found by `path` in a directory of struct deck_roots. -1: none, or no memory;
 * *valid is false where deck_source_include returns NULL. */
int deck_source_find(const struct deck_source *source, size_t includer, const char *path, size_t length,
                     bool *valid);

#endif
