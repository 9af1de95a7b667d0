/* Names of included files, and the limits of a source. Reading of decks: dm2/deck/deck.h. */
#ifndef DM2_DECK_SOURCE_H
#define DM2_DECK_SOURCE_H

#include <stddef.h>

enum { DECK_MAX_BYTES = 16 << 20, DECK_MAX_TEXTS = 64, DECK_MAX_DEFINES = 1000 };

/* The name of the file that the text `includer` includes by `path` (length bytes, without a NUL): relative to
 * the folder of `includer`. The caller frees the name. NULL: the path is empty, is absolute, has a '..' or a
 * control character; or no memory. */
char *deck_source_include(const char *includer, const char *path, size_t length);

#endif
