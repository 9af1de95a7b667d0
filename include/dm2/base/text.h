/* Texts put together. */
#ifndef DM2_BASE_TEXT_H
#define DM2_BASE_TEXT_H

/* a, b and c in a row; malloc'd, NULL: no memory. Give "" for what is not needed. */
char *text_join(const char *a, const char *b, const char *c);

#endif
