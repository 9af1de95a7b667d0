/* Joined texts, and texts from other programs made safe to show. */
#ifndef DM2_BASE_TEXT_H
#define DM2_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* The concatenation of a, b and c, each possibly "". malloc'd, the caller frees it; NULL: no memory. */
char *text_join(const char *a, const char *b, const char *c);

/* The number of bytes of the byte order mark of UTF-8 at the begin of a file's `n` bytes: 3 or 0. */
size_t text_mark(const char *text, size_t n);

/* The length in bytes of the printable character at s, where `left` bytes of text remain (at least 1); 0 for
 * a control character and for bytes that are not UTF-8. */
size_t text_printable(const char *s, size_t left);

/* Replaces all characters that could control a terminal or forge lines of a log: a newline or a tab becomes a
 * blank, any other byte that is not printable becomes '?'. With `lines`, newlines and tabs are kept, for
 * texts of several lines. */
void text_make_printable(char *text, bool lines);

#endif
