/* SHA-256 (FIPS 180-4): client and servers compare the digests of the decks that they have read. */
#ifndef DM2_BASE_SHA256_H
#define DM2_BASE_SHA256_H

#include <stddef.h>
#include <stdint.h>

enum { SHA256_BYTES = 32, SHA256_TEXT = 2 * SHA256_BYTES + 1 };

struct sha256 {
    uint32_t state[8];
    uint64_t length; /* bytes so far */
    unsigned char block[64];
};

/* The digest of a text: sha256_start, then sha256_add for each part, then sha256_finish. */
void sha256_start(struct sha256 *s);
void sha256_add(struct sha256 *s, const void *data, size_t n);
void sha256_finish(struct sha256 *s, unsigned char digest[SHA256_BYTES]);

/* The digest in hexadecimal, NUL-terminated. */
void sha256_text(const unsigned char digest[SHA256_BYTES], char out[SHA256_TEXT]);

#endif
