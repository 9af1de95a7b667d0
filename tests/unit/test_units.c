/* Units: exact values in base units, dimensions, prefixes, words that are no units. */
#include "deck/units.h"
#include "check.h"

static double value(const char *digits, const char *symbol)
{
    struct unit unit;
    int found = unit_find(symbol, strlen(symbol), &unit);
    CHECK_REPORT(found, "%s is no unit", symbol);
    return found ? unit_value(digits, strlen(digits), unit) : 0;
}

TEST(si_units_in_base_units)
{
    CHECK_SAME_BITS(value("1", "cm"), 1);
    CHECK_SAME_BITS(value("3", "mm"), 0.3);
    CHECK_SAME_BITS(value("25", "ns"), 0.025);
    CHECK_SAME_BITS(value("76", "GPa"), 0.76);
    CHECK_SAME_BITS(value("2", "kbar"), 0.002);
    CHECK_SAME_BITS(value("1", "Mbar"), 1);
    CHECK_SAME_BITS(value("1", "J"), 1e-5);
    CHECK_SAME_BITS(value("1", "N"), 1e-7);
    CHECK_SAME_BITS(value("1", "erg"), 1e-12);
    CHECK_SAME_BITS(value("1", "W"), 1e-11);
    CHECK_SAME_BITS(value("2.5", "kg"), 2500);
    CHECK_SAME_BITS(value("1", "angstrom"), 1e-8);
    CHECK_SAME_BITS(value("1", "kHz"), 1e-3);
    CHECK_SAME_BITS(value("7", "cm3"), 7);
    CHECK_SAME_BITS(value("1", "m2"), 1e4);
    CHECK_NEAR_REL(value("1", "eV"), 1.602176634e-24, 1e-15);
    CHECK_NEAR_REL(value("180", "deg"), 3.14159265358979323846, 1e-15);
    CHECK_NEAR_REL(value("1", "atm"), 1.01325e-6, 1e-15);
}

/* The power of ten of the unit goes into the decimal exponent of the number, so that there is no second
 * rounding. */
TEST(a_number_with_a_unit_is_rounded_once)
{
    CHECK_SAME_BITS(value("4.602", "mm"), 0.4602);
    CHECK_SAME_BITS(value("0.1e1", "mm"), 0.1);
    CHECK_SAME_BITS(value("1.1E-2", "km"), 1100);
    CHECK_SAME_BITS(value(".7", "mm"), 0.07);
    CHECK_SAME_BITS(value("123456.7", "ns"), 123.4567);
    CHECK(isinf(value("1e99999999999999999999", "cm")));
    CHECK_SAME_BITS(value("1e-99999999999999999999", "cm"), 0.0);
}

TEST(what_is_no_unit)
{
    static const char *const words[] = {"",     "x",  "kmm", "mmm",  "ccm",  "cm0", "cm1",
                                        "cm10", "Cm", "pa",  "kdeg", "Mm2x", "2"};
    struct unit unit;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        CHECK_REPORT(!unit_find(words[i], strlen(words[i]), &unit), "'%s' is a unit", words[i]);
}

TEST(products_and_powers)
{
    struct unit kg = {.factor = 1}, m3 = kg, density = kg, s = kg, v;
    CHECK(unit_find("kg", 2, &kg));
    CHECK(unit_find("m3", 2, &m3));
    CHECK(unit_times(kg, m3, -1, &density));
    CHECK_SAME_BITS(unit_value("8874", 4, density), 8.874);
    CHECK_EQ_INT(density.dim.length, -3);
    CHECK_EQ_INT(density.dim.mass, 1);
    CHECK(unit_find("s", 1, &s));
    CHECK(unit_times((struct unit){{1, 0, 0, 0, 0}, 1, 2}, s, -2, &v));
    CHECK_EQ_INT(v.dim.time, -2);
    CHECK_SAME_BITS(unit_value("1", 1, v), 1e-10);
    CHECK(!unit_times(m3, m3, 15, &v));
}

TEST(dimensions_have_names)
{
    struct dimension_text text;
    CHECK_STR(dimension_name((struct dimension){1, 0, -1, 0, 0}, &text), "a velocity (cm/us)");
    CHECK_STR(dimension_name((struct dimension){0, 0, 0, 0, 0}, &text), "a plain number");
    CHECK_STR(dimension_name((struct dimension){2, 0, 1, -1, 0}, &text), "a quantity in cm^2 us K^-1");
    CHECK_STR(dimension_unit((struct dimension){-1, 1, -2, 0, 0}, &text), "Mbar");
    /* The longest composed unit fits. */
    CHECK_CONTAINS(dimension_name((struct dimension){-30, -30, -30, -30, -30}, &text), "mol^-30");
    struct dimension sum;
    CHECK(!dimension_times((struct dimension){30, 0, 0, 0, 0}, (struct dimension){1, 0, 0, 0, 0}, 1, &sum));
    CHECK(dimension_times((struct dimension){1, 0, 0, 0, 0}, (struct dimension){0, 0, 0, 0, 0}, 5000, &sum));
}

TEST_MAIN(CASE(si_units_in_base_units), CASE(a_number_with_a_unit_is_rounded_once), CASE(what_is_no_unit),
          CASE(products_and_powers), CASE(dimensions_have_names))
