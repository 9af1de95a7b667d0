/* Tables as comma-separated values (RFC 4180): a header line, then rows with the same number of fields. */
#ifndef DM2_BASE_CSV_H
#define DM2_BASE_CSV_H

#include <stddef.h>

#include "dm2/base/status.h"

struct csv {
    char *path; /* for messages */
    char *text; /* the unquoted fields, each NUL-terminated */
    size_t n_columns, n_rows;
    char **fields; /* n_columns headings, then n_rows * n_columns fields */
    size_t *lines; /* line of each row in the file, from 1 */
};

/* Reads a file of at most 1 GiB. DM2_IO; DM2_MEMORY; DM2_PROTOCOL with path:line where a row has another
 * number of fields than the header, a quote is not closed, text follows a closing quote, the file has a NUL
 * byte or no header. Lines may end in CR LF; the end of the file after a line end is no row. The caller frees
 * *out with csv_free; after a failure there is nothing to free. */
enum dm2_status csv_read(const char *path, struct csv *out, struct dm2_error *err);

/* csv_read from a copy of text[0 .. length); `name` is the name of the table in messages. */
enum dm2_status csv_parse(const char *name, const char *text, size_t length, struct csv *out,
                          struct dm2_error *err);
void csv_free(struct csv *csv);

/* The heading of a column; the field of a row and a column. Rows and columns count from 0. */
const char *csv_heading(const struct csv *csv, size_t column);
const char *csv_field(const struct csv *csv, size_t row, size_t column);

/* The column whose heading is `name`, or `name` followed by a unit, as in "time [us]". DM2_USAGE, with the
 * list of headings, where no column has the name. */
enum dm2_status csv_column(const struct csv *csv, const char *name, size_t *column, struct dm2_error *err);

/* The n_rows numbers of a column, malloc'd; the caller frees *out. DM2_MEMORY; DM2_PROTOCOL with path:line
 * where a field is not a number. */
enum dm2_status csv_numbers(const struct csv *csv, size_t column, double **out, struct dm2_error *err);

/* Writes `text` as one field into out[0 .. size), quoted where needed. Returns the length of the whole field
 * without the NUL; where that is `size` or more, `out` has the first size - 1 bytes. */
size_t csv_quote(const char *text, char *out, size_t size);

#endif
