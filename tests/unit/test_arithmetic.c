/* The arithmetic on which equal bits depend: IEEE 754 doubles, evaluated as doubles, products rounded
 * before they are added, denormal numbers kept. */
#include <fenv.h>
#include <float.h>
#include <stdint.h>

#include "check.h"

/* Read at run time, so that the compiler cannot compute the results. */
static volatile double one = 1.0, tiny = 0x1p-30, least = DBL_MIN, big = 0x1p53;

TEST(format_is_binary64)
{
    CHECK_EQ_INT(FLT_RADIX, 2);
    CHECK_EQ_INT(DBL_MANT_DIG, 53);
    CHECK_EQ_INT(DBL_MAX_EXP, 1024);
    CHECK_EQ_INT(DBL_MIN_EXP, -1021);
    double number = -one;
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    CHECK(bits == UINT64_C(0xBFF0000000000000));
}

TEST(doubles_are_evaluated_as_doubles)
{
    CHECK_EQ_INT(FLT_EVAL_METHOD, 0);
    /* With more digits in intermediate results, 2^53 + 1 would survive until 2^53 is subtracted. */
    double sum = big + one - big;
    CHECK_SAME_BITS(sum, 0.0);
}

TEST(rounding_is_to_nearest)
{
    CHECK_EQ_INT(fegetround(), FE_TONEAREST);
}

/* (1 + e)(1 - e) is 1 - e^2, which rounds to 1: a fused multiply-add keeps the e^2. */
TEST(products_are_rounded_before_they_are_added)
{
    double a = one + tiny, b = one - tiny, c = -one;
    double residual = a * b + c;
    CHECK_SAME_BITS(residual, 0.0);
    double mirrored = c + a * b;
    CHECK_SAME_BITS(mirrored, 0.0);
    double difference = one - a * b;
    CHECK_SAME_BITS(difference, 0.0);
    CHECK_SAME_BITS(fma(a, b, c), -0x1p-60); /* the numbers distinguish a fused product from a rounded one */
}

/* In a loop that vectorises: each lane has the same result, with any instructions of the compiler. */
TEST(products_in_loops_too)
{
    double a[64], b[64], c[64];
    for (int i = 0; i < 64; i++) {
        a[i] = one + tiny * (1 << (i % 4));
        b[i] = 2.0 - a[i];
        c[i] = -one;
    }
    for (int i = 0; i < 64; i++)
        c[i] += a[i] * b[i];
    for (int i = 0; i < 64; i++)
        CHECK_SAME_BITS(c[i], 0.0);
}

/* 1 + (e - e) must not be regrouped, nor x / 3 turned into x * (1/3). */
TEST(nothing_is_regrouped)
{
    double e = 0x1p-53 * one;
    CHECK_SAME_BITS((one + e) + e, 1.0);
    CHECK_SAME_BITS(one + (e + e), 1.0 + DBL_EPSILON);
    CHECK_SAME_BITS((5.0 * one) / (3.0 * one), 0x1.aaaaaaaaaaaabp+0);
    CHECK_SAME_BITS((5.0 * one) * (1.0 / (3.0 * one)), 0x1.aaaaaaaaaaaaap+0);
}

TEST(subnormals_are_kept)
{
    double half = least / 2;
    CHECK(half > 0);
    CHECK_SAME_BITS(half * 2, DBL_MIN);
    CHECK_SAME_BITS(half - half, 0.0);
}

TEST(square_root_is_rounded_correctly)
{
    CHECK_SAME_BITS(sqrt(2 * one), 0x1.6a09e667f3bcdp+0);
    CHECK_SAME_BITS(sqrt(3 * one), 0x1.bb67ae8584caap+0);
    CHECK_SAME_BITS(sqrt(one - 0x1p-53), one - 0x1p-53);
}

TEST_MAIN(CASE(format_is_binary64), CASE(doubles_are_evaluated_as_doubles), CASE(rounding_is_to_nearest),
          CASE(products_are_rounded_before_they_are_added), CASE(products_in_loops_too),
          CASE(nothing_is_regrouped), CASE(subnormals_are_kept), CASE(square_root_is_rounded_correctly))
