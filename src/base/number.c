/* Numbers as text.
 *
 * Fewest digits: for every double some decimal of at most 17 significant digits reads back to that double.
 * Below 15 digits the %g format drops trailing zeros by itself, so that three tries suffice. Whole numbers
 * below 1e15, such as the counts and steps of the result files, need no tries.
 *
 * The reader checks the grammar before it calls strtod, because strtod also accepts leading blanks,
 * hexadecimal, "infinity" and a prefix. The programs never leave the "C" locale, so that the decimal
 * separator is a point. */
#include "dm2/base/number.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t format_whole(uint64_t n, bool negative, char *out)
{
    char digits[24];
    size_t count = 0, length = 0;
    do {
        digits[count++] = (char)('0' + n % 10);
        n /= 10;
    } while (n != 0);
    if (negative)
        out[length++] = '-';
    while (count > 0)
        out[length++] = digits[--count];
    out[length] = '\0';
    return length;
}

size_t number_format(double x, char out[NUMBER_TEXT_MAX])
{
    x = number_plus_zero(x);
    if (isnan(x)) {
        memcpy(out, "nan", 4);
        return 3;
    }
    if (fabs(x) < 1e15 && x == floor(x))
        return format_whole((uint64_t)fabs(x), x < 0, out);
    int length = 0;
    for (int digits = 15; digits <= 17; digits++) {
        length = snprintf(out, NUMBER_TEXT_MAX, "%.*g", digits, x);
        if (digits == 17 || strtod(out, NULL) == x)
            break;
    }
    return (size_t)length;
}

static size_t skip_digits(const char *text, size_t at, size_t length)
{
    while (at < length && text[at] >= '0' && text[at] <= '9')
        at++;
    return at;
}

static bool is_decimal(const char *text, size_t length)
{
    size_t at = length > 0 && (text[0] == '+' || text[0] == '-') ? 1 : 0;
    size_t begin = at;
    at = skip_digits(text, at, length);
    size_t digits = at - begin;
    if (at < length && text[at] == '.') {
        begin = at + 1;
        at = skip_digits(text, begin, length);
        digits += at - begin;
    }
    if (digits == 0)
        return false;
    if (at < length && (text[at] == 'e' || text[at] == 'E')) {
        at++;
        at += at < length && (text[at] == '+' || text[at] == '-') ? 1 : 0;
        begin = at;
        at = skip_digits(text, at, length);
        if (at == begin)
            return false;
    }
    return at == length;
}

static bool equals(const char *text, size_t length, const char *word)
{
    return strlen(word) == length && memcmp(text, word, length) == 0;
}

bool number_parse(const char *text, size_t length, double *x)
{
    if (equals(text, length, "nan")) {
        *x = NAN;
        return true;
    }
    if (equals(text, length, "inf") || equals(text, length, "-inf")) {
        *x = text[0] == '-' ? -INFINITY : INFINITY;
        return true;
    }
    char copy[128];
    if (length >= sizeof copy || !is_decimal(text, length))
        return false;
    memcpy(copy, text, length);
    copy[length] = '\0';
    double value = strtod(copy, NULL);
    if (isinf(value))
        return false;
    *x = value;
    return true;
}

bool number_parse_integer(const char *text, size_t length, int64_t *x)
{
    char copy[32];
    size_t begin = length > 0 && (text[0] == '+' || text[0] == '-') ? 1 : 0;
    if (length == begin || length >= sizeof copy || skip_digits(text, begin, length) != length)
        return false;
    memcpy(copy, text, length);
    copy[length] = '\0';
    errno = 0;
    long long value = strtoll(copy, NULL, 10);
    if (errno != 0)
        return false;
    *x = value;
    return true;
}
