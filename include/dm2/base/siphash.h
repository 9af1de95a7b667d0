/* SipHash-2-4 with 128 bits of output (Aumasson and Bernstein): a keyed check as fast as the network, for the
 * frames of a session. The tag of a message cannot be made without the key. */
#ifndef DM2_BASE_SIPHASH_H
#define DM2_BASE_SIPHASH_H

#include <stddef.h>
#include <stdint.h>

enum { SIPHASH_KEY = 16, SIPHASH_BYTES = 16 };

struct siphash {
    uint64_t v[4];
    uint64_t word;   /* the bytes of the unfinished word, the first byte lowest */
    uint64_t length; /* bytes so far */
};

/* The tag of a text: siphash_start, then siphash_add for each part, then siphash_finish. */
void siphash_start(struct siphash *s, const unsigned char key[SIPHASH_KEY]);
void siphash_add(struct siphash *s, const void *data, size_t n);
void siphash_finish(struct siphash *s, unsigned char tag[SIPHASH_BYTES]);

#endif
