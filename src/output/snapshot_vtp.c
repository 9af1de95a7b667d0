/* The .vtp writer. VTK's XML requires array after array, so the writer passes over the elements once per
 * array and sends the values through a base64 encoder, 3072 bytes at a time, into the file's buffer: the
 * state is never copied.
 *
 * VTK facts that are easy to get wrong: an inline binary array is one base64 stream of a UInt64 byte count
 * followed by the values (VTKFile version 1.0 with header_type); an array of strings is an <Array>, and in
 * ascii its characters are numbers with a 0 after each string. */
#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "snapshot_fields.h"

static const struct {
    const char *name;
    size_t bytes;
} type_info[] = {{"UInt8", 1}, {"UInt16", 2}, {"UInt32", 4}, {"Int32", 4}, {"Int64", 8}, {"Float64", 8}};

/* What the file draws: a point per element that is shown, a line per pair with such an element; the feet of
 * contacts with walls, and the walls. */
struct drawing {
    size_t *point, n_shown; /* [n_elements] the point of each element that is shown */
    struct {
        size_t end[2]; /* points */
        size_t pair;
    } * line;
    size_t n_lines;
    const struct wall_force *foot; /* [n_feet], whose points follow those of elements */
    size_t n_feet;
    const struct wall_outlines *outlines; /* whose points follow the feet */
    size_t n_outline;
};

enum { NO_WALL = UINT16_MAX };
static const uint32_t no_element = UINT32_MAX;

static size_t count_points(const struct drawing *d)
{
    return d->n_shown + d->n_feet + d->n_outline;
}

/* A value of a pair. */
struct pair_field {
    const char *name;
    enum number_type type;
    bool is_id;
    double (*get)(const struct pair_record *p, const struct pair_measure *m);
};

/* --- base64 --- */

enum { RAW_BYTES = FILE_RESERVE_MAX / 4 * 3 };

struct base64 {
    struct file_out *file;
    size_t used;
    unsigned char raw[RAW_BYTES];
};

static void base64_flush(struct base64 *b)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t padding = (3 - b->used % 3) % 3, groups = (b->used + padding) / 3;
    memset(b->raw + b->used, 0, padding);
    unsigned char *out = file_reserve(b->file, groups * 4);
    const unsigned char *in = b->raw;
    for (size_t g = 0; g < groups; g++, in += 3) {
        uint32_t bits = (uint32_t)in[0] << 16 | (uint32_t)in[1] << 8 | in[2];
        for (int shift = 18; shift >= 0; shift -= 6)
            *out++ = (unsigned char)digit[bits >> shift & 63];
    }
    for (size_t p = 1; p <= padding; p++)
        out[-(ptrdiff_t)p] = '=';
    file_filled(b->file, groups * 4);
    b->used = 0;
}

/* Appends the low `bytes` bytes of `bits`, the lowest first. RAW_BYTES is a multiple of every width up to
 * 8. */
static inline void base64_put(struct base64 *b, uint64_t bits, size_t bytes)
{
    if (b->used + bytes > RAW_BYTES)
        base64_flush(b);
    for (size_t k = 0; k < bytes; k++)
        b->raw[b->used + k] = (unsigned char)(bits >> (8 * k));
    b->used += bytes;
}

/* The bits of x, of +0 where x is -0. */
static inline uint64_t bits_of(double x)
{
    uint64_t bits;
    x = number_plus_zero(x);
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* --- .vtp --- */

static void open_array(struct base64 *b, const struct snapshot_field *f, size_t n)
{
    file_printf(b->file, "        <DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\"",
                type_info[f->type].name, f->name, f->components);
    for (int c = 0; c < f->components && f->component[c] != NULL; c++)
        file_printf(b->file, " ComponentName%d=\"%s\"", c, f->component[c]);
    file_puts(b->file, " format=\"binary\">");
    base64_put(b, n * (uint64_t)f->components * type_info[f->type].bytes, 8);
}

static void close_array(struct base64 *b)
{
    base64_flush(b);
    file_puts(b->file, "</DataArray>\n");
}

/* The values of a point that is no element: its place, else 0, but for the id. */
static void write_extra(struct base64 *b, const struct snapshot_field *f, const double place[2])
{
    bool is_place = f == &snapshot_position, is_id = strcmp(f->name, "id") == 0;
    for (int c = 0; c < f->components; c++)
        base64_put(b,
                   is_place && c < 2 ? bits_of(place[c])
                   : is_id           ? no_element
                                     : 0,
                   type_info[f->type].bytes);
}

static void write_field(struct base64 *b, const struct snapshot_field *f, const struct snapshot *s,
                        const struct drawing *d)
{
    open_array(b, f, count_points(d));
    for (size_t i = 0; i < s->n_elements; i++) {
        double value[3];
        if (!snapshot_shows(s, i))
            continue;
        f->get(s, i, value);
        for (int c = 0; c < f->components; c++)
            base64_put(b, f->type == TYPE_F64 ? bits_of(value[c]) : (uint64_t)(int64_t)value[c],
                       type_info[f->type].bytes);
    }
    for (size_t k = 0; k < d->n_feet; k++)
        write_extra(b, f, d->foot[k].foot);
    for (size_t k = 0; k < d->n_outline; k++)
        write_extra(b, f, d->outlines->point[k]);
    close_array(b);
}

static const struct snapshot_field connectivity[] = {
    {"connectivity", NULL, TYPE_I32, 1, {NULL, NULL, NULL}, NULL, NULL},
    {"connectivity", NULL, TYPE_I64, 1, {NULL, NULL, NULL}, NULL, NULL}};
static const struct snapshot_field offsets[] = {
    {"offsets", NULL, TYPE_I32, 1, {NULL, NULL, NULL}, NULL, NULL},
    {"offsets", NULL, TYPE_I64, 1, {NULL, NULL, NULL}, NULL, NULL}};

/* Vertices and lines are a third of the file, so their indices are 32 bits wide where they fit. */
static bool is_long(size_t largest)
{
    return largest > INT32_MAX;
}

/* Offsets of n vertices or lines with `points` points each, then of the walls' polylines. */
static void write_offsets(struct base64 *b, size_t n, size_t points, const struct wall_outlines *walls)
{
    size_t n_walls = walls != NULL ? walls->n_walls : 0, last = n_walls > 0 ? walls->start[n_walls] : 0;
    const struct snapshot_field *f = &offsets[is_long(n * points + last)];
    open_array(b, f, n + n_walls);
    for (size_t i = 1; i <= n; i++)
        base64_put(b, (uint64_t)(i * points), type_info[f->type].bytes);
    for (size_t k = 1; k <= n_walls; k++)
        base64_put(b, (uint64_t)(n * points + walls->start[k]), type_info[f->type].bytes);
    close_array(b);
}

static void write_vertices(struct base64 *b, size_t n)
{
    file_puts(b->file, "      <Verts>\n");
    const struct snapshot_field *f = &connectivity[is_long(n)];
    open_array(b, f, n);
    for (size_t i = 0; i < n; i++)
        base64_put(b, (uint64_t)i, type_info[f->type].bytes);
    close_array(b);
    write_offsets(b, n, 1, NULL);
    file_puts(b->file, "      </Verts>\n");
}

static void write_lines(struct base64 *b, const struct snapshot *s, const struct drawing *d)
{
    const struct snapshot_field *f = &connectivity[is_long(count_points(d))];
    const size_t width = type_info[f->type].bytes;
    file_puts(b->file, "      <Lines>\n");
    open_array(b, f, 2 * (d->n_lines + d->n_feet) + d->n_outline);
    for (size_t k = 0; k < d->n_lines; k++) {
        base64_put(b, d->line[k].end[0], width);
        base64_put(b, d->line[k].end[1], width);
    }
    for (size_t k = 0; k < d->n_feet; k++) {
        size_t i = element_find(s->elements, s->n_elements, d->foot[k].id), foot = d->n_shown + k;
        base64_put(b, snapshot_shows(s, i) ? d->point[i] : foot, width);
        base64_put(b, foot, width);
    }
    for (size_t k = 0; k < d->n_outline; k++)
        base64_put(b, d->n_shown + d->n_feet + k, width);
    close_array(b);
    write_offsets(b, d->n_lines + d->n_feet, 2, d->outlines);
    file_puts(b->file, "      </Lines>\n");
}

/* --- the arrays of pairs --- */

static void write_pair_value(struct base64 *b, const struct pair_field *f, const struct pair_record *pair,
                             const struct pair_measure *measure)
{
    double value = f->get(pair, measure);
    base64_put(b, f->type == TYPE_F64 ? bits_of(value) : (uint64_t)value, type_info[f->type].bytes);
}

static size_t count_walls(const struct drawing *d)
{
    return d->outlines != NULL ? d->outlines->n_walls : 0;
}

/* Cells are the vertices, then the lines; a vertex has its element's id twice, and 0. */
static void write_pair_field(struct base64 *b, const struct pair_field *f, const struct snapshot *s,
                             const struct drawing *d)
{
    const struct snapshot_field array = {f->name, NULL, f->type, 1, {NULL, NULL, NULL}, NULL, NULL};
    open_array(b, &array, d->n_shown + d->n_lines + d->n_feet + count_walls(d));
    for (size_t i = 0; i < s->n_elements; i++) {
        if (snapshot_shows(s, i))
            base64_put(b, f->is_id ? s->elements[i].id : 0, type_info[f->type].bytes);
    }
    for (size_t k = 0; k < d->n_lines; k++) {
        size_t p = d->line[k].pair;
        write_pair_value(b, f, &s->pairs[p], &s->forces[p]);
    }
    struct pair_record pair = {.id_b = no_element};
    for (size_t k = 0; k < d->n_feet; k++) {
        const struct wall_force *at = &d->foot[k];
        pair.id_a = at->id;
        write_pair_value(b, f, &pair,
                         &(struct pair_measure){{at->force[0], at->force[1]}, at->normal, at->tangential});
    }
    pair.id_a = no_element;
    for (size_t k = 0; k < count_walls(d); k++)
        write_pair_value(b, f, &pair, &(struct pair_measure){.normal = 0.0});
    close_array(b);
}

/* The wall of each cell. */
static void write_cell_walls(struct base64 *b, const struct drawing *d)
{
    const struct snapshot_field array = {"wall", NULL, TYPE_U16, 1, {NULL, NULL, NULL}, NULL, NULL};
    if (count_walls(d) == 0)
        return;
    open_array(b, &array, d->n_shown + d->n_lines + d->n_feet + count_walls(d));
    for (size_t k = 0; k < d->n_shown + d->n_lines; k++)
        base64_put(b, NO_WALL, type_info[TYPE_U16].bytes);
    for (size_t k = 0; k < d->n_feet; k++)
        base64_put(b, d->foot[k].wall, type_info[TYPE_U16].bytes);
    for (size_t k = 0; k < count_walls(d); k++)
        base64_put(b, k, type_info[TYPE_U16].bytes);
    close_array(b);
}

static double get_id_a(const struct pair_record *p, const struct pair_measure *m)
{
    (void)m;
    return p->id_a;
}

static double get_id_b(const struct pair_record *p, const struct pair_measure *m)
{
    (void)m;
    return p->id_b;
}

static double get_linked(const struct pair_record *p, const struct pair_measure *m)
{
    (void)m;
    return p->linked;
}

static double get_force_x(const struct pair_record *p, const struct pair_measure *m)
{
    (void)p;
    return m->force[0];
}

static double get_force_y(const struct pair_record *p, const struct pair_measure *m)
{
    (void)p;
    return m->force[1];
}

static double get_normal(const struct pair_record *p, const struct pair_measure *m)
{
    (void)p;
    return m->normal;
}

static double get_tangential(const struct pair_record *p, const struct pair_measure *m)
{
    (void)p;
    return m->tangential;
}

static const struct pair_field pair_fields[] = {{"id_a", TYPE_U32, true, get_id_a},
                                                {"id_b", TYPE_U32, true, get_id_b},
                                                {"linked", TYPE_U8, false, get_linked},
                                                {"force_x", TYPE_F64, false, get_force_x},
                                                {"force_y", TYPE_F64, false, get_force_y},
                                                {"normal", TYPE_F64, false, get_normal},
                                                {"tangential", TYPE_F64, false, get_tangential}};

static void write_pairs(struct base64 *b, const struct snapshot *s, const struct drawing *d)
{
    if (!snapshot_has_pairs(s) && count_walls(d) == 0)
        return;
    file_puts(b->file, "      <CellData>\n");
    for (size_t k = 0; k < sizeof pair_fields / sizeof pair_fields[0] && snapshot_has_pairs(s); k++)
        write_pair_field(b, &pair_fields[k], s, d);
    write_cell_walls(b, d);
    file_puts(b->file, "      </CellData>\n");
}

/* --- the whole file --- */

static void write_doubles(struct file_out *f, const char *name, const double *values, size_t n)
{
    file_printf(f, "      <DataArray type=\"Float64\" Name=\"%s\" NumberOfTuples=\"%zu\" format=\"ascii\">",
                name, n);
    for (size_t i = 0; i < n; i++) {
        char text[NUMBER_TEXT_MAX];
        number_format(values[i], text);
        file_printf(f, "%s%s", i == 0 ? "" : " ", text);
    }
    file_puts(f, "</DataArray>\n");
}

static void open_string_array(struct file_out *f, const char *name, size_t n)
{
    file_printf(f, "      <Array type=\"String\" Name=\"%s\" NumberOfTuples=\"%zu\" format=\"ascii\">", name,
                n);
}

static void write_string(struct file_out *f, const char *text)
{
    for (const char *c = text; *c != '\0'; c++)
        file_printf(f, "%d ", (unsigned char)*c);
    file_puts(f, "0 ");
}

static void write_field_data(struct file_out *f, const struct snapshot *s)
{
    const struct config *c = s->config;
    double time = config_time(c, s->step);
    double domain[4] = {c->origin[0], c->origin[1], c->size[0], c->size[1]};
    file_puts(f, "    <FieldData>\n");
    write_doubles(f, "TimeValue", &time, 1);
    file_printf(f,
                "      <DataArray type=\"Int64\" Name=\"step\" NumberOfTuples=\"1\" format=\"ascii\">%" PRId64
                "</DataArray>\n",
                s->step);
    write_doubles(f, "domain", domain, 4);
    file_printf(
        f,
        "      <DataArray type=\"UInt8\" Name=\"periodic\" NumberOfTuples=\"2\" format=\"ascii\">%d %d"
        "</DataArray>\n",
        c->periodic[0], c->periodic[1]);
    struct kind_name name;
    open_string_array(f, "materials", config_kinds(c));
    for (size_t m = 0; m < config_kinds(c); m++)
        write_string(f, config_kind_name(c, m, &name));
    file_puts(f, "</Array>\n");
    open_string_array(f, "bodies", c->n_bodies);
    for (size_t m = 0; m < c->n_bodies; m++)
        write_string(f, c->bodies[m].name);
    file_puts(f, "</Array>\n");
    if (s->walls != NULL && s->walls->outlines.n_walls > 0) {
        open_string_array(f, "walls", c->n_walls);
        for (size_t k = 0; k < c->n_walls; k++)
            write_string(f, c->walls[k].name);
        file_puts(f, "</Array>\n");
    }
    file_puts(f, "    </FieldData>\n");
}

/* The two points of a pair's line. A line across a periodic side, or to an element that is not shown, ends
 * where it begins, so that nothing is drawn while the pair has its force. False: neither element is shown. */
static bool find_ends(const struct snapshot *s, const struct drawing *d, size_t a, size_t b, size_t end[2])
{
    const struct config *c = s->config;
    bool shows_a = snapshot_shows(s, a), shows_b = snapshot_shows(s, b), point = !shows_a || !shows_b;
    for (int axis = 0; axis < 2; axis++) {
        double length = fabs(s->elements[a].r[axis] - s->elements[b].r[axis]);
        point |= c->periodic[axis] && length > 0.5 * c->size[axis];
    }
    end[0] = d->point[shows_a ? a : b];
    end[1] = point ? end[0] : d->point[b];
    return shows_a || shows_b;
}

static enum dm2_status find_lines(const struct snapshot *s, struct drawing *d, struct dm2_error *err)
{
    for (size_t p = 0; p < s->n_pairs && snapshot_has_pairs(s); p++) {
        const struct pair_record *pair = &s->pairs[p];
        size_t a = element_find(s->elements, s->n_elements, pair->id_a),
               b = element_find(s->elements, s->n_elements, pair->id_b);
        if (a == s->n_elements || b == s->n_elements)
            return dm2_fail(err, DM2_NUMERIC,
                            "snapshot of step %" PRId64 ": the pair (%" PRIu32 ", %" PRIu32
                            ") names an element that is not in the state",
                            s->step, pair->id_a, pair->id_b);
        if (find_ends(s, d, a, b, d->line[d->n_lines].end))
            d->line[d->n_lines++].pair = p;
    }
    return DM2_OK;
}

static enum dm2_status find_walls(const struct snapshot *s, struct drawing *d, struct dm2_error *err)
{
    const struct snapshot_walls *w = s->walls;
    if (w == NULL || w->outlines.n_walls == 0)
        return DM2_OK;
    d->outlines = &w->outlines;
    d->n_outline = w->outlines.start[w->outlines.n_walls];
    d->foot = w->forces.records;
    d->n_feet = snapshot_has_pairs(s) ? w->forces.n : 0;
    for (size_t k = 0; k < d->n_feet; k++)
        if (element_find(s->elements, s->n_elements, d->foot[k].id) == s->n_elements)
            return dm2_fail(err, DM2_NUMERIC,
                            "snapshot of step %" PRId64 ": a contact with a wall names element %" PRIu32
                            ", which is not in the state",
                            s->step, d->foot[k].id);
    return DM2_OK;
}

/* Numbers the points and finds the lines. The caller frees *d with close_drawing, also after a failure. */
static enum dm2_status open_drawing(const struct snapshot *s, struct drawing *d, struct dm2_error *err)
{
    *d = (struct drawing){.point = mem_alloc(s->n_elements, sizeof *d->point),
                          .line = mem_alloc(s->n_pairs, sizeof *d->line)};
    if (d->point == NULL || d->line == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the lines of a snapshot of %zu elements",
                        s->n_elements);
    for (size_t i = 0; i < s->n_elements; i++) {
        d->point[i] = d->n_shown;
        d->n_shown += snapshot_shows(s, i);
    }
    enum dm2_status status = find_lines(s, d, err);
    return status == DM2_OK ? find_walls(s, d, err) : status;
}

static void close_drawing(struct drawing *d)
{
    free(d->point);
    free(d->line);
}

static void write_piece(struct base64 *b, const struct snapshot *s, const struct drawing *d)
{
    file_printf(
        b->file,
        "    <Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\" NumberOfLines=\"%zu\" NumberOfStrips=\"0\""
        " NumberOfPolys=\"0\">\n      <Points>\n",
        count_points(d), d->n_shown, d->n_lines + d->n_feet + count_walls(d));
    write_field(b, &snapshot_position, s, d);
    file_puts(b->file, "      </Points>\n");
    write_vertices(b, d->n_shown);
    write_lines(b, s, d);
    file_printf(b->file, "      <PointData%s%s>\n", snapshot_writes(s, "kind") ? " Scalars=\"kind\"" : "",
                snapshot_writes(s, "velocity") ? " Vectors=\"velocity\"" : "");
    for (int a = 0; a < SNAPSHOT_FIELDS; a++)
        if (snapshot_has(s, &snapshot_fields[a]))
            write_field(b, &snapshot_fields[a], s, d);
    file_puts(b->file, "      </PointData>\n");
    write_pairs(b, s, d);
    file_puts(b->file, "    </Piece>\n");
}

enum dm2_status snapshot_write_vtp(const char *path, const struct snapshot *s, struct dm2_error *err)
{
    struct file_out f;
    struct drawing d;
    enum dm2_status status = open_drawing(s, &d, err);
    if (status == DM2_OK)
        status = file_create(&f, path, err);
    if (status == DM2_OK) {
        struct base64 b = {.file = &f, .used = 0};
        file_puts(&f, "<?xml version=\"1.0\"?>\n"
                      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                      "header_type=\"UInt64\">\n"
                      "  <PolyData>\n");
        write_field_data(&f, s);
        write_piece(&b, s, &d);
        file_puts(&f, "  </PolyData>\n</VTKFile>\n");
        status = file_commit(&f, err);
    }
    close_drawing(&d);
    return status;
}
