/* The least-squares line: how m_N and b_N of the paper's eqs. (2)-(4), and k of (13), come from measurements.
 */
#ifndef DM2_PERFORMANCE_FIT_H
#define DM2_PERFORMANCE_FIT_H

#include <stddef.h>

#include "dm2/base/status.h"

/* y = slope x + intercept; units are those of y/x and of y. */
struct fit {
    size_t points;
    double slope, intercept;
    double slope_error, intercept_error; /* standard errors; 0 for two points */
    double
        residual; /* standard deviation of the points about the line, n - 2 degrees of freedom; 0 for two */
    double r2;    /* share of y's variance that the line explains, 0..1; 1 where y does not vary */
};

/* Fits n points. DM2_NUMERIC, with *out zeroed: fewer than two points, all x equal, a value that is not
 * finite, or values so large that their squares overflow. */
enum dm2_status fit_line(const double *x, const double *y, size_t n, struct fit *out, struct dm2_error *err);

/* The same through the origin, intercept 0, one degree of freedom less spent; x = 0 alone is DM2_NUMERIC. One
 * point is enough. r2 is then against y = 0, not against the mean. */
enum dm2_status fit_proportional(const double *x, const double *y, size_t n, struct fit *out,
                                 struct dm2_error *err);

/* Mean and standard deviation (n - 1) of n >= 1 values: the spread of repeated runs. The deviation of one is
 * 0. */
void fit_spread(const double *values, size_t n, double *mean, double *deviation);

#endif
