/* Charts.
 *
 * The legend is right of the frame, where it cannot hide data; a single series has none. A point that
 * falls on the same hundredth of a pixel as the point before is left out, so that the size of a curve is
 * bounded by the size of the picture. */
#include "dm2/plot/chart.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "axis.h"
#include "colour.h"
#include "svg.h"

static const char frame_colour[] = "#444", grid_colour[] = "#e4e4e4";
static const double font_size = 13, title_size = 17;

struct layout {
    double width, height;            /* of the picture */
    double left, right, top, bottom; /* of the frame */
    struct axis x, y;
};

static bool is_drawable(const struct chart *c, double x, double y)
{
    return isfinite(x) && isfinite(y) && (!c->log_x || x > 0) && (!c->log_y || y > 0);
}

/* The ranges of the points that can be drawn; false where there is none. */
static bool find_ranges(const struct chart *c, double x[2], double y[2])
{
    x[0] = y[0] = INFINITY;
    x[1] = y[1] = -INFINITY;
    for (size_t s = 0; s < c->n_series; s++) {
        const struct chart_series *one = &c->series[s];
        for (size_t i = 0; i < one->n; i++) {
            if (!is_drawable(c, one->x[i], one->y[i]))
                continue;
            x[0] = fmin(x[0], one->x[i]);
            x[1] = fmax(x[1], one->x[i]);
            y[0] = fmin(y[0], one->y[i]);
            y[1] = fmax(y[1], one->y[i]);
        }
    }
    return x[0] <= x[1];
}

static double widest_label(const struct axis *a)
{
    double widest = 0;
    for (size_t i = 0; i < a->n_ticks; i++)
        widest = fmax(widest, svg_text_width(a->label[i], font_size));
    return widest;
}

static bool has_legend(const struct chart *c)
{
    return c->n_series > 1;
}

static void lay_out_chart(const struct chart *c, const double x[2], const double y[2], struct layout *l)
{
    double legend = 0;
    for (size_t s = 0; has_legend(c) && s < c->n_series; s++)
        legend = fmax(legend, 44 + svg_text_width(c->series[s].name, font_size));
    l->width = c->width > 0 ? c->width : 760;
    l->height = c->height > 0 ? c->height : 460;
    axis_make(&l->x, x[0], x[1], c->log_x, false, 8);
    axis_make(&l->y, y[0], y[1], c->log_y, true, 7);
    l->left = 16 + widest_label(&l->y) + (c->y_label != NULL ? 22 : 0);
    l->right = l->width - 20 - legend;
    l->top = (c->title != NULL ? 42 : 18) + (l->y.exponent != 0 ? 16 : 0);
    if (has_legend(c))
        l->height = fmax(l->height, l->top + 21 * (double)c->n_series + 30);
    l->bottom = l->height - 34 - (c->x_label != NULL ? 20 : 0);
}

static double place_x(const struct layout *l, double x)
{
    return l->left + axis_place(&l->x, x) * (l->right - l->left);
}

static double place_y(const struct layout *l, double y)
{
    return l->bottom - axis_place(&l->y, y) * (l->bottom - l->top);
}

static void draw_x_axis(struct svg *svg, const struct chart *c, const struct layout *l)
{
    const struct svg_font middle = {.size = font_size, .anchor = SVG_MIDDLE};
    for (size_t i = 0; i < l->x.n_minor; i++) {
        double at = place_x(l, l->x.minor[i]);
        svg_line(svg, at, l->bottom, at, l->bottom - 3, frame_colour, 0.7);
    }
    for (size_t i = 0; i < l->x.n_ticks; i++) {
        double at = place_x(l, l->x.tick[i]);
        svg_line(svg, at, l->top, at, l->bottom, grid_colour, 1);
        svg_line(svg, at, l->bottom, at, l->bottom + 5, frame_colour, 1);
        svg_text(svg, at, l->bottom + 19, &middle, l->x.label[i]);
    }
    char label[256], factor[AXIS_LABEL_MAX];
    axis_factor(&l->x, factor);
    (void)snprintf(label, sizeof label, "%s%s%s", c->x_label == NULL ? "" : c->x_label,
                   factor[0] == '\0' ? "" : "  ", factor);
    if (label[0] != '\0')
        svg_text(svg, 0.5 * (l->left + l->right), l->bottom + 41, &middle, label);
}

static void draw_y_axis(struct svg *svg, const struct chart *c, const struct layout *l)
{
    const struct svg_font end = {.size = font_size, .anchor = SVG_END};
    const struct svg_font label = {.size = font_size, .anchor = SVG_MIDDLE, .rotated = 1};
    for (size_t i = 0; i < l->y.n_minor; i++) {
        double at = place_y(l, l->y.minor[i]);
        svg_line(svg, l->left, at, l->left + 3, at, frame_colour, 0.7);
    }
    for (size_t i = 0; i < l->y.n_ticks; i++) {
        double at = place_y(l, l->y.tick[i]);
        svg_line(svg, l->left, at, l->right, at, grid_colour, 1);
        svg_line(svg, l->left - 5, at, l->left, at, frame_colour, 1);
        svg_text(svg, l->left - 9, at + 0.35 * font_size, &end, l->y.label[i]);
    }
    if (l->y.exponent != 0) {
        char factor[AXIS_LABEL_MAX];
        const struct svg_font start = {.size = font_size};
        axis_factor(&l->y, factor);
        svg_text(svg, l->left, l->top - 8, &start, factor);
    }
    if (c->y_label != NULL)
        svg_text(svg, 20, 0.5 * (l->top + l->bottom), &label, c->y_label);
}

static void series_colour(const struct chart_series *s, char out[COLOUR_TEXT])
{
    if (s->shaded)
        colour_sequential(0.92 * s->shade, out); /* the lightest colours are hard to see on white */
    else
        colour_category(s->colour, out);
}

/* Appends the line style of a series as attributes and closes the element. */
static void put_stroke(struct svg *svg, const struct chart_series *s)
{
    char colour[COLOUR_TEXT];
    series_colour(s, colour);
    svg_puts(svg, "\" fill=\"none\" stroke=\"");
    svg_puts(svg, colour);
    svg_puts(svg, "\" stroke-width=\"1.8\" stroke-linejoin=\"round");
    svg_puts(svg, s->dashed ? "\" stroke-dasharray=\"6 4\"/>\n" : "\"/>\n");
}

static void draw_line(struct svg *svg, const struct chart *c, const struct layout *l,
                      const struct chart_series *s)
{
    bool pen_down = false;
    double last_x = NAN, last_y = NAN;
    svg_puts(svg, "<path d=\"");
    for (size_t i = 0; i < s->n; i++) {
        if (!is_drawable(c, s->x[i], s->y[i])) {
            pen_down = false;
            continue;
        }
        double x = round(100 * place_x(l, s->x[i])), y = round(100 * place_y(l, s->y[i]));
        if (pen_down && x == last_x && y == last_y)
            continue;
        svg_number(svg, pen_down ? "L" : "M", x / 100);
        svg_number(svg, " ", y / 100);
        last_x = x;
        last_y = y;
        pen_down = true;
    }
    put_stroke(svg, s);
}

/* Appends one marker. Its shape follows the colour's index, so that the series differ without colours too. */
static void put_marker(struct svg *svg, size_t shape, double x, double y)
{
    static const char *const outlines[] = {"m-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0z", "m-3.6-3.6h7.2v7.2h-7.2z",
                                           "m0-4.6l4.4 7.8h-8.8z", "m0-5l5 5l-5 5l-5-5z"};
    svg_number(svg, "M", x);
    svg_number(svg, " ", y);
    svg_puts(svg, outlines[shape % 4]);
}

static void close_markers(struct svg *svg, const struct chart_series *s)
{
    char colour[COLOUR_TEXT];
    series_colour(s, colour);
    svg_puts(svg, "\" stroke=\"#fff\" stroke-width=\".8\" fill=\"");
    svg_puts(svg, colour);
    svg_puts(svg, "\"/>\n");
}

static void draw_markers(struct svg *svg, const struct chart *c, const struct layout *l,
                         const struct chart_series *s)
{
    svg_puts(svg, "<path d=\"");
    for (size_t i = 0; i < s->n; i++)
        if (is_drawable(c, s->x[i], s->y[i]))
            put_marker(svg, s->colour, place_x(l, s->x[i]), place_y(l, s->y[i]));
    close_markers(svg, s);
}

static void draw_legend(struct svg *svg, const struct chart *c, const struct layout *l)
{
    const struct svg_font font = {.size = font_size};
    for (size_t i = 0; i < c->n_series; i++) {
        const struct chart_series *s = &c->series[i];
        double x = l->right + 14, y = l->top + 10 + 21 * (double)i;
        if (s->line) {
            svg_number(svg, "<path d=\"M", x);
            svg_number(svg, " ", y);
            svg_puts(svg, "h24");
            put_stroke(svg, s);
        }
        if (s->markers) {
            svg_puts(svg, "<path d=\"");
            put_marker(svg, s->colour, x + 12, y);
            close_markers(svg, s);
        }
        svg_text(svg, x + 31, y + 0.35 * font_size, &font, s->name);
    }
}

enum dm2_status chart_write(const char *path, const struct chart *chart, struct dm2_error *err)
{
    double x[2], y[2];
    struct layout l;
    struct svg svg;
    if (!find_ranges(chart, x, y))
        return dm2_fail(err, DM2_USAGE, "%s: there is no point to draw: every value is missing%s", path,
                        chart->log_x || chart->log_y ? ", or not positive on a logarithmic axis" : "");
    lay_out_chart(chart, x, y, &l);
    if (l.right - l.left < 40 || l.bottom - l.top < 40)
        return dm2_fail(err, DM2_USAGE,
                        "%s: a chart of %.0f x %.0f pixels has no room for its labels; make it larger", path,
                        l.width, l.height);
    enum dm2_status status = svg_create(&svg, path, l.width, l.height, chart->title, err);
    if (status != DM2_OK)
        return status;
    const struct svg_font title = {.size = title_size, .bold = 1};
    if (chart->title != NULL)
        svg_text(&svg, l.left, 27, &title, chart->title);
    draw_x_axis(&svg, chart, &l);
    draw_y_axis(&svg, chart, &l);
    svg_rectangle(&svg, l.left, l.top, l.right - l.left, l.bottom - l.top, NULL, frame_colour, 1);
    for (size_t s = 0; s < chart->n_series; s++) {
        if (chart->series[s].line)
            draw_line(&svg, chart, &l, &chart->series[s]);
        if (chart->series[s].markers)
            draw_markers(&svg, chart, &l, &chart->series[s]);
    }
    if (has_legend(chart))
        draw_legend(&svg, chart, &l);
    return svg_commit(&svg, err);
}
