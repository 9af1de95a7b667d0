/* Texts put together, and texts of others made safe to show. */
#ifndef DM2_BASE_TEXT_H
#define DM2_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* a, b and c in a row; malloc'd, NULL: no memory. Give "" for what is not needed. */
char *text_join(const char *a, const char *b, const char *c);

/* Length in bytes of the character at s, of which `left` bytes remain (at least 1); 0 where it is not to be
 * shown as it is: a control character, or no character of UTF-8. */
size_t text_printable(const char *s, size_t left);

/* Makes a text of others do nothing to the terminal or log that shows it: what is not printable becomes '?',
 * a newline or a tab a blank. With `lines` newlines and tabs stay: it may have several lines. */
void text_make_printable(char *text, bool lines);

#endif
