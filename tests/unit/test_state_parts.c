/* Further sections in STATE messages: round trip, every cut, order, merging, shares of ranks. */
#include "check.h"
#include "record_help.h"

#include <stdlib.h>

#include "dm2/cluster/messages.h"
#include "dm2/cluster/wire.h"
#include "cluster/state_merge.h"
#include "cluster/state_parts.h"

static struct home_record homes[] = {{0, {0.5, 1}}, {3, {2, -1}}, {5, {0.25, 0}}};
static struct body_record bodies[] = {{.mover = 0, .spin = 1}, {.mover = 1, .contacts = {3, 4}}};
static struct wall_contact contacts[] = {{1, 0, 1, 0.5}, {3, 1, -1, 0}, {3, 2, 1, -0.5}};
static const struct record_limits walls = {.elements = 10,
                                           .bodies = 3,
                                           .kinds = 3,
                                           .probes = 8,
                                           .periodic = {true, true},
                                           .movers = 2,
                                           .features = 3,
                                           .sections = 7};

static const struct record_limits plain = {
    .elements = 10, .bodies = 3, .kinds = 3, .probes = 8, .periodic = {true, true}};

/* A state of ten elements without pairs, all sections there. The caller frees the elements. */
static struct state_view state_with_sections(void)
{
    struct element *elements = calloc(10, sizeof *elements);
    for (uint32_t k = 0; k < 10 && elements != NULL; k++)
        elements[k] = record_sample(k);
    return (struct state_view){.step = 4,
                               .elements = elements,
                               .n_elements = 10,
                               .sections = {[SECTION_HOME] = {homes, 3, 3},
                                            [SECTION_BODY] = {bodies, 2, 2},
                                            [SECTION_WCON] = {contacts, 3, 3}}};
}

static void put_parts(const struct state_view *view, struct bytes_writer *w)
{
    struct state_parts parts = {.head = {.step = 4, .purpose = STATE_COPY}, .state = *view};
    CHECK(state_parts_next(&parts, w));
    CHECK(parts.head.last);
}

TEST(a_state_message_with_sections)
{
    struct bytes_writer w = {0};
    struct state_view view = state_with_sections();
    struct state_message m;
    put_parts(&view, &w);
    CHECK_EQ_INT(w.length, 11 + 4 * SECTION_HEAD + 10 * 162 + 3 * 20 + 2 * 218 + 3 * 17);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_state(&r, &m);
    CHECK(!r.failed && m.n_elements == 10 && m.n_pairs == 0 && m.last && !state_message_empty(&m));
    CHECK(m.sections[SECTION_HOME] == 3 && m.sections[SECTION_BODY] == 2 && m.sections[SECTION_WCON] == 3);
    for (size_t n = 0; n < w.length; n++) { /* cut anywhere */
        r = bytes_reader_of(w.data, n);
        message_get_state(&r, &m);
        CHECK(r.failed);
    }
    for (size_t at = 10; at < 11 + 4 * SECTION_HEAD; at++) { /* a head changed anywhere */
        w.data[at] ^= 1;
        r = bytes_reader_of(w.data, w.length);
        message_get_state(&r, &m);
        CHECK_REPORT(r.failed, "byte %zu", at);
        w.data[at] ^= 1;
    }
    unsigned char head[SECTION_HEAD]; /* two sections in the wrong order */
    memcpy(head, w.data + 11 + SECTION_HEAD, sizeof head);
    memcpy(w.data + 11 + SECTION_HEAD, w.data + 11 + 2 * SECTION_HEAD, sizeof head);
    memcpy(w.data + 11 + 2 * SECTION_HEAD, head, sizeof head);
    r = bytes_reader_of(w.data, w.length);
    message_get_state(&r, &m);
    CHECK(r.failed);
    free((void *)(uintptr_t)view.elements);
    bytes_free(&w);
}

/* Adds a message to the state; the message belongs to the caller. */
static enum dm2_status add_message(struct state_merge *m, const struct bytes_writer *w, struct dm2_error *err)
{
    struct state_message head;
    struct bytes_reader r = bytes_reader_of(w->data, w->length);
    message_get_state(&r, &head);
    CHECK(!r.failed);
    return state_merge_add(m, &head, &r, err);
}

/* Servers send the records of their elements; the client sorts them, and refuses two of one key. */
TEST(sections_are_merged)
{
    struct state_merge m;
    struct bytes_writer w = {0};
    struct dm2_error err = {0};
    struct state_view view = state_with_sections(), one = view, other = view;
    one.n_elements = 5;
    one.sections[SECTION_HOME] = (struct section_array){homes + 1, 2, 2};
    one.sections[SECTION_WCON] = (struct section_array){contacts + 1, 2, 2};
    other.elements += 5;
    other.n_elements = 5;
    other.sections[SECTION_HOME].n = other.sections[SECTION_WCON].n = 1;
    other.sections[SECTION_BODY].n = 0;
    state_merge_open(&m, walls);
    for (int round = 0; round < 2; round++) {
        state_merge_clear(&m);
        put_parts(&one, &w);
        CHECK_EQ_INT(add_message(&m, &w, &err), DM2_OK);
        put_parts(&other, &w);
        CHECK_EQ_INT(add_message(&m, &w, &err), DM2_OK);
        CHECK_EQ_INT(state_merge_finish(&m, &err), DM2_OK);
        const struct state_view whole = state_merge_view(&m, 4);
        for (int k = 0; k < SECTION_COUNT; k++)
            CHECK_EQ_INT(section_check((enum section)k, &whole.sections[k], &walls, whole.elements, 10, &err),
                         DM2_OK);
        CHECK_EQ_INT(whole.sections[SECTION_HOME].n, 3);
        CHECK_EQ_INT(memcmp(whole.sections[SECTION_HOME].records, homes, sizeof homes), 0);
        CHECK_EQ_INT(whole.sections[SECTION_BODY].n, 2);
        CHECK_EQ_INT(((const struct wall_contact *)whole.sections[SECTION_WCON].records)[2].feature, 2);
    }
    state_merge_clear(&m);
    put_parts(&one, &w);
    CHECK_EQ_INT(add_message(&m, &w, &err), DM2_OK);
    other.sections[SECTION_BODY].n = 1;
    put_parts(&other, &w);
    CHECK_EQ_INT(add_message(&m, &w, &err), DM2_OK);
    CHECK_EQ_INT(state_merge_finish(&m, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "section BODY: record 1 is out of order or there twice");
    state_merge_free(&m);
    state_merge_open(&m, plain);
    CHECK_EQ_INT(add_message(&m, &w, &err), DM2_NUMERIC);
    CHECK_CONTAINS(err.text, "section HOME is there, and the deck has nothing for it");
    state_merge_free(&m);
    free((void *)(uintptr_t)view.elements);
    bytes_free(&w);
}

/* A rank gets the records of its own elements, and those of the run. */
TEST(a_share_has_the_records_of_owned_elements)
{
    struct dm2_error err = {0};
    struct grid grid;
    struct decomposition d;
    const double origin[2] = {0, 0}, size[2] = {10, 1};
    const bool periodic[2] = {false, false};
    struct state_view view = state_with_sections();
    struct element *elements = (struct element *)(uintptr_t)view.elements;
    for (uint32_t k = 0; k < 10; k++) {
        elements[k].r[0] = k + 0.5;
        elements[k].r[1] = 0.5;
    }
    CHECK_EQ_INT(grid_build(origin, size, periodic, 1.0, &grid, &err), DM2_OK);
    CHECK_EQ_INT(decomposition_bisect(&grid, 2, NULL, &d, &err), DM2_OK);
    size_t found[SECTION_COUNT] = {0};
    for (int rank = 0; rank < 2; rank++) {
        struct state_share share;
        CHECK_EQ_INT(state_parts_share(&d, rank, &view, &share, &err), DM2_OK);
        const struct state_view part = state_share_view(&share, 4);
        for (int k = 0; k < SECTION_COUNT; k++)
            found[k] += part.sections[k].n;
        for (size_t k = 0; k < part.sections[SECTION_HOME].n; k++) {
            const struct home_record *h = section_record(SECTION_HOME, &part.sections[SECTION_HOME], k);
            CHECK_EQ_INT(d.owner[grid_cell(&grid, elements[h->id].r[0], 0.5)], rank);
        }
        CHECK_EQ_INT(part.sections[SECTION_BODY].n, 2);
        state_share_free(&share);
    }
    CHECK(found[SECTION_HOME] == 3 && found[SECTION_WCON] == 3 && found[SECTION_BODY] == 4);
    decomposition_free(&d);
    free(elements);
}

TEST_MAIN(CASE(a_state_message_with_sections), CASE(sections_are_merged),
          CASE(a_share_has_the_records_of_owned_elements))
