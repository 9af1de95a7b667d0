/* The writer of extended XYZ. OVITO maps the columns species, pos, id, radius and velo to its own properties;
 * other columns become properties of the same name. */
#include <inttypes.h>

#include "dm2/base/file.h"
#include "dm2/base/number.h"
#include "snapshot_fields.h"

static void write_column(struct file_out *f, double x)
{
    char text[NUMBER_TEXT_MAX + 1] = " ";
    size_t length = number_format(x, text + 1);
    file_write(f, text, length + 1);
}

static void write_property(struct file_out *f, const struct snapshot_field *field)
{
    char type = field->type == TYPE_F64 ? 'R' : 'I';
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
    write_property(f, &snapshot_position);
    for (int a = 0; a < SNAPSHOT_FIELDS; a++)
        if (snapshot_has(s, &snapshot_fields[a]))
            write_property(f, &snapshot_fields[a]);
    char time[NUMBER_TEXT_MAX];
    number_format(config_time(c, s->step), time);
    file_printf(f, " Time=%s Step=%" PRId64 "\n", time, s->step);
}

static void write_columns(struct file_out *f, const struct snapshot_field *field, const struct snapshot *s,
                          size_t i)
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
    size_t shown = 0;
    for (size_t i = 0; i < s->n_elements; i++)
        shown += snapshot_shows(s, i);
    file_printf(&f, "%zu\n", shown);
    write_comment_line(&f, s);
    for (size_t i = 0; i < s->n_elements; i++) {
        if (!snapshot_shows(s, i))
            continue;
        unsigned kind = s->elements[i].kind;
        struct kind_name name;
        if (kind < config_kinds(s->config))
            file_puts(&f, config_kind_name(s->config, kind, &name));
        else
            file_printf(&f, "kind%u", kind);
        write_columns(&f, &snapshot_position, s, i);
        for (int a = 0; a < SNAPSHOT_FIELDS; a++)
            if (snapshot_has(s, &snapshot_fields[a]))
                write_columns(&f, &snapshot_fields[a], s, i);
        file_puts(&f, "\n");
    }
    return file_commit(&f, err);
}
