/* Snapshots: well-formed XML, array lengths, values read back by vtp_reader; the seam; extended XYZ. */
#include "check.h"
#include "fake_state.h"
#include "scratch.h"

#include "dm2/base/number.h"
#include "dm2/plot/vtp_reader.h"
#include "deck/schema.h"
#include "output/snapshot.h"
#include "output/snapshot_fields.h"
#include "plot/xml.h"

static struct snapshot snapshot_of(const struct fake *f)
{
    return (struct snapshot){&f->config, 200,       f->elements, f->measured, f->n,
                             f->pairs,   f->forces, f->n_pairs,  NULL,        NULL};
}

static void check_well_formed(const char *name)
{
    size_t n;
    struct xml xml;
    struct dm2_error err = {0};
    char *text = scratch_read(name, &n);
    enum xml_event event;
    xml_open(&xml, name, text, n);
    do
        event = xml_next(&xml, &err);
    while (event != XML_DONE && event != XML_ERROR);
    CHECK_STR(err.text, "");
    free(text);
}

static const double *values(const struct vtp *vtp, const char *name, size_t components)
{
    const struct vtp_array *a = vtp_find(vtp, "PointData", name);
    CHECK_REPORT(a != NULL && a->components == components, "no array '%s' of %zu components", name,
                 components);
    if (a == NULL || a->components != components)
        exit(1);
    return a->values;
}

static void check_values(const struct vtp *vtp, const struct fake *f)
{
    for (size_t i = 0; i < f->n; i++) {
        const struct element *e = &f->elements[i];
        const struct element_measure *m = &f->measured[i];
        CHECK_SAME_BITS(vtp->position[3 * i], e->r[0]);
        CHECK_SAME_BITS(vtp->position[3 * i + 1], e->r[1]);
        CHECK_SAME_BITS(vtp->position[3 * i + 2], 0.0);
        CHECK_EQ_INT(values(vtp, "id", 1)[i], e->id);
        CHECK_EQ_INT(values(vtp, "kind", 1)[i], e->kind);
        CHECK_EQ_INT(values(vtp, "body", 1)[i], e->body);
        CHECK_EQ_INT(values(vtp, "grain", 1)[i], e->grain);
        CHECK_SAME_BITS(values(vtp, "radius", 1)[i], e->radius);
        CHECK_SAME_BITS(values(vtp, "velocity", 3)[3 * i], m->velocity[0]);
        CHECK_SAME_BITS(values(vtp, "velocity", 3)[3 * i + 1], m->velocity[1]);
        CHECK_SAME_BITS(values(vtp, "spin", 1)[i], e->w);
        CHECK_SAME_BITS(values(vtp, "temperature", 1)[i], m->temperature);
        CHECK_SAME_BITS(values(vtp, "pressure", 1)[i], -0.5 * (m->stress[0] + m->stress[1]) + 0.0);
        for (size_t c = 0; c < 3; c++)
            CHECK_SAME_BITS(values(vtp, "stress", 3)[3 * i + c], m->stress[c]);
        CHECK_EQ_INT(values(vtp, "links", 1)[i], m->links);
        CHECK_EQ_INT(values(vtp, "contacts", 1)[i], m->contacts);
        CHECK_EQ_INT(values(vtp, "bonds", 1)[i], e->bonds);
        CHECK_SAME_BITS(values(vtp, "damage", 1)[i], 1 - m->links / 6.0);
        for (size_t c = 0; c < 2; c++)
            CHECK_EQ_INT(values(vtp, "image", 2)[2 * i + c], e->image[c]);
    }
}

static void check_field_data(const struct vtp *vtp)
{
    CHECK_SAME_BITS(vtp_value(vtp, "TimeValue", -1), 200 * 0.025);
    CHECK_SAME_BITS(vtp_value(vtp, "step", -1), 200);
    CHECK_SAME_BITS(vtp_value(vtp, "absent", -1), -1);
    const struct vtp_array *domain = vtp_find(vtp, "FieldData", "domain");
    CHECK(domain != NULL && domain->n_tuples == 4);
    CHECK_EQ_INT(vtp->materials.n, 2);
    CHECK_STR(vtp->materials.name[1], "aluminium");
    CHECK_EQ_INT(vtp->bodies.n, 2);
    CHECK_STR(vtp->bodies.name[0], "flyer");
}

/* Sizes around the encoder's blocks of 3072 bytes, and all paddings. */
TEST(vtp_round_trip)
{
    static const size_t columns[] = {1, 2, 5, 127, 128, 129};
    for (size_t k = 0; k < sizeof columns / sizeof columns[0]; k++) {
        struct fake f;
        struct vtp vtp;
        struct dm2_error err = {0};
        fake_make(&f, columns[k], 3);
        struct snapshot s = snapshot_of(&f);
        CHECK_EQ_INT(snapshot_write_vtp(scratch_path("s.vtp"), &s, &err), DM2_OK);
        check_well_formed("s.vtp");
        CHECK_EQ_INT(vtp_read(scratch_path("s.vtp"), &vtp, &err), DM2_OK);
        CHECK_STR(err.text, "");
        CHECK_EQ_INT(vtp.n_points, f.n);
        check_values(&vtp, &f);
        check_field_data(&vtp);
        const struct vtp_array *verts = vtp_find(&vtp, "Verts", "connectivity"),
                               *ends = vtp_find(&vtp, "Verts", "offsets");
        CHECK_EQ_INT(verts->n_tuples, f.n);
        CHECK_EQ_INT(verts->values[f.n - 1], f.n - 1);
        CHECK_EQ_INT(ends->values[f.n - 1], f.n);
        vtp_free(&vtp);
        fake_free(&f);
    }
}

/* Strain and fragments are in the file only where they are known. */
TEST(arrays_on_demand)
{
    struct fake f;
    struct vtp vtp;
    struct dm2_error err = {0};
    uint32_t fragment[12];
    fake_make(&f, 4, 3);
    f.elements[5].bonds = 0; /* no bond: no damage */
    f.elements[6].bonds = 2;
    f.measured[6].links = 5; /* more links than at the start: no damage either */
    for (uint32_t i = 0; i < 12; i++)
        fragment[i] = i % 3;
    struct snapshot s = snapshot_of(&f);
    CHECK_EQ_INT(snapshot_write_vtp(scratch_path("d.vtp"), &s, &err), DM2_OK);
    CHECK_EQ_INT(vtp_read(scratch_path("d.vtp"), &vtp, &err), DM2_OK);
    CHECK(vtp_find(&vtp, "PointData", "strain") == NULL && vtp_find(&vtp, "PointData", "fragment") == NULL);
    CHECK_SAME_BITS(values(&vtp, "damage", 1)[5], 0);
    CHECK_SAME_BITS(values(&vtp, "damage", 1)[6], 0);
    vtp_free(&vtp);
    s.fragment = fragment;
    f.config.output.strain = true;
    CHECK_EQ_INT(snapshot_write_vtp(scratch_path("d.vtp"), &s, &err), DM2_OK);
    check_well_formed("d.vtp");
    CHECK_EQ_INT(vtp_read(scratch_path("d.vtp"), &vtp, &err), DM2_OK);
    for (size_t i = 0; i < f.n; i++) {
        CHECK_EQ_INT(values(&vtp, "fragment", 1)[i], fragment[i]);
        for (size_t c = 0; c < 3; c++)
            CHECK_SAME_BITS(values(&vtp, "strain", 3)[3 * i + c], f.elements[i].strain[c]);
    }
    vtp_free(&vtp);
    CHECK_EQ_INT(snapshot_write_xyz(scratch_path("d.xyz"), &s, &err), DM2_OK);
    char *text = scratch_read("d.xyz", NULL);
    CHECK_CONTAINS(text, ":fragment:I:1:strain_xx:R:1:strain_yy:R:1:strain_xy:R:1:image:I:2 Time=5");
    free(text);
    fake_free(&f);
}

TEST(lines_are_the_linked_pairs)
{
    struct fake f;
    struct vtp vtp;
    struct dm2_error err = {0};
    fake_make(&f, 6, 4);
    struct snapshot s = snapshot_of(&f);
    CHECK_EQ_INT(snapshot_write_vtp(scratch_path("l.vtp"), &s, &err), DM2_OK);
    CHECK_EQ_INT(vtp_read(scratch_path("l.vtp"), &vtp, &err), DM2_OK);
    size_t line = 0;
    for (size_t p = 0; p < f.n_pairs; p++) {
        if (f.pairs[p].linked == 0)
            continue;
        CHECK(line < vtp.n_lines && vtp.line[2 * line] == f.pairs[p].id_a &&
              vtp.line[2 * line + 1] == f.pairs[p].id_b);
        line++;
    }
    CHECK_EQ_INT(vtp.n_lines, line);
    vtp_free(&vtp);
    fake_free(&f);
}

static const double *cell_values(const struct vtp *vtp, const char *name, size_t cells)
{
    const struct vtp_array *a = vtp_find(vtp, "CellData", name);
    CHECK_REPORT(a != NULL && a->components == 1 && a->n_tuples == cells, "no array '%s' of %zu cells", name,
                 cells);
    if (a == NULL || a->n_tuples != cells)
        exit(1);
    return a->values;
}

/* Pairs follow the vertices in the arrays of cells, linked or not, across the seam or not. */
static void check_pair_arrays(const struct fake *f, const struct vtp *vtp)
{
    size_t cells = f->n + f->n_pairs;
    for (size_t p = 0; p < f->n_pairs; p++) {
        size_t k = f->n + p;
        CHECK_EQ_INT(cell_values(vtp, "id_a", cells)[k], f->pairs[p].id_a);
        CHECK_EQ_INT(cell_values(vtp, "id_b", cells)[k], f->pairs[p].id_b);
        CHECK_EQ_INT(cell_values(vtp, "linked", cells)[k], f->pairs[p].linked);
        CHECK_SAME_BITS(cell_values(vtp, "force_x", cells)[k], f->forces[p].force[0]);
        CHECK_SAME_BITS(cell_values(vtp, "force_y", cells)[k], f->forces[p].force[1]);
        CHECK_SAME_BITS(cell_values(vtp, "normal", cells)[k], f->forces[p].normal);
        CHECK_SAME_BITS(cell_values(vtp, "tangential", cells)[k], f->forces[p].tangential);
    }
    for (size_t i = 0; i < f->n; i++) {
        CHECK_EQ_INT(cell_values(vtp, "id_a", cells)[i], f->elements[i].id);
        CHECK_EQ_INT(cell_values(vtp, "id_b", cells)[i], f->elements[i].id);
        CHECK_SAME_BITS(cell_values(vtp, "normal", cells)[i], 0.0);
    }
}

TEST(pairs_have_their_forces)
{
    struct fake f;
    struct vtp vtp;
    struct dm2_error err = {0};
    fake_make(&f, 6, 4);
    struct snapshot s = snapshot_of(&f);
    CHECK_EQ_INT(snapshot_write_vtp(scratch_path("f.vtp"), &s, &err), DM2_OK);
    CHECK_EQ_INT(vtp_read(scratch_path("f.vtp"), &vtp, &err), DM2_OK);
    check_pair_arrays(&f, &vtp);
    vtp_free(&vtp);
    fake_free(&f);
}

/* Rows alternate between the two bodies. Pairs within a body that is not shown are left out; those with one
 * element that is shown have no length. */
TEST(one_body_is_shown)
{
    struct fake f;
    struct vtp vtp;
    struct dm2_error err = {0};
    bool bodies[2] = {false, true};
    fake_make(&f, 6, 4);
    f.config.output.bodies = bodies;
    struct snapshot s = snapshot_of(&f);
    CHECK_EQ_INT(snapshot_write_vtp(scratch_path("b.vtp"), &s, &err), DM2_OK);
    CHECK_EQ_INT(vtp_read(scratch_path("b.vtp"), &vtp, &err), DM2_OK);
    CHECK_EQ_INT(vtp.n_points, 12);
    size_t pairs = 0, within = 0;
    for (size_t p = 0; p < f.n_pairs; p++) {
        int a = f.elements[f.pairs[p].id_a].body, b = f.elements[f.pairs[p].id_b].body;
        pairs += a == 1 || b == 1;
        within += a == 1 && b == 1 && f.pairs[p].linked;
    }
    CHECK_EQ_INT(vtp_find(&vtp, "CellData", "id_a")->n_tuples, 12 + pairs);
    CHECK_EQ_INT(vtp.n_lines, within);
    for (size_t i = 0; i < 12; i++)
        CHECK_EQ_INT(f.elements[(size_t)values(&vtp, "id", 1)[i]].body, 1);
    vtp_free(&vtp);
    CHECK_EQ_INT(snapshot_write_xyz(scratch_path("b.xyz"), &s, &err), DM2_OK);
    char *text = scratch_read("b.xyz", NULL);
    CHECK_CONTAINS(text, "12\nLattice");
    free(text);
    fake_free(&f);
}

/* The words of `fields` are the names of the table, in its order, and `pairs`. */
TEST(fields_are_chosen_by_name)
{
    struct fake f;
    struct vtp vtp;
    struct dm2_error err = {0};
    const struct block_schema *block = schema_block(BLOCK_OUTPUT);
    const struct deck_key *key = &block->keys[schema_find_key(block, "fields", 6)];
    fake_make(&f, 3, 2);
    CHECK_EQ_INT(OUTPUT_ALL_FIELDS, (1u << (SNAPSHOT_FIELDS + 1)) - 1u);
    for (int k = 0; k <= SNAPSHOT_FIELDS; k++) {
        const char *name = k < SNAPSHOT_FIELDS ? snapshot_fields[k].name : "pairs";
        struct snapshot s = snapshot_of(&f);
        CHECK_EQ_INT(schema_find_choice(key->choices, name, strlen(name)), k);
        f.config.output.fields = 1u << k;
        CHECK_EQ_INT(snapshot_write_vtp(scratch_path("k.vtp"), &s, &err), DM2_OK);
        CHECK_EQ_INT(vtp_read(scratch_path("k.vtp"), &vtp, &err), DM2_OK);
        for (int other = 0; other < SNAPSHOT_FIELDS; other++) {
            const struct snapshot_field *field = &snapshot_fields[other];
            bool there = other == k && (field->present == NULL || field->present(&s));
            CHECK((vtp_find(&vtp, "PointData", field->name) != NULL) == there);
        }
        CHECK((vtp_find(&vtp, "CellData", "force_x") != NULL) == (k == SNAPSHOT_FIELDS));
        vtp_free(&vtp);
    }
    fake_free(&f);
}

/* The link between the first and the last element of a row crosses the periodic seam. */
TEST(no_line_across_the_seam)
{
    struct fake f;
    struct vtp vtp;
    struct dm2_error err = {0};
    fake_make(&f, 6, 1);
    f.pairs[5] = f.pairs[4];
    memmove(&f.pairs[2], &f.pairs[1], 4 * sizeof f.pairs[0]);
    f.pairs[1] = (struct pair_record){0, 5, 1, 0, 0};
    f.n_pairs = 6;
    struct snapshot s = snapshot_of(&f);
    CHECK_EQ_INT(snapshot_write_vtp(scratch_path("p.vtp"), &s, &err), DM2_OK);
    CHECK_EQ_INT(vtp_read(scratch_path("p.vtp"), &vtp, &err), DM2_OK);
    CHECK_EQ_INT(vtp.n_lines, 5);
    check_pair_arrays(&f, &vtp);
    vtp_free(&vtp);
    f.config.periodic[0] = false;
    CHECK_EQ_INT(snapshot_write_vtp(scratch_path("p.vtp"), &s, &err), DM2_OK);
    CHECK_EQ_INT(vtp_read(scratch_path("p.vtp"), &vtp, &err), DM2_OK);
    CHECK_EQ_INT(vtp.n_lines, 6);
    vtp_free(&vtp);
    fake_free(&f);
}

TEST(absent_element_of_a_pair)
{
    struct fake f;
    struct dm2_error err = {0};
    fake_make(&f, 3, 1);
    f.pairs[1].id_b = 9;
    struct snapshot s = snapshot_of(&f);
    CHECK_EQ_INT(snapshot_write_vtp(scratch_path("q.vtp"), &s, &err), DM2_NUMERIC);
    CHECK_CONTAINS(err.text, "(1, 9) names an element");
    CHECK(!scratch_exists("q.vtp") && !scratch_exists("q.vtp.part"));
    fake_free(&f);
}

TEST(series)
{
    static const int64_t steps[] = {0, 40, 200};
    struct dm2_error err = {0};
    const struct config c = {.dt = 0.025};
    CHECK_EQ_INT(snapshot_write_series(scratch_path("series.pvd"), steps, 3, &c, &err), DM2_OK);
    check_well_formed("series.pvd");
    char *text = scratch_read("series.pvd", NULL);
    CHECK_CONTAINS(text, "<DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"state-000000000.vtp\"/>");
    CHECK_CONTAINS(text, "<DataSet timestep=\"5\" group=\"\" part=\"0\" file=\"state-000000200.vtp\"/>");
    free(text);
}

/* The next word of a text; *x, if given, is its number. */
static const char *word(const char *at, char *out, size_t size, double *x)
{
    at += strspn(at, " \n");
    size_t n = strcspn(at, " \n");
    if (n < size) {
        memcpy(out, at, n);
        out[n] = '\0';
    }
    if (x != NULL)
        CHECK_REPORT(number_parse(at, n, x), "'%s' is no number", out);
    return at + n;
}

TEST(xyz_round_trip)
{
    struct fake f;
    struct dm2_error err = {0};
    fake_make(&f, 5, 2);
    struct snapshot s = snapshot_of(&f);
    CHECK_EQ_INT(snapshot_write_xyz(scratch_path("s.xyz"), &s, &err), DM2_OK);
    char *text = scratch_read("s.xyz", NULL);
    static const char head[] =
        "10\nLattice=\"0.2 0 0 0 0.08 0 0 0 1\" Origin=\"0 0 -0.5\" pbc=\"T F F\" Properties=";
    CHECK_EQ_INT(strncmp(text, head, strlen(head)), 0);
    CHECK_CONTAINS(
        text, "Properties=species:S:1:pos:R:3:id:I:1:kind:I:1:body:I:1:grain:I:1:radius:R:1:velo:R:3:"
              "angular_velocity:R:1:temperature:R:1:pressure:R:1:stress_xx:R:1:stress_yy:R:1:stress_xy:R:1:"
              "links:I:1:contacts:I:1:bonds:I:1:damage:R:1:image:I:2 Time=5 Step=200\n");
    const char *at = strchr(strchr(text, '\n') + 1, '\n');
    for (size_t i = 0; i < f.n; i++) {
        const struct element *e = &f.elements[i];
        const struct element_measure *m = &f.measured[i];
        const double want[] = {e->r[0],
                               e->r[1],
                               0,
                               e->id,
                               e->kind,
                               e->body,
                               e->grain,
                               e->radius,
                               m->velocity[0],
                               m->velocity[1],
                               0,
                               e->w,
                               m->temperature,
                               -0.5 * (m->stress[0] + m->stress[1]) + 0.0,
                               m->stress[0],
                               m->stress[1],
                               m->stress[2],
                               m->links,
                               m->contacts,
                               e->bonds,
                               1 - m->links / 6.0,
                               e->image[0],
                               e->image[1]};
        char buffer[64];
        at = word(at, buffer, sizeof buffer, NULL);
        CHECK_STR(buffer, f.materials[e->kind].name);
        for (size_t c = 0; c < sizeof want / sizeof want[0]; c++) {
            double x = NAN;
            at = word(at, buffer, sizeof buffer, &x);
            CHECK_SAME_BITS(x, want[c]);
        }
        CHECK_EQ_INT(*at, '\n');
    }
    CHECK_STR(at, "\n");
    free(text);
    fake_free(&f);
}

/* The reader refuses a spoiled copy of a good file. */
static void check_spoiled(const char *text, const char *from, const char *to, const char *want)
{
    struct vtp vtp;
    struct dm2_error err = {0};
    const char *at = strstr(text, from);
    CHECK_REPORT(at != NULL, "the file does not contain '%s'", from);
    if (at == NULL)
        return;
    size_t before = (size_t)(at - text), n = strlen(text) + strlen(to) + 1;
    char *spoiled = malloc(n);
    snprintf(spoiled, n, "%.*s%s%s", (int)before, text, to, at + strlen(from));
    scratch_write("bad.vtp", spoiled);
    CHECK_EQ_INT(vtp_read(scratch_path("bad.vtp"), &vtp, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, want);
    CHECK(vtp.arrays == NULL);
    free(spoiled);
}

TEST(reader_refuses)
{
    struct fake f;
    struct dm2_error err = {0};
    fake_make(&f, 3, 2);
    struct snapshot s = snapshot_of(&f);
    CHECK_EQ_INT(snapshot_write_vtp(scratch_path("r.vtp"), &s, &err), DM2_OK);
    char *text = scratch_read("r.vtp", NULL);
    check_spoiled(text, "NumberOfPoints=\"6\"", "NumberOfPoints=\"7\"", "tuples for 7 points");
    check_spoiled(text, "NumberOfLines=\"", "NumberOfLines=\"9", "two points for each of its");
    check_spoiled(text, "</Points>", "</Point>", ":15: not well-formed XML: an end tag that does not match");
    check_spoiled(text, "type=\"PolyData\"", "type=\"ImageData\"", "PolyData was expected");
    check_spoiled(text, "LittleEndian", "BigEndian", "only little-endian");
    check_spoiled(text, "Name=\"id\"", "Name=\"id\" Name=\"x\"", "an attribute is there twice");
    check_spoiled(text, "type=\"UInt16\"", "type=\"Complex\"", "unknown type");
    check_spoiled(text, "type=\"UInt16\" Name=\"kind\" NumberOfComponents=\"1\" format=\"binary\">D",
                  "type=\"UInt16\" Name=\"kind\" NumberOfComponents=\"1\" format=\"binary\">E",
                  "whose length is not the one that it announces");
    check_spoiled(text, "format=\"binary\">", "format=\"binary\">*", "not base64");
    check_spoiled(text, "format=\"ascii\">5<", "format=\"ascii\">5x<", "no number");
    check_spoiled(text, "110 105 99", "110 -105 99", "a character that is none");
    check_spoiled(text, "</VTKFile>", "", "the text ends inside an element");
    size_t n = strlen(text);
    for (size_t k = 0; k < n - 1; k += 7) { /* any cut is an error and reads nothing beyond the end */
        struct vtp vtp;
        char kept = text[k];
        text[k] = '\0';
        scratch_write("cut.vtp", text);
        text[k] = kept;
        CHECK_EQ_INT(vtp_read(scratch_path("cut.vtp"), &vtp, &err), DM2_PROTOCOL);
    }
    free(text);
    fake_free(&f);
}

TEST(xml_refuses)
{
    static const char *const bad[] = {
        "",
        "text",
        "<a>",
        "<a></b>",
        "<a/><b/>",
        "<a x=1/>",
        "<a x='1' x='2'/>",
        "<a x='1'y='2'/>",
        "<a>&</a>",
        "<a>&nope;</a>",
        "<a x='<'/>",
        "<a><!-- -- --></a>",
        "</a>",
        "<a/>x",
        "<1/>",
        "<a>\x01</a>",
        "<a><?xml?></a>",
        "<a b='1'",
        "<!DOCTYPE a><a/>",
        "<a>&#;</a>",
    };
    static const char *const good[] = {
        "<a/>",
        "<?xml version=\"1.0\"?>\n<!-- c -->\n<a x='\"' y=\"'\">t &amp; &#65; &#x4a;<b/></a >\n",
        "<a\n x = '1' />",
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct xml xml;
        struct dm2_error err = {0};
        enum xml_event event;
        xml_open(&xml, "x", bad[i], strlen(bad[i]));
        do
            event = xml_next(&xml, &err);
        while (event != XML_DONE && event != XML_ERROR);
        CHECK_REPORT(event == XML_ERROR, "'%s' was taken", bad[i]);
    }
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        scratch_write("good.xml", good[i]);
        check_well_formed("good.xml");
    }
}

TEST(begin)
{
    scratch_begin();
}

TEST(end)
{
    scratch_end();
}

TEST_MAIN(CASE(begin), CASE(vtp_round_trip), CASE(arrays_on_demand), CASE(lines_are_the_linked_pairs),
          CASE(pairs_have_their_forces), CASE(one_body_is_shown), CASE(fields_are_chosen_by_name),
          CASE(no_line_across_the_seam), CASE(absent_element_of_a_pair), CASE(series), CASE(xyz_round_trip),
          CASE(reader_refuses), CASE(xml_refuses), CASE(end))
