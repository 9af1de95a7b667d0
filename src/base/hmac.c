/* HMAC as in RFC 2104: H(key ^ opad, H(key ^ ipad, text)); a key longer than a block is hashed first.
 * hmac_start feeds both pads to their hashes, so that the struct does not keep the key.
 *
 * hmac_equal collects the differences of all bytes and tests them once; `volatile` prevents that a compiler
 * ends the loop early. */
#include "dm2/base/hmac.h"

#include <string.h>

enum { BLOCK = 64 };

void hmac_start(struct hmac *h, const void *key, size_t n)
{
    unsigned char pad[BLOCK] = {0};
    if (n > BLOCK) {
        sha256_start(&h->inner);
        sha256_add(&h->inner, key, n);
        sha256_finish(&h->inner, pad);
    } else if (n > 0) {
        memcpy(pad, key, n);
    }
    for (int k = 0; k < BLOCK; k++)
        pad[k] ^= 0x36;
    sha256_start(&h->inner);
    sha256_add(&h->inner, pad, BLOCK);
    for (int k = 0; k < BLOCK; k++)
        pad[k] ^= 0x36 ^ 0x5c;
    sha256_start(&h->outer);
    sha256_add(&h->outer, pad, BLOCK);
}

void hmac_add(struct hmac *h, const void *data, size_t n)
{
    sha256_add(&h->inner, data, n);
}

void hmac_finish(struct hmac *h, unsigned char code[SHA256_BYTES])
{
    unsigned char digest[SHA256_BYTES];
    sha256_finish(&h->inner, digest);
    sha256_add(&h->outer, digest, sizeof digest);
    sha256_finish(&h->outer, code);
}

bool hmac_equal(const void *a, const void *b, size_t n)
{
    const unsigned char *p = a, *q = b;
    volatile unsigned char differences = 0;
    for (size_t k = 0; k < n; k++)
        differences = (unsigned char)(differences | (p[k] ^ q[k]));
    return differences == 0;
}
