/* The SVG writer.
 *
 * Numbers make up most of a file, so they are cut to hundredths of a pixel. Text positions are independent
 * of font metrics, which are unknown here: every text is anchored, and svg_text_width only reserves room. */
#include "svg.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void put_escaped(struct svg *svg, const char *text, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        char c = text[i];
        if (c == '<')
            svg_puts(svg, "&lt;");
        else if (c == '>')
            svg_puts(svg, "&gt;");
        else if (c == '&')
            svg_puts(svg, "&amp;");
        else if (c == '"')
            svg_puts(svg, "&quot;");
        else if ((unsigned char)c >= 0x20)
            file_write(&svg->file, &c, 1);
        else
            svg_puts(svg, " ");
    }
}

enum dm2_status svg_create(struct svg *svg, const char *path, double width, double height, const char *title,
                           struct dm2_error *err)
{
    enum dm2_status status =
        strcmp(path, "-") == 0 ? file_create_output(&svg->file, err) : file_create(&svg->file, path, err);
    if (status != DM2_OK)
        return status;
    svg_number(svg, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"", width);
    svg_number(svg, "\" height=\"", height);
    svg_number(svg, "\" viewBox=\"0 0 ", width);
    svg_number(svg, " ", height);
    svg_puts(svg, "\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n");
    if (title != NULL) {
        svg_puts(svg, "<title>");
        put_escaped(svg, title, strlen(title));
        svg_puts(svg, "</title>\n");
    }
    svg_puts(svg, "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n");
    return DM2_OK;
}

enum dm2_status svg_commit(struct svg *svg, struct dm2_error *err)
{
    svg_puts(svg, "</svg>\n");
    return file_commit(&svg->file, err);
}

void svg_puts(struct svg *svg, const char *text)
{
    file_puts(&svg->file, text);
}

void svg_number(struct svg *svg, const char *before, double x)
{
    char text[64];
    int n = snprintf(text, sizeof text, "%.2f", x);
    while (n > 0 && text[n - 1] == '0')
        n--;
    if (n > 0 && text[n - 1] == '.')
        n--;
    text[n] = '\0';
    svg_puts(svg, before);
    svg_puts(svg, strcmp(text, "-0") == 0 ? "0" : text);
}

void svg_integer(struct svg *svg, const char *before, long long x)
{
    file_printf(&svg->file, "%s%lld", before, x);
}

static void put_marked_up(struct svg *svg, const char *text, double size)
{
    for (;;) {
        const char *up = strstr(text, "^{"), *close = up == NULL ? NULL : strchr(up, '}');
        if (close == NULL) {
            put_escaped(svg, text, strlen(text));
            return;
        }
        put_escaped(svg, text, (size_t)(up - text));
        svg_number(svg, "<tspan font-size=\"", 0.72 * size);
        svg_number(svg, "\" dy=\"", -0.36 * size);
        svg_puts(svg, "\">");
        put_escaped(svg, up + 2, (size_t)(close - up - 2));
        svg_puts(svg, "</tspan>");
        text = close + 1;
        if (*text != '\0') { /* the next character returns to the base line */
            size_t n = 1;
            while (((unsigned char)text[n] & 0xc0) == 0x80)
                n++;
            svg_number(svg, "<tspan dy=\"", 0.36 * size);
            svg_puts(svg, "\">");
            put_escaped(svg, text, n);
            svg_puts(svg, "</tspan>");
            text += n;
        }
    }
}

void svg_text(struct svg *svg, double x, double y, const struct svg_font *font, const char *text)
{
    static const char *const anchors[] = {"start", "middle", "end"};
    svg_number(svg, "<text x=\"", x);
    svg_number(svg, "\" y=\"", y);
    svg_number(svg, "\" font-size=\"", font->size);
    if (font->anchor != SVG_START) {
        svg_puts(svg, "\" text-anchor=\"");
        svg_puts(svg, anchors[font->anchor]);
    }
    if (font->bold)
        svg_puts(svg, "\" font-weight=\"bold");
    if (font->rotated) {
        svg_number(svg, "\" transform=\"rotate(-90 ", x);
        svg_number(svg, " ", y);
        svg_puts(svg, ")");
    }
    svg_puts(svg, "\" fill=\"");
    svg_puts(svg, font->colour == NULL ? "#222" : font->colour);
    svg_puts(svg, "\">");
    put_marked_up(svg, text, font->size);
    svg_puts(svg, "</text>\n");
}

double svg_text_width(const char *text, double size)
{
    size_t characters = 0;
    for (const char *c = text; *c != '\0'; c++)
        characters += ((unsigned char)*c & 0xc0) != 0x80 && *c != '^' && *c != '{' && *c != '}' ? 1 : 0;
    return 0.62 * size * (double)characters;
}

void svg_line(struct svg *svg, double x0, double y0, double x1, double y1, const char *colour, double width)
{
    svg_number(svg, "<path d=\"M", x0);
    svg_number(svg, " ", y0);
    svg_number(svg, "L", x1);
    svg_number(svg, " ", y1);
    svg_puts(svg, "\" stroke=\"");
    svg_puts(svg, colour);
    svg_number(svg, "\" stroke-width=\"", width);
    svg_puts(svg, "\" fill=\"none\"/>\n");
}

void svg_rectangle(struct svg *svg, double x, double y, double width, double height, const char *fill,
                   const char *stroke, double stroke_width)
{
    svg_number(svg, "<rect x=\"", x);
    svg_number(svg, "\" y=\"", y);
    svg_number(svg, "\" width=\"", width);
    svg_number(svg, "\" height=\"", height);
    svg_puts(svg, "\" fill=\"");
    svg_puts(svg, fill == NULL ? "none" : fill);
    if (stroke != NULL) {
        svg_puts(svg, "\" stroke=\"");
        svg_puts(svg, stroke);
        svg_number(svg, "\" stroke-width=\"", stroke_width);
    }
    svg_puts(svg, "\"/>\n");
}
