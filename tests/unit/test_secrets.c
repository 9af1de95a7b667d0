/* HMAC-SHA-256 and SipHash-2-4-128 against the vectors published by their authors. */
#include "check.h"

#include "dm2/base/hmac.h"
#include "dm2/base/siphash.h"

static void check_hmac(const void *key, size_t key_n, const void *text, size_t n, const char *want)
{
    struct hmac h;
    unsigned char code[SHA256_BYTES];
    char hex[SHA256_TEXT];
    hmac_start(&h, key, key_n);
    hmac_add(&h, text, n / 2);
    hmac_add(&h, (const char *)text + n / 2, n - n / 2);
    hmac_finish(&h, code);
    sha256_text(code, hex);
    hex[strlen(want)] = '\0'; /* the published result of case 5 is cut to 128 bits */
    CHECK_STR(hex, want);
}

/* RFC 4231, sections 4.2 to 4.8. */
TEST(hmac_known_values)
{
    unsigned char key[131], text[50];
    memset(key, 0x0b, 20);
    check_hmac(key, 20, "Hi There", 8, "b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7");
    check_hmac("Jefe", 4, "what do ya want for nothing?", 28,
               "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
    memset(key, 0xaa, 20);
    memset(text, 0xdd, 50);
    check_hmac(key, 20, text, 50, "773ea91e36800e46854db8ebd09181a72959098b3ef8c122d9635514ced565fe");
    for (int k = 0; k < 25; k++)
        key[k] = (unsigned char)(k + 1);
    memset(text, 0xcd, 50);
    check_hmac(key, 25, text, 50, "82558a389a443c0ea4cc819899f2083a85f0faa3e578f8077a2e3ff46729665b");
    memset(key, 0x0c, 20);
    check_hmac(key, 20, "Test With Truncation", 20, "a3b6167473100ee06e0c796c2955552b");
    memset(key, 0xaa, 131);
    check_hmac(key, 131, "Test Using Larger Than Block-Size Key - Hash Key First", 54,
               "60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54");
    check_hmac(
        key, 131,
        "This is a test using a larger than block-size key and a larger than block-size data. The key needs "
        "to be hashed before being used by the HMAC algorithm.",
        152, "9b09ffa71b942fcb27635fbcd5b0e944bfdc63644f0713938a7f51535c3a35e2");
}

/* The authors' reference table: key 00 01 .. 0f, the text of length n is 00 01 .. n-1. */
TEST(siphash_known_values)
{
    static const struct {
        size_t n;
        unsigned char tag[SIPHASH_BYTES];
    } table[] = {
        {0, {0xa3, 0x81, 0x7f, 0x04, 0xba, 0x25, 0xa8, 0xe6, 0x6d, 0xf6, 0x72, 0x14, 0xc7, 0x55, 0x02, 0x93}},
        {1, {0xda, 0x87, 0xc1, 0xd8, 0x6b, 0x99, 0xaf, 0x44, 0x34, 0x76, 0x59, 0x11, 0x9b, 0x22, 0xfc, 0x45}},
        {2, {0x81, 0x77, 0x22, 0x8d, 0xa4, 0xa4, 0x5d, 0xc7, 0xfc, 0xa3, 0x8b, 0xde, 0xf6, 0x0a, 0xff, 0xe4}},
        {7, {0xa1, 0xf1, 0xeb, 0xbe, 0xd8, 0xdb, 0xc1, 0x53, 0xc0, 0xb8, 0x4a, 0xa6, 0x1f, 0xf0, 0x82, 0x39}},
        {8, {0x3b, 0x62, 0xa9, 0xba, 0x62, 0x58, 0xf5, 0x61, 0x0f, 0x83, 0xe2, 0x64, 0xf3, 0x14, 0x97, 0xb4}},
        {9, {0x26, 0x44, 0x99, 0x06, 0x0a, 0xd9, 0xba, 0xab, 0xc4, 0x7f, 0x8b, 0x02, 0xbb, 0x6d, 0x71, 0xed}},
        {15,
         {0x54, 0x93, 0xe9, 0x99, 0x33, 0xb0, 0xa8, 0x11, 0x7e, 0x08, 0xec, 0x0f, 0x97, 0xcf, 0xc3, 0xd9}},
        {16,
         {0x6e, 0xe2, 0xa4, 0xca, 0x67, 0xb0, 0x54, 0xbb, 0xfd, 0x33, 0x15, 0xbf, 0x85, 0x23, 0x05, 0x77}},
        {63,
         {0x51, 0x50, 0xd1, 0x77, 0x2f, 0x50, 0x83, 0x4a, 0x50, 0x3e, 0x06, 0x9a, 0x97, 0x3f, 0xbd, 0x7c}}};
    unsigned char text[64], tag[SIPHASH_BYTES];
    for (int k = 0; k < 64; k++)
        text[k] = (unsigned char)k;
    for (size_t c = 0; c < sizeof table / sizeof table[0]; c++)
        for (size_t cut = 0; cut <= table[c].n; cut++) {
            struct siphash s;
            siphash_start(&s, text);
            siphash_add(&s, text, cut);
            siphash_add(&s, text + cut, table[c].n - cut);
            siphash_finish(&s, tag);
            CHECK(memcmp(tag, table[c].tag, SIPHASH_BYTES) == 0);
        }
}

TEST(equality_sees_every_bit)
{
    unsigned char a[33] = {0}, b[33] = {0};
    CHECK(hmac_equal(a, b, 32));
    b[32] = 1; /* beyond the end of the text */
    CHECK(hmac_equal(a, b, 32));
    for (int bit = 0; bit < 256; bit++) {
        b[bit / 8] ^= (unsigned char)(1 << bit % 8);
        CHECK(!hmac_equal(a, b, 32));
        b[bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
}

TEST_MAIN(CASE(hmac_known_values), CASE(siphash_known_values), CASE(equality_sees_every_bit))
