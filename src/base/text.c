/* Texts put together: one allocation of the right size, lengths measured once. */
#include "dm2/base/text.h"

#include <stdlib.h>
#include <string.h>

char *text_join(const char *a, const char *b, const char *c)
{
    size_t la = strlen(a), lb = strlen(b), lc = strlen(c);
    char *text = malloc(la + lb + lc + 1);
    if (text != NULL) {
        memcpy(text, a, la);
        memcpy(text + la, b, lb);
        memcpy(text + la + lb, c, lc + 1);
    }
    return text;
}
