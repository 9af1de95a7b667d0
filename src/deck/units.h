/* Dimensions and units of the numbers in a deck. Base units: cm, g, us, K, mol. */
#ifndef DM2_DECK_UNITS_H
#define DM2_DECK_UNITS_H

#include <stdbool.h>
#include <stddef.h>

/* The exponents of the base units. All zero: a plain number (an angle is one, in radians). */
struct dimension {
    signed char length, mass, time, temperature, amount;
};

struct quantity {
    double value; /* in base units */
    struct dimension dim;
};

/* One unit is factor * 10^exponent base units. Kept apart so that a number with a unit is rounded once. */
struct unit {
    struct dimension dim;
    double factor;
    int exponent;
};

/* The unit called `word`: a symbol, with an SI prefix where that makes sense, with a power from 2 to 9 behind
 * it
 * (`cm3`). False: there is none. */
bool unit_find(const char *word, size_t length, struct unit *out);

/* out = a * b^power. False: an exponent leaves -30 .. 30, or the factor leaves the range of a double. */
bool unit_times(struct unit a, struct unit b, int power, struct unit *out);

/* The number whose decimal digits are `digits` (checked by the caller: digits, a point, an exponent), in
 * `unit`: rounded once where the unit's factor is 1. inf: too large. 0 for digits that are not all 0: too
 * small. */
double unit_value(const char *digits, size_t length, struct unit unit);

bool dimension_equal(struct dimension a, struct dimension b);
bool dimension_is_plain(struct dimension a);

/* out = a + power * b in exponents. False as for unit_times. */
bool dimension_times(struct dimension a, struct dimension b, int power, struct dimension *out);

/* What a value of this dimension is called, with its base unit: "a velocity (cm/us)". */
struct dimension_text {
    char text[80];
};
const char *dimension_name(struct dimension dim, struct dimension_text *out);

/* The base unit alone: "cm/us", "-" for a plain number. */
const char *dimension_unit(struct dimension dim, struct dimension_text *out);

#endif
