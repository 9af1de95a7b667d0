/* The least-squares line, by which m_N and b_N of the paper's eqs. (2)-(4) and k of eq. (13) are found from
 * measurements. */
#ifndef DM2_PERFORMANCE_FIT_H
#define DM2_PERFORMANCE_FIT_H

#include <stddef.h>

#include "dm2/base/status.h"

/* y = slope x + intercept. The slope has the unit of y/x, the intercept that of y. */
struct fit {
    size_t points;
    double slope, intercept;
    double slope_error, intercept_error; /* standard errors; 0 for two points */
    double residual; /* standard deviation of the points from the line, n - 2 degrees of freedom; 0 for two */
    double r2; /* the share of the variance of y that the line explains, 0..1; 1 where y does not vary */
};

/* Fits a line to n points. DM2_NUMERIC, with *out zeroed: fewer than two points, all x equal, a value that is
 * not finite, or values whose squares overflow. */
enum dm2_status fit_line(const double *x, const double *y, size_t n, struct fit *out, struct dm2_error *err);

/* Fits a line through the origin: intercept 0, n - 1 degrees of freedom, r2 against y = 0 instead of the
 * mean. One point is enough. DM2_NUMERIC as for fit_line, with all x = 0 in place of all x equal. */
enum dm2_status fit_proportional(const double *x, const double *y, size_t n, struct fit *out,
                                 struct dm2_error *err);

/* Mean and standard deviation (n - 1) of n >= 1 values, for the spread of repeated runs. The deviation of one
 * value is 0. */
void fit_spread(const double *values, size_t n, double *mean, double *deviation);

#endif
