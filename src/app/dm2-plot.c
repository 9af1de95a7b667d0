/* dm2-plot: pictures of snapshots and charts of tables, as SVG. */
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/csv.h"
#include "dm2/base/number.h"
#include "dm2/base/text.h"
#include "dm2/base/version.h"
#include "dm2/engine/self_test.h"
#include "dm2/plot/chart.h"
#include "dm2/plot/picture.h"
#include "dm2/plot/vtp_reader.h"
#include "options.h"
#include "process.h"

enum { SERIES_MAX = 32 };

static const char usage[] = "usage: dm2-plot snapshot FILE.vtp [options]   draws the elements of a state\n"
                            "       dm2-plot chart FILE.csv [options]      draws columns of a table\n";

/* The options of both commands. */
struct plot_arguments {
    const char *out, *title;
    int64_t width;
    bool help;
    /* snapshot */
    const char *colour;
    bool links;
    double range[2];
    /* chart */
    const char *x, *y, *by, *only, *dashed, *x_label, *y_label;
    bool log_x, log_y, markers;
};

/* The file's base name with the suffix ".svg", in the current directory. malloc'd; NULL: no memory. */
static char *default_output(const char *path)
{
    const char *slash = strrchr(path, '/'), *base = slash == NULL ? path : slash + 1,
               *dot = strrchr(base, '.');
    size_t length = dot == NULL || dot == base ? strlen(base) : (size_t)(dot - base);
    char *out = malloc(length + 5);
    if (out != NULL) {
        memcpy(out, base, length);
        memcpy(out + length, ".svg", 5);
    }
    return out;
}

/* Removes `--range MIN MAX` from the command line, because options_parse knows no option with two values. */
static enum dm2_status take_range(int *argc, char **argv, double range[2], struct dm2_error *err)
{
    range[0] = range[1] = NAN;
    for (int i = 1; i < *argc; i++) {
        if (strcmp(argv[i], "--") == 0)
            break;
        if (strcmp(argv[i], "--range") != 0)
            continue;
        for (int k = 0; k < 2; k++)
            if (i + 1 + k >= *argc || !number_parse(argv[i + 1 + k], strlen(argv[i + 1 + k]), &range[k]) ||
                !isfinite(range[k]))
                return dm2_fail(err, DM2_USAGE, "--range needs two numbers: MIN MAX");
        for (int k = i; k + 3 <= *argc; k++)
            argv[k] = argv[k + 3]; /* moves the NULL at the end, too */
        *argc -= 3;
        i--;
    }
    return DM2_OK;
}

/* Parses the words behind the command; the one operand is the file. */
static enum dm2_status parse_arguments(const struct option *table, size_t n, int argc, char **argv,
                                       const struct plot_arguments *a, const char **file,
                                       struct dm2_error *err)
{
    struct option_list operands = {0};
    enum dm2_status status = options_parse(table, n, argc, argv, &operands, err);
    if (status == DM2_OK && !a->help && operands.n != 1)
        status =
            dm2_fail(err, DM2_USAGE, "one file is expected, %zu were given; --help explains", operands.n);
    *file = status == DM2_OK && operands.n == 1 ? operands.items[0] : NULL;
    option_list_free(&operands);
    return status;
}

static void print_help(const char *first, const struct option *table, size_t n)
{
    printf("%s\n", first);
    options_print(stdout, table, n);
}

static enum dm2_status snapshot_command(int argc, char **argv, struct dm2_error *err)
{
    struct plot_arguments a = {.width = 900};
    const struct option table[] = {
        {"output", 'o', OPTION_TEXT, &a.out, "OUT.svg",
         "where to write, - for standard output; default FILE.svg here", 0, 0},
        {"colour", 'c', OPTION_TEXT, &a.colour, "WHAT",
         "what colours the elements, see below; default material", 0, 0},
        {"links", 0, OPTION_FLAG, &a.links, NULL, "draw the links", 0, 0},
        {"title", 't', OPTION_TEXT, &a.title, "TEXT", "a headline", 0, 0},
        {"width", 'w', OPTION_INTEGER, &a.width, "PX", "width of the picture; default 900", 300, 20000},
        {"help", 'h', OPTION_FLAG, &a.help, NULL, "this", 0, 0},
    };
    const char *file;
    enum dm2_status status = take_range(&argc, argv, a.range, err);
    if (status == DM2_OK)
        status = parse_arguments(table, sizeof table / sizeof table[0], argc, argv, &a, &file, err);
    if (status != DM2_OK)
        return status;
    if (a.help) {
        print_help("usage: dm2-plot snapshot FILE.vtp [options]", table, sizeof table / sizeof table[0]);
        printf("      --range MIN MAX          %s\n\nWHAT is one of: %s\n",
               "range of the colours; default: of the values", picture_colours());
        return DM2_OK;
    }
    char *own = a.out == NULL ? default_output(file) : NULL;
    const char *out = a.out == NULL ? own : a.out;
    struct vtp vtp;
    if (out == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for a file name");
    status = vtp_read(file, &vtp, err);
    if (status == DM2_OK) {
        const struct picture_options options = {
            a.colour, a.links, {a.range[0], a.range[1]}, a.title, (double)a.width};
        status = picture_write(out, &vtp, &options, err);
        vtp_free(&vtp);
    }
    if (status == DM2_OK && strcmp(out, "-") != 0)
        printf("%s\n", out);
    free(own);
    return status;
}

/* A heading as a label: in its unit a u for micro becomes U+00B5 and digits become superscripts. Returns
 * `out`. */
static const char *typeset_heading(const char *heading, char *out, size_t size)
{
    size_t n = 0;
    bool unit = false;
    for (const char *at = heading; *at != '\0' && n + 8 < size; at++) {
        unit = at[0] == '[' || (unit && at[0] != ']');
        if (unit && at[0] == 'u' && at[1] == 's' && strchr("[/ ", at[-1]) != NULL)
            n += (size_t)snprintf(out + n, size - n, "\u00b5");
        else if (unit && at[0] >= '2' && at[0] <= '9')
            n += (size_t)snprintf(out + n, size - n, "^{%c}", at[0]);
        else
            out[n++] = at[0];
    }
    out[n] = '\0';
    return out;
}

/* A chart's columns. `heading` points into the table. */
struct chart_columns {
    double *x, *y[SERIES_MAX];
    const char *heading[SERIES_MAX];
    size_t n;
};

static void free_columns(struct chart_columns *c)
{
    free(c->x);
    for (size_t i = 0; i < c->n; i++)
        free(c->y[i]);
}

/* Appends the columns whose names are in `list`, comma-separated; cuts `list` into names. */
static enum dm2_status take_columns(const struct csv *csv, char *list, struct chart_columns *c,
                                    struct dm2_error *err)
{
    for (char *name = list, *next; name != NULL; name = next) {
        size_t column;
        next = strchr(name, ',');
        if (next != NULL)
            *next++ = '\0';
        if (c->n == SERIES_MAX)
            return dm2_fail(err, DM2_USAGE, "--y names more than %d columns", SERIES_MAX);
        enum dm2_status status = csv_column(csv, name, &column, err);
        if (status == DM2_OK)
            status = csv_numbers(csv, column, &c->y[c->n], err);
        if (status != DM2_OK)
            return status;
        c->heading[c->n++] = csv_heading(csv, column);
    }
    return DM2_OK;
}

/* The unit that all headings share, "[us]", for the axis; names[] gets the headings without this unit.
 * NULL: there is no shared unit. */
static const char *shared_unit(const struct chart_columns *c, char names[SERIES_MAX][64])
{
    const char *unit = strstr(c->heading[0], " [");
    for (size_t i = 0; i < c->n; i++) {
        const char *own = strstr(c->heading[i], " [");
        if (unit == NULL || own == NULL || strcmp(own, unit) != 0)
            return NULL;
    }
    for (size_t i = 0; i < c->n; i++)
        (void)snprintf(names[i], 64, "%.*s", (int)(strstr(c->heading[i], " [") - c->heading[i]),
                       c->heading[i]);
    return unit + 1;
}

/* One curve of --by: the n rows from `first` on, which have one value in that column. */
struct row_group {
    size_t first, n;
    double value;
};

/* Whether the value is in the comma-separated list. A list of NULL has every value. */
static bool is_listed(const char *list, double value)
{
    for (const char *at = list; at != NULL; at = strchr(at, ',') == NULL ? NULL : strchr(at, ',') + 1) {
        double one;
        if (number_parse(at, strcspn(at, ","), &one) && fabs(one - value) <= 1e-9 * fabs(value))
            return true;
    }
    return list == NULL;
}

/* Cuts the table into groups where the column of --by changes. */
static enum dm2_status find_groups(const struct csv *csv, const struct plot_arguments *a,
                                   struct row_group groups[SERIES_MAX], size_t *n, const char **heading,
                                   struct dm2_error *err)
{
    size_t column;
    double *values;
    enum dm2_status status = csv_column(csv, a->by, &column, err);
    if (status == DM2_OK)
        status = csv_numbers(csv, column, &values, err);
    if (status != DM2_OK)
        return status;
    *heading = csv_heading(csv, column);
    *n = 0;
    for (size_t row = 0, next; row < csv->n_rows && status == DM2_OK; row = next) {
        for (next = row + 1; next < csv->n_rows && values[next] == values[row];)
            next++;
        if (!is_listed(a->only, values[row]))
            continue;
        if (*n == SERIES_MAX)
            status = dm2_fail(err, DM2_USAGE, "'%s' has more than %d values; choose some with --only",
                              *heading, SERIES_MAX);
        else
            groups[(*n)++] = (struct row_group){row, next - row, values[row]};
    }
    free(values);
    if (status == DM2_OK && *n == 0)
        return dm2_fail(err, DM2_USAGE, "'%s' has none of the values %s", *heading,
                        a->only == NULL ? "" : a->only);
    return status;
}

/* Writes the legend's name of a curve: "2.5 us" (with U+00B5) of 2.5 in a column "time [us]", "step 100"
 * in a column without a unit. */
static void name_group(const char *heading, double value, char *out, size_t size)
{
    char text[200];
    const char *unit = strchr(typeset_heading(heading, text, sizeof text), '[');
    if (unit == NULL)
        (void)snprintf(out, size, "%.40s %.6g", heading, value);
    else
        (void)snprintf(out, size, "%.6g %.*s", value, (int)strcspn(unit + 1, "]"), unit + 1);
}

/* The curves of one column, one for each value of --by, from dark to light. */
static enum dm2_status split_curve(const struct csv *csv, const struct plot_arguments *a,
                                   const struct chart_columns *c, struct chart_series series[SERIES_MAX],
                                   char names[SERIES_MAX][64], size_t *n, struct dm2_error *err)
{
    struct row_group groups[SERIES_MAX];
    const char *heading = "";
    if (c->n > 1)
        return dm2_fail(err, DM2_USAGE, "with --by, --y names one column");
    enum dm2_status status = find_groups(csv, a, groups, n, &heading, err);
    for (size_t i = 0; status == DM2_OK && i < *n; i++) {
        name_group(heading, groups[i].value, names[i], sizeof names[i]);
        series[i] = (struct chart_series){.name = names[i],
                                          .x = c->x + groups[i].first,
                                          .y = c->y[0] + groups[i].first,
                                          .n = groups[i].n,
                                          .colour = i,
                                          .shade = *n > 1 ? (double)i / (double)(*n - 1) : 0,
                                          .shaded = true,
                                          .line = true,
                                          .markers = a->markers};
    }
    return status;
}

static enum dm2_status draw_chart(const struct csv *csv, const struct plot_arguments *a, char *list,
                                  char *dashed, const char *out, struct dm2_error *err)
{
    struct chart_columns c = {0};
    struct chart_series series[SERIES_MAX];
    char names[SERIES_MAX][64];
    char across[256], upward[256];
    const char *unit = NULL;
    size_t x_column;
    enum dm2_status status = csv_column(csv, a->x, &x_column, err);
    if (status == DM2_OK)
        status = csv_numbers(csv, x_column, &c.x, err);
    if (status == DM2_OK)
        status = take_columns(csv, list, &c, err);
    size_t solid = c.n;
    if (status == DM2_OK && dashed != NULL)
        status = take_columns(csv, dashed, &c, err);
    if (status == DM2_OK && c.n > 1)
        unit = shared_unit(&c, names);
    size_t n_series = c.n;
    if (status == DM2_OK && a->by != NULL)
        status = split_curve(csv, a, &c, series, names, &n_series, err);
    for (size_t i = 0; status == DM2_OK && a->by == NULL && i < c.n; i++)
        series[i] = (struct chart_series){.name = unit != NULL ? names[i] : c.heading[i],
                                          .x = c.x,
                                          .y = c.y[i],
                                          .n = csv->n_rows,
                                          .colour = i < solid ? i : i - solid,
                                          .line = true,
                                          .dashed = i >= solid,
                                          .markers = a->markers && i < solid};
    if (status == DM2_OK) {
        const struct chart chart = {
            .title = a->title,
            .x_label = a->x_label != NULL
                           ? a->x_label
                           : typeset_heading(csv_heading(csv, x_column), across, sizeof across),
            .y_label = a->y_label != NULL ? a->y_label
                       : c.n == 1         ? typeset_heading(c.heading[0], upward, sizeof upward)
                       : unit != NULL     ? typeset_heading(unit, upward, sizeof upward)
                                          : NULL,
            .log_x = a->log_x,
            .log_y = a->log_y,
            .width = (double)a->width,
            .height = 0.6 * (double)a->width,
            .series = series,
            .n_series = n_series,
        };
        status = chart_write(out, &chart, err);
    }
    free_columns(&c);
    return status;
}

static enum dm2_status chart_command(int argc, char **argv, struct dm2_error *err)
{
    struct plot_arguments a = {.width = 760};
    const struct option table[] = {
        {"output", 'o', OPTION_TEXT, &a.out, "OUT.svg",
         "where to write, - for standard output; default FILE.svg here", 0, 0},
        {"x", 'x', OPTION_TEXT, &a.x, "COLUMN", "the column across; required", 0, 0},
        {"y", 'y', OPTION_TEXT, &a.y, "COLUMN,...", "the columns to draw; required", 0, 0},
        {"by", 'b', OPTION_TEXT, &a.by, "COLUMN", "a curve for each value of this column, as in profiles", 0,
         0},
        {"only", 0, OPTION_TEXT, &a.only, "VALUE,...", "of these values alone", 0, 0},
        {"dashed", 0, OPTION_TEXT, &a.dashed, "COLUMN,...",
         "further columns, drawn dashed in the colours of --y: models beside measurements", 0, 0},
        {"log-x", 0, OPTION_FLAG, &a.log_x, NULL, "a logarithmic scale across", 0, 0},
        {"log-y", 0, OPTION_FLAG, &a.log_y, NULL, "a logarithmic scale upwards", 0, 0},
        {"markers", 0, OPTION_FLAG, &a.markers, NULL, "mark the points", 0, 0},
        {"title", 't', OPTION_TEXT, &a.title, "TEXT", "a headline", 0, 0},
        {"xlabel", 0, OPTION_TEXT, &a.x_label, "TEXT", "below the chart; default the column's heading", 0, 0},
        {"ylabel", 0, OPTION_TEXT, &a.y_label, "TEXT", "beside it; default the heading of a single column", 0,
         0},
        {"width", 'w', OPTION_INTEGER, &a.width, "PX", "width of the chart; default 760", 300, 20000},
        {"help", 'h', OPTION_FLAG, &a.help, NULL, "this", 0, 0},
    };
    const char *file;
    enum dm2_status status =
        parse_arguments(table, sizeof table / sizeof table[0], argc, argv, &a, &file, err);
    if (status != DM2_OK)
        return status;
    if (a.help) {
        print_help("usage: dm2-plot chart FILE.csv --x COLUMN --y COLUMN[,COLUMN...] [options]", table,
                   sizeof table / sizeof table[0]);
        return DM2_OK;
    }
    if (a.x == NULL || a.y == NULL)
        return dm2_fail(err, DM2_USAGE, "--x and --y must name columns of the table");
    if (a.only != NULL && a.by == NULL)
        return dm2_fail(err, DM2_USAGE, "--only chooses values of a column that --by names");
    struct csv csv;
    status = csv_read(file, &csv, err);
    if (status != DM2_OK)
        return status;
    char *own = a.out == NULL ? default_output(file) : NULL, *list = text_join(a.y, "", "");
    char *dashed = a.dashed == NULL ? NULL : text_join(a.dashed, "", "");
    const char *out = a.out == NULL ? own : a.out;
    if (out == NULL || list == NULL || (a.dashed != NULL && dashed == NULL))
        status = dm2_fail(err, DM2_MEMORY, "no memory for a file name");
    else
        status = draw_chart(&csv, &a, list, dashed, out, err);
    if (status == DM2_OK && strcmp(out, "-") != 0)
        printf("%s\n", out);
    free(own);
    free(list);
    free(dashed);
    csv_free(&csv);
    return status;
}

/* The exit status: 1 for DM2_PROTOCOL, for which dm2_exit_code gives 3, because a file that does not
 * decode is no failure of the network. */
static int exit_status(enum dm2_status status)
{
    return status == DM2_PROTOCOL ? 1 : dm2_exit_code(status);
}

int main(int argc, char **argv)
{
    struct dm2_error err = {0};
    const char *command = argc > 1 ? argv[1] : "";
    enum dm2_status status = DM2_OK;
    process_start();
    (void)signal(SIGXFSZ, SIG_IGN); /* an exceeded file size limit becomes an error of write */
    if (strcmp(command, "-h") == 0 || strcmp(command, "--help") == 0) {
        fputs(usage, stdout);
    } else if (strcmp(command, "--version") == 0) {
        puts("dm2-plot " DM2_VERSION);
    } else if (self_test_check(&err) != DM2_OK) {
        fprintf(stderr, "dm2-plot: %s\n", err.text);
        return process_finish("dm2-plot", dm2_exit_code(err.status), true);
    } else if (strcmp(command, "snapshot") == 0)
        status = snapshot_command(argc - 1, argv + 1, &err);
    else if (strcmp(command, "chart") == 0)
        status = chart_command(argc - 1, argv + 1, &err);
    else
        status = dm2_fail(&err, DM2_USAGE, "'%s' is no command; snapshot and chart are", command);
    if (status != DM2_OK)
        fprintf(stderr, "dm2-plot: %s\n%s", err.text, status == DM2_USAGE && command[0] == '\0' ? usage : "");
    return process_finish("dm2-plot", exit_status(status), true);
}
