/* Snapshot writers.
 *
 * The table `fields` lists the values of each element, and both formats loop over it. VTK's XML requires
 * array after array, so the .vtp writer passes over the elements once per array and sends the values through
 * a base64 encoder, 3072 bytes at a time, into the file's buffer: the state is never copied.
 *
 * VTK facts that are easy to get wrong: an inline binary array is one base64 stream of a UInt64 byte count
 * followed by the values (VTKFile version 1.0 with header_type); an array of strings is an <Array>, and in
 * ascii its characters are numbers with a 0 after each string. OVITO maps the XYZ columns species, pos, id,
 * radius and velo to its own properties; other columns become properties of the same name. */
#include "snapshot.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "dm2/base/file.h"
#include "dm2/base/number.h"

/* --- the fields of an element --- */

enum number_type { TYPE_U16, TYPE_U32, TYPE_I32, TYPE_I64, TYPE_F64 };

static const struct {
    const char *vtk;
    size_t bytes;
    char xyz;
} type_info[] = {
    {"UInt16", 2, 'I'}, {"UInt32", 4, 'I'}, {"Int32", 4, 'I'}, {"Int64", 8, 'I'}, {"Float64", 8, 'R'}};

struct field {
    const char *name;
    const char *xyz_name; /* NULL: one column per component, named NAME_COMPONENT */
    enum number_type type;
    int components;
    const char *component[3]; /* names, NULL: none */
    void (*get)(const struct snapshot *s, size_t i, double out[3]);
    bool (*present)(const struct snapshot *s); /* NULL: always */
};

static void get_position(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].r[0];
    out[1] = s->elements[i].r[1];
    out[2] = 0;
}

static void get_id(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].id;
}

static void get_kind(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].kind;
}

static void get_body(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].body;
}

static void get_grain(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].grain;
}

static void get_radius(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].radius;
}

static void get_velocity(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->measured[i].velocity[0];
    out[1] = s->measured[i].velocity[1];
    out[2] = 0;
}

static void get_spin(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].w;
}

static void get_temperature(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->measured[i].temperature;
}

static void get_pressure(const struct snapshot *s, size_t i, double out[3])
{
    const double *stress = s->measured[i].stress;
    out[0] = -0.5 * (stress[0] + stress[1]);
}

static void get_stress(const struct snapshot *s, size_t i, double out[3])
{
    memcpy(out, s->measured[i].stress, sizeof s->measured[i].stress);
}

/* The index of the element's phase among the phases of its material: 0 the first, then in deck order. */
static void get_phase(const struct snapshot *s, size_t i, double out[3])
{
    const struct config *c = s->config;
    size_t kind = s->elements[i].kind, phase = 0;
    for (size_t k = c->n_materials; k <= kind && k < config_kinds(c); k++)
        phase += c->phases[k - c->n_materials].material == c->phases[kind - c->n_materials].material;
    out[0] = (double)phase;
}

static bool has_phases(const struct snapshot *s)
{
    return s->config->n_phases > 0;
}

static bool has_composition(const struct snapshot *s)
{
    return s->config->n_reactions > 0;
}

static void get_composition(const struct snapshot *s, size_t i, double out[3])
{
    const struct reaction_config *r = &s->config->reactions[0];
    const struct config *c = s->config;
    size_t kind = s->elements[i].kind;
    int material = kind < c->n_materials ? (int)kind : c->phases[kind - c->n_materials].material;
    bool takes_part = material == r->reactant[0] || material == r->reactant[1] || material == r->product;
    out[0] = s->elements[i].share[0];
    out[1] = s->elements[i].share[1];
    out[2] = takes_part ? 1.0 - out[0] - out[1] : 0.0;
}

static void get_links(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->measured[i].links;
}

static void get_contacts(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->measured[i].contacts;
}

static void get_bonds(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].bonds;
}

/* 1 - links/bonds, at least 0: links that formed during the run make up for broken ones, but damage is not
 * negative. */
static void get_damage(const struct snapshot *s, size_t i, double out[3])
{
    double bonds = s->elements[i].bonds, links = s->measured[i].links;
    out[0] = links < bonds ? 1 - links / bonds : 0;
}

static void get_fragment(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->fragment[i];
}

static bool has_fragment(const struct snapshot *s)
{
    return s->fragment != NULL;
}

static void get_strain(const struct snapshot *s, size_t i, double out[3])
{
    memcpy(out, s->elements[i].strain, sizeof s->elements[i].strain);
}

static bool has_strain(const struct snapshot *s)
{
    return s->config->output.strain;
}

static void get_image(const struct snapshot *s, size_t i, double out[3])
{
    out[0] = s->elements[i].image[0];
    out[1] = s->elements[i].image[1];
}

static bool has_image(const struct snapshot *s)
{
    return s->config->periodic[0] || s->config->periodic[1];
}

static const struct field position_field = {"position",         "pos",        TYPE_F64, 3,
                                            {NULL, NULL, NULL}, get_position, NULL};

static const struct field fields[] = {
    {"id", "id", TYPE_U32, 1, {NULL, NULL, NULL}, get_id, NULL},
    {"kind", "kind", TYPE_U16, 1, {NULL, NULL, NULL}, get_kind, NULL},
    {"body", "body", TYPE_U16, 1, {NULL, NULL, NULL}, get_body, NULL},
    {"grain", "grain", TYPE_U32, 1, {NULL, NULL, NULL}, get_grain, NULL},
    {"radius", "radius", TYPE_F64, 1, {NULL, NULL, NULL}, get_radius, NULL},
    {"velocity", "velo", TYPE_F64, 3, {"x", "y", "z"}, get_velocity, NULL},
    {"spin", "angular_velocity", TYPE_F64, 1, {NULL, NULL, NULL}, get_spin, NULL},
    {"temperature", "temperature", TYPE_F64, 1, {NULL, NULL, NULL}, get_temperature, NULL},
    {"pressure", "pressure", TYPE_F64, 1, {NULL, NULL, NULL}, get_pressure, NULL},
    {"stress", NULL, TYPE_F64, 3, {"xx", "yy", "xy"}, get_stress, NULL},
    {"phase", "phase", TYPE_U16, 1, {NULL, NULL, NULL}, get_phase, has_phases},
    {"composition", NULL, TYPE_F64, 3, {"a", "b", "product"}, get_composition, has_composition},
    {"links", "links", TYPE_U32, 1, {NULL, NULL, NULL}, get_links, NULL},
    {"contacts", "contacts", TYPE_U32, 1, {NULL, NULL, NULL}, get_contacts, NULL},
    {"bonds", "bonds", TYPE_U16, 1, {NULL, NULL, NULL}, get_bonds, NULL},
    {"damage", "damage", TYPE_F64, 1, {NULL, NULL, NULL}, get_damage, NULL},
    {"fragment", "fragment", TYPE_U32, 1, {NULL, NULL, NULL}, get_fragment, has_fragment},
    {"strain", NULL, TYPE_F64, 3, {"xx", "yy", "xy"}, get_strain, has_strain},
    {"image", "image", TYPE_I32, 2, {"x", "y", NULL}, get_image, has_image},
};

enum { N_FIELDS = sizeof fields / sizeof fields[0] };

void snapshot_file_name(int64_t step, const char *suffix, char out[SNAPSHOT_NAME_MAX])
{
    (void)snprintf(out, SNAPSHOT_NAME_MAX, "state-%09" PRId64 ".%s", step, suffix);
}

static bool is_present(const struct field *f, const struct snapshot *s)
{
    return f->present == NULL || f->present(s);
}

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

static void open_array(struct base64 *b, const struct field *f, size_t n)
{
    file_printf(b->file, "        <DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\"",
                type_info[f->type].vtk, f->name, f->components);
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

static void write_field(struct base64 *b, const struct field *f, const struct snapshot *s)
{
    open_array(b, f, s->n_elements);
    for (size_t i = 0; i < s->n_elements; i++) {
        double value[3];
        f->get(s, i, value);
        for (int c = 0; c < f->components; c++)
            base64_put(b, f->type == TYPE_F64 ? bits_of(value[c]) : (uint64_t)(int64_t)value[c],
                       type_info[f->type].bytes);
    }
    close_array(b);
}

static const struct field connectivity[] = {
    {"connectivity", NULL, TYPE_I32, 1, {NULL, NULL, NULL}, NULL, NULL},
    {"connectivity", NULL, TYPE_I64, 1, {NULL, NULL, NULL}, NULL, NULL}};
static const struct field offsets[] = {{"offsets", NULL, TYPE_I32, 1, {NULL, NULL, NULL}, NULL, NULL},
                                       {"offsets", NULL, TYPE_I64, 1, {NULL, NULL, NULL}, NULL, NULL}};

/* Vertices and lines are a third of the file, so their indices are 32 bits wide where they fit. */
static bool is_long(size_t largest)
{
    return largest > INT32_MAX;
}

/* Offsets of n vertices or lines with `points` points each. */
static void write_offsets(struct base64 *b, size_t n, size_t points)
{
    const struct field *f = &offsets[is_long(n * points)];
    open_array(b, f, n);
    for (size_t i = 1; i <= n; i++)
        base64_put(b, (uint64_t)(i * points), type_info[f->type].bytes);
    close_array(b);
}

static void write_vertices(struct base64 *b, size_t n)
{
    file_puts(b->file, "      <Verts>\n");
    const struct field *f = &connectivity[is_long(n)];
    open_array(b, f, n);
    for (size_t i = 0; i < n; i++)
        base64_put(b, (uint64_t)i, type_info[f->type].bytes);
    close_array(b);
    write_offsets(b, n, 1);
    file_puts(b->file, "      </Verts>\n");
}

/* Whether the pair is drawn as a line; then end[] gets the indices of its two points. */
static bool is_line(const struct snapshot *s, const struct pair_record *pair, size_t end[2])
{
    if (pair->linked == 0)
        return false;
    end[0] = element_find(s->elements, s->n_elements, pair->id_a);
    end[1] = element_find(s->elements, s->n_elements, pair->id_b);
    const struct config *c = s->config;
    for (int axis = 0; axis < 2; axis++) {
        double length = fabs(s->elements[end[0]].r[axis] - s->elements[end[1]].r[axis]);
        if (c->periodic[axis] && length > 0.5 * c->size[axis])
            return false;
    }
    return true;
}

static void write_lines(struct base64 *b, const struct snapshot *s, size_t n_lines)
{
    size_t end[2];
    const struct field *f = &connectivity[is_long(s->n_elements)];
    file_puts(b->file, "      <Lines>\n");
    open_array(b, f, 2 * n_lines);
    for (size_t p = 0; p < s->n_pairs; p++) {
        if (is_line(s, &s->pairs[p], end)) {
            base64_put(b, end[0], type_info[f->type].bytes);
            base64_put(b, end[1], type_info[f->type].bytes);
        }
    }
    close_array(b);
    write_offsets(b, n_lines, 2);
    file_puts(b->file, "      </Lines>\n");
}

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
    double time = (double)s->step * c->dt;
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
    file_puts(f, "</Array>\n    </FieldData>\n");
}

/* Counts the lines; false where a pair names an element that is not there. */
static bool count_lines(const struct snapshot *s, size_t *n_lines, struct dm2_error *err)
{
    size_t end[2], n = 0;
    for (size_t p = 0; p < s->n_pairs; p++) {
        const struct pair_record *pair = &s->pairs[p];
        if (element_find(s->elements, s->n_elements, pair->id_a) == s->n_elements ||
            element_find(s->elements, s->n_elements, pair->id_b) == s->n_elements) {
            (void)dm2_fail(err, DM2_NUMERIC,
                           "snapshot of step %" PRId64 ": the pair (%" PRIu32 ", %" PRIu32
                           ") names an element that is not in the state",
                           s->step, pair->id_a, pair->id_b);
            return false;
        }
        n += is_line(s, pair, end) ? 1 : 0;
    }
    *n_lines = n;
    return true;
}

enum dm2_status snapshot_write_vtp(const char *path, const struct snapshot *s, struct dm2_error *err)
{
    size_t n_lines;
    struct file_out f;
    if (!count_lines(s, &n_lines, err))
        return DM2_NUMERIC;
    enum dm2_status status = file_create(&f, path, err);
    if (status != DM2_OK)
        return status;
    struct base64 b = {.file = &f, .used = 0};
    file_puts(
        &f, "<?xml version=\"1.0\"?>\n"
            "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
            "  <PolyData>\n");
    write_field_data(&f, s);
    file_printf(
        &f,
        "    <Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\" NumberOfLines=\"%zu\" NumberOfStrips=\"0\""
        " NumberOfPolys=\"0\">\n      <Points>\n",
        s->n_elements, s->n_elements, n_lines);
    write_field(&b, &position_field, s);
    file_puts(&f, "      </Points>\n");
    write_vertices(&b, s->n_elements);
    write_lines(&b, s, n_lines);
    file_puts(&f, "      <PointData Scalars=\"kind\" Vectors=\"velocity\">\n");
    for (int a = 0; a < N_FIELDS; a++)
        if (is_present(&fields[a], s))
            write_field(&b, &fields[a], s);
    file_puts(&f, "      </PointData>\n    </Piece>\n  </PolyData>\n</VTKFile>\n");
    return file_commit(&f, err);
}

enum dm2_status snapshot_write_series(const char *path, const int64_t *steps, size_t n_steps, double dt,
                                      struct dm2_error *err)
{
    struct file_out f;
    enum dm2_status status = file_create(&f, path, err);
    if (status != DM2_OK)
        return status;
    file_puts(&f,
              "<?xml version=\"1.0\"?>\n"
              "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n");
    for (size_t i = 0; i < n_steps; i++) {
        char name[SNAPSHOT_NAME_MAX], time[NUMBER_TEXT_MAX];
        snapshot_file_name(steps[i], "vtp", name);
        number_format((double)steps[i] * dt, time);
        file_printf(&f, "    <DataSet timestep=\"%s\" group=\"\" part=\"0\" file=\"%s\"/>\n", time, name);
    }
    file_puts(&f, "  </Collection>\n</VTKFile>\n");
    return file_commit(&f, err);
}

/* --- .xyz --- */

static void write_column(struct file_out *f, double x)
{
    char text[NUMBER_TEXT_MAX + 1] = " ";
    size_t length = number_format(x, text + 1);
    file_write(f, text, length + 1);
}

static void write_property(struct file_out *f, const struct field *field)
{
    char type = type_info[field->type].xyz;
    if (field->xyz_name != NULL)
        file_printf(f, ":%s:%c:%d", field->xyz_name, type, field->components);
    else
        for (int c = 0; c < field->components; c++)
            file_printf(f, ":%s_%s:%c:1", field->name, field->component[c], type);
}

/* The third edge of the lattice is the model's depth of 1 cm, centred on the plane of the elements. */
static void write_comment_line(struct file_out *f, const struct snapshot *s)
{
    const struct config *c = s->config;
    const double lattice[9] = {c->size[0], 0, 0, 0, c->size[1], 0, 0, 0, 1};
    const double origin[3] = {c->origin[0], c->origin[1], -0.5};
    file_puts(f, "Lattice=\"");
    for (int k = 0; k < 9; k++) {
        char text[NUMBER_TEXT_MAX];
        number_format(lattice[k], text);
        file_printf(f, "%s%s", k == 0 ? "" : " ", text);
    }
    file_puts(f, "\" Origin=\"");
    for (int k = 0; k < 3; k++) {
        char text[NUMBER_TEXT_MAX];
        number_format(origin[k], text);
        file_printf(f, "%s%s", k == 0 ? "" : " ", text);
    }
    file_printf(f, "\" pbc=\"%c %c F\" Properties=species:S:1", c->periodic[0] ? 'T' : 'F',
                c->periodic[1] ? 'T' : 'F');
    write_property(f, &position_field);
    for (int a = 0; a < N_FIELDS; a++)
        if (is_present(&fields[a], s))
            write_property(f, &fields[a]);
    char time[NUMBER_TEXT_MAX];
    number_format((double)s->step * c->dt, time);
    file_printf(f, " Time=%s Step=%" PRId64 "\n", time, s->step);
}

static void write_columns(struct file_out *f, const struct field *field, const struct snapshot *s, size_t i)
{
    double value[3];
    field->get(s, i, value);
    for (int c = 0; c < field->components; c++)
        write_column(f, value[c]);
}

enum dm2_status snapshot_write_xyz(const char *path, const struct snapshot *s, struct dm2_error *err)
{
    struct file_out f;
    enum dm2_status status = file_create(&f, path, err);
    if (status != DM2_OK)
        return status;
    file_printf(&f, "%zu\n", s->n_elements);
    write_comment_line(&f, s);
    for (size_t i = 0; i < s->n_elements; i++) {
        unsigned kind = s->elements[i].kind;
        struct kind_name name;
        if (kind < config_kinds(s->config))
            file_puts(&f, config_kind_name(s->config, kind, &name));
        else
            file_printf(&f, "kind%u", kind);
        write_columns(&f, &position_field, s, i);
        for (int a = 0; a < N_FIELDS; a++)
            if (is_present(&fields[a], s))
                write_columns(&f, &fields[a], s, i);
        file_puts(&f, "\n");
    }
    return file_commit(&f, err);
}
