/* SipHash-2-4-128 as its authors define it: four words of state, two rounds for every word of 8 bytes, four
 * rounds before each half of the tag. The highest byte of the last word is the length modulo 256.
 *
 * Frames do not use HMAC-SHA-256, because HMAC takes some 20 times as long per byte (figures in
 * docs/security.md) and the relay authenticates all boundaries in every step. */
#include "dm2/base/siphash.h"

static uint64_t load(const unsigned char *p)
{
    return (uint64_t)p[0] | (uint64_t)p[1] << 8 | (uint64_t)p[2] << 16 | (uint64_t)p[3] << 24 |
           (uint64_t)p[4] << 32 | (uint64_t)p[5] << 40 | (uint64_t)p[6] << 48 | (uint64_t)p[7] << 56;
}

static uint64_t rotate(uint64_t x, int n)
{
    return x << n | x >> (64 - n);
}

static inline void mix(uint64_t v[4], int rounds)
{
    for (int k = 0; k < rounds; k++) {
        v[0] += v[1];
        v[1] = rotate(v[1], 13) ^ v[0];
        v[0] = rotate(v[0], 32);
        v[2] += v[3];
        v[3] = rotate(v[3], 16) ^ v[2];
        v[0] += v[3];
        v[3] = rotate(v[3], 21) ^ v[0];
        v[2] += v[1];
        v[1] = rotate(v[1], 17) ^ v[2];
        v[2] = rotate(v[2], 32);
    }
}

static inline void take_word(uint64_t v[4], uint64_t word)
{
    v[3] ^= word;
    mix(v, 2);
    v[0] ^= word;
}

void siphash_start(struct siphash *s, const unsigned char key[SIPHASH_KEY])
{
    uint64_t k0 = load(key), k1 = load(key + 8);
    *s = (struct siphash){.v = {k0 ^ 0x736f6d6570736575U, k1 ^ 0x646f72616e646f6dU ^ 0xee,
                                k0 ^ 0x6c7967656e657261U, k1 ^ 0x7465646279746573U}};
}

static void take_byte(struct siphash *s, unsigned char byte)
{
    s->word |= (uint64_t)byte << 8 * (s->length % 8);
    if (++s->length % 8 == 0) {
        take_word(s->v, s->word);
        s->word = 0;
    }
}

void siphash_add(struct siphash *s, const void *data, size_t n)
{
    const unsigned char *p = data;
    for (; n > 0 && s->length % 8 != 0; n--)
        take_byte(s, *p++);
    uint64_t v[4] = {s->v[0], s->v[1], s->v[2], s->v[3]};
    s->length += n / 8 * 8;
    for (; n >= 8; n -= 8, p += 8)
        take_word(v, load(p));
    for (int k = 0; k < 4; k++)
        s->v[k] = v[k];
    for (; n > 0; n--)
        take_byte(s, *p++);
}

void siphash_finish(struct siphash *s, unsigned char tag[SIPHASH_BYTES])
{
    take_word(s->v, s->word | (s->length & 0xff) << 56);
    s->v[2] ^= 0xee;
    for (int half = 0; half < 2; half++) {
        mix(s->v, 4);
        uint64_t word = s->v[0] ^ s->v[1] ^ s->v[2] ^ s->v[3];
        for (int k = 0; k < 8; k++)
            tag[8 * half + k] = (unsigned char)(word >> 8 * k & 0xff);
        s->v[1] ^= 0xdd;
    }
}
