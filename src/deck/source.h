/* Names of included files. Reading of decks: dm2/deck/deck.h. */
#ifndef DM2_DECK_SOURCE_H
#define DM2_DECK_SOURCE_H

#include <stddef.h>

enum { DECK_MAX_BYTES = 16 << 20, DECK_MAX_TEXTS = 64, DECK_MAX_DEFINES = 1000 };

/* The name of the file that the text `includer` means by `path` (not NUL-terminated): beside it. malloc'd.
 * NULL: the path is empty, absolute, has a '..' or a control character in it; or memory lacks. */
char *deck_source_include(const char *includer, const char *path, size_t length);

#endif
