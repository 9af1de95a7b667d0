/* The sections of the state file: round trip, order, counts, indices, and the numbers of the header. */
#include "state_help.h"

TEST(further_sections)
{
    struct fake f;
    struct state s;
    struct dm2_error err = {0};
    size_t n, more, again;
    fake_make(&f, 3, 2);
    write_fake(&f, "plain.dm2");
    write_all(&f, "all.dm2");
    free(scratch_read("plain.dm2", &n));
    char *bytes = scratch_read("all.dm2", &more);
    CHECK_EQ_INT(more - n, 3 * 16 + 3 * 20 + 2 * 218 + 3 * 17);
    CHECK_EQ_INT(state_read(scratch_path("all.dm2"), &s, &err), DM2_OK);
    CHECK_STR(err.text, "");
    CHECK_EQ_INT(s.sections[SECTION_HOME].n, 3);
    const struct body_record *body = section_record(SECTION_BODY, &s.sections[SECTION_BODY], 0);
    const struct wall_contact *contact = section_record(SECTION_WCON, &s.sections[SECTION_WCON], 1);
    CHECK(body->touched[1][1].hi == -25 && body->touched[1][1].lo == UINT64_MAX && body->contacts[1] == 27);
    CHECK(contact->id == 1 && contact->feature == 4 && contact->sign == -1);
    const struct state_view view = state_view_of(&s);
    write_view(&view, "again.dm2");
    char *copy = scratch_read("again.dm2", &again);
    CHECK(again == more && memcmp(bytes, copy, more) == 0);
    state_free(&s);
    free(bytes);
    free(copy);
    fake_free(&f);
}

/* Changes a whole file with all sections by `change`, seals it, and returns why it is refused. */
static const char *change_sections(size_t (*change)(char *bytes, size_t n))
{
    struct fake f;
    size_t n;
    fake_make(&f, 2, 2);
    write_all(&f, "k.dm2");
    char *bytes = scratch_read("k.dm2", &n);
    write_sealed("k.dm2", bytes, change(bytes, n));
    free(bytes);
    fake_free(&f);
    return read_failure("k.dm2");
}

/* The place of a section's head. */
static char *find_section(char *bytes, size_t n, const char *tag)
{
    for (size_t at = HEADER; at + 16 < n; at++)
        if (memcmp(bytes + at, tag, 4) == 0)
            return bytes + at;
    CHECK_REPORT(false, "no section %s", tag);
    return bytes + HEADER;
}

static size_t section_bytes(const char *head)
{
    uint32_t bytes, records;
    memcpy(&bytes, head + 4, sizeof bytes);
    memcpy(&records, head + 8, sizeof records);
    return 16 + (size_t)bytes * records;
}

static size_t rename_pairs(char *bytes, size_t n)
{
    memcpy(find_section(bytes, n, "PAIR"), "P\001IR", 4);
    return n;
}

static size_t repeat_pairs(char *bytes, size_t n)
{
    memcpy(find_section(bytes, n, "WCON"), "PAIR\31\0\0\0\0\0\0\0\0\0\0\0", 16);
    return n - 4 - 3 * 17 + 4;
}

static size_t drop_section(char *bytes, size_t n, const char *tag)
{
    char *head = find_section(bytes, n, tag);
    size_t length = section_bytes(head);
    memmove(head, head + length, n - (size_t)(head - bytes) - length);
    bytes[84]--;
    return n - length;
}

static size_t drop_text(char *bytes, size_t n)
{
    return drop_section(bytes, n, "TEXT");
}

static size_t drop_pairs(char *bytes, size_t n)
{
    return drop_section(bytes, n, "PAIR");
}

static size_t drop_all_after_elements(char *bytes, size_t n)
{
    static const char *const after[] = {"PAIR", "HOME", "BODY", "WCON"};
    for (size_t k = 0; k < 4; k++)
        n = drop_section(bytes, n, after[k]);
    return n;
}

/* Puts a section behind the section that follows it. */
static size_t swap_sections(char *bytes, size_t n)
{
    char *home = find_section(bytes, n, "HOME"), moved[16 + 3 * 20];
    size_t body = section_bytes(home + sizeof moved);
    memcpy(moved, home, sizeof moved);
    memmove(home, home + sizeof moved, body);
    memcpy(home + body, moved, sizeof moved);
    return n;
}

static size_t widen_pairs(char *bytes, size_t n)
{
    char *head = find_section(bytes, n, "PAIR");
    head[4] = 5;
    head[8] = (char)(head[8] * 5);
    return n;
}

static size_t empty_section(char *bytes, size_t n)
{
    memset(find_section(bytes, n, "WCON") + 8, 0, 8);
    return n - 3 * 17;
}

/* Exchanges the first two records of a section. */
static size_t swap_records(char *bytes, size_t n, const char *tag)
{
    char *head = find_section(bytes, n, tag), record[218];
    size_t width = (unsigned char)head[4];
    memcpy(record, head + 16, width);
    memcpy(head + 16, head + 16 + width, width);
    memcpy(head + 16 + width, record, width);
    return n;
}

static size_t swap_homes(char *bytes, size_t n)
{
    return swap_records(bytes, n, "HOME");
}

static size_t swap_bodies(char *bytes, size_t n)
{
    return swap_records(bytes, n, "BODY");
}

static size_t swap_contacts(char *bytes, size_t n)
{
    return swap_records(bytes, n, "WCON");
}

static size_t spoil_sign(char *bytes, size_t n)
{
    find_section(bytes, n, "WCON")[16 + 8] = 2;
    return n;
}

static size_t spoil_home(char *bytes, size_t n)
{
    memcpy(find_section(bytes, n, "HOME") + 16 + 4, "\0\0\0\0\0\0\360\177", 8);
    return n;
}

static size_t absent_element(char *bytes, size_t n)
{
    find_section(bytes, n, "HOME")[16 + 2 * 20] = 4;
    return n;
}

static size_t spoil_name(char *bytes, size_t n)
{
    find_section(bytes, n, "NAME")[16 + 64 + 1 + 20] = 'x'; /* behind the NUL of the second name */
    return n;
}

static size_t swap_names(char *bytes, size_t n)
{
    find_section(bytes, n, "NAME")[16] = NAME_LOAD;
    return n;
}

static size_t spoil_text(char *bytes, size_t n)
{
    bytes[HEADER + 16 + 3] = 'Y';
    return n;
}

TEST(spoiled_sections)
{
    CHECK_CONTAINS(change_sections(rename_pairs), "has a section 'P?IR', which this program does not know");
    CHECK_CONTAINS(change_sections(repeat_pairs), "section PAIR is out of order or there twice");
    CHECK_CONTAINS(change_sections(drop_text), "section TEXT is missing");
    CHECK_CONTAINS(change_sections(drop_pairs), "section PAIR is missing");
    CHECK_CONTAINS(change_sections(drop_all_after_elements), "section PAIR is missing");
    CHECK_CONTAINS(change_sections(swap_sections), "section HOME is out of order or there twice");
    CHECK_CONTAINS(change_sections(widen_pairs), "section PAIR has records of 5 bytes, 25 are expected");
    CHECK_CONTAINS(change_sections(empty_section), "section WCON has no records: then it is to be absent");
    CHECK_CONTAINS(change_sections(swap_homes), "section HOME: record 1 is out of order or there twice");
    CHECK_CONTAINS(change_sections(swap_bodies), "section BODY: record 1 is out of order or there twice");
    CHECK_CONTAINS(change_sections(swap_contacts), "section WCON: record 1 is out of order or there twice");
    CHECK_CONTAINS(change_sections(spoil_sign),
                   "section WCON has a sign that is neither 1 nor -1 for element 1");
    CHECK_CONTAINS(change_sections(spoil_home), "section HOME has a number that is not finite for element 0");
    CHECK_CONTAINS(change_sections(absent_element),
                   "section HOME names element 4, which is not in the state");
    CHECK_CONTAINS(change_sections(spoil_name), "section NAME: record 1 is no name, or out of order");
    CHECK_CONTAINS(change_sections(swap_names), "section NAME: record 1 is no name, or out of order");
    CHECK_CONTAINS(change_sections(spoil_text), "section TEXT is not the text of the state's digest");
}

static const uint8_t no_text[STATE_DIGEST_BYTES] = {0xe3, 0xb0, 0xc4, 0x42, 0x98, 0xfc, 0x1c, 0x14, 0x9a,
                                                    0xfb, 0xf4, 0xc8, 0x99, 0x6f, 0xb9, 0x24, 0x27, 0xae,
                                                    0x41, 0xe4, 0x64, 0x9b, 0x93, 0x4c, 0xa4, 0x95, 0x99,
                                                    0x1b, 0x78, 0x52, 0xb8, 0x55}; /* SHA-256 of no text */

/* The numbers of the header against each other and against the elements. */
TEST(spoiled_origin)
{
    static const struct {
        struct state_origin origin;
        int64_t step;
        const char *want;
    } cases[] = {
        {{.next_id = 4, .next_grain = 1}, -1, "has a negative step"},
        {{.next_id = 4, .next_grain = 1, .n_start = 6}, 5, "is of step 5 of a stage that begins with step 6"},
        {{.next_id = 4, .next_grain = 1, .n_start = -1}, 5, "of a stage that begins with step -1"},
        {{.next_id = 4, .next_grain = 1, .t_start = INFINITY}, 5, "begins at a time that is not finite"},
        {{.next_id = 3, .next_grain = 1}, 5, "element 3 of grain 0 is beyond the next element, 3"},
        {{.next_id = 4, .next_grain = 0},
         5,
         "element 0 of grain 0 is beyond the next element, 4, or the next grain, 0"},
    };
    struct fake f;
    fake_make(&f, 2, 2);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        struct state_view view = view_of(&f);
        struct state_origin other = cases[k].origin;
        memcpy(other.digest, no_text, sizeof no_text);
        view.origin = &other;
        view.step = cases[k].step;
        write_view(&view, "l.dm2");
        CHECK_CONTAINS(read_failure("l.dm2"), cases[k].want);
    }
    fake_free(&f);
}

/* A run refuses sections for which its deck has nothing, and indices that it lacks. */
TEST(sections_of_another_run)
{
    struct record_limits limits = {.elements = 4,
                                   .bodies = 2,
                                   .kinds = 2,
                                   .probes = 2,
                                   .periodic = {true, false},
                                   .movers = 3,
                                   .features = 5};
    static const struct {
        size_t elements, movers, features;
        unsigned sections;
        const char *want;
    } cases[] = {
        {4, 3, 5, 7, ""},
        {4, 3, 5, 6, "k.dm2: section HOME is there, and the deck has nothing for it"},
        {4, 3, 5, 3, "k.dm2: section WCON is there, and the deck has nothing for it"},
        {4, 2, 5, 7, "k.dm2: section BODY names body or wall 2, counted from 0; the deck has 2"},
        {4, 3, 4, 7, "k.dm2: section WCON names feature 4 of walls, counted from 0; the deck has 4"},
    };
    struct fake f;
    struct state s;
    fake_make(&f, 2, 2);
    write_all(&f, "k.dm2");
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        struct dm2_error err = {0};
        CHECK_EQ_INT(state_read(scratch_path("k.dm2"), &s, &err), DM2_OK);
        limits.elements = cases[k].elements;
        limits.movers = cases[k].movers;
        limits.features = cases[k].features;
        limits.sections = cases[k].sections;
        CHECK_EQ_INT(state_check("k.dm2", &s, &limits, &err), *cases[k].want == '\0' ? DM2_OK : DM2_PROTOCOL);
        CHECK_STR(err.text, cases[k].want);
        state_free(&s);
    }
    fake_free(&f);
}

TEST(begin)
{
    scratch_begin();
}

TEST(end)
{
    scratch_end();
}

TEST_MAIN(CASE(begin), CASE(further_sections), CASE(spoiled_sections), CASE(spoiled_origin),
          CASE(sections_of_another_run), CASE(end))
