/* Pictures of states.
 *
 * A disc is a zero-length line with round ends: about ten bytes when discs of one colour and radius share a
 * path and each is given relative to the one before, in tenths of a pixel. So the elements are sorted by
 * (colour, radius, index) first, with the colours of a measured quantity cut into 96 steps. Positions are
 * rounded before differences are taken: no error adds up along a path. */
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
#include "svg.h"

enum scheme { SCHEME_CATEGORY, SCHEME_SEQUENTIAL, SCHEME_DIVERGING };

/* What discs can be coloured by. */
struct quantity {
    const char *word, *label, *array;
    enum scheme scheme;
    double (*value)(const double *tuple);
};

static double first(const double *tuple)
{
    return tuple[0];
}

static double second(const double *tuple)
{
    return tuple[1];
}

static double third(const double *tuple)
{
    return tuple[2];
}

static double speed(const double *tuple)
{
    return sqrt(tuple[0] * tuple[0] + tuple[1] * tuple[1]);
}

static double mean_stress(const double *tuple)
{
    return 0.5 * (tuple[0] + tuple[1]);
}

/* The largest shear strain in the plane, and the change of area. */
static double shear_strain(const double *tuple)
{
    double half = 0.5 * (tuple[0] - tuple[1]);
    return sqrt(half * half + tuple[2] * tuple[2]);
}

static double area_strain(const double *tuple)
{
    return tuple[0] + tuple[1];
}

static const struct quantity quantities[] = {
    {"material", "material", "kind", SCHEME_CATEGORY, first},
    {"velocity", "speed [cm/\u00b5s]", "velocity", SCHEME_SEQUENTIAL, speed},
    {"vx", "velocity x [cm/\u00b5s]", "velocity", SCHEME_DIVERGING, first},
    {"vy", "velocity y [cm/\u00b5s]", "velocity", SCHEME_DIVERGING, second},
    {"stress", "mean stress, tension positive [Mbar]", "stress", SCHEME_DIVERGING, mean_stress},
    {"stress-xx", "stress xx [Mbar]", "stress", SCHEME_DIVERGING, first},
    {"stress-yy", "stress yy [Mbar]", "stress", SCHEME_DIVERGING, second},
    {"stress-xy", "stress xy [Mbar]", "stress", SCHEME_DIVERGING, third},
    {"pressure", "pressure [Mbar]", "pressure", SCHEME_DIVERGING, first},
    {"temperature", "temperature [K]", "temperature", SCHEME_SEQUENTIAL, first},
    {"spin", "angular velocity [1/\u00b5s]", "spin", SCHEME_DIVERGING, first},
    {"links", "links", "links", SCHEME_SEQUENTIAL, first},
    {"contacts", "contacts", "contacts", SCHEME_SEQUENTIAL, first},
    {"bonds", "links at the start", "bonds", SCHEME_SEQUENTIAL, first},
    {"damage", "damage: lost share of links", "damage", SCHEME_SEQUENTIAL, first},
    {"strain", "largest shear strain", "strain", SCHEME_SEQUENTIAL, shear_strain},
    {"strain-area", "area strain", "strain", SCHEME_DIVERGING, area_strain},
    {"strain-xx", "strain xx", "strain", SCHEME_DIVERGING, first},
    {"strain-yy", "strain yy", "strain", SCHEME_DIVERGING, second},
    {"strain-xy", "strain xy", "strain", SCHEME_DIVERGING, third},
    {"fragment", "fragment", "fragment", SCHEME_CATEGORY, first},
    {"phase", "phase", "phase", SCHEME_CATEGORY, first},
    {"composition", "mass fraction of the product", "composition", SCHEME_SEQUENTIAL, third},
    {"grain", "grain", "grain", SCHEME_CATEGORY, first},
    {"body", "body", "body", SCHEME_CATEGORY, first},
};

enum { N_QUANTITIES = sizeof quantities / sizeof quantities[0], STEPS = 96, LEGEND_MAX = 24 };

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
    struct quantity quantity;
    char name[2 * VTP_NAME_MAX]; /* of a quantity that is not in the table */
    const double *values, *radius;
    size_t components;
    double low, high;                   /* range of the colours */
    double view[4];                     /* what is shown: x0 y0 x1 y1, cm */
    double left, top, frame_w, frame_h; /* where, px */
    double width, height, scale;        /* of the picture, px; px per cm */
    double side;                        /* width of the column with the legend */
    struct disc *discs;
    size_t n_discs;
};

const char *picture_colours(void)
{
    return "material velocity vx vy stress stress-xx stress-yy stress-xy pressure temperature spin links "
           "contacts bonds damage strain strain-area strain-xx strain-yy strain-xy fragment phase "
           "composition grain "
           "body, or ARRAY or ARRAY:COMPONENT of the file";
}

/* --- what is shown --- */

/* The names of the arrays of points, blank-separated; cut where there are many. */
static void list_arrays(const struct vtp *vtp, char *out, size_t size)
{
    size_t used = 0;
    out[0] = '\0';
    for (size_t k = 0; k < vtp->n_arrays && used < size; k++)
        if (strcmp(vtp->arrays[k].section, "PointData") == 0)
            used +=
                (size_t)snprintf(out + used, size - used, "%s%s", used == 0 ? "" : " ", vtp->arrays[k].name);
}

/* Any other array of the file by its name, with the component behind a colon, from 1. */
static const struct vtp_array *find_other(struct picture *p, const char *word, size_t *component)
{
    const char *colon = strrchr(word, ':');
    size_t length = colon == NULL ? strlen(word) : (size_t)(colon - word);
    int64_t number = 1;
    if (length >= VTP_NAME_MAX ||
        (colon != NULL && (!number_parse_integer(colon + 1, strlen(colon + 1), &number) || number < 1)))
        return NULL;
    (void)snprintf(p->name, sizeof p->name, "%.*s", (int)length, word);
    const struct vtp_array *array = vtp_find(p->vtp, "PointData", p->name);
    if (array == NULL || (uint64_t)number > array->components)
        return NULL;
    if (array->components > 1)
        (void)snprintf(p->name, sizeof p->name, "%.*s, component %d", (int)length, word, (int)number);
    *component = (size_t)number - 1;
    return array;
}

static bool any_negative(const struct picture *p)
{
    for (size_t i = 0; i < p->vtp->n_points; i++)
        if (p->values[i * p->components] < 0)
            return true;
    return false;
}

static enum dm2_status choose_quantity(struct picture *p, struct dm2_error *err)
{
    const char *word = p->options->colour == NULL ? "material" : p->options->colour;
    const struct vtp_array *radius = vtp_find(p->vtp, "PointData", "radius"), *values;
    size_t component = 0;
    char names[400];
    bool known = false;
    for (int i = 0; i < N_QUANTITIES && !known; i++) {
        known = strcmp(word, quantities[i].word) == 0;
        p->quantity = quantities[i];
    }
    values = known ? vtp_find(p->vtp, "PointData", p->quantity.array) : find_other(p, word, &component);
    list_arrays(p->vtp, names, sizeof names);
    if (!known && values == NULL)
        return dm2_fail(err, DM2_USAGE,
                        "'%.60s' is nothing to colour by; choose one of: %s. The file has the arrays: %.200s",
                        word, picture_colours(), names);
    size_t least = p->quantity.value == first || !known ? 1
                   : p->quantity.value == second        ? 2
                                                        : 3; /* that it reads */
    if (values == NULL || values->components < least)
        return dm2_fail(err, DM2_USAGE,
                        "'%s' needs an array '%s' that the snapshot does not have; it has: %s", word,
                        p->quantity.array, names);
    if (radius == NULL || radius->components != 1)
        return dm2_fail(err, DM2_USAGE, "the snapshot has no array 'radius' of its points; it has: %s",
                        names);
    p->values = values->values + component;
    p->components = values->components;
    p->radius = radius->values;
    if (!known)
        p->quantity = (struct quantity){word, p->name, values->name,
                                        any_negative(p) ? SCHEME_DIVERGING : SCHEME_SEQUENTIAL, first};
    return DM2_OK;
}

static double value_of(const struct picture *p, size_t i)
{
    return p->quantity.value(p->values + i * p->components);
}

static enum dm2_status choose_range(struct picture *p, struct dm2_error *err)
{
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < p->vtp->n_points; i++) {
        double value = value_of(p, i);
        if (isfinite(value)) {
            low = fmin(low, value);
            high = fmax(high, value);
        }
    }
    if (low > high)
        low = high = 0;
    if (p->quantity.scheme == SCHEME_DIVERGING) {
        high = fmax(fabs(low), fabs(high));
        low = -high;
    }
    if (!isnan(p->options->range[0])) {
        low = p->options->range[0];
        high = p->options->range[1];
        if (!(low < high) || !isfinite(low) || !isfinite(high))
            return dm2_fail(err, DM2_USAGE, "the range of the colours needs a minimum below its maximum");
    }
    if (high - low <= 1e-9 * fmax(fabs(low), fabs(high))) {
        double half = low == 0 ? 1 : 0.01 * fabs(low);
        low -= half;
        high += half;
    }
    p->low = low;
    p->high = high;
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

/* --- categories --- */

static void category_name(const struct picture *p, size_t category, char *out, size_t size)
{
    const struct vtp_names *names = strcmp(p->quantity.word, "material") == 0 ? &p->vtp->materials
                                    : strcmp(p->quantity.word, "body") == 0   ? &p->vtp->bodies
                                                                              : NULL;
    if (names != NULL && category < names->n)
        (void)snprintf(out, size, "%s", names->name[category]);
    else
        (void)snprintf(out, size, "%s %zu", p->quantity.word, category);
}

/* Grains are many: neighbouring numbers are spread over the colours. */
static uint32_t category_colour(const struct picture *p, double value)
{
    uint64_t category = value >= 0 && value < 0x1p53 ? (uint64_t)value : 0;
    if (strcmp(p->quantity.word, "grain") == 0)
        category = category * 0x9E3779B97F4A7C15u >> 40;
    return (uint32_t)(category % COLOUR_CATEGORIES);
}

/* The categories that occur, ascending, at most LEGEND_MAX + 1 of them (then there are more). */
static size_t categories_present(const struct picture *p, size_t out[LEGEND_MAX + 1])
{
    size_t n = 0;
    for (size_t i = 0; i < p->vtp->n_points; i++) {
        double value = value_of(p, i);
        size_t category = value >= 0 && value < 0x1p53 ? (size_t)value : 0, at = 0;
        while (at < n && out[at] < category)
            at++;
        if ((at < n && out[at] == category) || at > LEGEND_MAX)
            continue;
        size_t kept = n > LEGEND_MAX ? LEGEND_MAX : n;
        for (size_t k = kept; k > at; k--)
            out[k] = out[k - 1];
        out[at] = category;
        n = kept + 1;
    }
    return n;
}

/* --- discs --- */

static uint32_t step_of(const struct picture *p, double value)
{
    double t = (value - p->low) / (p->high - p->low);
    return t > 0 ? t < 1 ? (uint32_t)(t * STEPS) : STEPS - 1 : 0; /* not a number: 0 */
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

static bool to_frame(const struct picture *p, const double *r, int32_t *x, int32_t *y)
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
        double value = value_of(p, i), radius = rint(10 * p->radius[i] * p->scale);
        if (!to_frame(p, p->vtp->position + 3 * i, &d->x, &d->y))
            continue;
        d->colour = p->quantity.scheme == SCHEME_CATEGORY ? category_colour(p, value) : step_of(p, value);
        d->radius = radius >= 4 ? (uint32_t)fmin(radius, 1e6) : 4; /* still visible */
        d->index = (uint32_t)i;
        p->n_discs++;
    }
    qsort(p->discs, p->n_discs, sizeof *p->discs, compare_discs);
    return DM2_OK;
}

static void step_colour(const struct picture *p, double t, char out[COLOUR_TEXT])
{
    if (p->quantity.scheme == SCHEME_DIVERGING)
        colour_diverging(t, out);
    else
        colour_sequential(t, out);
}

/* Appends a relative move; a minus sign needs no blank before it. */
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
        if (p->quantity.scheme == SCHEME_CATEGORY)
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
        if (!to_frame(p, a, &end[0], &end[1]) || !to_frame(p, b, &end[2], &end[3]))
            continue;
        put_move(svg, end[0] - x, end[1] - y);
        svg_integer(svg, "l", end[2] - end[0]);
        svg_integer(svg, end[3] < end[1] ? "" : " ", end[3] - end[1]);
        x = end[2];
        y = end[3];
    }
    svg_puts(svg, "\"/>\n");
}

/* --- what stands around --- */

static bool has_colour_bar(const struct picture *p)
{
    return p->quantity.scheme != SCHEME_CATEGORY;
}

static void colour_axis(const struct picture *p, struct axis *a)
{
    bool whole = p->quantity.scheme == SCHEME_SEQUENTIAL && p->high - p->low < 8 &&
                 (strcmp(p->quantity.word, "links") == 0 || strcmp(p->quantity.word, "contacts") == 0);
    axis_make(a, p->low, p->high, false, false, whole ? (int)fmax(2, p->high - p->low) : 8);
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
    size_t present[LEGEND_MAX + 1], n = categories_present(p, present);
    for (size_t i = 0; n <= LEGEND_MAX && i < n; i++) {
        char name[80];
        category_name(p, present[i], name, sizeof name);
        widest = fmax(widest, svg_text_width(name, font_size));
    }
    return widest > 0 ? 16 + 20 + widest : 0;
}

static enum dm2_status lay_out(struct picture *p, struct dm2_error *err)
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
    double least = has_colour_bar(p) ? 120 : 0; /* room for the bar beside a flat picture */
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
    (void)snprintf(label, sizeof label, "%s%s%s", p->quantity.label, factor[0] == '\0' ? "" : "  ", factor);
    const struct svg_font beside = {.size = font_size, .anchor = SVG_MIDDLE, .rotated = 1};
    svg_text(svg, x + w + 8 + widest + 17, top + 0.5 * height, &beside, label);
}

static void draw_legend(struct svg *svg, const struct picture *p)
{
    size_t present[LEGEND_MAX + 1], n = categories_present(p, present);
    const struct svg_font font = {.size = font_size};
    for (size_t i = 0; n <= LEGEND_MAX && i < n; i++) {
        char name[80], colour[COLOUR_TEXT];
        double x = p->left + p->frame_w + 22, y = p->top + 10 + 21 * (double)i;
        category_name(p, present[i], name, sizeof name);
        colour_category(category_colour(p, (double)present[i]), colour);
        svg_number(svg, "<circle r=\"6\" cx=\"", x);
        svg_number(svg, "\" cy=\"", y);
        svg_puts(svg, "\" fill=\"");
        svg_puts(svg, colour);
        svg_puts(svg, "\"/>\n");
        svg_text(svg, x + 13, y + 0.35 * font_size, &font, name);
    }
}

static enum dm2_status draw(struct picture *p, const char *path, struct dm2_error *err)
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
    enum dm2_status status = choose_quantity(&p, err);
    if (status == DM2_OK)
        status = choose_range(&p, err);
    if (status == DM2_OK) {
        choose_view(&p);
        status = lay_out(&p, err);
    }
    if (status == DM2_OK)
        status = make_discs(&p, err);
    if (status == DM2_OK)
        status = draw(&p, path, err);
    free(p.discs);
    return status;
}
