/* Comma-separated values.
 *
 * The parser unquotes the text into one buffer of the same length, which suffices because unquoting never
 * lengthens a field. Fields are pointers into the buffer, in row order behind the headings. */
#include "dm2/base/csv.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/base/text.h"

enum { CSV_BYTES_MAX = 1 << 30 };

struct csv_parser {
    const char *in, *end;
    char *out;
    size_t line; /* of the reading position */
    struct csv *csv;
    size_t n_fields, cap_fields, cap_rows;
};

static enum dm2_status fault(const struct csv_parser *p, struct dm2_error *err, const char *what)
{
    return dm2_fail(err, DM2_PROTOCOL, "%s:%zu: %s", p->csv->path, p->line, what);
}

static enum dm2_status no_memory(const struct csv *csv, struct dm2_error *err)
{
    return dm2_fail(err, DM2_MEMORY, "%s: no memory for the table", csv->path == NULL ? "csv" : csv->path);
}

static bool at_line_end(const struct csv_parser *p)
{
    return p->in == p->end || *p->in == '\n' || (*p->in == '\r' && p->in + 1 < p->end && p->in[1] == '\n');
}

static enum dm2_status unquote(struct csv_parser *p, struct dm2_error *err)
{
    p->in++;
    for (;;) {
        if (p->in == p->end)
            return fault(p, err, "a quote is not closed");
        char c = *p->in++;
        if (c == '"' && (p->in == p->end || *p->in != '"'))
            break;
        if (c == '"')
            p->in++;
        p->line += c == '\n' ? 1 : 0;
        *p->out++ = c;
    }
    if (!at_line_end(p) && *p->in != ',')
        return fault(p, err, "a comma was expected after the closing quote");
    return DM2_OK;
}

static enum dm2_status parse_field(struct csv_parser *p, struct dm2_error *err)
{
    struct csv *csv = p->csv;
    char **fields = mem_grown(csv->fields, &p->cap_fields, p->n_fields, p->n_fields + 1, sizeof *fields);
    if (fields == NULL)
        return no_memory(csv, err);
    csv->fields = fields;
    csv->fields[p->n_fields++] = p->out;
    if (p->in < p->end && *p->in == '"') {
        enum dm2_status status = unquote(p, err);
        if (status != DM2_OK)
            return status;
    } else {
        while (!at_line_end(p) && *p->in != ',')
            *p->out++ = *p->in++;
    }
    return DM2_OK;
}

/* Parses one line into fields; the terminators take the places of the commas and the line end. */
static enum dm2_status parse_row(struct csv_parser *p, size_t *count, struct dm2_error *err)
{
    *count = 0;
    for (;;) {
        enum dm2_status status = parse_field(p, err);
        if (status != DM2_OK)
            return status;
        ++*count;
        bool more = p->in < p->end && *p->in == ',';
        if (!more && p->in < p->end)
            p->in += *p->in == '\r' ? 2 : 1;
        else if (more)
            p->in++;
        *p->out++ = '\0';
        if (!more)
            return DM2_OK;
    }
}

static enum dm2_status parse_rows(struct csv_parser *p, struct dm2_error *err)
{
    struct csv *csv = p->csv;
    while (p->in < p->end) {
        size_t count, line = p->line;
        enum dm2_status status = parse_row(p, &count, err);
        if (status != DM2_OK)
            return status;
        if (csv->n_columns == 0) {
            csv->n_columns = count;
        } else if (count != csv->n_columns) {
            return dm2_fail(err, DM2_PROTOCOL, "%s:%zu: the row has %zu fields, the header has %zu",
                            csv->path, line, count, csv->n_columns);
        } else {
            size_t *lines = mem_grown(csv->lines, &p->cap_rows, csv->n_rows, csv->n_rows + 1, sizeof *lines);
            if (lines == NULL)
                return no_memory(csv, err);
            csv->lines = lines;
            csv->lines[csv->n_rows++] = line;
        }
        p->line++;
    }
    return DM2_OK;
}

enum dm2_status csv_parse(const char *name, const char *text, size_t length, struct csv *out,
                          struct dm2_error *err)
{
    memset(out, 0, sizeof *out);
    out->path = text_join(name, "", "");
    out->text = malloc(length + 1);
    if (out->path == NULL || out->text == NULL) {
        csv_free(out);
        return no_memory(out, err);
    }
    struct csv_parser p = {.in = text, .end = text + length, .out = out->text, .line = 1, .csv = out};
    enum dm2_status status = DM2_OK;
    if (length == 0)
        status = fault(&p, err, "the file is empty, a header line was expected");
    else if (memchr(text, '\0', length) != NULL)
        status = fault(&p, err, "the file has a NUL byte, so it is no table of text");
    if (status == DM2_OK)
        status = parse_rows(&p, err);
    if (status != DM2_OK)
        csv_free(out);
    return status;
}

enum dm2_status csv_read(const char *path, struct csv *out, struct dm2_error *err)
{
    unsigned char *bytes;
    size_t n;
    memset(out, 0, sizeof *out);
    enum dm2_status status = file_read(path, CSV_BYTES_MAX, &bytes, &n, err);
    if (status != DM2_OK)
        return status;
    size_t mark = text_mark((const char *)bytes, n);
    status = csv_parse(path, (const char *)bytes + mark, n - mark, out, err);
    free(bytes);
    return status;
}

void csv_free(struct csv *csv)
{
    free(csv->path);
    free(csv->text);
    free(csv->fields);
    free(csv->lines);
    memset(csv, 0, sizeof *csv);
}

const char *csv_heading(const struct csv *csv, size_t column)
{
    return csv->fields[column];
}

const char *csv_field(const struct csv *csv, size_t row, size_t column)
{
    return csv->fields[(row + 1) * csv->n_columns + column];
}

static bool is_named(const char *heading, const char *name)
{
    size_t n = strlen(name);
    return strncmp(heading, name, n) == 0 && (heading[n] == '\0' || strncmp(heading + n, " [", 2) == 0);
}

enum dm2_status csv_column(const struct csv *csv, const char *name, size_t *column, struct dm2_error *err)
{
    char list[400] = "";
    size_t used = 0;
    for (size_t c = 0; c < csv->n_columns; c++) {
        const char *heading = csv_heading(csv, c);
        if (is_named(heading, name)) {
            *column = c;
            return DM2_OK;
        }
        int wrote = snprintf(list + used, sizeof list - used, "%s%s", c == 0 ? "" : ", ", heading);
        used = wrote < 0 || (size_t)wrote >= sizeof list - used ? sizeof list - 1 : used + (size_t)wrote;
    }
    return dm2_fail(err, DM2_USAGE, "%s: has no column '%s'; it has: %s", csv->path, name, list);
}

enum dm2_status csv_numbers(const struct csv *csv, size_t column, double **out, struct dm2_error *err)
{
    double *values = mem_zalloc(csv->n_rows, sizeof *values);
    if (values == NULL)
        return no_memory(csv, err);
    for (size_t row = 0; row < csv->n_rows; row++) {
        const char *text = csv_field(csv, row, column);
        if (!number_parse(text, strlen(text), &values[row])) {
            free(values);
            return dm2_fail(err, DM2_PROTOCOL, "%s:%zu: '%.60s' in column '%s' is not a number", csv->path,
                            csv->lines[row], text, csv_heading(csv, column));
        }
    }
    *out = values;
    return DM2_OK;
}

static void put(char *out, size_t size, size_t *n, char c)
{
    if (*n + 1 < size)
        out[*n] = c;
    ++*n;
}

size_t csv_quote(const char *text, char *out, size_t size)
{
    bool quoted = strpbrk(text, ",\"\r\n") != NULL;
    size_t n = 0;
    if (quoted)
        put(out, size, &n, '"');
    for (const char *c = text; *c != '\0'; c++) {
        if (*c == '"')
            put(out, size, &n, '"');
        put(out, size, &n, *c);
    }
    if (quoted)
        put(out, size, &n, '"');
    if (size > 0)
        out[n < size ? n : size - 1] = '\0';
    return n;
}
