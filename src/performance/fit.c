/* Least squares.
 *
 * Sums are taken about the means, so that sizes of 1e6 bytes and times of 1e-3 s lose no digits. Residuals
 * are summed over the points, because a difference of large sums would lose digits. */
#include "dm2/performance/fit.h"

#include <math.h>

static enum dm2_status check_points(const double *x, const double *y, size_t n, size_t least, struct fit *out,
                                    struct dm2_error *err)
{
    *out = (struct fit){0};
    if (n < least)
        return dm2_fail(err, DM2_NUMERIC, "a line needs at least %zu points, there are %zu", least, n);
    for (size_t i = 0; i < n; i++)
        if (!isfinite(x[i]) || !isfinite(y[i]))
            return dm2_fail(err, DM2_NUMERIC, "point %zu of %zu, (%g, %g), is not finite", i + 1, n, x[i],
                            y[i]);
    return DM2_OK;
}

/* Sets the fields that depend on the residuals of a line with `spent` fitted numbers. `yy` is the sum of
 * squares for r2; `sxx` and `x_mean` are those of the slope. */
static enum dm2_status finish_fit(const double *x, const double *y, size_t n, size_t spent, double sxx,
                                  double x_mean, double yy, struct fit *out, struct dm2_error *err)
{
    double squares = 0;
    for (size_t i = 0; i < n; i++) {
        double off = y[i] - (out->slope * x[i] + out->intercept);
        squares += off * off;
    }
    out->points = n;
    out->residual = n > spent ? sqrt(squares / (double)(n - spent)) : 0;
    out->slope_error = out->residual / sqrt(sxx);
    out->intercept_error = spent == 2 ? out->residual * sqrt(1 / (double)n + x_mean * x_mean / sxx) : 0;
    out->r2 = yy > 0 ? fmax(0, 1 - squares / yy) : 1;
    if (isfinite(out->slope) && isfinite(out->intercept) && isfinite(out->residual) && isfinite(sxx) &&
        isfinite(yy))
        return DM2_OK;
    *out = (struct fit){0};
    return dm2_fail(err, DM2_NUMERIC,
                    "the points are too large or too close together for a line through them");
}

enum dm2_status fit_line(const double *x, const double *y, size_t n, struct fit *out, struct dm2_error *err)
{
    enum dm2_status status = check_points(x, y, n, 2, out, err);
    if (status != DM2_OK)
        return status;
    double x_mean, y_mean, spread, sxx = 0, sxy = 0, syy = 0;
    fit_spread(x, n, &x_mean, &spread);
    fit_spread(y, n, &y_mean, &spread);
    for (size_t i = 0; i < n; i++) {
        double dx = x[i] - x_mean, dy = y[i] - y_mean;
        sxx += dx * dx;
        sxy += dx * dy;
        syy += dy * dy;
    }
    if (!(sxx > 0))
        return dm2_fail(err, DM2_NUMERIC, "all %zu points of the line have the same x, %g", n, x[0]);
    out->slope = sxy / sxx;
    out->intercept = y_mean - out->slope * x_mean;
    return finish_fit(x, y, n, 2, sxx, x_mean, syy, out, err);
}

enum dm2_status fit_proportional(const double *x, const double *y, size_t n, struct fit *out,
                                 struct dm2_error *err)
{
    enum dm2_status status = check_points(x, y, n, 1, out, err);
    if (status != DM2_OK)
        return status;
    double sxx = 0, sxy = 0, syy = 0;
    for (size_t i = 0; i < n; i++) {
        sxx += x[i] * x[i];
        sxy += x[i] * y[i];
        syy += y[i] * y[i];
    }
    if (!(sxx > 0))
        return dm2_fail(err, DM2_NUMERIC, "all %zu points of the line have x = 0", n);
    out->slope = sxy / sxx;
    return finish_fit(x, y, n, 1, sxx, 0, syy, out, err);
}

void fit_spread(const double *values, size_t n, double *mean, double *deviation)
{
    double sum = 0, squares = 0;
    for (size_t i = 0; i < n; i++)
        sum += values[i];
    *mean = sum / (double)n;
    for (size_t i = 0; i < n; i++)
        squares += (values[i] - *mean) * (values[i] - *mean);
    *deviation = n > 1 ? sqrt(squares / (double)(n - 1)) : 0;
}
