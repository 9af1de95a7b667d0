/* Bounded byte streams.
 *
 * Numbers are coded byte by byte with shifts, so that the order is little-endian on any machine; compilers
 * turn the eight shifts of a double into one store. A reader never moves past its end: each get compares the
 * requested bytes with the remaining bytes before any access, and bytes_get_count compares a count before a
 * caller allocates for it. */
#include "dm2/base/bytes.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"

void bytes_clear(struct bytes_writer *w)
{
    w->length = 0;
    w->failed = false;
}

void bytes_free(struct bytes_writer *w)
{
    free(w->data);
    *w = (struct bytes_writer){0};
}

unsigned char *bytes_put_room(struct bytes_writer *w, size_t n)
{
    if (w->failed)
        return NULL;
    if (n > w->cap - w->length) {
        unsigned char *grown =
            n > SIZE_MAX - w->length ? NULL : mem_grown(w->data, &w->cap, w->length, w->length + n, 1);
        if (grown == NULL) {
            w->failed = true;
            return NULL;
        }
        w->data = grown;
    }
    unsigned char *room = w->data + w->length;
    w->length += n;
    return room;
}

static void store_u16(unsigned char *p, uint16_t v)
{
    p[0] = (unsigned char)(v & 0xff);
    p[1] = (unsigned char)(v >> 8);
}

static void store_u32(unsigned char *p, uint32_t v)
{
    p[0] = (unsigned char)(v & 0xff);
    p[1] = (unsigned char)(v >> 8 & 0xff);
    p[2] = (unsigned char)(v >> 16 & 0xff);
    p[3] = (unsigned char)(v >> 24);
}

static void store_u64(unsigned char *p, uint64_t v)
{
    p[0] = (unsigned char)(v & 0xff);
    p[1] = (unsigned char)(v >> 8 & 0xff);
    p[2] = (unsigned char)(v >> 16 & 0xff);
    p[3] = (unsigned char)(v >> 24 & 0xff);
    p[4] = (unsigned char)(v >> 32 & 0xff);
    p[5] = (unsigned char)(v >> 40 & 0xff);
    p[6] = (unsigned char)(v >> 48 & 0xff);
    p[7] = (unsigned char)(v >> 56);
}

static uint32_t load_u32(const unsigned char *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static uint64_t load_u64(const unsigned char *p)
{
    return (uint64_t)p[0] | (uint64_t)p[1] << 8 | (uint64_t)p[2] << 16 | (uint64_t)p[3] << 24 |
           (uint64_t)p[4] << 32 | (uint64_t)p[5] << 40 | (uint64_t)p[6] << 48 | (uint64_t)p[7] << 56;
}

static uint64_t bits_of(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static double double_of(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

void bytes_put_u8(struct bytes_writer *w, uint8_t value)
{
    unsigned char *p = bytes_put_room(w, 1);
    if (p != NULL)
        *p = value;
}

void bytes_put_u16(struct bytes_writer *w, uint16_t value)
{
    unsigned char *p = bytes_put_room(w, 2);
    if (p != NULL)
        store_u16(p, value);
}

void bytes_put_u32(struct bytes_writer *w, uint32_t value)
{
    unsigned char *p = bytes_put_room(w, 4);
    if (p != NULL)
        store_u32(p, value);
}

void bytes_put_u64(struct bytes_writer *w, uint64_t value)
{
    unsigned char *p = bytes_put_room(w, 8);
    if (p != NULL)
        store_u64(p, value);
}

void bytes_put_i64(struct bytes_writer *w, int64_t value)
{
    bytes_put_u64(w, (uint64_t)value);
}

void bytes_put_f64(struct bytes_writer *w, double value)
{
    bytes_put_u64(w, bits_of(number_plus_zero(value)));
}

void bytes_put_f64s(struct bytes_writer *w, const double *values, size_t n)
{
    if (n > SIZE_MAX / 8) {
        w->failed = true;
        return;
    }
    unsigned char *p = bytes_put_room(w, 8 * n);
    if (p == NULL)
        return;
    for (size_t k = 0; k < n; k++)
        store_u64(p + 8 * k, bits_of(number_plus_zero(values[k])));
}

void bytes_put_raw(struct bytes_writer *w, const void *data, size_t n)
{
    unsigned char *p = bytes_put_room(w, n);
    if (p != NULL && n > 0)
        memcpy(p, data, n);
}

void bytes_put_text(struct bytes_writer *w, const char *text, size_t length)
{
    if (length > UINT32_MAX) {
        w->failed = true;
        return;
    }
    bytes_put_u32(w, (uint32_t)length);
    bytes_put_raw(w, text, length);
}

void bytes_patch_u32(struct bytes_writer *w, size_t at, uint32_t value)
{
    if (!w->failed && at + 4 <= w->length)
        store_u32(w->data + at, value);
}

void bytes_patch_u64(struct bytes_writer *w, size_t at, uint64_t value)
{
    if (!w->failed && at + 8 <= w->length)
        store_u64(w->data + at, value);
}

struct bytes_reader bytes_reader_of(const void *data, size_t length)
{
    return (struct bytes_reader){.data = data, .length = length};
}

size_t bytes_remaining(const struct bytes_reader *r)
{
    return r->failed ? 0 : r->length - r->at;
}

const unsigned char *bytes_get_raw(struct bytes_reader *r, size_t n)
{
    if (r->failed || n > r->length - r->at) {
        r->failed = true;
        return NULL;
    }
    const unsigned char *p = r->data + r->at;
    r->at += n;
    return p;
}

uint8_t bytes_get_u8(struct bytes_reader *r)
{
    const unsigned char *p = bytes_get_raw(r, 1);
    return p == NULL ? 0 : *p;
}

uint16_t bytes_get_u16(struct bytes_reader *r)
{
    const unsigned char *p = bytes_get_raw(r, 2);
    if (p == NULL)
        return 0;
    return (uint16_t)(p[0] | p[1] << 8);
}

uint32_t bytes_get_u32(struct bytes_reader *r)
{
    const unsigned char *p = bytes_get_raw(r, 4);
    return p == NULL ? 0 : load_u32(p);
}

uint64_t bytes_get_u64(struct bytes_reader *r)
{
    const unsigned char *p = bytes_get_raw(r, 8);
    return p == NULL ? 0 : load_u64(p);
}

int64_t bytes_get_i64(struct bytes_reader *r)
{
    uint64_t bits = bytes_get_u64(r);
    return bits <= INT64_MAX ? (int64_t)bits : -(int64_t)(UINT64_MAX - bits) - 1;
}

double bytes_get_f64(struct bytes_reader *r)
{
    return double_of(bytes_get_u64(r));
}

void bytes_get_f64s(struct bytes_reader *r, double *out, size_t n)
{
    const unsigned char *p = n > SIZE_MAX / 8 ? NULL : bytes_get_raw(r, 8 * n);
    if (p == NULL) {
        r->failed = true;
        return;
    }
    for (size_t k = 0; k < n; k++)
        out[k] = double_of(load_u64(p + 8 * k));
}

size_t bytes_get_count(struct bytes_reader *r, size_t item_size)
{
    size_t count = bytes_get_u32(r);
    if (item_size > 0 && count > bytes_remaining(r) / item_size) {
        r->failed = true;
        return 0;
    }
    return count;
}

char *bytes_get_text(struct bytes_reader *r, size_t most, size_t *length)
{
    size_t n = bytes_get_count(r, 1);
    if (n > most)
        r->failed = true;
    const unsigned char *p = bytes_get_raw(r, n);
    if (p == NULL || memchr(p, '\0', n) != NULL) {
        r->failed = true;
        return NULL;
    }
    char *text = mem_alloc(n + 1, 1);
    if (text == NULL) {
        r->failed = true;
        return NULL;
    }
    memcpy(text, p, n);
    text[n] = '\0';
    if (length != NULL)
        *length = n;
    return text;
}

bool bytes_done(const struct bytes_reader *r)
{
    return !r->failed && r->at == r->length;
}
