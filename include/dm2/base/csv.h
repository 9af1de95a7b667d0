/* Tables as comma-separated values (RFC 4180): a header line, then rows with as many fields. */
#ifndef DM2_BASE_CSV_H
#define DM2_BASE_CSV_H

#include <stddef.h>

#include "dm2/base/status.h"

struct csv {
    char *path; /* for messages */
    char *text; /* the unquoted fields, NUL-terminated one by one */
    size_t n_columns, n_rows;
    char **fields; /* n_columns headings, then n_rows * n_columns fields */
    size_t *lines; /* line of each row in the file, from 1 */
};

/* Reads a file of at most 1 GiB. DM2_IO; DM2_MEMORY; DM2_PROTOCOL with path:line where a row has another
 * number of fields than the header, a quote is not closed, text follows a closing quote, a NUL byte is there,
 * or there is no header. Lines may end in CR LF; an empty last line is no row. csv_free it. */
enum dm2_status csv_read(const char *path, struct csv *out, struct dm2_error *err);

/* The same from a copy of text[0..length); `name` is what messages call it. */
enum dm2_status csv_parse(const char *name, const char *text, size_t length, struct csv *out,
                          struct dm2_error *err);
void csv_free(struct csv *csv);

/* The heading of a column; a field of a row, both from 0. */
const char *csv_heading(const struct csv *csv, size_t column);
const char *csv_field(const struct csv *csv, size_t row, size_t column);

/* The column whose heading is `name`, or `name` followed by a unit, as in "time [us]". DM2_USAGE that lists
 * the headings where there is none. */
enum dm2_status csv_column(const struct csv *csv, const char *name, size_t *column, struct dm2_error *err);

/* The numbers of a column, n_rows of them, malloc'd. DM2_PROTOCOL with path:line where a field is not a
 * number. */
enum dm2_status csv_numbers(const struct csv *csv, size_t column, double **out, struct dm2_error *err);

/* Writes `text` as one field into `out`, quoted where it has to be; returns the length without the NUL, or
 * `size` or more where it did not fit (out is cut then). */
size_t csv_quote(const char *text, char *out, size_t size);

#endif
