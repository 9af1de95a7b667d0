/* Bounded byte streams: a writer codes numbers as little-endian bytes, and a reader decodes bytes from
 * untrusted sources.
 *
 * Failures of a writer and of a reader stick: after the first failure every further call does nothing (a get
 * returns 0), so that a caller codes a whole message and checks `failed` once, at the end. */
#ifndef DM2_BASE_BYTES_H
#define DM2_BASE_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A buffer that grows. Starts as {0}; the owner frees the memory with bytes_free. */
struct bytes_writer {
    unsigned char *data;
    size_t length, cap;
    bool failed; /* no memory */
};

void bytes_clear(struct bytes_writer *w); /* sets length 0, not failed; keeps the memory */
void bytes_free(struct bytes_writer *w);

void bytes_put_u8(struct bytes_writer *w, uint8_t value);
void bytes_put_u16(struct bytes_writer *w, uint16_t value);
void bytes_put_u32(struct bytes_writer *w, uint32_t value);
void bytes_put_u64(struct bytes_writer *w, uint64_t value);
void bytes_put_i64(struct bytes_writer *w, int64_t value); /* two's complement */
void bytes_put_f64(struct bytes_writer *w, double value);  /* IEEE 754 binary64; -0 is put as 0 */
void bytes_put_f64s(struct bytes_writer *w, const double *values, size_t n);
void bytes_put_raw(struct bytes_writer *w, const void *data, size_t n);
/* Puts a text: the length as u32, then the bytes without the NUL. */
void bytes_put_text(struct bytes_writer *w, const char *text, size_t length);

/* Room for n more bytes, which the caller fills before the next call. NULL where the writer failed. */
unsigned char *bytes_put_room(struct bytes_writer *w, size_t n);

/* Overwrite the 4 or 8 bytes at `at`, which were put before: for counts and lengths that are known later. */
void bytes_patch_u32(struct bytes_writer *w, size_t at, uint32_t value);
void bytes_patch_u64(struct bytes_writer *w, size_t at, uint64_t value);

/* A cursor over bytes; the bytes belong to the caller and must outlive the cursor. */
struct bytes_reader {
    const unsigned char *data;
    size_t length, at;
    bool failed; /* a get asked for more bytes than remain, or a count or text was invalid */
    char *why; /* NULL, or BYTES_WHY bytes of the caller, "" at first: a decoder says which value cannot be */
};

enum { BYTES_WHY = 240 };

/* A cursor at the start of data[0 .. length). The number of bytes that remain, 0 after a failure. */
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

/* The next n bytes, in place; NULL, and failed, where fewer remain. */
const unsigned char *bytes_get_raw(struct bytes_reader *r, size_t n);

/* A u32 count of items of at least `item_size` bytes each. Fails where the remaining bytes cannot hold so
 * many items, so that the caller may allocate `count` items. */
size_t bytes_get_count(struct bytes_reader *r, size_t item_size);

/* A text as bytes_put_text writes texts, of at most `most` bytes and without a NUL; the copy is malloc'd and
 * terminated, and belongs to the caller. NULL, and failed, where the text is longer, has a NUL or there is no
 * memory. `length`, which may be NULL, receives the length. */
char *bytes_get_text(struct bytes_reader *r, size_t most, size_t *length);

/* True where nothing failed and no byte remains. */
bool bytes_done(const struct bytes_reader *r);

#endif
