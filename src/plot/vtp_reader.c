/* The snapshot reader: passes over the XML once, decodes each array at its place, and checks the shapes at
 * the end.
 *
 * The file may come from elsewhere, so no length in it is trusted: the length of an array's text bounds
 * the number of its values, and the piece's counts are only compared with the arrays that were read. */
#include "dm2/plot/vtp_reader.h"

#include <inttypes.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "xml.h"

struct vtp_type {
    const char *name;
    size_t bytes;
    enum { KIND_UNSIGNED, KIND_SIGNED, KIND_FLOAT } kind;
};

static const struct vtp_type number_types[] = {
    {"UInt8", 1, KIND_UNSIGNED},  {"UInt16", 2, KIND_UNSIGNED}, {"UInt32", 4, KIND_UNSIGNED},
    {"UInt64", 8, KIND_UNSIGNED}, {"Int8", 1, KIND_SIGNED},     {"Int16", 2, KIND_SIGNED},
    {"Int32", 4, KIND_SIGNED},    {"Int64", 8, KIND_SIGNED},    {"Float32", 4, KIND_FLOAT},
    {"Float64", 8, KIND_FLOAT},
};

struct vtp_reader {
    struct xml xml;
    struct vtp *vtp;
    size_t cap_arrays;
    char section[16];
    size_t n_verts;
};

static enum dm2_status fail_at_line(const struct vtp_reader *r, struct dm2_error *err, const char *what)
{
    return dm2_fail(err, DM2_PROTOCOL, "%s:%zu: %s", r->xml.path, xml_line(&r->xml), what);
}

static enum dm2_status no_memory(const struct vtp_reader *r, struct dm2_error *err)
{
    return dm2_fail(err, DM2_MEMORY, "%s: no memory for its arrays", r->xml.path);
}

/* --- values --- */

static int base64_digit(unsigned char c)
{
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/* Decodes the whole text, or returns false. `out` has room for length / 4 * 3 bytes. */
static bool base64_decode(const char *text, size_t length, unsigned char *out, size_t *n)
{
    signed char digit[256];
    for (int c = 0; c < 256; c++)
        digit[c] = (signed char)base64_digit((unsigned char)c);
    if (length == 0 || length % 4 != 0)
        return false;
    size_t padding = text[length - 1] != '=' ? 0 : text[length - 2] != '=' ? 1 : 2;
    size_t used = 0;
    for (size_t at = 0; at < length; at += 4) {
        uint32_t bits = 0;
        size_t digits = at + 4 == length ? 4 - padding : 4;
        for (size_t k = 0; k < digits; k++) {
            int value = digit[(unsigned char)text[at + k]];
            if (value < 0)
                return false;
            bits |= (uint32_t)value << (18 - 6 * k);
        }
        for (size_t k = 0; k + 1 < digits; k++)
            out[used++] = (unsigned char)(bits >> (16 - 8 * k));
    }
    *n = used;
    return true;
}

static uint64_t get_bits(const unsigned char *bytes, size_t n)
{
    uint64_t bits = 0;
    for (size_t k = 0; k < n; k++)
        bits |= (uint64_t)bytes[k] << (8 * k);
    return bits;
}

static double get_number(const unsigned char *bytes, const struct vtp_type *type)
{
    uint64_t bits = get_bits(bytes, type->bytes);
    if (type->kind == KIND_UNSIGNED)
        return (double)bits;
    if (type->kind == KIND_SIGNED) {
        unsigned shift = (unsigned)(64 - 8 * type->bytes);
        return (double)((int64_t)(bits << shift) / ((int64_t)1 << shift));
    }
    if (type->bytes == 4) {
        uint32_t low = (uint32_t)bits;
        float x;
        memcpy(&x, &low, sizeof x);
        return (double)x;
    }
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static struct xml_span trim_blanks(struct xml_span s)
{
    static const char blanks[] = " \t\r\n";
    while (s.length > 0 && strchr(blanks, s.at[0]) != NULL) {
        s.at++;
        s.length--;
    }
    while (s.length > 0 && strchr(blanks, s.at[s.length - 1]) != NULL)
        s.length--;
    return s;
}

static enum dm2_status read_binary(struct vtp_reader *r, struct xml_span text, const struct vtp_type *type,
                                   double **values, size_t *n, struct dm2_error *err)
{
    unsigned char *bytes = malloc(text.length / 4 * 3 + 1);
    size_t length = 0;
    if (bytes == NULL)
        return no_memory(r, err);
    enum dm2_status status = DM2_OK;
    if (!base64_decode(text.at, text.length, bytes, &length))
        status = fail_at_line(r, err, "an array that is not base64");
    else if (length < 8 || get_bits(bytes, 8) != length - 8 || (length - 8) % type->bytes != 0)
        status = fail_at_line(r, err, "an array whose length is not the one that it announces");
    if (status == DM2_OK) {
        *n = (length - 8) / type->bytes;
        *values = mem_alloc(*n, sizeof **values);
        if (*values == NULL)
            status = no_memory(r, err);
        for (size_t i = 0; status == DM2_OK && i < *n; i++)
            (*values)[i] = get_number(bytes + 8 + i * type->bytes, type);
    }
    free(bytes);
    return status;
}

static enum dm2_status read_ascii(struct vtp_reader *r, struct xml_span text, double **values, size_t *n,
                                  struct dm2_error *err)
{
    /* Every value but the last takes a digit and a blank. */
    *values = mem_alloc(text.length / 2 + 1, sizeof **values);
    *n = 0;
    if (*values == NULL)
        return no_memory(r, err);
    const char *at = text.at, *end = text.at + text.length;
    while (at < end) {
        const char *word = at;
        while (at < end && strchr(" \t\r\n", *at) == NULL)
            at++;
        if (at > word && !number_parse(word, (size_t)(at - word), &(*values)[(*n)++])) {
            free(*values);
            *values = NULL;
            return fail_at_line(r, err, "an array with a word that is no number");
        }
        at += at < end ? 1 : 0;
    }
    return DM2_OK;
}

/* --- elements --- */

/* Reads strings as VTK writes them: the characters as numbers, a 0 after each string. */
static enum dm2_status take_names(struct vtp_reader *r, const double *codes, size_t n, struct vtp_names *out,
                                  struct dm2_error *err)
{
    size_t count = 0, at = 0;
    for (size_t i = 0; i < n; i++) {
        if (!(codes[i] >= 0 && codes[i] < 256))
            return fail_at_line(r, err, "a string with a character that is none");
        count += codes[i] == 0 ? 1 : 0;
    }
    if (n > 0 && codes[n - 1] != 0)
        return fail_at_line(r, err, "a string that does not end");
    out->name = mem_zalloc(count, sizeof *out->name);
    if (out->name == NULL)
        return no_memory(r, err);
    for (out->n = 0; out->n < count; out->n++) {
        size_t length = 0;
        while (codes[at + length] != 0)
            length++;
        char *name = out->name[out->n] = malloc(length + 1);
        if (name == NULL)
            return no_memory(r, err);
        for (size_t k = 0; k <= length; k++)
            name[k] = (char)(unsigned char)codes[at + k];
        at += length + 1;
    }
    return DM2_OK;
}

static bool attribute_count(const struct xml *x, const char *name, size_t otherwise, size_t *out)
{
    struct xml_span span = xml_attribute(x, name);
    int64_t value;
    *out = otherwise;
    if (span.at == NULL)
        return true;
    if (!number_parse_integer(span.at, span.length, &value) || value < 0)
        return false;
    *out = (size_t)value;
    return true;
}

static void free_names(struct vtp_names *names)
{
    for (size_t i = 0; names->name != NULL && i < names->n; i++)
        free(names->name[i]);
    free(names->name);
    memset(names, 0, sizeof *names);
}

static enum dm2_status keep_array(struct vtp_reader *r, const struct vtp_array *array, struct dm2_error *err)
{
    struct vtp *vtp = r->vtp;
    struct vtp_array *grown =
        mem_grown(vtp->arrays, &r->cap_arrays, vtp->n_arrays, vtp->n_arrays + 1, sizeof *grown);
    if (grown == NULL)
        return no_memory(r, err);
    vtp->arrays = grown;
    vtp->arrays[vtp->n_arrays++] = *array;
    return DM2_OK;
}

/* Reads the text of the element that just began, up to its end tag. */
static enum dm2_status take_text(struct vtp_reader *r, struct xml_span *text, struct dm2_error *err)
{
    *text = (struct xml_span){"", 0};
    enum xml_event event = xml_next(&r->xml, err);
    if (event == XML_TEXT) {
        *text = trim_blanks(r->xml.text);
        event = xml_next(&r->xml, err);
    }
    if (event == XML_ERROR)
        return DM2_PROTOCOL;
    return event == XML_END ? DM2_OK
                            : fail_at_line(r, err, "an array with something else than its values inside");
}

static enum dm2_status take_strings(struct vtp_reader *r, const char *name, struct xml_span format,
                                    struct dm2_error *err)
{
    struct xml_span text;
    double *codes;
    size_t n;
    struct vtp_names *names = strcmp(name, "materials") == 0 ? &r->vtp->materials
                              : strcmp(name, "bodies") == 0  ? &r->vtp->bodies
                              : strcmp(name, "walls") == 0   ? &r->vtp->walls
                                                             : NULL;
    bool ascii = xml_is(format, "ascii");
    enum dm2_status status = take_text(r, &text, err);
    if (status != DM2_OK || names == NULL || names->name != NULL)
        return status;
    if (!ascii)
        return fail_at_line(r, err, "an array of strings in another format than ascii");
    status = read_ascii(r, text, &codes, &n, err);
    if (status != DM2_OK)
        return status;
    status = take_names(r, codes, n, names, err);
    free(codes);
    return status;
}

static enum dm2_status take_array(struct vtp_reader *r, struct dm2_error *err)
{
    struct vtp_array array = {.components = 1};
    struct xml_span name = xml_attribute(&r->xml, "Name"), type = xml_attribute(&r->xml, "type");
    struct xml_span format = xml_attribute(&r->xml, "format"), text;
    if (name.at == NULL || name.length >= sizeof array.name)
        return fail_at_line(r, err, "an array without a name, or with one that is too long");
    memcpy(array.name, name.at, name.length);
    memcpy(array.section, r->section, sizeof array.section);
    if (xml_is(r->xml.name, "Array"))
        return take_strings(r, array.name, format, err);
    const struct vtp_type *number = NULL;
    for (size_t i = 0; i < sizeof number_types / sizeof number_types[0]; i++)
        if (xml_is(type, number_types[i].name))
            number = &number_types[i];
    if (number == NULL)
        return fail_at_line(r, err, "an array of an unknown type");
    bool binary = xml_is(format, "binary");
    if (!binary && !xml_is(format, "ascii"))
        return fail_at_line(r, err, "an array in another format than binary or ascii");
    if (!attribute_count(&r->xml, "NumberOfComponents", 1, &array.components) || array.components == 0)
        return fail_at_line(r, err, "an array with a wrong number of components");
    enum dm2_status status = take_text(r, &text, err);
    size_t n;
    if (status == DM2_OK)
        status = binary ? read_binary(r, text, number, &array.values, &n, err)
                        : read_ascii(r, text, &array.values, &n, err);
    if (status != DM2_OK)
        return status;
    array.n_tuples = n / array.components;
    status = n % array.components != 0 ? fail_at_line(r, err, "an array that does not fill its last tuple")
                                       : keep_array(r, &array, err);
    if (status != DM2_OK)
        free(array.values);
    return status;
}

static enum dm2_status take_start(struct vtp_reader *r, struct dm2_error *err)
{
    struct xml *x = &r->xml;
    if (x->depth == 1) {
        if (!xml_is(x->name, "VTKFile") || !xml_is(xml_attribute(x, "type"), "PolyData"))
            return fail_at_line(r, err, "a VTKFile of type PolyData was expected");
        if (!xml_is(xml_attribute(x, "byte_order"), "LittleEndian") ||
            !xml_is(xml_attribute(x, "header_type"), "UInt64") || xml_attribute(x, "compressor").at != NULL)
            return fail_at_line(r, err,
                                "only little-endian files with UInt64 headers and no compressor can be read");
    } else if (xml_is(x->name, "Piece")) {
        if (r->vtp->position != NULL || r->vtp->n_points != 0)
            return fail_at_line(r, err, "a second piece; only one can be read");
        if (!attribute_count(x, "NumberOfPoints", 0, &r->vtp->n_points) ||
            !attribute_count(x, "NumberOfVerts", r->vtp->n_points, &r->n_verts) ||
            !attribute_count(x, "NumberOfLines", 0, &r->vtp->n_lines))
            return fail_at_line(r, err, "a piece whose counts are no numbers");
    } else if (xml_is(x->name, "DataArray") || xml_is(x->name, "Array")) {
        return take_array(r, err);
    } else if (x->name.length < sizeof r->section) {
        memcpy(r->section, x->name.at, x->name.length);
        r->section[x->name.length] = '\0';
    }
    return DM2_OK;
}

/* --- the whole file --- */

/* Keeps of the lines in `ends` those of linked pairs that have a length; all where the file does not say
 * which pairs are linked. Vertices, one per point, come before the lines in arrays of cells. */
static enum dm2_status keep_links(struct vtp_reader *r, double *ends, struct dm2_error *err)
{
    struct vtp *vtp = r->vtp;
    const struct vtp_array *linked = vtp_find(vtp, "CellData", "linked");
    size_t kept = 0;
    if (linked == NULL)
        return DM2_OK;
    if (linked->components != 1 || linked->n_tuples < vtp->n_lines ||
        linked->n_tuples - vtp->n_lines != vtp->n_points + vtp->walls.n)
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s: the array 'linked' has %zu tuples for %zu vertices and %zu lines", r->xml.path,
                        linked->n_tuples, vtp->n_points, vtp->n_lines);
    for (size_t k = 0; k < vtp->n_lines; k++) {
        if (linked->values[vtp->n_points + k] == 0.0 || ends[2 * k] == ends[2 * k + 1])
            continue;
        ends[2 * kept] = ends[2 * k];
        ends[2 * kept++ + 1] = ends[2 * k + 1];
    }
    vtp->n_lines = kept;
    return DM2_OK;
}

/* The last lines are the polylines of walls, one per name. */
static enum dm2_status take_walls(struct vtp_reader *r, const double *ends, const double *offsets,
                                  struct dm2_error *err)
{
    struct vtp *vtp = r->vtp;
    if (vtp->walls.n > vtp->n_lines)
        return dm2_fail(err, DM2_PROTOCOL, "%s: has %zu walls and %zu lines", r->xml.path, vtp->walls.n,
                        vtp->n_lines);
    vtp->n_lines -= vtp->walls.n;
    vtp->outline = ends;
    vtp->outline_end = offsets + vtp->n_lines;
    vtp->outline_start = 2 * vtp->n_lines;
    return DM2_OK;
}

static enum dm2_status check_lines(struct vtp_reader *r, size_t points, struct dm2_error *err)
{
    struct vtp *vtp = r->vtp;
    const struct vtp_array *ends = vtp_find(vtp, "Lines", "connectivity"),
                           *offsets = vtp_find(vtp, "Lines", "offsets");
    const size_t lines = vtp->n_lines;
    if (lines == 0 && vtp->walls.n == 0)
        return DM2_OK;
    if (ends == NULL || offsets == NULL || offsets->n_tuples != lines)
        return dm2_fail(err, DM2_PROTOCOL, "%s: has not the two points for each of its %zu lines",
                        r->xml.path, lines);
    enum dm2_status status = take_walls(r, ends->values, offsets->values, err);
    if (status != DM2_OK)
        return status;
    for (size_t i = 0; i < vtp->n_lines; i++)
        if (offsets->values[i] != 2.0 * (double)(i + 1))
            return dm2_fail(err, DM2_PROTOCOL, "%s: line %zu has not two points", r->xml.path, i);
    double last = (double)vtp->outline_start;
    for (size_t i = vtp->n_lines; i < lines; last = offsets->values[i++])
        if (!(offsets->values[i] >= last + 2.0))
            return dm2_fail(err, DM2_PROTOCOL, "%s: wall %zu has not two points", r->xml.path,
                            i - vtp->n_lines);
    if (last != (double)ends->n_tuples)
        return dm2_fail(err, DM2_PROTOCOL, "%s: has not the two points for each of its %zu lines",
                        r->xml.path, lines);
    for (size_t i = 0; i < ends->n_tuples; i++)
        if (!(ends->values[i] >= 0 && ends->values[i] < (double)points))
            return dm2_fail(err, DM2_PROTOCOL, "%s: line %zu names point %.15g of %zu", r->xml.path, i / 2,
                            ends->values[i], points);
    vtp->line = ends->values;
    return keep_links(r, ends->values, err);
}

static enum dm2_status check_shapes(struct vtp_reader *r, struct dm2_error *err)
{
    struct vtp *vtp = r->vtp;
    for (size_t i = 0; i < vtp->n_arrays; i++) {
        const struct vtp_array *a = &vtp->arrays[i];
        bool points = strcmp(a->section, "Points") == 0;
        if ((points || strcmp(a->section, "PointData") == 0) && a->n_tuples != vtp->n_points)
            return dm2_fail(err, DM2_PROTOCOL, "%s: the array '%s' has %zu tuples for %zu points",
                            r->xml.path, a->name, a->n_tuples, vtp->n_points);
        if (points && a->components == 3)
            vtp->position = a->values;
    }
    if (vtp->position == NULL)
        return dm2_fail(err, DM2_PROTOCOL, "%s: has no points with three components", r->xml.path);
    for (size_t i = 0; i < 3 * vtp->n_points; i++)
        if (!isfinite(vtp->position[i]))
            return dm2_fail(err, DM2_PROTOCOL, "%s: point %zu is not at a finite position", r->xml.path,
                            i / 3);
    const size_t points = vtp->n_points;
    if (vtp->walls.n > 0 && r->n_verts > points)
        return dm2_fail(err, DM2_PROTOCOL, "%s: has %zu points for %zu vertices", r->xml.path, points,
                        r->n_verts);
    if (vtp->walls.n > 0)
        vtp->n_points = r->n_verts;
    return check_lines(r, points, err);
}

static enum dm2_status read_events(struct vtp_reader *r, struct dm2_error *err)
{
    for (;;) {
        enum dm2_status status = DM2_OK;
        switch (xml_next(&r->xml, err)) {
        case XML_START:
            status = take_start(r, err);
            break;
        case XML_ERROR:
            return DM2_PROTOCOL;
        case XML_DONE:
            return check_shapes(r, err);
        case XML_END:
        case XML_TEXT:
            break;
        }
        if (status != DM2_OK)
            return status;
    }
}

enum dm2_status vtp_read(const char *path, struct vtp *out, struct dm2_error *err)
{
    unsigned char *bytes;
    size_t n;
    memset(out, 0, sizeof *out);
    enum dm2_status status = file_read(path, SIZE_MAX / 8, &bytes, &n, err);
    if (status != DM2_OK)
        return status;
    struct vtp_reader r = {.vtp = out};
    xml_open(&r.xml, path, (const char *)bytes, n);
    status = read_events(&r, err);
    free(bytes);
    if (status != DM2_OK)
        vtp_free(out);
    return status;
}

void vtp_free(struct vtp *vtp)
{
    for (size_t i = 0; i < vtp->n_arrays; i++)
        free(vtp->arrays[i].values);
    free(vtp->arrays);
    free_names(&vtp->materials);
    free_names(&vtp->bodies);
    free_names(&vtp->walls);
    memset(vtp, 0, sizeof *vtp);
}

const struct vtp_array *vtp_find(const struct vtp *vtp, const char *section, const char *name)
{
    for (size_t i = 0; i < vtp->n_arrays; i++)
        if (strcmp(vtp->arrays[i].section, section) == 0 && strcmp(vtp->arrays[i].name, name) == 0)
            return &vtp->arrays[i];
    return NULL;
}

double vtp_value(const struct vtp *vtp, const char *name, double otherwise)
{
    const struct vtp_array *a = vtp_find(vtp, "FieldData", name);
    return a != NULL && a->n_tuples > 0 ? a->values[0] : otherwise;
}
