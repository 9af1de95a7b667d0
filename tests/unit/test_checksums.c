/* CRC-32C, SHA-256 and the arithmetic fingerprint against known values. */
#include "check.h"

#include "dm2/base/crc32c.h"
#include "dm2/base/fingerprint.h"
#include "dm2/base/sha256.h"

/* RFC 3720, B.4, and the check value of the CRC catalogues. */
TEST(crc32c_known_values)
{
    unsigned char block[32];
    CHECK_EQ_INT(crc32c(0, "123456789", 9), 0xe3069283);
    CHECK_EQ_INT(crc32c(0, "", 0), 0);
    memset(block, 0, sizeof block);
    CHECK_EQ_INT(crc32c(0, block, 32), 0x8a9136aa);
    memset(block, 0xff, sizeof block);
    CHECK_EQ_INT(crc32c(0, block, 32), 0x62a8ab43);
    for (int k = 0; k < 32; k++)
        block[k] = (unsigned char)k;
    CHECK_EQ_INT(crc32c(0, block, 32), 0x46dd794e);
    for (int k = 0; k < 32; k++)
        block[k] = (unsigned char)(31 - k);
    CHECK_EQ_INT(crc32c(0, block, 32), 0x113fdb5c);
}

TEST(crc32c_piecewise_is_the_same)
{
    unsigned char data[100];
    for (int k = 0; k < 100; k++)
        data[k] = (unsigned char)(k * 37 + 11);
    uint32_t whole = crc32c(0, data, 100);
    for (size_t cut = 0; cut <= 100; cut++)
        CHECK_EQ_INT(crc32c(crc32c(0, data, cut), data + cut, 100 - cut), whole);
}

static void check_sha(const char *text, size_t repeat, const char *want)
{
    struct sha256 s;
    unsigned char digest[SHA256_BYTES];
    char hex[SHA256_TEXT];
    sha256_start(&s);
    for (size_t k = 0; k < repeat; k++)
        sha256_add(&s, text, strlen(text));
    sha256_finish(&s, digest);
    sha256_text(digest, hex);
    CHECK_STR(hex, want);
}

/* FIPS 180-4 examples. */
TEST(sha256_known_values)
{
    check_sha("", 1, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    check_sha("abc", 1, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    check_sha("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", 1,
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    check_sha("a", 1000000, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    check_sha("0123456701234567012345670123456701234567012345670123456701234567", 10,
              "594847328451bdfa85056225462cc1d867d877fb388df0ce35f25ab5562bfbb5");
}

TEST(the_arithmetic_is_ieee)
{
    CHECK_EQ_INT(fingerprint_compute(), FINGERPRINT_IEEE);
    CHECK_EQ_INT(fingerprint_compute(), fingerprint_compute());
}

TEST_MAIN(CASE(crc32c_known_values), CASE(crc32c_piecewise_is_the_same), CASE(sha256_known_values),
          CASE(the_arithmetic_is_ieee))
