/* A made-up state as a file: written whole, with further sections or without, damaged, read. */
#ifndef DM2_TESTS_STATE_HELP_H
#define DM2_TESTS_STATE_HELP_H

#include "check.h"
#include "fake_state.h"
#include "scratch.h"

#include "dm2/base/crc32c.h"
#include "dm2/output/state.h"

static char meaning[] = "body flyer velocity 0 -0.01\nbody target material nickel\n";
static struct state_name names[] = {
    {NAME_KIND, "nickel"}, {NAME_KIND, "nickel/beta"}, {NAME_BODY, "flyer"}, {NAME_WALL, "floor"}};
static const struct state_origin origin = {.digest = {0xfa, 0x39, 0x7c, 0xd1, 0xb2, 0x75, 0xb2, 0x47, 0xaf,
                                                      0x6d, 0xe5, 0xfc, 0x63, 0xc5, 0x72, 0xa3, 0xf2, 0x1f,
                                                      0x31, 0xae, 0x27, 0xc6, 0xa6, 0x89, 0xe2, 0x0c, 0x43,
                                                      0xef, 0x52, 0xf4, 0x6a, 0x53}, /* SHA-256 of the text */
                                           .n_start = 70,
                                           .t_start = 1.75,
                                           .next_id = 3000,
                                           .next_grain = 500,
                                           .text = meaning,
                                           .text_length = sizeof meaning - 1,
                                           .names = names,
                                           .n_names = sizeof names / sizeof names[0]};

/* Records of all further sections, for elements 0 to 3 and movers 0 to 2. */
static struct home_record homes[] = {{0, {0.5, -0.25}}, {1, {1, 2}}, {3, {-0.125, 3}}};
static struct body_record bodies[] = {{.mover = 0,
                                       .displacement = {1, 2},
                                       .velocity = {3, 4},
                                       .centroid = {5, 6},
                                       .integral = {7, 8},
                                       .angle = 9,
                                       .spin = 10,
                                       .force = {{{11, 12}, {-13, 14}}, {{15, 16}, {17, 18}}},
                                       .touched = {{{19, 20}, {21, 22}}, {{23, 24}, {-25, UINT64_MAX}}},
                                       .contacts = {26, 27}},
                                      {.mover = 2, .spin = -1}};
static struct wall_contact wall_contacts[] = {{1, 0, 1, 1e-5}, {1, 4, -1, 0}, {3, 2, 1, -2e-7}};

static inline void add_sections(struct state_view *view)
{
    view->sections[SECTION_HOME] = (struct section_array){homes, 3, 3};
    view->sections[SECTION_BODY] = (struct section_array){bodies, 2, 2};
    view->sections[SECTION_WCON] = (struct section_array){wall_contacts, 3, 3};
}

static inline enum dm2_status write_view(const struct state_view *view, const char *name)
{
    struct dm2_error err = {0};
    enum dm2_status status = state_write(scratch_path(name), view, &err);
    CHECK_STR(err.text, "");
    return status;
}

static inline struct state_view view_of(const struct fake *f)
{
    return (struct state_view){.origin = &origin,
                               .step = 200,
                               .elements = f->elements,
                               .n_elements = f->n,
                               .pairs = f->pairs,
                               .n_pairs = f->n_pairs};
}

/* A state without further sections, or with all of them. */
static inline enum dm2_status write_all(const struct fake *f, const char *name)
{
    struct state_view view = view_of(f);
    add_sections(&view);
    return write_view(&view, name);
}

static inline enum dm2_status write_fake(const struct fake *f, const char *name)
{
    struct dm2_error err = {0};
    const struct state_view view = view_of(f);
    enum dm2_status status = state_write(scratch_path(name), &view, &err);
    CHECK_STR(err.text, "");
    return status;
}

enum { HEADER = 88, TEXT = sizeof meaning - 1, ELEMENTS = HEADER + 16 + TEXT + 16 + 64 * 4 + 16 };

static inline void write_bytes(const char *name, const char *bytes, size_t n)
{
    FILE *f = fopen(scratch_path(name), "wb");
    CHECK(f != NULL && fwrite(bytes, 1, n, f) == n && fclose(f) == 0);
}

/* Reads the file `name`, which must fail, and returns the message. */
static inline const char *read_failure(const char *name)
{
    static struct dm2_error err;
    struct state s;
    err.text[0] = '\0';
    enum dm2_status status = state_read(scratch_path(name), &s, &err);
    CHECK_REPORT(status == DM2_PROTOCOL, "status is %d, text '%s'", status, err.text);
    CHECK(s.elements == NULL && s.pairs == NULL && s.origin.text == NULL && s.origin.names == NULL);
    for (int k = 0; k < SECTION_COUNT; k++)
        CHECK(s.sections[k].records == NULL);
    CHECK_CONTAINS(err.text, scratch_path(name));
    return err.text;
}

/* Writes changed bytes under a checksum that matches. */
static inline void write_sealed(const char *name, char *bytes, size_t n)
{
    uint32_t crc = crc32c(0, bytes, n - 4);
    for (int k = 0; k < 4; k++)
        bytes[n - 4 + (size_t)k] = (char)(crc >> (8 * k));
    write_bytes(name, bytes, n);
}

#endif
