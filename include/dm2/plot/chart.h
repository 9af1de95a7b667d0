/* Charts of curves: measured curves as lines or markers, models dashed. */
#ifndef DM2_PLOT_CHART_H
#define DM2_PLOT_CHART_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/status.h"

struct chart_series {
    const char *name; /* in the legend */
    const double *x, *y;
    size_t n;
    size_t colour; /* index of colour_category */
    double shade;  /* of colour_sequential, 0 to 1; replaces `colour` where `shaded` */
    bool shaded;
    bool line, dashed, markers;
};

struct chart {
    const char *title, *x_label, *y_label; /* may be NULL */
    bool log_x, log_y;
    double width, height; /* px; 0: 760 x 460 */
    const struct chart_series *series;
    size_t n_series;
};

/* Draws the chart into the SVG file `path`. A point that is not finite, or not positive on a logarithmic
 * axis, is left out and interrupts its line. DM2_USAGE where no point is left; DM2_IO, DM2_MEMORY. */
enum dm2_status chart_write(const char *path, const struct chart *chart, struct dm2_error *err);

#endif
