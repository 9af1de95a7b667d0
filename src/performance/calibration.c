/* The calibration file.
 *
 * The file is a table `quantity,servers,value,unit` with one number in each row, which a person and a
 * spreadsheet can read. The first row is the number of the format. `servers` is empty in the rows of
 * constants. m, b and residual occur once for each measured number of servers; size, k_alone and k_shared
 * occur once for each size.
 *
 * The reader goes through the rows once and records which quantities were there. Unknown, repeated and
 * missing quantities and other units are refused. A file of another host or version is refused as well,
 * because its constants would give wrong predictions without a sign of it. */
#include "dm2/performance/calibration.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/csv.h"
#include "dm2/base/file.h"
#include "dm2/base/number.h"

enum { COLUMNS = 4, SCALARS = 9 };

static const char *const HEADINGS[COLUMNS] = {"quantity", "servers", "value", "unit"};

/* The constants that do not depend on the number of servers: name, unit, address of the value. */
struct scalar {
    const char *name, *unit;
    double *value;
};

static void list_scalars(struct calibration *c, double *sizes, double *networks, struct scalar out[SCALARS])
{
    const struct scalar all[SCALARS] = {
        {"d_x", "cm", &c->perf.d_x},     {"d_y", "cm", &c->perf.d_y}, {"L_x", "cm", &c->perf.l_x},
        {"L_y", "cm", &c->perf.l_y},     {"g", "byte", &c->perf.g},   {"k", "s", &c->perf.k},
        {"k_spread", "s", &c->k_spread}, {"sizes", "", sizes},        {"networks", "", networks},
    };
    memcpy(out, all, sizeof all);
}

static enum dm2_status check_text(const char *what, const char *text, struct dm2_error *err)
{
    for (const char *p = text; *p != '\0'; p++)
        if ((unsigned char)*p < ' ' || *p == 0x7f)
            return dm2_fail(err, DM2_USAGE, "the calibration's %s has control characters", what);
    if (text[0] == '\0')
        return dm2_fail(err, DM2_USAGE, "the calibration has no %s", what);
    return DM2_OK;
}

static enum dm2_status check_spread(const char *what, double x, struct dm2_error *err)
{
    if (x >= 0 && isfinite(x))
        return DM2_OK;
    return dm2_fail(err, DM2_USAGE, "%s = %g s: a number of at least 0 is expected", what, x);
}

static enum dm2_status check_calibration(const struct calibration *c, struct dm2_error *err)
{
    enum dm2_status status = check_text("host", c->host, err);
    if (status == DM2_OK)
        status = check_text("version", c->version, err);
    if (status == DM2_OK)
        status = perf_check(&c->perf, err);
    if (status == DM2_OK)
        status = check_spread("k_spread", c->k_spread, err);
    for (size_t i = 0; status == DM2_OK && i < c->perf.n_network; i++)
        status = check_spread("residual", c->residual[i], err);
    return status;
}

/* --- writing --- */

static void put_text(struct file_out *f, const char *quantity, const char *text)
{
    char quoted[2 * CALIBRATION_TEXT_MAX + 3];
    (void)csv_quote(text, quoted, sizeof quoted);
    file_printf(f, "%s,,%s,\n", quantity, quoted);
}

static void put_number(struct file_out *f, const char *quantity, int servers, double value, const char *unit)
{
    char text[NUMBER_TEXT_MAX];
    (void)number_format(value, text);
    if (servers > 0)
        file_printf(f, "%s,%d,%s,%s\n", quantity, servers, text, unit);
    else
        file_printf(f, "%s,,%s,%s\n", quantity, text, unit);
}

enum dm2_status calibration_write(const char *path, const struct calibration *c, struct dm2_error *err)
{
    struct calibration copy = *c;
    double sizes = (double)c->perf.n_size, networks = (double)c->perf.n_network;
    struct scalar scalars[SCALARS];
    struct file_out f;
    enum dm2_status status = check_calibration(c, err);
    if (status == DM2_OK)
        status = file_create(&f, path, err);
    if (status != DM2_OK)
        return status;
    list_scalars(&copy, &sizes, &networks, scalars);
    file_puts(&f, "quantity,servers,value,unit\n");
    put_number(&f, "format", 0, CALIBRATION_FORMAT, "");
    put_text(&f, "host", c->host);
    put_text(&f, "version", c->version);
    for (int i = 0; i < SCALARS; i++)
        put_number(&f, scalars[i].name, 0, *scalars[i].value, scalars[i].unit);
    for (size_t i = 0; i < c->perf.n_size; i++) {
        put_number(&f, "size", 0, c->perf.size[i].n, "");
        put_number(&f, "k_alone", 0, c->perf.size[i].alone, "s");
        put_number(&f, "k_shared", 0, c->perf.size[i].shared, "s");
    }
    for (size_t i = 0; i < c->perf.n_network; i++) {
        const struct perf_network *row = &c->perf.network[i];
        put_number(&f, "m", row->servers, row->m, "s/byte");
        put_number(&f, "b", row->servers, row->b, "s");
        put_number(&f, "residual", row->servers, c->residual[i], "s");
    }
    return file_commit(&f, err);
}

/* --- reading --- */

struct reader {
    const struct csv *csv;
    size_t row;
    struct calibration *out;
    struct scalar scalars[SCALARS];
    double sizes,
        networks; /* the numbers of sizes and of networks, by which a truncated file is recognised */
    bool seen_format, seen_host, seen_version, seen_scalar[SCALARS];
    struct dm2_error *err;
};

static enum dm2_status fail_row(const struct reader *r, const char *problem)
{
    return dm2_fail(r->err, DM2_DECK, "%s:%zu: '%.40s': %s", r->csv->path, r->csv->lines[r->row],
                    csv_field(r->csv, r->row, 0), problem);
}

static enum dm2_status take_number(const struct reader *r, const char *unit, double *value)
{
    const char *text = csv_field(r->csv, r->row, 2), *has = csv_field(r->csv, r->row, 3);
    char problem[120];
    if (strcmp(has, unit) != 0) {
        (void)snprintf(problem, sizeof problem, "the unit '%s' is expected, not '%.20s'", unit, has);
        return fail_row(r, problem);
    }
    if (!number_parse(text, strlen(text), value) || !isfinite(*value)) {
        (void)snprintf(problem, sizeof problem, "'%.40s' is not a finite number", text);
        return fail_row(r, problem);
    }
    return DM2_OK;
}

static enum dm2_status take_text(const struct reader *r, bool *seen, char out[CALIBRATION_TEXT_MAX])
{
    const char *text = csv_field(r->csv, r->row, 2);
    if (*seen)
        return fail_row(r, "is there twice");
    if (csv_field(r->csv, r->row, 3)[0] != '\0')
        return fail_row(r, "has no unit");
    if (strlen(text) >= CALIBRATION_TEXT_MAX)
        return fail_row(r, "is too long");
    *seen = true;
    memcpy(out, text, strlen(text) + 1);
    return DM2_OK;
}

static enum dm2_status take_format(struct reader *r)
{
    double format;
    if (r->seen_format)
        return fail_row(r, "is there twice");
    r->seen_format = true;
    enum dm2_status status = take_number(r, "", &format);
    if (status == DM2_OK && format != CALIBRATION_FORMAT)
        status = fail_row(r, "this dm2 reads format 2 of the calibration; run dm2-model calibrate again");
    return status;
}

static enum dm2_status take_scalar(struct reader *r, int which)
{
    if (r->seen_scalar[which])
        return fail_row(r, "is there twice");
    r->seen_scalar[which] = true;
    return take_number(r, r->scalars[which].unit, r->scalars[which].value);
}

/* Takes a row size, k_alone or k_shared; the rows must be in this order. */
static enum dm2_status take_size(struct reader *r, const char *quantity)
{
    struct perf *p = &r->out->perf;
    if (strcmp(quantity, "size") == 0) {
        if (p->n_size == PERF_SIZE_MAX)
            return fail_row(r, "there are too many sizes");
        p->size[p->n_size++] = (struct perf_size){.alone = NAN, .shared = NAN};
        return take_number(r, "", &p->size[p->n_size - 1].n);
    }
    if (p->n_size == 0)
        return fail_row(r, "is expected behind its size");
    struct perf_size *last = &p->size[p->n_size - 1];
    double *value = strcmp(quantity, "k_alone") == 0 ? &last->alone : &last->shared;
    return isnan(*value) ? take_number(r, "s", value) : fail_row(r, "is there twice");
}

/* Takes a residual. The row of network with its number of servers must exist, because the rows are in the
 * order m, b, residual. */
static enum dm2_status take_residual(struct reader *r, int servers)
{
    struct perf *p = &r->out->perf;
    if (p->n_network == 0 || p->network[p->n_network - 1].servers != servers)
        return fail_row(r, "is expected behind m and b of the same number of servers");
    double *residual = &r->out->residual[p->n_network - 1];
    return isnan(*residual) ? take_number(r, "s", residual) : fail_row(r, "is there twice");
}

/* Takes a row m, b or residual. The numbers of servers must rise, so that the row is new or is the last
 * one. */
static enum dm2_status take_network(struct reader *r, const char *quantity, const char *servers_text)
{
    struct perf *p = &r->out->perf;
    int64_t servers;
    double value;
    if (!number_parse_integer(servers_text, strlen(servers_text), &servers) || servers < 1 || servers > 65535)
        return fail_row(r, "a number of servers from 1 to 65535 is expected");
    if (strcmp(quantity, "residual") == 0)
        return take_residual(r, (int)servers);
    bool is_b = strcmp(quantity, "b") == 0;
    const struct perf_network *last = p->n_network == 0 ? NULL : &p->network[p->n_network - 1];
    if (last != NULL && servers < last->servers)
        return fail_row(r, "the numbers of servers have to rise");
    if (last != NULL && servers == last->servers && !isnan(is_b ? last->b : last->m))
        return fail_row(r, "is there twice for this number of servers");
    enum dm2_status status = take_number(r, is_b ? "s" : "s/byte", &value);
    if (status == DM2_OK && perf_set_network(p, (int)servers, is_b, value, NULL) != DM2_OK)
        status = fail_row(r, "there are too many numbers of servers");
    return status;
}

static enum dm2_status take_row(struct reader *r)
{
    const char *quantity = csv_field(r->csv, r->row, 0), *servers = csv_field(r->csv, r->row, 1);
    if (strcmp(quantity, "m") == 0 || strcmp(quantity, "b") == 0 || strcmp(quantity, "residual") == 0)
        return take_network(r, quantity, servers);
    if (servers[0] != '\0')
        return fail_row(r, "does not depend on the number of servers");
    if (strcmp(quantity, "format") == 0)
        return take_format(r);
    if (!r->seen_format)
        return fail_row(r, "the first row of a calibration file is its format");
    if (strcmp(quantity, "host") == 0)
        return take_text(r, &r->seen_host, r->out->host);
    if (strcmp(quantity, "version") == 0)
        return take_text(r, &r->seen_version, r->out->version);
    if (strcmp(quantity, "size") == 0 || strcmp(quantity, "k_alone") == 0 ||
        strcmp(quantity, "k_shared") == 0)
        return take_size(r, quantity);
    for (int i = 0; i < SCALARS; i++)
        if (strcmp(quantity, r->scalars[i].name) == 0)
            return take_scalar(r, i);
    return fail_row(r, "is not a quantity of a calibration file");
}

static enum dm2_status check_complete(const struct reader *r)
{
    const char *missing = !r->seen_format    ? "format"
                          : !r->seen_host    ? "host"
                          : !r->seen_version ? "version"
                                             : NULL;
    for (int i = 0; missing == NULL && i < SCALARS; i++)
        missing = r->seen_scalar[i] ? NULL : r->scalars[i].name;
    for (size_t i = 0; missing == NULL && i < r->out->perf.n_network; i++)
        missing = isnan(r->out->residual[i]) ? "residual" : NULL;
    if (missing != NULL)
        return dm2_fail(r->err, DM2_DECK, "%s: '%s' is missing; run dm2-model calibrate again", r->csv->path,
                        missing);
    if (r->sizes != (double)r->out->perf.n_size)
        return dm2_fail(r->err, DM2_DECK, "%s: k is there for %zu sizes, not for %g as it says", r->csv->path,
                        r->out->perf.n_size, r->sizes);
    if (r->networks != (double)r->out->perf.n_network)
        return dm2_fail(r->err, DM2_DECK,
                        "%s: m and b are there for %zu numbers of servers, not for %g as it says",
                        r->csv->path, r->out->perf.n_network, r->networks);
    for (size_t i = r->out->perf.n_network; i < PERF_NETWORK_MAX; i++)
        r->out->residual[i] = 0;
    struct dm2_error why = {0};
    if (check_calibration(r->out, &why) != DM2_OK)
        return dm2_fail(r->err, DM2_DECK, "%s: %.400s", r->csv->path, why.text);
    return DM2_OK;
}

static enum dm2_status check_origin(const char *name, const struct calibration *c, const char *host,
                                    const char *version, struct dm2_error *err)
{
    if (strcmp(c->host, host) != 0)
        return dm2_fail(
            err, DM2_USAGE,
            "%s: was measured on the host '%.100s', this is '%.100s'; run dm2-model calibrate here", name,
            c->host, host);
    if (strcmp(c->version, version) != 0)
        return dm2_fail(err, DM2_USAGE,
                        "%s: was measured with dm2 %.60s, this is %.60s; run dm2-model calibrate again", name,
                        c->version, version);
    return DM2_OK;
}

static enum dm2_status read_rows(struct reader *r)
{
    bool headings = r->csv->n_columns == COLUMNS;
    for (size_t i = 0; headings && i < COLUMNS; i++)
        headings = strcmp(csv_heading(r->csv, i), HEADINGS[i]) == 0;
    if (!headings)
        return dm2_fail(r->err, DM2_DECK, "%s:1: the headings quantity,servers,value,unit are expected",
                        r->csv->path);
    enum dm2_status status = DM2_OK;
    for (r->row = 0; status == DM2_OK && r->row < r->csv->n_rows; r->row++)
        status = take_row(r);
    return status == DM2_OK ? check_complete(r) : status;
}

enum dm2_status calibration_parse(const char *name, const char *text, size_t length, const char *host,
                                  const char *version, struct calibration *out, struct dm2_error *err)
{
    struct csv csv;
    *out = (struct calibration){0};
    for (size_t i = 0; i < PERF_NETWORK_MAX; i++)
        out->residual[i] = NAN;
    enum dm2_status status = csv_parse(name, text, length, &csv, err);
    if (status == DM2_PROTOCOL) { /* csv_parse reports errors of a peer's data; this is an input file */
        status = DM2_DECK;
        if (err != NULL)
            err->status = DM2_DECK;
    }
    if (status != DM2_OK)
        return status;
    struct reader reader = {.csv = &csv, .out = out, .err = err};
    list_scalars(out, &reader.sizes, &reader.networks, reader.scalars);
    status = read_rows(&reader);
    csv_free(&csv);
    return status == DM2_OK ? check_origin(name, out, host, version, err) : status;
}

enum dm2_status calibration_read(const char *path, const char *host, const char *version,
                                 struct calibration *out, struct dm2_error *err)
{
    unsigned char *bytes;
    size_t length;
    enum dm2_status status = file_read(path, CALIBRATION_BYTES_MAX, &bytes, &length, err);
    if (status != DM2_OK)
        return status;
    status = calibration_parse(path, (const char *)bytes, length, host, version, out, err);
    free(bytes);
    return status;
}
