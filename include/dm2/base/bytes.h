/* Bounded byte streams: how numbers become bytes, little-endian, and how bytes that came from elsewhere
 * become numbers again without trusting them.
 *
 * Both ends are sticky: after the first failure every further call does nothing (a get gives 0), so a whole
 * message is coded in a row and `failed` is looked at once, at its end. */
#ifndef DM2_BASE_BYTES_H
#define DM2_BASE_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A buffer that grows. Start from {0}; it keeps its memory when cleared. */
struct bytes_writer {
    unsigned char *data;
    size_t length, cap;
    bool failed; /* no memory */
};

void bytes_clear(struct bytes_writer *w); /* length 0, not failed; keeps the memory */
void bytes_free(struct bytes_writer *w);

void bytes_put_u8(struct bytes_writer *w, uint8_t value);
void bytes_put_u16(struct bytes_writer *w, uint16_t value);
void bytes_put_u32(struct bytes_writer *w, uint32_t value);
void bytes_put_u64(struct bytes_writer *w, uint64_t value);
void bytes_put_i64(struct bytes_writer *w, int64_t value); /* two's complement */
void bytes_put_f64(struct bytes_writer *w, double value);  /* IEEE 754 binary64 */
void bytes_put_f64s(struct bytes_writer *w, const double *values, size_t n);
void bytes_put_raw(struct bytes_writer *w, const void *data, size_t n);
/* A text: its length as u32, then its bytes without the NUL. */
void bytes_put_text(struct bytes_writer *w, const char *text, size_t length);

/* Room for n more bytes; they are the caller's to fill. NULL where the writer failed. */
unsigned char *bytes_put_room(struct bytes_writer *w, size_t n);

/* Overwrites 4 bytes at `at`, which have been put before: for counts and lengths known afterwards. */
void bytes_patch_u32(struct bytes_writer *w, size_t at, uint32_t value);
void bytes_patch_u64(struct bytes_writer *w, size_t at, uint64_t value);

/* A cursor over bytes that belong to someone else. */
struct bytes_reader {
    const unsigned char *data;
    size_t length, at;
    bool failed; /* something asked for more bytes than there are, or a count that cannot be true */
};

/* A cursor at the start of the bytes; how many are left, 0 after a failure. */
struct bytes_reader bytes_reader_of(const void *data, size_t length);
size_t bytes_remaining(const struct bytes_reader *r);

/* The next number; 0 after a failure. */
uint8_t bytes_get_u8(struct bytes_reader *r);
uint16_t bytes_get_u16(struct bytes_reader *r);
uint32_t bytes_get_u32(struct bytes_reader *r);
uint64_t bytes_get_u64(struct bytes_reader *r);
int64_t bytes_get_i64(struct bytes_reader *r);
double bytes_get_f64(struct bytes_reader *r);
void bytes_get_f64s(struct bytes_reader *r, double *out, size_t n);

/* n bytes in place, or NULL and failed. */
const unsigned char *bytes_get_raw(struct bytes_reader *r, size_t n);

/* A u32 count of items that take at least `item_size` bytes each: fails where the bytes that remain cannot
 * hold them, so that the count is safe to allocate by. */
size_t bytes_get_count(struct bytes_reader *r, size_t item_size);

/* A text as bytes_put_text wrote it, at most `most` bytes and without a NUL inside; malloc'd and terminated.
 * NULL and failed otherwise. *length may be NULL. */
char *bytes_get_text(struct bytes_reader *r, size_t most, size_t *length);

/* Everything was read, nothing failed and nothing trails. */
bool bytes_done(const struct bytes_reader *r);

#endif
