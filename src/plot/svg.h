/* Writes SVG: a file that grows element by element, in pixels, y downwards.
 *
 * Texts are UTF-8 and are escaped; `^{...}` in a text is set as a superscript. The file keeps its first
 * error, which svg_commit returns (dm2/base/file.h). */
#ifndef DM2_PLOT_SVG_H
#define DM2_PLOT_SVG_H

#include <stddef.h>

#include "dm2/base/file.h"
#include "dm2/base/status.h"

struct svg {
    struct file_out file;
};

enum svg_anchor { SVG_START, SVG_MIDDLE, SVG_END };

struct svg_font {
    double size; /* px */
    enum svg_anchor anchor;
    const char *colour; /* NULL: #222 */
    int bold, rotated;  /* rotated by 90 degrees about the position, reading upwards */
};

/* Creates the file and opens the drawing on a white ground, with `title` for screen readers (may be NULL). */
enum dm2_status svg_create(struct svg *svg, const char *path, double width, double height, const char *title,
                           struct dm2_error *err);

/* Closes the drawing and gives the file its name. */
enum dm2_status svg_commit(struct svg *svg, struct dm2_error *err);

/* Appends markup as it is. */
void svg_puts(struct svg *svg, const char *text);

/* `before`, then x with at most two decimals and without trailing zeros; svg_integer: `before`, then x. */
void svg_number(struct svg *svg, const char *before, double x);
void svg_integer(struct svg *svg, const char *before, long long x);

/* A text whose base line has (x, y) at the end that the anchor names. */
void svg_text(struct svg *svg, double x, double y, const struct svg_font *font, const char *text);

/* An upper bound of the width of a text in the usual sans-serif fonts, px. */
double svg_text_width(const char *text, double size);

/* A straight line. */
void svg_line(struct svg *svg, double x0, double y0, double x1, double y1, const char *colour, double width);

/* A rectangle; `fill` and `stroke` may be NULL: none. */
void svg_rectangle(struct svg *svg, double x, double y, double width, double height, const char *fill,
                   const char *stroke, double stroke_width);

#endif
