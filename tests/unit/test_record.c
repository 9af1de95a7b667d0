/* The table of an element's fields: complete, round trips in every form and through the engine's arrays,
 * and refused values. */
#include "check.h"
#include "record_help.h"

#include "dm2/base/crc32c.h"
#include "dm2/output/state_hash.h"
#include "engine/particles.h"

static const struct record_limits limits = {
    .elements = 1000, .bodies = 3, .kinds = 4, .probes = 2, .periodic = {true, true}};

/* Each byte of struct element belongs to one field, except `home`, which has records of its own, and the
 * padding at the end. */
TEST(the_table_is_complete)
{
    unsigned char used[sizeof(struct element)] = {0};
    size_t bytes = 0, mirrored = 0, doubles = 0;
    for (size_t k = 0; k < ELEMENT_FIELDS; k++) {
        const struct element_field *f = &element_fields[k];
        for (size_t b = 0; b < record_field_bytes(f); b++)
            CHECK_EQ_INT(used[f->offset + b]++, 0);
        bytes += record_field_bytes(f);
        mirrored += f->owner ? 0 : record_field_bytes(f);
        doubles += f->type == FIELD_F64 ? (size_t)f->count : 0;
        CHECK(k == 0 || f->owner >= f[-1].owner);
    }
    CHECK_EQ_INT(bytes, RECORD_BYTES);
    CHECK_EQ_INT(mirrored, RECORD_MIRROR_BYTES);
    CHECK_EQ_INT(doubles, ELEMENT_DOUBLES);
    memset(used + offsetof(struct element, home), 1, sizeof((struct element *)0)->home);
    size_t end = sizeof used;
    while (end > 0 && used[end - 1] == 0)
        end--;
    CHECK(sizeof used - end < sizeof(double));
    CHECK(memchr(used, 0, end) == NULL);
}

/* The value of each field comes back to its own place; a field that a mirror lacks is 0. */
TEST(every_field_in_every_form)
{
    static const enum record_form forms[] = {RECORD_MIRROR, RECORD_OWNED, RECORD_STATE};
    struct bytes_writer w = {0};
    const struct element e = record_sample(77), zero = {0};
    for (size_t k = 0; k < 3; k++) {
        struct element got;
        bool mirror = forms[k] == RECORD_MIRROR;
        bytes_clear(&w);
        record_put(&w, forms[k], &e);
        CHECK_EQ_INT(w.length, mirror ? RECORD_MIRROR_BYTES : RECORD_BYTES);
        struct bytes_reader r = bytes_reader_of(w.data, w.length);
        record_get(&r, forms[k], &got);
        CHECK(bytes_done(&r));
        CHECK(record_difference(&got, &e, mirror) == NULL);
        for (size_t f = 0; f < ELEMENT_FIELDS && mirror; f++)
            CHECK(!element_fields[f].owner || memcmp((const char *)&got + element_fields[f].offset, &zero,
                                                     record_field_bytes(&element_fields[f])) == 0);
        for (size_t n = 0; n < w.length; n++) { /* cut anywhere */
            r = bytes_reader_of(w.data, n);
            record_get(&r, forms[k], &got);
            CHECK(r.failed);
            CHECK(record_difference(&got, &zero, false) == NULL);
        }
    }
    bytes_free(&w);
}

/* A field of -0 has the bytes and the hash of 0. */
TEST(a_negative_zero_is_stored_as_zero)
{
    struct bytes_writer w = {0};
    for (size_t k = 0; k < ELEMENT_FIELDS; k++) {
        const struct element_field *f = &element_fields[k];
        struct element plus = record_sample(1), minus = plus, got;
        const double zeros[3] = {0.0, 0.0, 0.0}, negative[3] = {-0.0, -0.0, -0.0};
        if (f->type != FIELD_F64)
            continue;
        memcpy((char *)&plus + f->offset, zeros, record_field_bytes(f));
        memcpy((char *)&minus + f->offset, negative, record_field_bytes(f));
        CHECK_EQ_INT(state_hash_element(&minus), state_hash_element(&plus));
        bytes_clear(&w);
        record_put(&w, RECORD_STATE, &minus);
        struct bytes_reader r = bytes_reader_of(w.data, w.length);
        record_get(&r, RECORD_STATE, &got);
        CHECK_REPORT(record_difference(&got, &plus, false) == NULL, "%s", f->name);
    }
    bytes_free(&w);
}

/* Checksums of the bytes in each form, and the hash of a state: messages and state files of other programs of
 * the same versions have the same. */
TEST(the_bytes_are_those_of_the_versions)
{
    static const struct {
        enum record_form form;
        uint32_t crc;
    } want[] = {{RECORD_MIRROR, 0xbb70567f}, {RECORD_OWNED, 0xd553679f}, {RECORD_STATE, 0x9727fd55}};
    const struct element e = {.id = 0x01020304,
                              .grain = 0xa1b2c3d4,
                              .body = 0x1122,
                              .kind = 0x3344,
                              .was = 0x5566,
                              .flags = 1,
                              .probes = 0x81,
                              .radius = 0.02,
                              .mass = 0.1,
                              .r = {1.5, -2.5},
                              .v = {-0.0, 5e-324},
                              .w = 1e300,
                              .heat = 0.25,
                              .p = -0.125,
                              .share = {0.25, 0.5},
                              .work = 3.5,
                              .strain = {0.5, -0.25, 1e-9},
                              .moved = -0.75,
                              .image = {-2, 0x01020304},
                              .damped = 0.375,
                              .bonds = 0x778};
    struct bytes_writer w = {0};
    for (size_t k = 0; k < sizeof want / sizeof want[0]; k++) {
        bytes_clear(&w);
        record_put(&w, want[k].form, &e);
        CHECK_EQ_INT(crc32c(0, w.data, w.length), want[k].crc);
    }
    bytes_free(&w);
    CHECK_EQ_INT(state_hash_element(&e), 0xafb92d4e126a2b88);
}

TEST(doubles_in_the_order_of_the_state_file)
{
    const struct element e = record_sample(1);
    const double want[ELEMENT_DOUBLES] = {
        e.radius, e.mass,      e.r[0],      e.r[1],      e.v[0],     e.v[1],     e.w,     e.heat,  e.p,
        e.work,   e.strain[0], e.strain[1], e.strain[2], e.share[0], e.share[1], e.moved, e.damped};
    double got[ELEMENT_DOUBLES];
    record_doubles(&e, got);
    for (int k = 0; k < ELEMENT_DOUBLES; k++)
        CHECK_SAME_BITS(got[k], want[k]);
}

/* --- the engine's arrays --- */

/* Puts the sample into slot 1 of 3 and gets slot 1. */
static struct element through_arrays(const struct model *m)
{
    struct particles p;
    struct element e = record_sample(5), other = record_sample(6), got = {0};
    particles_start(&p, m);
    CHECK_EQ_INT(particles_reserve(&p, 3), 0);
    particles_put(&p, m, 1, &e);
    particles_put(&p, m, 0, &other);
    particles_put(&p, m, 2, &other);
    particles_get(&p, 1, &got);
    particles_free(&p);
    return got;
}

TEST(every_field_through_the_arrays)
{
    struct config config = {.gravity = {0, -1}, .periodic = {true, false}};
    struct kind kinds[3] = {{.cp = 1, .over_cp = 1}, {.cp = 1, .over_cp = 1}, {.cp = 1, .over_cp = 1}};
    const struct model m = {.config = &config,
                            .kinds = kinds,
                            .n_kinds = 3,
                            .has_near = true,
                            .has_pressure = true,
                            .has_kinds = true,
                            .has_strain = true,
                            .has_damping = true,
                            .reaction = {.any = true, .reactant = {0, 1}, .product = 2}};
    const struct element e = record_sample(5), got = through_arrays(&m);
    const char *field = record_difference(&got, &e, false);
    CHECK_REPORT(field == NULL, "%s is lost", field);
}

/* Without its physics the engine has no array for these fields, and they are 0. */
TEST(fields_that_no_physics_needs)
{
    struct config config = {.n_bodies = 0};
    struct kind kinds[3] = {{.cp = INFINITY}, {.cp = INFINITY}, {.cp = INFINITY}};
    const struct model m = {.config = &config, .kinds = kinds, .n_kinds = 3};
    struct element want = record_sample(5);
    const struct element got = through_arrays(&m);
    want.p = want.work = want.moved = want.damped = want.share[0] = want.share[1] = 0;
    want.strain[0] = want.strain[1] = want.strain[2] = 0;
    want.bonds = want.was = 0;
    want.image[0] = want.image[1] = 0;
    const char *field = record_difference(&got, &want, false);
    CHECK_REPORT(field == NULL, "%s differs", field);
}

/* --- valid values --- */

/* The first invalid field of the element is `name`, and its description is `text`. */
static void check_fault(const struct element *e, const struct record_limits *most, const char *name,
                        const char *text)
{
    char got[RECORD_FAULT_TEXT];
    const struct element_field *fault = record_fault(e, most);
    CHECK(fault != NULL);
    if (fault == NULL)
        return;
    CHECK_STR(fault->name, name);
    record_describe_fault(fault, e, most, got);
    CHECK_STR(got, text);
}

static void check_valid(const struct element *e, const struct record_limits *most)
{
    const struct element_field *fault = record_fault(e, most);
    CHECK_REPORT(fault == NULL, "%s is refused", fault->name);
}

TEST(every_double_is_finite)
{
    static const double wrong[] = {NAN, INFINITY, -INFINITY};
    for (size_t k = 0; k < ELEMENT_FIELDS; k++) {
        const struct element_field *f = &element_fields[k];
        for (int c = 0; c < f->count && f->type == FIELD_F64; c++)
            for (size_t n = 0; n < 3; n++) {
                struct element e = record_sample(1);
                memcpy((char *)&e + f->offset + (size_t)c * sizeof(double), &wrong[n], sizeof(double));
                char text[RECORD_FAULT_TEXT];
                snprintf(text, sizeof text, "has a number that is not finite: %s %g", f->name, wrong[n]);
                check_fault(&e, &limits, f->name, text);
                check_fault(&e, NULL, f->name, text);
            }
    }
}

TEST(values_without_limits)
{
    struct element e = record_sample(1);
    check_valid(&e, NULL);
    e.radius = 0;
    check_fault(&e, NULL, "radius", "has a radius or a mass that is not positive: radius 0");
    e = record_sample(1);
    e.mass = -1;
    check_fault(&e, NULL, "mass", "has a radius or a mass that is not positive: mass -1");
    e = record_sample(1);
    e.flags = 2;
    check_fault(&e, NULL, "flags", "has a flag that this program does not know: flags 2, 0 or 1 is expected");
    e = record_sample(1);
    e.share[1] = 7;
    check_fault(&e, NULL, "share", "has share 7, 0 to 1 is expected");
    e.share[1] = -0.25;
    check_fault(&e, NULL, "share", "has share -0.25, 0 to 1 is expected");
    e.share[0] = e.share[1] = 0.625;
    check_fault(&e, NULL, "share", "has share 0.625 and 0.625, a sum of at most 1 is expected");
    e.image[1] = -IMAGE_MOST - 1;
    e.share[0] = e.share[1] = 0.5;
    check_fault(&e, NULL, "image", "has image -1073741825 in y, at most 2^30 either way is expected");
    e.image[1] = IMAGE_MOST;
    e.share[0] = 0;
    e.share[1] = 1;
    check_valid(&e, NULL);
    e = record_sample(UINT32_MAX); /* any index */
    e.body = e.kind = e.was = UINT16_MAX;
    e.probes = UINT8_MAX;
    check_valid(&e, NULL);
}

TEST(indices_within_limits)
{
    struct element e = record_sample(999);
    e.body = 2;
    e.kind = e.was = 3;
    check_valid(&e, &limits);
    e.id = 1000;
    check_fault(&e, &limits, "id", "is none of the 1000 elements that the deck makes");
    e = record_sample(1);
    e.body = 3;
    check_fault(&e, &limits, "body",
                "is of a body or a kind that the deck does not have: body 3, counted from 0; the deck has 3");
    e = record_sample(1);
    e.kind = 4;
    check_fault(&e, &limits, "kind",
                "is of a body or a kind that the deck does not have: kind 4, counted from 0; the deck has 4");
    e = record_sample(1);
    e.was = 9;
    check_fault(&e, &limits, "was",
                "is of a body or a kind that the deck does not have: was 9, counted from 0; the deck has 4");
    e = record_sample(1);
    e.probes = 4;
    check_fault(&e, &limits, "probes", "belongs to probe 2, counted from 0; the deck has 2");
    e.probes = 0x81;
    check_fault(&e, &limits, "probes", "belongs to probe 7, counted from 0; the deck has 2");
    struct record_limits free_y = limits;
    free_y.periodic[1] = false;
    e = record_sample(1);
    check_fault(&e, &free_y, "image", "has image -5 in y, 0 is expected: the domain is not periodic there");
    struct record_limits probes = limits;
    probes.probes = 8;
    check_valid(&e, &probes);
    probes.probes = 0;
    e.probes = 1;
    check_fault(&e, &probes, "probes", "belongs to probe 0, counted from 0; the deck has 0");
}

TEST_MAIN(CASE(the_table_is_complete), CASE(every_field_in_every_form),
          CASE(a_negative_zero_is_stored_as_zero), CASE(the_bytes_are_those_of_the_versions),
          CASE(doubles_in_the_order_of_the_state_file), CASE(every_field_through_the_arrays),
          CASE(fields_that_no_physics_needs), CASE(every_double_is_finite), CASE(values_without_limits),
          CASE(indices_within_limits))
