/* SipHash-2-4 with 128 bits of output (Aumasson and Bernstein): a keyed check that is as fast as the network,
 * for the frames of a session. Without the key nobody can make the tag of a message. */
#ifndef DM2_BASE_SIPHASH_H
#define DM2_BASE_SIPHASH_H

#include <stddef.h>
#include <stdint.h>

enum { SIPHASH_KEY = 16, SIPHASH_BYTES = 16 };

struct siphash {
    uint64_t v[4];
    uint64_t word;   /* the bytes of an unfinished word, the first one lowest */
    uint64_t length; /* bytes so far */
};

/* A tag is made by start, any number of adds, and finish. */
void siphash_start(struct siphash *s, const unsigned char key[SIPHASH_KEY]);
void siphash_add(struct siphash *s, const void *data, size_t n);
void siphash_finish(struct siphash *s, unsigned char tag[SIPHASH_BYTES]);

#endif
