/* HMAC-SHA-256 (RFC 2104), and the comparison of secrets. */
#ifndef DM2_BASE_HMAC_H
#define DM2_BASE_HMAC_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/sha256.h"

struct hmac {
    struct sha256 inner, outer;
};

/* The code of a text: hmac_start with a key of n bytes, n arbitrary, then hmac_add for each part, then
 * hmac_finish. */
void hmac_start(struct hmac *h, const void *key, size_t n);
void hmac_add(struct hmac *h, const void *data, size_t n);
void hmac_finish(struct hmac *h, unsigned char code[SHA256_BYTES]);

/* Are the n bytes of a and b equal? The time does not depend on the bytes, so that the time reveals nothing
 * about a code. */
bool hmac_equal(const void *a, const void *b, size_t n);

#endif
