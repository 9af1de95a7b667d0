/* Least squares against known lines and against sums worked out by hand. */
#include "check.h"

#include "dm2/performance/fit.h"

enum { POINTS = 9 };

TEST(a_line_is_found_again)
{
    double x[POINTS], y[POINTS];
    struct fit f;
    for (int i = 0; i < POINTS; i++) {
        x[i] = 1000.0 * (1 << i);
        y[i] = 14.6e-6 * x[i] + 25.8e-3; /* eq. (4) */
    }
    CHECK_EQ_INT(fit_line(x, y, POINTS, &f, NULL), DM2_OK);
    CHECK_EQ_INT(f.points, POINTS);
    CHECK_NEAR_REL(f.slope, 14.6e-6, 1e-13);
    CHECK_NEAR_REL(f.intercept, 25.8e-3, 1e-11);
    CHECK_NEAR(f.residual, 0, 1e-14);
    CHECK_NEAR(f.r2, 1, 1e-14);
    for (int i = 0; i < POINTS; i++)
        y[i] = 3 * x[i];
    CHECK_EQ_INT(fit_proportional(x, y, POINTS, &f, NULL), DM2_OK);
    CHECK_NEAR_REL(f.slope, 3, 1e-14);
    CHECK_EQ_INT(f.intercept, 0);
}

/* (1,1) (2,3) (3,2) (4,4): slope 4/5, intercept 1/2, squared residuals 1.8, r2 0.64. */
TEST(scattered_points)
{
    const double x[] = {1, 2, 3, 4}, y[] = {1, 3, 2, 4};
    struct fit f;
    CHECK_EQ_INT(fit_line(x, y, 4, &f, NULL), DM2_OK);
    CHECK_NEAR(f.slope, 0.8, 1e-15);
    CHECK_NEAR(f.intercept, 0.5, 1e-15);
    CHECK_NEAR(f.residual, sqrt(0.9), 1e-15);
    CHECK_NEAR(f.r2, 0.64, 1e-15);
    CHECK_NEAR(f.slope_error, sqrt(0.9 / 5), 1e-15);
    CHECK_NEAR(f.intercept_error, sqrt(0.9 * (0.25 + 6.25 / 5)), 1e-15);
    CHECK_EQ_INT(fit_proportional(x, y, 4, &f, NULL), DM2_OK);
    CHECK_NEAR(f.slope, 29.0 / 30, 1e-15);
    CHECK_NEAR(f.residual, sqrt((30 - 29.0 * 29 / 30) / 3), 1e-14);
    double mean, deviation;
    fit_spread(y, 4, &mean, &deviation);
    CHECK_NEAR(mean, 2.5, 0);
    CHECK_NEAR(deviation, sqrt(5.0 / 3), 1e-15);
    fit_spread(y, 1, &mean, &deviation);
    CHECK_NEAR(mean, 1, 0);
    CHECK_NEAR(deviation, 0, 0);
}

/* Digits survive an offset a million times the spread. */
TEST(far_from_the_origin)
{
    const double x[] = {1e9 + 1, 1e9 + 2, 1e9 + 3, 1e9 + 4}, y[] = {1, 3, 2, 4};
    struct fit f;
    CHECK_EQ_INT(fit_line(x, y, 4, &f, NULL), DM2_OK);
    CHECK_NEAR(f.slope, 0.8, 1e-12);
    CHECK_NEAR(f.residual, sqrt(0.9), 1e-6);
}

TEST(two_points_and_constants)
{
    const double x[] = {2, 4}, y[] = {1, 2}, flat[] = {5, 5};
    struct fit f;
    CHECK_EQ_INT(fit_line(x, y, 2, &f, NULL), DM2_OK);
    CHECK_NEAR(f.slope, 0.5, 0);
    CHECK_NEAR(f.residual, 0, 0);
    CHECK_EQ_INT(fit_line(x, flat, 2, &f, NULL), DM2_OK);
    CHECK_NEAR(f.slope, 0, 0);
    CHECK_NEAR(f.r2, 1, 0);
}

TEST(points_without_a_line)
{
    const double x[] = {1, 2, 3}, same[] = {7, 7, 7}, zero[] = {0, 0, 0}, holes[] = {1, NAN, 3};
    const double huge[] = {-1e300, 0, 1e300};
    struct fit f;
    struct dm2_error err = {0};
    CHECK_EQ_INT(fit_line(x, x, 1, &f, &err), DM2_NUMERIC);
    CHECK_CONTAINS(err.text, "at least 2 points");
    CHECK_EQ_INT(fit_line(same, x, 3, &f, &err), DM2_NUMERIC);
    CHECK_CONTAINS(err.text, "the same x, 7");
    CHECK_EQ_INT(fit_line(x, holes, 3, &f, &err), DM2_NUMERIC);
    CHECK_CONTAINS(err.text, "point 2 of 3");
    CHECK_EQ_INT(fit_line(huge, x, 3, &f, &err), DM2_NUMERIC);
    CHECK_EQ_INT(fit_proportional(x, x, 0, &f, &err), DM2_NUMERIC);
    CHECK_EQ_INT(fit_proportional(zero, x, 3, &f, &err), DM2_NUMERIC);
    CHECK_EQ_INT(f.points, 0);
}

TEST_MAIN(CASE(a_line_is_found_again), CASE(scattered_points), CASE(far_from_the_origin),
          CASE(two_points_and_constants), CASE(points_without_a_line))
