/* An axis: a range with round ticks and their labels, linear or logarithmic. */
#ifndef DM2_PLOT_AXIS_H
#define DM2_PLOT_AXIS_H

#include <stdbool.h>
#include <stddef.h>

enum { AXIS_TICKS_MAX = 24, AXIS_MINOR_MAX = 200, AXIS_LABEL_MAX = 24 };

struct axis {
    bool log;
    double low, high;
    size_t n_ticks, n_minor;
    double tick[AXIS_TICKS_MAX], minor[AXIS_MINOR_MAX];
    char label[AXIS_TICKS_MAX][AXIS_LABEL_MAX]; /* may contain ^{...}, see svg_text */
    int exponent; /* value = label * 10^exponent; 0: the labels are the values */
};

/* Sets *axis to the range [low, high] with about `about` ticks (2 to 10) at round values. With `extend`
 * the range grows to the next tick on both sides, else the ticks lie inside. The bounds of a reversed
 * range are swapped, and an empty range is widened. A logarithmic axis needs low > 0. Values must be
 * finite. */
void axis_make(struct axis *axis, double low, double high, bool log, bool extend, int about);

/* The factor that the labels leave out, "x 10^{-3}" with the minus sign U+2212; empty where exponent is 0. */
void axis_factor(const struct axis *axis, char out[AXIS_LABEL_MAX]);

/* The position of a value on the axis: 0 at low, 1 at high. */
double axis_place(const struct axis *axis, double value);

/* The largest of 1, 2, 5 times a power of ten that is at most x (> 0). */
double axis_round_below(double x);

#endif
