/* Numbers as text: the fewest digits that read back to the same double, and a strict reader. */
#ifndef DM2_BASE_NUMBER_H
#define DM2_BASE_NUMBER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { NUMBER_TEXT_MAX = 32 };

/* x, and 0 where x is -0. The two zeros compare as equal, so that the minimum or maximum of several numbers
 * may be either, by their order; whatever is printed, stored or hashed is +0. */
static inline double number_plus_zero(double x)
{
    return x + 0.0; /* in rounding to nearest, -0 + 0 is +0 and no other sum changes */
}

/* Writes x with the fewest of 15, 16 or 17 significant digits that read back to the same double, or as "nan",
 * "inf",
 * "-inf", and returns the length. A negative zero is "0". */
size_t number_format(double x, char out[NUMBER_TEXT_MAX]);

/* Reads text[0 .. length), which must be one number: decimal digits with optional sign, point and exponent,
 * or nan, inf, -inf. False, and *x unchanged, for any other text: blanks, hexadecimal, an empty field, more
 * than 127 bytes, a number beyond the range of a double. */
bool number_parse(const char *text, size_t length, double *x);

/* number_parse for an integer in the range of int64_t: digits with an optional sign, at most 31 bytes. */
bool number_parse_integer(const char *text, size_t length, int64_t *x);

#endif
