/* The project's own elementary functions against libm's. */
#include "dm2/base/real.h"
#include "check.h"

TEST(exp_matches_libm)
{
    for (double x = -40.0; x <= 40.0; x += 0.00917)
        CHECK_NEAR_REL(real_exp(x), exp(x), 5e-16);
    CHECK_SAME_BITS(real_exp(0.0), 1.0);
    CHECK_SAME_BITS(real_exp(-1e4), 0.0);
    CHECK_SAME_BITS(real_exp(1e4), 0x1p1023);
    CHECK(isnan(real_exp(NAN)));
    CHECK_NEAR_REL(real_exp(699.0), exp(699.0), 1e-15);
    CHECK_NEAR_REL(real_exp(-699.0), exp(-699.0), 1e-15);
}

TEST(log_matches_libm)
{
    for (double x = 1e-9; x < 1e9; x *= 1.0131)
        CHECK_NEAR(real_log(x), log(x), 4e-16 * (1.0 + fabs(log(x))));
    CHECK_SAME_BITS(real_log(1.0), 0.0);
    CHECK(isinf(real_log(0.0)) && real_log(0.0) < 0);
    CHECK(isnan(real_log(-1.0)));
}

TEST(circular_functions_match_libm)
{
    for (double x = -20.0; x < 20.0; x += 0.00731) {
        CHECK_NEAR(real_sin(x), sin(x), 3e-16);
        CHECK_NEAR(real_cos(x), cos(x), 3e-16);
    }
    CHECK_SAME_BITS(real_sin(0.0), 0.0);
    CHECK_SAME_BITS(real_cos(0.0), 1.0);
}

TEST(pow_matches_libm)
{
    for (double x = 0.01; x < 1.0; x += 0.013)
        for (double n = 0.3; n < 4.0; n += 0.17)
            CHECK_NEAR_REL(real_pow(x, n), pow(x, n), 5e-15);
    CHECK_SAME_BITS(real_pow(0.37, 1.0), 0.37);
    CHECK_SAME_BITS(real_pow(0.0, 0.5), 0.0);
}

TEST_MAIN(CASE(exp_matches_libm), CASE(log_matches_libm), CASE(circular_functions_match_libm),
          CASE(pow_matches_libm))
