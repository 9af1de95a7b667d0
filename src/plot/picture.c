/* Pictures of states.
 *
 * A disc is a zero-length line with round ends. Discs of one colour and radius share a path, in which each
 * position is relative to the previous one in tenths of a pixel, so that a disc takes about ten bytes.
 * Therefore the elements are sorted by (colour, radius, index), with the colours of a measured quantity
 * cut into 96 steps. Positions are rounded before their differences are taken, so that no error adds up
 * along a path. */
#include "dm2/plot/picture.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "axis.h"
#include "colour.h"
#include "quantity.h"
#include "svg.h"

enum { STEPS = 96 };

static const double margin = 16, font_size = 13, title_size = 17;
static const char grey[] = "#555";

struct disc {
    uint32_t colour, radius; /* radius in tenths of a pixel */
    uint32_t index;
    int32_t x, y; /* tenths of a pixel from the frame's upper left corner */
};

struct picture {
    const struct vtp *vtp;
    const struct picture_options *options;
    struct shown_quantity quantity;
    const double *radius;               /* cm, per point */
    double view[4];                     /* the shown part of the plane: x0 y0 x1 y1, cm */
    double left, top, frame_w, frame_h; /* the frame, px */
    double width, height, scale;        /* of the picture, px; px per cm */
    double side;                        /* width of the column with the legend */
    struct disc *discs;
    size_t n_discs;
};

const char *picture_colours(void)
{
    return quantity_words();
}

/* --- radius, view --- */

static enum dm2_status find_radius(struct picture *p, struct dm2_error *err)
{
    const struct vtp_array *radius = vtp_find(p->vtp, "PointData", "radius");
    char names[400];
    quantity_list_arrays(p->vtp, names, sizeof names);
    if (radius == NULL || radius->components != 1)
        return dm2_fail(err, DM2_USAGE, "the snapshot has no array 'radius' of its points; it has: %s",
                        names);
    p->radius = radius->values;
    return DM2_OK;
}

static void choose_view(struct picture *p)
{
    const struct vtp *vtp = p->vtp;
    const struct vtp_array *domain = vtp_find(vtp, "FieldData", "domain");
    double box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < vtp->n_points; i++) {
        const double *r = vtp->position + 3 * i;
        for (int a = 0; a < 2; a++) {
            box[a] = fmin(box[a], r[a] - p->radius[i]);
            box[2 + a] = fmax(box[2 + a], r[a] + p->radius[i]);
        }
    }
    if (domain != NULL && domain->n_tuples == 4) {
        const double *d = domain->values;
        double beyond = 0.5 * fmax(d[2], d[3]);
        for (int a = 0; a < 2; a++) {
            box[a] = fmax(fmin(box[a], d[a]), d[a] - beyond);
            box[2 + a] = fmin(fmax(box[2 + a], d[a] + d[2 + a]), d[a] + d[2 + a] + beyond);
        }
    }
    for (int a = 0; a < 2; a++) {
        if (!(box[a] < box[2 + a])) {
            box[a] = -1;
            box[2 + a] = 1;
        }
        p->view[a] = box[a];
        p->view[2 + a] = box[2 + a];
    }
}

/* --- discs --- */

static uint32_t step_of(const struct picture *p, double value)
{
    double t = (value - p->quantity.low) / (p->quantity.high - p->quantity.low);
    return t > 0 ? t < 1 ? (uint32_t)(t * STEPS) : STEPS - 1 : 0; /* NaN: step 0 */
}

static int compare_discs(const void *a, const void *b)
{
    const struct disc *x = a, *y = b;
    if (x->colour != y->colour)
        return x->colour < y->colour ? -1 : 1;
    if (x->radius != y->radius)
        return x->radius < y->radius ? -1 : 1;
    return x->index < y->index ? -1 : x->index > y->index;
}

static bool map_to_frame(const struct picture *p, const double *r, int32_t *x, int32_t *y)
{
    double px = rint(10 * (r[0] - p->view[0]) * p->scale), py = rint(10 * (p->view[3] - r[1]) * p->scale);
    if (!(px >= 0 && px <= 10 * p->frame_w && py >= 0 && py <= 10 * p->frame_h))
        return false;
    *x = (int32_t)px;
    *y = (int32_t)py;
    return true;
}

static enum dm2_status make_discs(struct picture *p, struct dm2_error *err)
{
    size_t n = p->vtp->n_points;
    p->discs = mem_alloc(n, sizeof *p->discs);
    if (p->discs == NULL || n > UINT32_MAX)
        return dm2_fail(err, DM2_MEMORY, "no memory for a picture of %zu elements", n);
    for (size_t i = 0; i < n; i++) {
        struct disc *d = &p->discs[p->n_discs];
        double value = quantity_value(&p->quantity, i), radius = rint(10 * p->radius[i] * p->scale);
        if (!map_to_frame(p, p->vtp->position + 3 * i, &d->x, &d->y))
            continue;
        d->colour = p->quantity.entry.scheme == SCHEME_CATEGORY
                        ? quantity_category_colour(&p->quantity, value)
                        : step_of(p, value);
        d->radius = radius >= 4 ? (uint32_t)fmin(radius, 1e6) : 4; /* 0.4 px is still visible */
        d->index = (uint32_t)i;
        p->n_discs++;
    }
    qsort(p->discs, p->n_discs, sizeof *p->discs, compare_discs);
    return DM2_OK;
}

static void step_colour(const struct picture *p, double t, char out[COLOUR_TEXT])
{
    if (p->quantity.entry.scheme == SCHEME_DIVERGING)
        colour_diverging(t, out);
    else
        colour_sequential(t, out);
}

/* Appends a relative move. A minus sign needs no blank before it. */
static void put_move(struct svg *svg, int32_t dx, int32_t dy)
{
    svg_integer(svg, "m", dx);
    svg_integer(svg, dy < 0 ? "" : " ", dy);
}

static void draw_discs(struct svg *svg, const struct picture *p)
{
    svg_number(svg, "<g transform=\"translate(", p->left);
    svg_number(svg, " ", p->top);
    svg_puts(svg, ") scale(.1)\" fill=\"none\" stroke-linecap=\"round\">\n");
    for (size_t i = 0; i < p->n_discs;) {
        const struct disc *head = &p->discs[i];
        int32_t x = 0, y = 0;
        char colour[COLOUR_TEXT];
        if (p->quantity.entry.scheme == SCHEME_CATEGORY)
            colour_category(head->colour, colour);
        else
            step_colour(p, (head->colour + 0.5) / STEPS, colour);
        svg_puts(svg, "<path stroke=\"");
        svg_puts(svg, colour);
        svg_integer(svg, "\" stroke-width=\"", 2 * (long long)head->radius);
        svg_puts(svg, "\" d=\"");
        for (; i < p->n_discs && p->discs[i].colour == head->colour && p->discs[i].radius == head->radius;
             i++) {
            put_move(svg, p->discs[i].x - x, p->discs[i].y - y);
            svg_puts(svg, "h0");
            x = p->discs[i].x;
            y = p->discs[i].y;
        }
        svg_puts(svg, "\"/>\n");
    }
    svg_puts(svg, "</g>\n");
}

static void draw_links(struct svg *svg, const struct picture *p)
{
    int32_t x = 0, y = 0;
    double thickness = p->n_discs == 0 ? 4 : fmin(fmax(0.2 * p->discs[0].radius, 3), 20);
    svg_number(svg, "<path transform=\"translate(", p->left);
    svg_number(svg, " ", p->top);
    svg_number(svg, ") scale(.1)\" fill=\"none\" stroke=\"#111\" stroke-opacity=\".6\" stroke-width=\"",
               thickness);
    svg_puts(svg, "\" d=\"");
    for (size_t k = 0; k < p->vtp->n_lines; k++) {
        int32_t end[4];
        const double *a = p->vtp->position + 3 * (size_t)p->vtp->line[2 * k];
        const double *b = p->vtp->position + 3 * (size_t)p->vtp->line[2 * k + 1];
        if (!map_to_frame(p, a, &end[0], &end[1]) || !map_to_frame(p, b, &end[2], &end[3]))
            continue;
        put_move(svg, end[0] - x, end[1] - y);
        svg_integer(svg, "l", end[2] - end[0]);
        svg_integer(svg, end[3] < end[1] ? "" : " ", end[3] - end[1]);
        x = end[2];
        y = end[3];
    }
    svg_puts(svg, "\"/>\n");
}

/* --- walls --- */

static double frame_x(const struct picture *p, double x)
{
    return p->left + fmin(fmax((x - p->view[0]) * p->scale, -1e6), 1e6);
}

static double frame_y(const struct picture *p, double y)
{
    return p->top + fmin(fmax((p->view[3] - y) * p->scale, -1e6), 1e6);
}

/* Opens a group that shows nothing beyond the frame, nor beyond the periodic sides of the domain. */
static void open_clip(struct svg *svg, const struct picture *p, const double *domain, const bool periodic[2])
{
    double box[4];
    for (int a = 0; a < 2; a++) {
        box[a] = periodic[a] ? domain[a] : p->view[a];
        box[2 + a] = periodic[a] ? domain[a] + domain[2 + a] : p->view[2 + a];
    }
    svg_number(svg, "<clipPath id=\"frame\"><rect x=\"", frame_x(p, box[0]));
    svg_number(svg, "\" y=\"", frame_y(p, box[3]));
    svg_number(svg, "\" width=\"", (box[2] - box[0]) * p->scale);
    svg_number(svg, "\" height=\"", (box[3] - box[1]) * p->scale);
    svg_puts(svg, "\"/></clipPath>\n<g clip-path=\"url(#frame)\" fill=\"none\" stroke=\"#111\" "
                  "stroke-width=\"1.6\" stroke-linejoin=\"round\">\n");
}

/* Each wall, and its images across periodic sides. */
static void draw_walls(struct svg *svg, const struct picture *p)
{
    const struct vtp *vtp = p->vtp;
    const struct vtp_array *domain = vtp_find(vtp, "FieldData", "domain");
    const struct vtp_array *periodic = vtp_find(vtp, "FieldData", "periodic");
    bool images[2] = {false, false};
    if (vtp->walls.n == 0)
        return;
    for (int a = 0; a < 2 && periodic != NULL && periodic->n_tuples == 2; a++)
        images[a] = domain != NULL && domain->n_tuples == 4 && periodic->values[a] != 0.0;
    open_clip(svg, p, domain != NULL ? domain->values : NULL, images);
    for (int turn = 0; turn < 9; turn++) {
        const int shift[2] = {turn % 3 - 1, turn / 3 - 1};
        if ((shift[0] != 0 && !images[0]) || (shift[1] != 0 && !images[1]))
            continue;
        size_t k = vtp->outline_start;
        for (size_t w = 0; w < vtp->walls.n; w++) {
            svg_puts(svg, "<path d=\"");
            for (bool first = true; (double)k < vtp->outline_end[w]; k++, first = false) {
                const double *r = vtp->position + 3 * (size_t)vtp->outline[k];
                svg_number(svg, first ? "M" : "L",
                           frame_x(p, r[0] + (images[0] ? shift[0] * domain->values[2] : 0.0)));
                svg_number(svg, " ", frame_y(p, r[1] + (images[1] ? shift[1] * domain->values[3] : 0.0)));
            }
            svg_puts(svg, "\"/>\n");
        }
    }
    svg_puts(svg, "</g>\n");
}

/* --- around the frame --- */

static bool has_colour_bar(const struct picture *p)
{
    return p->quantity.entry.scheme != SCHEME_CATEGORY;
}

static void colour_axis(const struct picture *p, struct axis *a)
{
    bool whole =
        p->quantity.entry.scheme == SCHEME_SEQUENTIAL && p->quantity.high - p->quantity.low < 8 &&
        (strcmp(p->quantity.entry.word, "links") == 0 || strcmp(p->quantity.entry.word, "contacts") == 0);
    axis_make(a, p->quantity.low, p->quantity.high, false, false,
              whole ? (int)fmax(2, p->quantity.high - p->quantity.low) : 8);
}

static double side_width(const struct picture *p)
{
    double widest = 0;
    if (has_colour_bar(p)) {
        struct axis a;
        colour_axis(p, &a);
        for (size_t i = 0; i < a.n_ticks; i++)
            widest = fmax(widest, svg_text_width(a.label[i], font_size));
        return 16 + 14 + 8 + widest + 24;
    }
    size_t present[QUANTITY_CATEGORIES_MAX + 1], n = quantity_categories(&p->quantity, present);
    for (size_t i = 0; n <= QUANTITY_CATEGORIES_MAX && i < n; i++) {
        char name[80];
        quantity_category_name(&p->quantity, present[i], name, sizeof name);
        widest = fmax(widest, svg_text_width(name, font_size));
    }
    return widest > 0 ? 16 + 20 + widest : 0;
}

static enum dm2_status lay_out_picture(struct picture *p, struct dm2_error *err)
{
    double view_w = p->view[2] - p->view[0], view_h = p->view[3] - p->view[1];
    p->width = p->options->width > 0 ? p->options->width : 900;
    p->side = side_width(p);
    double room = p->width - 2 * margin - p->side;
    if (!(room >= 80) || !(p->width <= 20000))
        return dm2_fail(
            err, DM2_USAGE,
            "a picture %.0f pixels wide has no room for its elements and legend; choose 300 to 20000",
            p->width);
    p->scale = fmin(room / view_w, 1.2 * p->width / view_h);
    p->frame_w = view_w * p->scale;
    p->frame_h = view_h * p->scale;
    p->left = margin;
    p->top = margin + 20 + (p->options->title != NULL ? 24 : 0);
    double least = has_colour_bar(p) ? 120 : 0; /* the colour bar beside a flat picture */
    p->height = p->top + fmax(p->frame_h, least) + 40;
    p->width = fmin(p->width, fmax(p->frame_w + p->side + 2 * margin, 420));
    return DM2_OK;
}

static void draw_header(struct svg *svg, const struct picture *p)
{
    const struct svg_font title = {.size = title_size, .bold = 1},
                          small = {.size = font_size, .colour = grey};
    char text[200], time[NUMBER_TEXT_MAX];
    (void)snprintf(time, sizeof time, "%.6g", vtp_value(p->vtp, "TimeValue", 0));
    size_t beyond = p->vtp->n_points - p->n_discs;
    int used = snprintf(text, sizeof text, "t = %s \u00b5s, step %.0f, %zu elements", time,
                        vtp_value(p->vtp, "step", 0), p->vtp->n_points);
    if (beyond > 0 && used > 0 && (size_t)used < sizeof text)
        (void)snprintf(text + used, sizeof text - (size_t)used, " (%zu beyond the picture)", beyond);
    if (p->options->title != NULL)
        svg_text(svg, p->left, margin + 15, &title, p->options->title);
    svg_text(svg, p->left, p->top - 9, &small, text);
}

/* The domain's edges; dashed where they are periodic. */
static void draw_domain(struct svg *svg, const struct picture *p)
{
    const struct vtp_array *domain = vtp_find(p->vtp, "FieldData", "domain");
    const struct vtp_array *periodic = vtp_find(p->vtp, "FieldData", "periodic");
    if (domain == NULL || domain->n_tuples != 4)
        return;
    const double *d = domain->values;
    double x0 = p->left + (d[0] - p->view[0]) * p->scale, y1 = p->top + (p->view[3] - d[1]) * p->scale;
    double w = d[2] * p->scale, h = d[3] * p->scale;
    for (int axis = 0; axis < 2; axis++) {
        bool dashed = periodic != NULL && periodic->n_tuples == 2 && periodic->values[axis] != 0;
        svg_number(svg, "<path d=\"M", x0);
        svg_number(svg, " ", y1);
        svg_number(svg, axis == 0 ? "v" : "h", axis == 0 ? -h : w);
        svg_number(svg, "M", axis == 0 ? x0 + w : x0);
        svg_number(svg, " ", axis == 0 ? y1 : y1 - h);
        svg_number(svg, axis == 0 ? "v" : "h", axis == 0 ? -h : w);
        svg_puts(svg, "\" fill=\"none\" stroke=\"#aaa\" stroke-width=\"1");
        svg_puts(svg, dashed ? "\" stroke-dasharray=\"5 4\"/>\n" : "\"/>\n");
    }
}

static void draw_scale_bar(struct svg *svg, const struct picture *p)
{
    static const struct {
        const char *name;
        double cm;
    } units[] = {{"m", 100}, {"cm", 1}, {"mm", 0.1}, {"\u00b5m", 1e-4}, {"nm", 1e-7}};
    double length = axis_round_below(0.22 * p->frame_w / p->scale);
    size_t unit = 0;
    while (unit + 1 < sizeof units / sizeof units[0] && length < units[unit].cm * (1 - 1e-9))
        unit++;
    char text[48];
    (void)snprintf(text, sizeof text, "%.6g %s", length / units[unit].cm, units[unit].name);
    double x = p->left, y = p->height - margin - 8, w = length * p->scale;
    svg_line(svg, x, y, x + w, y, "#222", 3);
    const struct svg_font font = {.size = font_size};
    svg_text(svg, x + w + 9, y + 0.35 * font_size, &font, text);
}

static void draw_colour_bar(struct svg *svg, const struct picture *p)
{
    struct axis a;
    colour_axis(p, &a);
    double x = p->left + p->frame_w + 16, top = p->top, height = fmin(fmax(p->frame_h, 120), 420), w = 14;
    svg_puts(svg, "<linearGradient id=\"bar\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">\n");
    for (int i = 0; i <= 16; i++) {
        char colour[COLOUR_TEXT];
        step_colour(p, i / 16.0, colour);
        svg_number(svg, "<stop offset=\"", i / 16.0 * 100);
        svg_puts(svg, "%\" stop-color=\"");
        svg_puts(svg, colour);
        svg_puts(svg, "\"/>\n");
    }
    svg_puts(svg, "</linearGradient>\n");
    svg_rectangle(svg, x, top, w, height, "url(#bar)", "#444", 0.7);
    const struct svg_font font = {.size = font_size};
    double widest = 0;
    for (size_t i = 0; i < a.n_ticks; i++) {
        double y = top + height * (1 - axis_place(&a, a.tick[i]));
        svg_line(svg, x + w, y, x + w + 4, y, "#444", 1);
        svg_text(svg, x + w + 8, y + 0.35 * font_size, &font, a.label[i]);
        widest = fmax(widest, svg_text_width(a.label[i], font_size));
    }
    char label[96], factor[AXIS_LABEL_MAX];
    axis_factor(&a, factor);
    (void)snprintf(label, sizeof label, "%s%s%s", p->quantity.entry.label, factor[0] == '\0' ? "" : "  ",
                   factor);
    const struct svg_font beside = {.size = font_size, .anchor = SVG_MIDDLE, .rotated = 1};
    svg_text(svg, x + w + 8 + widest + 17, top + 0.5 * height, &beside, label);
}

static void draw_legend(struct svg *svg, const struct picture *p)
{
    size_t present[QUANTITY_CATEGORIES_MAX + 1], n = quantity_categories(&p->quantity, present);
    const struct svg_font font = {.size = font_size};
    for (size_t i = 0; n <= QUANTITY_CATEGORIES_MAX && i < n; i++) {
        char name[80], colour[COLOUR_TEXT];
        double x = p->left + p->frame_w + 22, y = p->top + 10 + 21 * (double)i;
        quantity_category_name(&p->quantity, present[i], name, sizeof name);
        colour_category(quantity_category_colour(&p->quantity, (double)present[i]), colour);
        svg_number(svg, "<circle r=\"6\" cx=\"", x);
        svg_number(svg, "\" cy=\"", y);
        svg_puts(svg, "\" fill=\"");
        svg_puts(svg, colour);
        svg_puts(svg, "\"/>\n");
        svg_text(svg, x + 13, y + 0.35 * font_size, &font, name);
    }
}

static enum dm2_status draw_picture(struct picture *p, const char *path, struct dm2_error *err)
{
    struct svg svg;
    enum dm2_status status = svg_create(&svg, path, p->width, p->height, p->options->title, err);
    if (status != DM2_OK)
        return status;
    draw_header(&svg, p);
    draw_domain(&svg, p);
    draw_discs(&svg, p);
    if (p->options->links)
        draw_links(&svg, p);
    draw_walls(&svg, p);
    draw_scale_bar(&svg, p);
    if (has_colour_bar(p))
        draw_colour_bar(&svg, p);
    else
        draw_legend(&svg, p);
    return svg_commit(&svg, err);
}

enum dm2_status picture_write(const char *path, const struct vtp *vtp, const struct picture_options *options,
                              struct dm2_error *err)
{
    struct picture p = {.vtp = vtp, .options = options};
    const char *word = options->colour == NULL ? "material" : options->colour;
    enum dm2_status status = quantity_choose(&p.quantity, vtp, word, err);
    if (status == DM2_OK)
        status = find_radius(&p, err);
    if (status == DM2_OK)
        status = quantity_choose_range(&p.quantity, options->range, err);
    if (status == DM2_OK) {
        choose_view(&p);
        status = lay_out_picture(&p, err);
    }
    if (status == DM2_OK)
        status = make_discs(&p, err);
    if (status == DM2_OK)
        status = draw_picture(&p, path, err);
    free(p.discs);
    return status;
}
