/* The state file: round trip, canonical bytes, every damage, and invalid content. */
#include "check.h"
#include "record_help.h"
#include "state_help.h"

#include "dm2/engine/self_test.h"

TEST(round_trip)
{
    struct fake f;
    struct state s;
    struct dm2_error err = {0};
    fake_make(&f, 57, 41); /* more than one block of the writer */
    write_fake(&f, "a.dm2");
    CHECK_EQ_INT(state_read(scratch_path("a.dm2"), &s, &err), DM2_OK);
    CHECK_STR(err.text, "");
    CHECK_EQ_INT(memcmp(s.origin.digest, origin.digest, sizeof origin.digest), 0);
    CHECK_EQ_INT(s.origin.n_start, 70);
    CHECK_SAME_BITS(s.origin.t_start, 1.75);
    CHECK_EQ_INT(s.origin.next_id, 3000);
    CHECK_EQ_INT(s.origin.next_grain, 500);
    CHECK_EQ_INT(s.origin.text_length, sizeof meaning - 1);
    CHECK_STR(s.origin.text, meaning);
    CHECK_EQ_INT(s.origin.n_names, 4);
    for (size_t k = 0; k < s.origin.n_names && k < 4; k++) {
        CHECK_EQ_INT(s.origin.names[k].sort, names[k].sort);
        CHECK_STR(s.origin.names[k].text, names[k].text);
    }
    CHECK_EQ_INT(s.step, 200);
    CHECK_EQ_INT(s.n_elements, f.n);
    CHECK_EQ_INT(s.n_pairs, f.n_pairs);
    for (size_t i = 0; i < s.n_elements && i < f.n; i++)
        CHECK(record_difference(&s.elements[i], &f.elements[i], false) == NULL);
    for (size_t i = 0; i < s.n_pairs && i < f.n_pairs; i++) {
        CHECK_EQ_INT(s.pairs[i].id_a, f.pairs[i].id_a);
        CHECK_EQ_INT(s.pairs[i].id_b, f.pairs[i].id_b);
        CHECK_EQ_INT(s.pairs[i].linked, f.pairs[i].linked);
        CHECK_SAME_BITS(s.pairs[i].stretch, f.pairs[i].stretch);
        CHECK_SAME_BITS(s.pairs[i].spring, f.pairs[i].spring);
    }
    state_free(&s);
    fake_free(&f);
}

/* The bytes depend on the format alone: the size and the first bytes, worked out by hand. */
TEST(bytes_are_canonical)
{
    struct fake f;
    size_t n;
    fake_make(&f, 3, 2);
    write_fake(&f, "b.dm2");
    char *bytes = scratch_read("b.dm2", &n);
    CHECK_EQ_INT(n, HEADER + 16 + TEXT + 16 + 64 * 4 + 16 + 162 * f.n + 16 + 25 * f.n_pairs + 4);
    CHECK_EQ_INT(memcmp(bytes, "DM2STATE\6\0\0\0\372\071\174\321\262", 17), 0);
    CHECK_EQ_INT(memcmp(bytes + 52, "\310\0\0\0\0\0\0\0\106\0\0\0\0\0\0\0\0\0\0\0\0\0\374\077", 24), 0);
    CHECK_EQ_INT(memcmp(bytes + 76, "\270\13\0\0\364\1\0\0\4\0\0\0TEXT\1\0\0\0\070\0\0\0\0\0\0\0body", 32),
                 0);
    CHECK_EQ_INT(memcmp(bytes + ELEMENTS - 16, "ELEM\242\0\0\0\6\0\0\0\0\0\0\0", 16), 0);
    write_fake(&f, "c.dm2");
    char *again = scratch_read("c.dm2", NULL);
    CHECK_EQ_INT(memcmp(bytes, again, n), 0);
    CHECK(!scratch_exists("c.dm2.part"));
    free(bytes);
    free(again);
    fake_free(&f);
}

TEST(no_elements)
{
    struct fake f = {.n = 0};
    struct state s;
    struct dm2_error err = {0};
    write_fake(&f, "empty.dm2");
    CHECK_EQ_INT(state_read(scratch_path("empty.dm2"), &s, &err), DM2_OK);
    CHECK_EQ_INT(s.n_elements, 0);
    state_free(&s);
}

TEST(every_truncation)
{
    struct fake f;
    size_t n;
    fake_make(&f, 3, 2);
    write_all(&f, "d.dm2");
    char *bytes = scratch_read("d.dm2", &n);
    for (size_t k = 0; k < n; k++) {
        write_bytes("cut.dm2", bytes, k);
        const char *text = read_failure("cut.dm2");
        CHECK_CONTAINS(text, k == 0 ? "is not a dm2 state file" : "is cut short");
    }
    free(bytes);
    fake_free(&f);
}

/* Every bit of the header and of the first section's head, one bit of every other byte. */
TEST(flipped_bits)
{
    struct fake f;
    size_t n, not_damaged = 0;
    fake_make(&f, 2, 2);
    write_all(&f, "e.dm2");
    char *bytes = scratch_read("e.dm2", &n);
    for (size_t at = 0; at < n; at++)
        for (size_t bit = at < HEADER + 16 ? 0 : at % 8; bit < 8; bit += at < HEADER + 16 ? 1 : 8) {
            bytes[at] = (char)(bytes[at] ^ (1 << bit));
            write_bytes("flip.dm2", bytes, n);
            not_damaged += strstr(read_failure("flip.dm2"), "is damaged: its checksum") == NULL;
            bytes[at] = (char)(bytes[at] ^ (1 << bit));
        }
    CHECK(not_damaged <= 8 * (8 + 4 + 4 + 12) + 6 * 12); /* magic, version, number and lengths of sections */
    free(bytes);
    fake_free(&f);
}

TEST(foreign_files)
{
    write_bytes("x.dm2", "<?xml version=\"1.0\"?>", 21);
    CHECK_CONTAINS(read_failure("x.dm2"), "is not a dm2 state file");
    write_bytes("x.dm2", "DM2STATE\6\0\0\0", 12);
    CHECK_CONTAINS(read_failure("x.dm2"), "is cut short");
    char bytes[128] = "DM2STATE", of_version[40];
    bytes[8] = STATE_VERSION + 1;
    (void)snprintf(of_version, sizeof of_version, "is a state of format version %d,", STATE_VERSION + 1);
    write_bytes("x.dm2", bytes, sizeof bytes);
    CHECK_CONTAINS(read_failure("x.dm2"), of_version);
    memset(bytes + 8, 0, sizeof bytes - 8);
    bytes[8] = STATE_VERSION;
    memset(bytes + 84, 0xff, 4);
    write_bytes("x.dm2", bytes, sizeof bytes);
    CHECK_CONTAINS(read_failure("x.dm2"), "announces 4294967295 sections, and it ends in section 3");
    memcpy(bytes + 88, "ELEM\242\0\0\0\377\377\377\377\377\377\377\377", 16);
    write_bytes("x.dm2", bytes, sizeof bytes); /* 2^64 - 1 records: neither allocated nor an overflow */
    CHECK_CONTAINS(read_failure("x.dm2"), "its section ELEM announces 18446744073709551615 records");
    struct state s;
    struct dm2_error err;
    CHECK_EQ_INT(state_read(scratch_path("absent.dm2"), &s, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "cannot open: No such file");
    CHECK_EQ_INT(state_read(scratch_directory, &s, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "is not a regular file");
}

TEST(trailing_bytes)
{
    struct fake f;
    size_t n;
    fake_make(&f, 2, 2);
    write_fake(&f, "f.dm2");
    char *bytes = scratch_read("f.dm2", &n);
    write_bytes("f.dm2", bytes, n + 1); /* scratch_read ends with a NUL */
    CHECK_CONTAINS(read_failure("f.dm2"), "has 1 bytes behind the end");
    free(bytes);
    fake_free(&f);
}

/* A whole file with a matching checksum and invalid content. */
static void check_content(void (*spoil)(struct fake *f), const char *want)
{
    struct fake f;
    fake_make(&f, 3, 3);
    spoil(&f);
    write_fake(&f, "g.dm2");
    CHECK_CONTAINS(read_failure("g.dm2"), want);
    fake_free(&f);
}

static void infinite(struct fake *f)
{
    f->elements[3].v[1] = INFINITY;
}

static void massless(struct fake *f)
{
    f->elements[2].mass = 0;
}

static void flagged(struct fake *f)
{
    f->elements[1].flags = 8;
}

static void overfull(struct fake *f)
{
    f->elements[4].share[1] = 7;
}

static void repeated_pair(struct fake *f)
{
    f->pairs[1] = f->pairs[0];
}

static void reversed_pair(struct fake *f)
{
    f->pairs[0] = (struct pair_record){1, 0, 1, 0, 0};
}

static void absent_pair(struct fake *f)
{
    f->pairs[f->n_pairs - 1].id_b = 77;
}

TEST(invalid_content)
{
    check_content(infinite, "element 3 has a number that is not finite");
    check_content(massless, "element 2 has a radius or a mass that is not positive");
    check_content(flagged, "element 1 has a flag");
    check_content(overfull, "g.dm2: element 4 has share 7, 0 to 1 is expected");
    check_content(repeated_pair, "the pair (0, 1) is out of order or there twice");
    check_content(reversed_pair, "the pair (1, 0) does not name its lower element first");
    check_content(absent_pair, ", 77) names an element that is not in the state");
}

/* Indices that a run lacks: state_read takes them, state_check refuses them. */
static void check_indices(uint8_t probes, uint16_t was, const char *want)
{
    const struct record_limits limits = {
        .elements = 9, .bodies = 2, .kinds = 2, .probes = 2, .periodic = {true, false}};
    struct fake f;
    struct state s;
    struct dm2_error err = {0};
    fake_make(&f, 3, 3);
    f.elements[5].probes = probes;
    f.elements[5].was = was;
    write_fake(&f, "j.dm2");
    CHECK_EQ_INT(state_read(scratch_path("j.dm2"), &s, &err), DM2_OK);
    CHECK_EQ_INT(state_check("j.dm2", &s, &limits, &err), *want == '\0' ? DM2_OK : DM2_PROTOCOL);
    CHECK_STR(err.text, want);
    state_free(&s);
    fake_free(&f);
}

TEST(indices_of_another_run)
{
    check_indices(3, 1, "");
    check_indices(4, 1, "j.dm2: element 5 belongs to probe 2, counted from 0; the deck has 2");
    check_indices(
        0, 2,
        "j.dm2: element 5 is of a body or a kind that the deck does not have: was 2, counted from 0; the "
        "deck has 2");
}

/* Swaps two records in the bytes, because state_write asserts the order in a debug build. */
TEST(elements_out_of_order)
{
    struct fake f;
    size_t n;
    fake_make(&f, 2, 2);
    write_fake(&f, "h.dm2");
    char *bytes = scratch_read("h.dm2", &n), record[162];
    memcpy(record, bytes + ELEMENTS, 162);
    memcpy(bytes + ELEMENTS, bytes + ELEMENTS + 162, 162);
    memcpy(bytes + ELEMENTS + 162, record, 162);
    write_sealed("h.dm2", bytes, n);
    CHECK_CONTAINS(read_failure("h.dm2"), "element 0 is out of order or there twice");
    free(bytes);
    fake_free(&f);
}

/* A whole state with the fingerprint of another arithmetic. */
TEST(another_arithmetic)
{
    struct fake f;
    size_t n;
    char text[200];
    fake_make(&f, 2, 2);
    write_fake(&f, "i.dm2");
    char *bytes = scratch_read("i.dm2", &n);
    for (int k = 0; k < 8; k++)
        CHECK_EQ_INT((unsigned char)bytes[44 + k], SELF_TEST_FINGERPRINT >> (8 * k) & 0xff);
    bytes[51] ^= 1;
    write_sealed("i.dm2", bytes, n);
    (void)snprintf(
        text, sizeof text,
        "by another release or with another arithmetic, of fingerprint %016llx; this program's is %016llx",
        (unsigned long long)SELF_TEST_FINGERPRINT ^ 1ULL << 56, (unsigned long long)SELF_TEST_FINGERPRINT);
    CHECK_CONTAINS(read_failure("i.dm2"), text);
    free(bytes);
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

TEST_MAIN(CASE(begin), CASE(round_trip), CASE(bytes_are_canonical), CASE(no_elements), CASE(every_truncation),
          CASE(flipped_bits), CASE(foreign_files), CASE(trailing_bytes), CASE(invalid_content),
          CASE(indices_of_another_run), CASE(elements_out_of_order), CASE(another_arithmetic), CASE(end))
