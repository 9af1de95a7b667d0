/* Numbers as text: fewest digits, exact return, a strict reader. */
#include "check.h"

#include <float.h>
#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/number.h"

static void check_text(double x, const char *want)
{
    char text[NUMBER_TEXT_MAX];
    size_t length = number_format(x, text);
    CHECK_STR(text, want);
    CHECK_EQ_INT(length, strlen(text));
}

TEST(fewest_digits)
{
    check_text(0.1, "0.1");
    check_text(0.1 + 0.2, "0.30000000000000004");
    check_text(1.0 / 3.0, "0.3333333333333333");
    check_text(5e-324, "4.94065645841247e-324");
    check_text(DBL_MAX, "1.7976931348623157e+308");
    check_text(1e22, "1e+22");
    check_text(-2.5e-7, "-2.5e-07");
}

TEST(whole_numbers)
{
    check_text(0.0, "0");
    check_text(-0.0, "0");
    check_text(200, "200");
    check_text(-1689, "-1689");
    check_text(999999999999999, "999999999999999");
    check_text(1e15, "1e+15");
}

TEST(not_numbers)
{
    check_text(NAN, "nan");
    check_text(-NAN, "nan");
    check_text(INFINITY, "inf");
    check_text(-INFINITY, "-inf");
}

/* Random bit patterns of every magnitude come back as the same bits. */
TEST(round_trip)
{
    uint64_t state = 1;
    for (int i = 0; i < 20000; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        uint64_t bits = state ^ state >> 29;
        double x, back = 0;
        char text[NUMBER_TEXT_MAX];
        memcpy(&x, &bits, sizeof x);
        if (!isfinite(x))
            continue;
        size_t length = number_format(x, text);
        CHECK(number_parse(text, length, &back));
        CHECK_SAME_BITS(back, x);
    }
}

TEST(reader_takes_the_whole_field)
{
    static const struct {
        const char *text;
        double value;
    } good[] = {{"1", 1},       {"-1.5e3", -1500}, {"+.5", 0.5}, {"7.", 7},
                {"1E-2", 0.01}, {"-0", -0.0},      {"1e-400", 0}};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        double x = 99;
        CHECK_REPORT(number_parse(good[i].text, strlen(good[i].text), &x), "'%s' was refused", good[i].text);
        CHECK_SAME_BITS(x, good[i].value);
    }
    static const char *const bad[] = {"",    " 1",       "1 ",    "1x",   "0x10", "1e",   ".",
                                      "+",   "-",        "e5",    "1,5",  "--1",  "1e+-", "NaN",
                                      "Inf", "infinity", "1e400", "-nan", "1_0"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        double x = 99;
        CHECK_REPORT(!number_parse(bad[i], strlen(bad[i]), &x), "'%s' was taken", bad[i]);
        CHECK_SAME_BITS(x, 99);
    }
    double x = 0;
    CHECK(number_parse("12345", 3, &x)); /* only the 3 characters of the field */
    CHECK_SAME_BITS(x, 123);
}

TEST(reader_of_whole_numbers)
{
    int64_t x = 0;
    CHECK(number_parse_integer("-42", 3, &x));
    CHECK_EQ_INT(x, -42);
    CHECK(number_parse_integer("9223372036854775807", 19, &x));
    CHECK_EQ_INT(x, INT64_MAX);
    static const char *const bad[] = {"", "-", "1.0", "1e3", " 1", "9223372036854775808", "0x1"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK_REPORT(!number_parse_integer(bad[i], strlen(bad[i]), &x), "'%s' was taken", bad[i]);
}

TEST_MAIN(CASE(fewest_digits), CASE(whole_numbers), CASE(not_numbers), CASE(round_trip),
          CASE(reader_takes_the_whole_field), CASE(reader_of_whole_numbers))
