/* Dimensions and units of the numbers in a deck. The base units are cm, g, us, K, mol. */
#ifndef DM2_DECK_UNITS_H
#define DM2_DECK_UNITS_H

#include <stdbool.h>
#include <stddef.h>

/* The exponents of the base units. All zero: a plain number. An angle is a plain number, in radians. */
struct dimension {
    signed char length, mass, time, temperature, amount;
};

struct quantity {
    double value; /* in base units */
    struct dimension dim;
};

/* The unit is factor * 10^exponent base units. Factor and exponent are separate so that a number with a unit
 * is rounded once. */
struct unit {
    struct dimension dim;
    double factor;
    int exponent;
};

/* The unit of a word: a symbol, with an SI prefix if the symbol can have one, with a power from 2 to 9 after
 * it if any (`cm3`). False: no such unit. */
bool unit_find(const char *word, size_t length, struct unit *out);

/* out = a * b^power. False: an exponent of the dimension is outside -30 .. 30, or the factor is outside the
 * range of a double. */
bool unit_times(struct unit a, struct unit b, int power, struct unit *out);

/* The number with the decimal digits `digits` (length bytes that the caller has checked: digits, a point, an
 * exponent) in `unit`, in base units; rounded once where unit.factor is 1. inf: too large. 0 for digits that
 * are not all 0: too small. NaN: more than 100 digits. */
double unit_value(const char *digits, size_t length, struct unit unit);

bool dimension_equal(struct dimension a, struct dimension b);
bool dimension_is_plain(struct dimension a);

/* out = a + power * b, in exponents. False as for unit_times. */
bool dimension_times(struct dimension a, struct dimension b, int power, struct dimension *out);

/* The name of a dimension with its base unit: "a velocity (cm/us)". Returns a constant or `out->text`. */
struct dimension_text {
    char text[80];
};
const char *dimension_name(struct dimension dim, struct dimension_text *out);

/* The base unit of a dimension: "cm/us"; "-" for a plain number. Returns a constant or `out->text`. */
const char *dimension_unit(struct dimension dim, struct dimension_text *out);

#endif
