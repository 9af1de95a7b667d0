/* Round ticks.
 *
 * Linear: the step is the smallest of 1, 2, 5 times a power of ten that gives at most the requested number
 * of ticks. Ticks are whole multiples of the step, computed as index * step so that 0 is exactly 0. Labels
 * have the decimals of the step; very large and very small labels share a power of ten. Logarithmic: one
 * tick per decade (or per several), minor ticks at 2 to 9; over less than a decade and a half 2 and 5 have
 * labels too. */
#include "axis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double axis_round_below(double x)
{
    double power = pow(10, floor(log10(x) + 1e-12));
    double leading = x / power * (1 + 1e-12);
    return power * (leading >= 5 ? 5 : leading >= 2 ? 2 : 1);
}

static void widen_range(double *low, double *high, bool log)
{
    if (*low > *high) {
        double swap = *low;
        *low = *high;
        *high = swap;
    }
    if (log && *high <= *low * (1 + 1e-9)) {
        *low /= 2;
        *high *= 2;
    } else if (!log && *high - *low <= 1e-12 * fmax(fabs(*low), fabs(*high))) {
        double half = *low == 0 ? 1 : 0.5 * fabs(*low);
        *low -= half;
        *high += half;
    }
}

static void label_linear(struct axis *a, double step)
{
    double largest = fmax(fabs(a->low), fabs(a->high));
    int magnitude = (int)floor(log10(largest) + 1e-9), of_step = (int)floor(log10(step) + 1e-9);
    a->exponent = magnitude >= 5 || magnitude <= -4 ? magnitude : 0;
    int decimals = a->exponent - of_step;
    for (size_t i = 0; i < a->n_ticks; i++) /* with the minus sign U+2212 */
        (void)snprintf(a->label[i], AXIS_LABEL_MAX, "%s%.*f", a->tick[i] < 0 ? "\u2212" : "",
                       decimals > 0 ? decimals : 0, fabs(a->tick[i]) / pow(10, a->exponent));
}

static void make_linear_axis(struct axis *a, bool extend, int about)
{
    double span = a->high - a->low, step = axis_round_below(span / about);
    while (span / step > about + 1e-9) { /* to the next of 1, 2, 5 times a power of ten */
        double leading = step / pow(10, floor(log10(step) + 1e-9));
        step *= leading > 1.5 && leading < 3 ? 2.5 : 2;
    }
    double first = extend ? floor(a->low / step + 1e-9) : ceil(a->low / step - 1e-9);
    double last = extend ? ceil(a->high / step - 1e-9) : floor(a->high / step + 1e-9);
    for (double k = first; k <= last && a->n_ticks < AXIS_TICKS_MAX; k++)
        a->tick[a->n_ticks++] = k == 0 ? 0 : k * step;
    if (extend) {
        a->low = first * step;
        a->high = last * step;
    }
    label_linear(a, step);
}

static void add_log_tick(struct axis *a, int leading, int decade)
{
    if (a->n_ticks == AXIS_TICKS_MAX)
        return;
    char *label = a->label[a->n_ticks];
    a->tick[a->n_ticks++] = leading * pow(10, decade);
    const char *minus = decade < 0 ? "\u2212" : "";
    if (decade >= -3 && decade <= 4)
        (void)snprintf(label, AXIS_LABEL_MAX, "%.*f", decade < 0 ? -decade : 0, leading * pow(10, decade));
    else if (leading == 1)
        (void)snprintf(label, AXIS_LABEL_MAX, "10^{%s%d}", minus, abs(decade));
    else
        (void)snprintf(label, AXIS_LABEL_MAX, "%d\u00b710^{%s%d}", leading, minus, abs(decade));
}

static void make_log_axis(struct axis *a, bool extend, int about)
{
    double from = log10(a->low), to = log10(a->high);
    bool few = to - from < 1.5;
    if (extend && !few) {
        a->low = pow(10, floor(from + 1e-9));
        a->high = pow(10, ceil(to - 1e-9));
    } else if (extend) { /* to the next whole multiple of the decade */
        double below = pow(10, floor(from + 1e-9)), above = pow(10, floor(to + 1e-9));
        a->low = below * floor(a->low / below + 1e-9);
        a->high = above * ceil(a->high / above - 1e-9);
    }
    int first = (int)floor(log10(a->low) + 1e-9), last = (int)ceil(log10(a->high) - 1e-9);
    int stride = (last - first) / about + 1;
    for (int decade = first; decade <= last; decade++) {
        for (int leading = 1; leading <= 9; leading++) {
            double value = leading * pow(10, decade);
            if (value < a->low * (1 - 1e-9) || value > a->high * (1 + 1e-9))
                continue;
            if ((leading == 1 && (decade - first) % stride == 0) || (few && (leading == 2 || leading == 5)))
                add_log_tick(a, leading, decade);
            else if ((stride == 1 || leading == 1) && a->n_minor < AXIS_MINOR_MAX)
                a->minor[a->n_minor++] = value;
        }
    }
}

void axis_make(struct axis *axis, double low, double high, bool log, bool extend, int about)
{
    memset(axis, 0, sizeof *axis);
    widen_range(&low, &high, log);
    axis->log = log;
    axis->low = low;
    axis->high = high;
    if (log)
        make_log_axis(axis, extend, about);
    else
        make_linear_axis(axis, extend, about);
}

void axis_factor(const struct axis *axis, char out[AXIS_LABEL_MAX])
{
    out[0] = '\0';
    if (axis->exponent != 0)
        (void)snprintf(out, AXIS_LABEL_MAX, "\u00d710^{%s%d}", axis->exponent < 0 ? "\u2212" : "",
                       abs(axis->exponent));
}

double axis_place(const struct axis *axis, double value)
{
    if (axis->log)
        return log(value / axis->low) / log(axis->high / axis->low);
    return (value - axis->low) / (axis->high - axis->low);
}
