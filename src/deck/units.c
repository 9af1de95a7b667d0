/* Every unit except eV, cal, atm and deg is a power of ten times the base unit. The power of ten is kept as
 * an integer and added to the decimal exponent of the number before the conversion: `4.602 km/s` becomes
 * strtod("4.602e-1"), the same double as `0.4602`. A product with 0.1 could be another double, because it
 * would be rounded twice.
 *
 * strtod in the C locale is correctly rounded in every libc that dm2 supports, so that a deck gives the same
 * bits on every machine. */
#include "units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DIM(l, m, t, k, n)                                                                                   \
    {                                                                                                        \
        l, m, t, k, n                                                                                        \
    }

struct symbol {
    const char *name;
    const char *prefixes; /* letters of the prefixes that the symbol can have */
    struct unit unit;
};

static const struct symbol symbols[] = {
    {"m", "afpnumckM", {DIM(1, 0, 0, 0, 0), 1, 2}},
    {"angstrom", "", {DIM(1, 0, 0, 0, 0), 1, -8}},
    {"g", "fpnumkM", {DIM(0, 1, 0, 0, 0), 1, 0}},
    {"s", "afpnum", {DIM(0, 0, 1, 0, 0), 1, 6}},
    {"Hz", "kMGT", {DIM(0, 0, -1, 0, 0), 1, -6}},
    {"K", "mk", {DIM(0, 0, 0, 1, 0), 1, 0}},
    {"mol", "umk", {DIM(0, 0, 0, 0, 1), 1, 0}},
    {"N", "unmkMG", {DIM(1, 1, -2, 0, 0), 1, -7}},
    {"dyn", "", {DIM(1, 1, -2, 0, 0), 1, -12}},
    {"Pa", "mhkMGT", {DIM(-1, 1, -2, 0, 0), 1, -11}},
    {"bar", "mkMG", {DIM(-1, 1, -2, 0, 0), 1, -6}},
    {"atm", "", {DIM(-1, 1, -2, 0, 0), 1.01325, -6}},
    {"J", "pnumkMG", {DIM(2, 1, -2, 0, 0), 1, -5}},
    {"erg", "", {DIM(2, 1, -2, 0, 0), 1, -12}},
    {"eV", "mkMG", {DIM(2, 1, -2, 0, 0), 1.602176634, -24}},
    {"cal", "k", {DIM(2, 1, -2, 0, 0), 4.184, -5}},
    {"W", "numkMG", {DIM(2, 1, -3, 0, 0), 1, -11}},
    {"rad", "m", {DIM(0, 0, 0, 0, 0), 1, 0}},
    {"deg", "", {DIM(0, 0, 0, 0, 0), 0.017453292519943295, 0}},
};

static const struct {
    char letter;
    int exponent;
} prefixes[] = {{'a', -18}, {'f', -15}, {'p', -12}, {'n', -9}, {'u', -6}, {'m', -3},
                {'c', -2},  {'h', 2},   {'k', 3},   {'M', 6},  {'G', 9},  {'T', 12}};

static int prefix_exponent(char letter)
{
    for (size_t i = 0; i < sizeof prefixes / sizeof prefixes[0]; i++)
        if (prefixes[i].letter == letter)
            return prefixes[i].exponent;
    return 0;
}

static bool symbol_find(const char *word, size_t length, struct unit *out)
{
    for (size_t i = 0; i < sizeof symbols / sizeof symbols[0]; i++) {
        const struct symbol *s = &symbols[i];
        size_t n = strlen(s->name);
        bool bare = length == n;
        bool prefixed = length == n + 1 && strchr(s->prefixes, word[0]) != NULL;
        if ((!bare && !prefixed) || memcmp(word + length - n, s->name, n) != 0)
            continue;
        *out = s->unit;
        if (prefixed)
            out->exponent += prefix_exponent(word[0]);
        return true;
    }
    return false;
}

bool unit_find(const char *word, size_t length, struct unit *out)
{
    static const struct unit one = {DIM(0, 0, 0, 0, 0), 1, 0};
    int power = 1;
    if (length == 0)
        return false;
    if (length > 1 && word[length - 1] >= '2' && word[length - 1] <= '9') {
        power = word[length - 1] - '0';
        length--;
    }
    struct unit symbol;
    return symbol_find(word, length, &symbol) && unit_times(one, symbol, power, out);
}

static bool exponent_sum(signed char a, signed char b, int power, signed char *out)
{
    int sum = a + b * power;
    *out = (signed char)sum;
    return sum >= -30 && sum <= 30;
}

bool dimension_times(struct dimension a, struct dimension b, int power, struct dimension *out)
{
    if (power < -1000 || power > 1000)
        return dimension_is_plain(b) && dimension_times(a, b, 0, out);
    return exponent_sum(a.length, b.length, power, &out->length) &&
           exponent_sum(a.mass, b.mass, power, &out->mass) &&
           exponent_sum(a.time, b.time, power, &out->time) &&
           exponent_sum(a.temperature, b.temperature, power, &out->temperature) &&
           exponent_sum(a.amount, b.amount, power, &out->amount);
}

bool unit_times(struct unit a, struct unit b, int power, struct unit *out)
{
    struct unit product = a;
    if (power < -30 || power > 30 || !dimension_times(a.dim, b.dim, power, &product.dim))
        return false;
    for (int i = 0; i < abs(power); i++)
        product.factor = power > 0 ? product.factor * b.factor : product.factor / b.factor;
    product.exponent += power * b.exponent;
    *out = product;
    return isfinite(product.factor) && product.factor > 0 && abs(product.exponent) < 2000;
}

double unit_value(const char *digits, size_t length, struct unit unit)
{
    char text[160];
    size_t mantissa = 0;
    while (mantissa < length && digits[mantissa] != 'e' && digits[mantissa] != 'E')
        mantissa++;
    long exponent = 0;
    if (mantissa < length) {
        bool negative = digits[mantissa + 1] == '-';
        for (size_t i = mantissa + 1; i < length; i++)
            if (digits[i] >= '0' && digits[i] <= '9' && exponent < 100000)
                exponent = exponent * 10 + (digits[i] - '0');
        exponent = negative ? -exponent : exponent;
    }
    if (mantissa > 100)
        return (double)NAN;
    (void)snprintf(text, sizeof text, "%.*se%ld", (int)mantissa, digits, exponent + unit.exponent);
    return strtod(text, NULL) * unit.factor;
}

bool dimension_equal(struct dimension a, struct dimension b)
{
    return a.length == b.length && a.mass == b.mass && a.time == b.time && a.temperature == b.temperature &&
           a.amount == b.amount;
}

bool dimension_is_plain(struct dimension a)
{
    return dimension_equal(a, (struct dimension){0, 0, 0, 0, 0});
}

static const struct {
    struct dimension dim;
    const char *name, *unit;
} named[] = {
    {DIM(0, 0, 0, 0, 0), "a plain number", "-"},
    {DIM(1, 0, 0, 0, 0), "a length", "cm"},
    {DIM(2, 0, 0, 0, 0), "an area", "cm2"},
    {DIM(3, 0, 0, 0, 0), "a volume", "cm3"},
    {DIM(0, 1, 0, 0, 0), "a mass", "g"},
    {DIM(0, 0, 1, 0, 0), "a time", "us"},
    {DIM(0, 0, -1, 0, 0), "a rate", "1/us"},
    {DIM(0, 0, 0, 1, 0), "a temperature", "K"},
    {DIM(0, 0, 0, -1, 0), "a change per kelvin", "1/K"},
    {DIM(0, 0, 0, 0, 1), "an amount of substance", "mol"},
    {DIM(1, 0, -1, 0, 0), "a velocity", "cm/us"},
    {DIM(1, 0, -2, 0, 0), "an acceleration", "cm/us2"},
    {DIM(-3, 1, 0, 0, 0), "a density", "g/cm3"},
    {DIM(-1, 1, -2, 0, 0), "a stress", "Mbar"},
    {DIM(1, -1, 2, 0, 0), "a change per pressure", "1/Mbar"},
    {DIM(1, 1, -2, 0, 0), "a force", "g cm/us2"},
    {DIM(0, 1, -2, 0, 0), "a stiffness", "Mbar cm"},
    {DIM(2, 1, -2, 0, 0), "an energy", "g cm2/us2"},
    {DIM(2, 1, -3, 0, 0), "a power", "g cm2/us3"},
    {DIM(2, 0, -2, 0, 0), "an energy per mass", "cm2/us2"},
    {DIM(2, 0, -2, -1, 0), "a heat capacity", "cm2/us2/K"},
    {DIM(1, 1, -3, -1, 0), "a heat conductivity", "g cm/us3/K"},
    {DIM(2, 1, -2, 0, -1), "an energy per mole", "g cm2/us2/mol"},
};

static void compose_unit(struct dimension dim, char *out, size_t size)
{
    const char *names[] = {"g", "cm", "us", "K", "mol"};
    const int powers[] = {dim.mass, dim.length, dim.time, dim.temperature, dim.amount};
    size_t used = 0;
    out[0] = '\0';
    for (int i = 0; i < 5; i++) {
        if (powers[i] == 0)
            continue;
        int n = snprintf(out + used, size - used, powers[i] == 1 ? "%s%s" : "%s%s^%d", used > 0 ? " " : "",
                         names[i], powers[i]);
        used += (size_t)n;
    }
}

const char *dimension_unit(struct dimension dim, struct dimension_text *out)
{
    for (size_t i = 0; i < sizeof named / sizeof named[0]; i++)
        if (dimension_equal(dim, named[i].dim))
            return named[i].unit;
    compose_unit(dim, out->text, sizeof out->text);
    return out->text;
}

const char *dimension_name(struct dimension dim, struct dimension_text *out)
{
    char unit[60];
    if (dimension_is_plain(dim))
        return named[0].name;
    for (size_t i = 1; i < sizeof named / sizeof named[0]; i++) {
        if (dimension_equal(dim, named[i].dim)) {
            (void)snprintf(out->text, sizeof out->text, "%s (%s)", named[i].name, named[i].unit);
            return out->text;
        }
    }
    compose_unit(dim, unit, sizeof unit);
    (void)snprintf(out->text, sizeof out->text, "a quantity in %s", unit);
    return out->text;
}
