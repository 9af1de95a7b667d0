/* Records and messages as bytes: round trips, sizes, every cut, every changed byte, and invalid values. */
#include "check.h"
#include "record_help.h"
#include "wire_help.h"

#include "dm2/cluster/messages.h"
#include "dm2/cluster/wire.h"
#include "cluster/state_merge.h"

static const struct record_limits limits = {
    .elements = 1000, .bodies = 2, .kinds = 3, .probes = 6, .periodic = {true, true}};

static struct element some_element(uint32_t id)
{
    return (struct element){.id = id,
                            .grain = 7,
                            .body = 1,
                            .kind = 2,
                            .flags = ELEMENT_FIXED_MOTION,
                            .probes = 0x21,
                            .radius = 0.02,
                            .mass = 0.1 + id,
                            .r = {1.5, -2.5},
                            .v = {0.0, 5e-324},
                            .w = 1e300,
                            .heat = 0.25,
                            .p = -0.125,
                            .work = 3.5,
                            .strain = {0.5, -0.25, 1e-9},
                            .moved = -0.75,
                            .image = {-1, 1 << 30},
                            .bonds = 6,
                            .was = 1,
                            .share = {0.25, 0.5}};
}

/* The parts of a parcel: two migrants with three pairs, and a mirror. */
static const struct pair_record some_pairs[3] = {{1, 2, 1, 0.5, -0.5}, {1, 999, 0, 0, 1}, {0, 1, 1, -1, 0}};

TEST(sizes)
{
    struct bytes_writer w = {0};
    struct element e = some_element(5);
    struct element_measure m = {
        .stress = {1, 2, 3}, .velocity = {4, 5}, .temperature = 300, .links = 6, .contacts = 1};
    wire_put_element(&w, &e);
    CHECK_EQ_INT(w.length, WIRE_ELEMENT);
    wire_put_pair(&w, &some_pairs[0]);
    CHECK_EQ_INT(w.length, WIRE_ELEMENT + WIRE_PAIR);
    wire_put_measured(&w, &m);
    CHECK_EQ_INT(w.length, WIRE_ELEMENT + WIRE_PAIR + WIRE_MEASURED);
    bytes_clear(&w);
    wire_put_mirror(&w, &e);
    CHECK_EQ_INT(w.length, WIRE_MIRROR);
    bytes_free(&w);
}

TEST(a_parcel_round_trip)
{
    struct bytes_writer w = {0};
    struct element migrants[2] = {some_element(1), some_element(999)}, mirror = some_element(0);
    struct parcel out = {.migrants = migrants,
                         .n_migrants = 2,
                         .pairs = (struct pair_record *)(uintptr_t)some_pairs,
                         .n_pairs = 3,
                         .mirrors = &mirror,
                         .n_mirrors = 1},
                  in;
    wire_put_parcel(&w, &out);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    wire_get_parcel(&r, &limits, &in);
    CHECK(bytes_done(&r));
    CHECK_EQ_INT(in.n_migrants, 2);
    CHECK_EQ_INT(in.n_pairs, 3);
    CHECK_EQ_INT(in.n_mirrors, 1);
    CHECK(record_difference(&in.migrants[0], &migrants[0], false) == NULL);
    CHECK(record_difference(&in.migrants[1], &migrants[1], false) == NULL);
    CHECK(record_difference(&in.mirrors[0], &mirror, true) == NULL);
    CHECK(in.mirrors[0].work == 0 && in.mirrors[0].bonds == 0); /* the owner's fields */
    for (int k = 0; k < 3; k++)
        CHECK(in.pairs[k].id_a == some_pairs[k].id_a && in.pairs[k].id_b == some_pairs[k].id_b &&
              in.pairs[k].linked == some_pairs[k].linked && in.pairs[k].stretch == some_pairs[k].stretch &&
              in.pairs[k].spring == some_pairs[k].spring);
    wire_parcel_free(&in);
    for (size_t n = 0; n < w.length; n++) { /* cut anywhere */
        r = bytes_reader_of(w.data, n);
        wire_get_parcel(&r, &limits, &in);
        CHECK(r.failed && in.migrants == NULL);
    }
    for (size_t at = 0; at < w.length; at++) { /* changed anywhere: a parcel that decodes is valid */
        w.data[at] ^= 0xff;
        r = bytes_reader_of(w.data, w.length);
        wire_get_parcel(&r, &limits, &in);
        for (size_t k = 0; k < in.n_migrants; k++)
            CHECK(in.migrants[k].id < limits.elements && isfinite(in.migrants[k].r[0]));
        wire_parcel_free(&in);
        w.data[at] ^= 0xff;
    }
    bytes_free(&w);
}

/* Checks that the element does not decode: alone, in a parcel, and, with `mirrored`, as a mirror. */
static void check_refused(struct element e, bool mirrored)
{
    struct bytes_writer w = {0};
    struct parcel in, parcels[] = {{.migrants = &e, .n_migrants = 1}, {.mirrors = &e, .n_mirrors = 1}};
    struct element got;
    wire_put_element(&w, &e);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    wire_get_element(&r, &limits, &got);
    CHECK(r.failed);
    for (int k = 0; k < (mirrored ? 2 : 1); k++) {
        char why[BYTES_WHY] = "", id[40], text[RECORD_FAULT_TEXT];
        (void)snprintf(id, sizeof id, "element %u ", e.id);
        record_describe_fault(record_fault(&e, &limits), &e, &limits, text);
        bytes_clear(&w);
        wire_put_parcel(&w, &parcels[k]);
        r = bytes_reader_of(w.data, w.length);
        r.why = why;
        wire_get_parcel(&r, &limits, &in);
        CHECK(r.failed && in.migrants == NULL && in.mirrors == NULL);
        CHECK_CONTAINS(why, id);
        CHECK_CONTAINS(why, text);
    }
    bytes_free(&w);
}

TEST(invalid_elements)
{
    struct element e = some_element(1000);
    check_refused(e, true);
    e = some_element(1);
    e.body = 2;
    check_refused(e, true);
    e = some_element(1);
    e.kind = 3;
    check_refused(e, true);
    e = some_element(1);
    e.was = 3;
    check_refused(e, true);
    e = some_element(1);
    e.flags = 2;
    check_refused(e, true);
    e = some_element(1);
    e.probes = 1 << 6;
    check_refused(e, true);
    e = some_element(1);
    e.share[0] = 7;
    check_refused(e, true);
    e = some_element(1);
    e.share[1] = -0.125;
    check_refused(e, true);
    e = some_element(1);
    e.r[1] = NAN;
    check_refused(e, true);
    e = some_element(1);
    e.v[0] = INFINITY;
    check_refused(e, true);
    e = some_element(1);
    e.mass = 0;
    check_refused(e, true);
    e = some_element(1);
    e.radius = -1;
    check_refused(e, true);
    e = some_element(1);
    e.image[0] = IMAGE_MOST + 1;
    check_refused(e, false);
    e = some_element(1);
    e.strain[2] = NAN;
    check_refused(e, false);
}

static void check_pair_refused(struct pair_record p)
{
    struct bytes_writer w = {0};
    wire_put_pair(&w, &p);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    char why[BYTES_WHY] = "";
    r.why = why;
    wire_get_pair(&r, &limits, &p);
    CHECK(r.failed);
    CHECK_CONTAINS(why, "the pair of element ");
    bytes_free(&w);
}

TEST(invalid_pairs)
{
    check_pair_refused((struct pair_record){2, 1, 0, 0, 0});
    check_pair_refused((struct pair_record){1, 1, 0, 0, 0});
    check_pair_refused((struct pair_record){1, 1000, 0, 0, 0});
    check_pair_refused((struct pair_record){1, 2, 2, 0, 0});
    check_pair_refused((struct pair_record){1, 2, 1, NAN, 0});
    check_pair_refused((struct pair_record){1, 2, 1, 0, -INFINITY});
}

TEST(a_deck_message_round_trip)
{
    struct bytes_writer w = {0};
    char define[2][8] = {"n=3", "scale=2"}, name[2][8] = {"a.dm2", "b.dm2"},
         text[2][16] = {"domain {}\n", ""};
    char *defines[] = {define[0], define[1]}, path[] = "input/a.dm2";
    struct deck_text texts[] = {{name[0], text[0], 10}, {name[1], text[1], 0}};
    struct deck_message out = {.with_texts = true, .name = path, .digest = {1, 2, 3}}, in;
    out.source =
        (struct deck_source){.texts = texts, .n_texts = 2, .defines = defines, .n_defines = 2, .steps = -1};
    message_put_deck(&w, &out);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_deck(&r, &in);
    CHECK(!r.failed);
    CHECK_STR(in.name, "input/a.dm2");
    CHECK_EQ_INT(in.source.n_texts, 2);
    CHECK_STR(in.source.texts[0].text, "domain {}\n");
    CHECK_EQ_INT(in.source.texts[0].length, 10);
    CHECK_STR(in.source.defines[1], "scale=2");
    CHECK_EQ_INT(in.source.steps, -1);
    message_free_deck(&in);
    for (size_t n = 0; n < w.length; n++) {
        r = bytes_reader_of(w.data, n);
        message_get_deck(&r, &in);
        CHECK(r.failed);
        message_free_deck(&in);
    }
    for (size_t at = 0; at < w.length; at++) {
        w.data[at] ^= 0xff;
        r = bytes_reader_of(w.data, w.length);
        message_get_deck(&r, &in);
        message_free_deck(&in);
        w.data[at] ^= 0xff;
    }
    bytes_free(&w);
}

TEST(an_assign_message_round_trip)
{
    struct bytes_writer w = {0};
    struct cell_rect rects[2] = {{0, 0, 2, 4}, {2, 0, 4, 4}};
    struct assign_message out = {.rank = 1,
                                 .ranks = 2,
                                 .cx = 4,
                                 .cy = 4,
                                 .elements = 99,
                                 .rects = rects,
                                 .interfaces = {1, 0, 0, 0, 0, 0, 0, 0},
                                 .timeout = 60,
                                 .hash_every = 5,
                                 .rebuild_first = true},
                          in;
    message_put_assign(&w, &out);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_assign(&r, &in);
    CHECK(!r.failed);
    CHECK(in.rank == 1 && in.ranks == 2 && in.cx == 4 && in.elements == 99 && in.rects[1].x1 == 4 &&
          in.interfaces[0] == 1 && in.hash_every == 5 && in.rebuild_first);
    message_free_assign(&in);
    for (size_t n = 0; n < w.length; n++) {
        r = bytes_reader_of(w.data, n);
        message_get_assign(&r, &in);
        CHECK(r.failed);
        message_free_assign(&in);
    }
    out.rank = 2;
    bytes_clear(&w);
    message_put_assign(&w, &out);
    r = bytes_reader_of(w.data, w.length);
    message_get_assign(&r, &in);
    CHECK(r.failed);
    message_free_assign(&in);
    bytes_free(&w);
}

TEST(a_ready_message_round_trip)
{
    struct bytes_writer w = {0};
    /* pairs, ratio, ids, bodies, places */
    struct overlap overlap = {4, 0.625, {7, 9}, {1, 2}, {{0.25, -0.5}, {0.125, 1.5}}};
    struct ready_message out = {.owned = 5, .mirrored = 6, .bytes = 7, .hash = 8, .overlap = overlap}, in;
    message_put_ready(&w, &out);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_ready(&r, &in);
    CHECK(!r.failed && in.owned == 5 && in.mirrored == 6 && in.bytes == 7 && in.hash == 8);
    CHECK(in.overlap.pairs == 4 && in.overlap.ratio == 0.625);
    CHECK(in.overlap.id[0] == 7 && in.overlap.id[1] == 9 && in.overlap.body[1] == 2);
    CHECK_SAME_BITS(in.overlap.r[0][1], -0.5);
    CHECK_SAME_BITS(in.overlap.r[1][1], 1.5);
    for (size_t n = 0; n < w.length; n++) {
        r = bytes_reader_of(w.data, n);
        message_get_ready(&r, &in);
        CHECK(r.failed);
    }
    const double wrong[] = {-0.5, 1.0, NAN};
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        bytes_clear(&w);
        out.overlap.ratio = wrong[k];
        message_put_ready(&w, &out);
        r = bytes_reader_of(w.data, w.length);
        message_get_ready(&r, &in);
        CHECK(r.failed);
    }
    bytes_free(&w);
}

TEST(the_small_messages)
{
    struct bytes_writer w = {0};
    struct hello_message hello = {.turn = true, .fingerprint = 42, .version = "1.2"}, hello_in;
    message_put_hello(&w, &hello);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_hello(&r, &hello_in);
    CHECK(!r.failed && hello_in.fingerprint == 42);
    CHECK_STR(hello_in.version, "1.2");
    bytes_clear(&w);
    struct next_message next = {.step = 3, .redo = true, .survey_next = true}, next_in;
    message_put_next(&w, &next);
    r = bytes_reader_of(w.data, w.length);
    message_get_next(&r, &next_in);
    CHECK(bytes_done(&r) && next_in.redo && !next_in.rebuild_next && next_in.survey_next &&
          next_in.step == 3 && !next_in.ends);
    bytes_clear(&w);
    struct done_message done = {.measures = some_measures(),
                                .cracks = {.n = 2, .items = some_cracks},
                                .times = {.forces = 1.5, .bytes_out = 77}},
                        done_in;
    message_put_done(&w, &done);
    r = bytes_reader_of(w.data, w.length);
    message_get_done(&r, &done_in);
    CHECK(!r.failed && done_in.times.bytes_out == 77 && same_cracks(&done_in.cracks));
    CHECK_SAME_BITS(done_in.times.forces, 1.5);
    bytes_clear(&w);
    struct error_message error = {.status = DM2_NUMERIC, .text = "bad \033[2J\a"}, error_in;
    message_put_error(&w, &error);
    r = bytes_reader_of(w.data, w.length);
    message_get_error(&r, &error_in);
    CHECK(!r.failed && error_in.status == DM2_NUMERIC);
    CHECK_STR(error_in.text, "bad ?[2J?"); /* no escape sequence reaches a terminal */
    bytes_free(&w);
}

/* A part of a state: elements first .. first + n - 1, and one pair. */
static enum dm2_status add_part(struct state_merge *m, uint32_t first, uint32_t n, struct pair_record pair,
                                struct dm2_error *err)
{
    struct bytes_writer w = {0};
    struct state_message head = {
        .step = 4, .purpose = STATE_FINAL, .last = true, .n_elements = n, .n_pairs = 1};
    message_put_state(&w, &head);
    for (uint32_t k = 0; k < n; k++) {
        struct element e = some_element(first + k);
        wire_put_element(&w, &e);
    }
    wire_put_pair(&w, &pair);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_state(&r, &head);
    CHECK(!r.failed);
    enum dm2_status status = state_merge_add(m, &head, &r, err);
    bytes_free(&w);
    return status;
}

TEST(a_state_is_compiled_from_parts)
{
    struct state_merge m;
    struct dm2_error err = {0};
    const struct record_limits ten = {
        .elements = 10, .bodies = 2, .kinds = 3, .probes = 8, .periodic = {true, true}};
    state_merge_open(&m, ten);
    for (int round = 0; round < 2; round++) {
        state_merge_clear(&m);
        CHECK_EQ_INT(add_part(&m, 6, 4, (struct pair_record){6, 9, 1, 0, 0}, &err), DM2_OK);
        CHECK_EQ_INT(add_part(&m, 3, 3, (struct pair_record){0, 9, 1, 0, 0}, &err), DM2_OK);
        CHECK_EQ_INT(state_merge_finish(&m, &err), DM2_PROTOCOL);
        CHECK_CONTAINS(err.text, "3 of 10 elements are missing, the first is element 0");
        CHECK_EQ_INT(add_part(&m, 0, 3, (struct pair_record){0, 1, 1, 0, 0}, &err), DM2_OK);
        CHECK_EQ_INT(state_merge_finish(&m, &err), DM2_OK);
        for (uint32_t k = 0; k < 10; k++)
            CHECK_EQ_INT(m.elements[k].id, k);
        CHECK_EQ_INT(m.n_pairs, 3);
        CHECK(m.pairs[0].id_b == 1 && m.pairs[1].id_b == 9 && m.pairs[2].id_a == 6);
        CHECK_EQ_INT(add_part(&m, 4, 1, (struct pair_record){0, 1, 1, 0, 0}, &err), DM2_NUMERIC);
        CHECK_CONTAINS(err.text, "element 4 came twice");
    }
    state_merge_clear(&m);
    CHECK_EQ_INT(add_part(&m, 0, 5, (struct pair_record){1, 3, 1, 0, 0}, &err), DM2_OK);
    CHECK_EQ_INT(add_part(&m, 5, 5, (struct pair_record){1, 3, 1, 0, 0}, &err), DM2_OK);
    CHECK_EQ_INT(state_merge_finish(&m, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "pair 1-3 came twice");
    state_merge_clear(&m);
    for (size_t k = 0; k < 10 * WIRE_PAIRS_MOST; k++)
        CHECK_EQ_INT(add_part(&m, (uint32_t)k, k < 10, (struct pair_record){1, 3, 1, 0, 0}, &err), DM2_OK);
    CHECK_EQ_INT(add_part(&m, 0, 0, (struct pair_record){1, 3, 1, 0, 0}, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "more than 64 pairs per element");
    CHECK_EQ_INT(m.n_pairs, 10 * WIRE_PAIRS_MOST);
    state_merge_free(&m);
}

/* The client refuses a part of a state with an invalid element. */
TEST(a_state_with_an_invalid_element)
{
    struct state_message head = {.step = 4, .purpose = STATE_FINAL, .last = true, .n_elements = 1};
    struct element wrong[] = {some_element(3), some_element(3)};
    wrong[0].share[1] = 7;
    wrong[1].probes = 1 << 6;
    static const char *const why[] = {"element 3 has share 7, 0 to 1 is expected",
                                      "element 3 belongs to probe 6, counted from 0; the deck has"};
    for (int k = 0; k < 2; k++) {
        struct state_merge m;
        struct bytes_writer w = {0};
        struct dm2_error err = {0};
        state_merge_open(&m, limits);
        wire_put_element(&w, &wrong[k]);
        struct bytes_reader r = bytes_reader_of(w.data, w.length);
        CHECK_EQ_INT(state_merge_add(&m, &head, &r, &err), DM2_NUMERIC);
        CHECK_CONTAINS(err.text, why[k]);
        CHECK_CONTAINS(err.text, "a part of a state has a value that cannot be: element 3 ");
        CHECK_EQ_INT(m.n_seen, 0);
        r = bytes_reader_of(w.data, 20);
        CHECK_EQ_INT(state_merge_add(&m, &head, &r, &err), DM2_PROTOCOL);
        CHECK_CONTAINS(err.text, "a part of a state is cut");
        state_merge_free(&m);
        bytes_free(&w);
    }
}

/* A profile's message: the head, two bins, and every cut. */
TEST(a_profile)
{
    struct bytes_writer w = {0};
    struct profile_bin bin = {.elements = 7,
                              .mass = {1, 2},
                              .momentum = {{3, 4}, {-5, 6}},
                              .volume = {7, 8},
                              .stress = {{9, 10}, {-11, 12}, {13, UINT64_MAX}},
                              .temperature = {14, 15}},
                       got;
    struct profile_message m = {.step = 40, .which = 2, .n_bins = 2}, in;
    message_put_profile(&w, &m);
    size_t head = w.length;
    wire_put_bin(&w, &bin);
    CHECK_EQ_INT(w.length, head + WIRE_BIN);
    wire_put_bin(&w, &bin);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_profile(&r, &in);
    CHECK(!r.failed && in.step == 40 && in.which == 2 && in.n_bins == 2);
    wire_get_bin(&r, &got);
    CHECK_EQ_INT(memcmp(&got, &bin, sizeof bin), 0);
    wire_get_bin(&r, &got);
    CHECK(bytes_done(&r));
    for (size_t n = 0; n < w.length; n++) { /* cut anywhere */
        r = bytes_reader_of(w.data, n);
        message_get_profile(&r, &in);
        CHECK(r.failed);
    }
    bytes_free(&w);
}

TEST_MAIN(CASE(sizes), CASE(a_parcel_round_trip), CASE(invalid_elements), CASE(invalid_pairs),
          CASE(a_deck_message_round_trip), CASE(an_assign_message_round_trip),
          CASE(a_ready_message_round_trip), CASE(the_small_messages), CASE(a_state_is_compiled_from_parts),
          CASE(a_state_with_an_invalid_element), CASE(a_profile))
