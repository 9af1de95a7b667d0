/* text_join: one allocation of the exact size; each length is measured once.
 *
 * text_make_printable protects a terminal from control characters in texts of other programs: only printable
 * characters, in ASCII or well-formed UTF-8, are kept. U+0080 to U+009F count as control characters, as
 * terminals treat them; so does any byte that is not part of a character, because an 8-bit terminal could
 * read the byte as a control character. */
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

size_t text_mark(const char *text, size_t n)
{
    static const char mark[] = "\xef\xbb\xbf";
    return n >= sizeof mark - 1 && memcmp(text, mark, sizeof mark - 1) == 0 ? sizeof mark - 1 : 0;
}

size_t text_printable(const char *s, size_t left)
{
    unsigned char c = (unsigned char)s[0];
    if (c < 0x80)
        return c >= 0x20 && c != 0x7f ? 1 : 0;
    size_t n = c >= 0xf0 && c <= 0xf4 ? 4 : c >= 0xe0 && c < 0xf0 ? 3 : c >= 0xc2 && c < 0xe0 ? 2 : 0;
    if (n == 0 || n > left)
        return 0;
    for (size_t i = 1; i < n; i++)
        if (((unsigned char)s[i] & 0xc0u) != 0x80u)
            return 0;
    return c == 0xc2 && (unsigned char)s[1] < 0xa0 ? 0 : n;
}

void text_make_printable(char *text, bool lines)
{
    size_t n = strlen(text);
    for (size_t i = 0; i < n;) {
        size_t step = text_printable(text + i, n - i);
        bool blank = text[i] == '\n' || text[i] == '\t';
        if (step == 0 && !(blank && lines))
            text[i] = blank ? ' ' : '?';
        i += step > 0 ? step : 1;
    }
}
