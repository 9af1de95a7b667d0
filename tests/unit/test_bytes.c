/* Bytes written and read: values, order, limits. */
#include "check.h"

#include <stdint.h>

#include "dm2/base/bytes.h"

TEST(round_trip)
{
    struct bytes_writer w = {0};
    const double values[4] = {0.1, -0.0, 5e-324, 1e308};
    bytes_put_u8(&w, 0xab);
    bytes_put_u16(&w, 0xabcd);
    bytes_put_u32(&w, 0xdeadbeef);
    bytes_put_u64(&w, 0x0123456789abcdefU);
    bytes_put_i64(&w, -1);
    bytes_put_i64(&w, INT64_MIN);
    bytes_put_i64(&w, INT64_MAX);
    bytes_put_f64(&w, -1.5);
    bytes_put_f64s(&w, values, 4);
    bytes_put_text(&w, "deck", 4);
    CHECK(!w.failed);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    CHECK_EQ_INT(bytes_get_u8(&r), 0xab);
    CHECK_EQ_INT(bytes_get_u16(&r), 0xabcd);
    CHECK_EQ_INT(bytes_get_u32(&r), 0xdeadbeef);
    CHECK_EQ_INT(bytes_get_u64(&r), 0x0123456789abcdef);
    CHECK_EQ_INT(bytes_get_i64(&r), -1);
    CHECK_EQ_INT(bytes_get_i64(&r), INT64_MIN);
    CHECK_EQ_INT(bytes_get_i64(&r), INT64_MAX);
    CHECK_SAME_BITS(bytes_get_f64(&r), -1.5);
    double back[4] = {0};
    bytes_get_f64s(&r, back, 4);
    for (int k = 0; k < 4; k++)
        CHECK_SAME_BITS(back[k], k == 1 ? 0.0 : values[k]); /* -0 is put as 0 */
    CHECK(!bytes_done(&r));                                 /* the text remains */
    size_t length = 0;
    char *text = bytes_get_text(&r, 100, &length);
    CHECK_STR(text, "deck");
    CHECK_EQ_INT(length, 4);
    free(text);
    CHECK(bytes_done(&r));
    bytes_free(&w);
}

TEST(little_endian)
{
    struct bytes_writer w = {0};
    bytes_put_u16(&w, 0x0102);
    bytes_put_u32(&w, 0x03040506);
    bytes_put_f64(&w, 1.0);
    static const unsigned char want[] = {2, 1, 6, 5, 4, 3, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f};
    CHECK_EQ_INT(w.length, sizeof want);
    CHECK(memcmp(w.data, want, sizeof want) == 0);
    bytes_patch_u32(&w, 2, 0x0a0b0c0d);
    CHECK_EQ_INT(w.data[2], 0x0d);
    CHECK_EQ_INT(w.data[5], 0x0a);
    bytes_free(&w);
}

TEST(reading_past_the_end_fails_and_stays_failed)
{
    static const unsigned char data[3] = {1, 2, 3};
    struct bytes_reader r = bytes_reader_of(data, 3);
    CHECK_EQ_INT(bytes_get_u32(&r), 0);
    CHECK(r.failed);
    CHECK_EQ_INT(bytes_get_u8(&r), 0); /* a byte remains, but the reader has failed */
    CHECK_EQ_INT(bytes_remaining(&r), 0);
    CHECK(!bytes_done(&r));
    r = bytes_reader_of(data, 3);
    double out[1] = {7};
    bytes_get_f64s(&r, out, SIZE_MAX / 4); /* the product overflows */
    CHECK(r.failed);
    CHECK_NEAR(out[0], 7, 0);
}

TEST(a_count_must_fit_what_remains)
{
    struct bytes_writer w = {0};
    bytes_put_u32(&w, 3);
    bytes_put_f64s(&w, (const double[3]){1, 2, 3}, 3);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    CHECK_EQ_INT(bytes_get_count(&r, 8), 3);
    CHECK(!r.failed);
    r = bytes_reader_of(w.data, w.length);
    CHECK_EQ_INT(bytes_get_count(&r, 9), 0);
    CHECK(r.failed);
    bytes_patch_u32(&w, 0, UINT32_MAX);
    r = bytes_reader_of(w.data, w.length);
    CHECK_EQ_INT(bytes_get_count(&r, 8), 0);
    CHECK(r.failed);
    bytes_free(&w);
}

TEST(texts_are_bounded_and_whole)
{
    struct bytes_writer w = {0};
    bytes_put_text(&w, "12345", 5);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    CHECK(bytes_get_text(&r, 4, NULL) == NULL); /* longer than allowed */
    CHECK(r.failed);
    r = bytes_reader_of(w.data, w.length - 1);
    CHECK(bytes_get_text(&r, 100, NULL) == NULL); /* cut */
    bytes_clear(&w);
    bytes_put_text(&w, "a\0b", 3);
    r = bytes_reader_of(w.data, w.length);
    CHECK(bytes_get_text(&r, 100, NULL) == NULL); /* a NUL inside */
    bytes_free(&w);
}

TEST(the_writer_grows)
{
    struct bytes_writer w = {0};
    for (uint32_t k = 0; k < 10000; k++)
        bytes_put_u32(&w, k);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    uint32_t wrong = 0;
    for (uint32_t k = 0; k < 10000; k++)
        wrong += bytes_get_u32(&r) != k;
    CHECK_EQ_INT(wrong, 0);
    CHECK(bytes_done(&r));
    CHECK(bytes_put_room(&w, SIZE_MAX) == NULL);
    CHECK(w.failed);
    bytes_free(&w);
}

TEST_MAIN(CASE(round_trip), CASE(little_endian), CASE(reading_past_the_end_fails_and_stays_failed),
          CASE(a_count_must_fit_what_remains), CASE(texts_are_bounded_and_whole), CASE(the_writer_grows))
