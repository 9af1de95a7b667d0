/* The state file.
 *
 * Every field is encoded by itself, so that the bytes do not depend on the layout of structs. The writer
 * encodes into a block that is checksummed and written when full. The reader holds the whole file in memory
 * and checks magic, version, length against the counts, checksum, fingerprint, and then every record, in this
 * order, so that a message names the first error. Memory is allocated only for counts that the file's length
 * confirms. */
#include "dm2/output/state.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/bytes.h"
#include "dm2/base/crc32c.h"
#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/engine/self_test.h"

static const char magic[8] = {'D', 'M', '2', 'S', 'T', 'A', 'T', 'E'};

enum {
    HEADER_BYTES = 8 + 4 + STATE_DIGEST_BYTES + 4 * 8,
    ELEMENT_BYTES = RECORD_BYTES,
    PAIR_BYTES = 4 + 4 + 1 + 2 * 8,
    CRC_BYTES = 4,
    BLOCK_BYTES = 1 << 16
};

/* --- writing --- */

struct encoder {
    struct file_out file;
    struct bytes_writer bytes;
    uint32_t crc;
};

static void put_header(struct bytes_writer *w, const struct state_view *s)
{
    bytes_put_raw(w, magic, sizeof magic);
    bytes_put_u32(w, STATE_VERSION);
    bytes_put_raw(w, s->digest, STATE_DIGEST_BYTES);
    bytes_put_u64(w, SELF_TEST_FINGERPRINT);
    bytes_put_i64(w, s->step);
    bytes_put_u64(w, s->n_elements);
    bytes_put_u64(w, s->n_pairs);
}

static void put_pair(struct bytes_writer *w, const struct pair_record *p)
{
    bytes_put_u32(w, p->id_a);
    bytes_put_u32(w, p->id_b);
    bytes_put_u8(w, p->linked != 0 ? 1 : 0);
    bytes_put_f64(w, p->stretch);
    bytes_put_f64(w, p->spring);
}

/* Writes the block once it holds `threshold` bytes. */
static void write_block(struct encoder *e, size_t threshold)
{
    if (e->bytes.length < threshold || e->bytes.failed)
        return;
    e->crc = crc32c(e->crc, e->bytes.data, e->bytes.length);
    file_write(&e->file, e->bytes.data, e->bytes.length);
    bytes_clear(&e->bytes);
}

static void encode_state(struct encoder *e, const struct state_view *s)
{
    put_header(&e->bytes, s);
    bool given = s->elements == NULL && s->element != NULL;
    struct element element;
    struct pair_record pair;
    uint32_t before = 0;
    for (size_t i = 0; i < s->n_elements; i++) {
        if (given)
            s->element(s->records, i, &element);
        else
            element = s->elements[i];
        assert(i == 0 || before < element.id);
        before = element.id;
        record_put(&e->bytes, RECORD_STATE, &element);
        write_block(e, BLOCK_BYTES);
    }
    for (size_t i = 0; i < s->n_pairs; i++) {
        if (given)
            s->pair(s->records, i, &pair);
        else
            pair = s->pairs[i];
        put_pair(&e->bytes, &pair);
        write_block(e, BLOCK_BYTES);
    }
    write_block(e, 1);
    bytes_put_u32(&e->bytes, e->crc);
    write_block(e, 1);
}

enum dm2_status state_write(const char *path, const struct state_view *s, struct dm2_error *err)
{
    struct encoder e = {.bytes = {0}, .crc = 0};
    enum dm2_status status = file_create(&e.file, path, err);
    if (status != DM2_OK)
        return status;
    encode_state(&e, s);
    bool failed = e.bytes.failed;
    bytes_free(&e.bytes);
    if (failed) {
        file_abandon(&e.file);
        return dm2_fail(err, DM2_MEMORY, "%s: no memory to encode the state", path);
    }
    return file_commit(&e.file, err);
}

/* --- reading --- */

static enum dm2_status refuse_file(const char *path, struct dm2_error *err, const char *what)
{
    return dm2_fail(err, DM2_PROTOCOL, "%s: %s", path, what);
}

/* Reads the header and compares the counts with the file's length; *r is then at the first element. */
static enum dm2_status get_header(struct bytes_reader *r, const char *path, struct state *out,
                                  uint64_t *fingerprint, struct dm2_error *err)
{
    size_t known = r->length < sizeof magic ? r->length : sizeof magic;
    if (known == 0 || memcmp(r->data, magic, known) != 0)
        return refuse_file(path, err, "is not a dm2 state file: it does not begin with DM2STATE");
    if (r->length < HEADER_BYTES + CRC_BYTES)
        return refuse_file(path, err, "is cut short: it ends within the header of the state");
    (void)bytes_get_raw(r, sizeof magic);
    uint32_t version = bytes_get_u32(r);
    if (version != STATE_VERSION)
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s: is a state of format version %" PRIu32 ", this program reads version %d", path,
                        version, STATE_VERSION);
    memcpy(out->digest, bytes_get_raw(r, STATE_DIGEST_BYTES), STATE_DIGEST_BYTES);
    *fingerprint = bytes_get_u64(r);
    out->step = bytes_get_i64(r);
    uint64_t n_elements = bytes_get_u64(r), n_pairs = bytes_get_u64(r);
    uint64_t most = bytes_remaining(r);
    if (n_elements > most / ELEMENT_BYTES || n_pairs > most / PAIR_BYTES ||
        n_elements * ELEMENT_BYTES + n_pairs * PAIR_BYTES + CRC_BYTES > most)
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s: is cut short: its header announces %" PRIu64 " elements and %" PRIu64
                        " pairs, more than its %zu bytes hold",
                        path, n_elements, n_pairs, r->length);
    uint64_t extra = most - (n_elements * ELEMENT_BYTES + n_pairs * PAIR_BYTES + CRC_BYTES);
    if (extra != 0)
        return dm2_fail(err, DM2_PROTOCOL, "%s: has %" PRIu64 " bytes behind the end of the state", path,
                        extra);
    out->n_elements = (size_t)n_elements;
    out->n_pairs = (size_t)n_pairs;
    return DM2_OK;
}

static enum dm2_status check_crc(const struct bytes_reader *r, const char *path, struct dm2_error *err)
{
    size_t body = r->length - CRC_BYTES;
    struct bytes_reader trailer = bytes_reader_of(r->data + body, CRC_BYTES);
    uint32_t stored = bytes_get_u32(&trailer), computed = crc32c(0, r->data, body);
    if (stored != computed)
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s: is damaged: its checksum is %08" PRIx32 ", its content has %08" PRIx32
                        "; copy it again from where it was written",
                        path, stored, computed);
    return DM2_OK;
}

static enum dm2_status check_fingerprint(uint64_t there, const char *path, struct dm2_error *err)
{
    uint64_t here = SELF_TEST_FINGERPRINT;
    if (there == here)
        return DM2_OK;
    return dm2_fail(
        err, DM2_PROTOCOL,
        "%s: was computed by another release or with another arithmetic, of fingerprint %016" PRIx64
        "; this program's is %016" PRIx64 ", and would not go on to the same results: "
        "continue with the release that wrote it",
        path, there, here);
}

/* Refuses an element with an invalid field; limits NULL: any index is valid. */
static enum dm2_status check_element(const char *path, const struct element *e,
                                     const struct record_limits *limits, struct dm2_error *err)
{
    const struct element_field *fault = record_fault(e, limits);
    char text[RECORD_FAULT_TEXT];
    if (fault == NULL)
        return DM2_OK;
    record_describe_fault(fault, e, limits, text);
    return dm2_fail(err, DM2_PROTOCOL, "%s: element %" PRIu32 " %s", path, e->id, text);
}

static enum dm2_status refuse_pair(const char *path, const struct pair_record *p, const char *text,
                                   struct dm2_error *err)
{
    return dm2_fail(err, DM2_PROTOCOL, "%s: the pair (%" PRIu32 ", %" PRIu32 ") %s", path, p->id_a, p->id_b,
                    text);
}

/* The fault of a pair among the pairs and elements of its state, as the end of a sentence; NULL: there is
 * none. */
static const char *pair_fault(const struct state *s, const struct pair_record *p,
                              const struct pair_record *before)
{
    if (before != NULL && (p->id_a < before->id_a || (p->id_a == before->id_a && p->id_b <= before->id_b)))
        return "is out of order or there twice";
    if (element_find(s->elements, s->n_elements, p->id_a) == s->n_elements ||
        element_find(s->elements, s->n_elements, p->id_b) == s->n_elements)
        return "names an element that is not in the state";
    return NULL;
}

static enum dm2_status get_records(struct bytes_reader *r, const char *path, struct state *s,
                                   struct dm2_error *err)
{
    for (size_t i = 0; i < s->n_elements; i++) {
        struct element *e = &s->elements[i];
        record_get(r, RECORD_STATE, e);
        if (i > 0 && e->id <= e[-1].id)
            return dm2_fail(err, DM2_PROTOCOL, "%s: element %" PRIu32 " is out of order or there twice", path,
                            e->id);
        enum dm2_status status = check_element(path, e, NULL, err);
        if (status != DM2_OK)
            return status;
    }
    for (size_t i = 0; i < s->n_pairs; i++) {
        struct pair_record *p = &s->pairs[i];
        p->id_a = bytes_get_u32(r);
        p->id_b = bytes_get_u32(r);
        p->linked = bytes_get_u8(r);
        p->stretch = bytes_get_f64(r);
        p->spring = bytes_get_f64(r);
        char text[RECORD_FAULT_TEXT];
        if (!record_pair_valid(p, NULL, text))
            return refuse_pair(path, p, text, err);
        const char *fault = pair_fault(s, p, i == 0 ? NULL : p - 1);
        if (fault != NULL)
            return refuse_pair(path, p, fault, err);
    }
    return DM2_OK;
}

static enum dm2_status decode_state(const unsigned char *bytes, size_t n, const char *path, struct state *out,
                                    struct dm2_error *err)
{
    struct bytes_reader r = bytes_reader_of(bytes, n);
    uint64_t fingerprint = 0;
    enum dm2_status status = get_header(&r, path, out, &fingerprint, err);
    if (status == DM2_OK)
        status = check_crc(&r, path, err);
    if (status == DM2_OK)
        status = check_fingerprint(fingerprint, path, err);
    if (status != DM2_OK)
        return status;
    if (out->step < 0)
        return refuse_file(path, err, "has a negative step");
    out->elements = mem_zalloc(out->n_elements, sizeof *out->elements);
    out->pairs = mem_zalloc(out->n_pairs, sizeof *out->pairs);
    if (out->elements == NULL || out->pairs == NULL)
        return dm2_fail(err, DM2_MEMORY, "%s: no memory for its %zu elements and %zu pairs", path,
                        out->n_elements, out->n_pairs);
    return get_records(&r, path, out, err);
}

enum dm2_status state_read(const char *path, struct state *out, struct dm2_error *err)
{
    unsigned char *bytes;
    size_t n;
    memset(out, 0, sizeof *out);
    enum dm2_status status = file_read(path, SIZE_MAX / 4, &bytes, &n, err);
    if (status != DM2_OK)
        return status;
    status = decode_state(bytes, n, path, out, err);
    free(bytes);
    if (status != DM2_OK)
        state_free(out);
    return status;
}

enum dm2_status state_check(const char *path, const struct state *s, const struct record_limits *limits,
                            struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < s->n_elements && status == DM2_OK; k++)
        status = check_element(path, &s->elements[k], limits, err);
    for (size_t k = 0; k < s->n_pairs && status == DM2_OK; k++) {
        const struct pair_record *p = &s->pairs[k];
        const struct element *a = &s->elements[element_find(s->elements, s->n_elements, p->id_a)],
                             *b = &s->elements[element_find(s->elements, s->n_elements, p->id_b)];
        char text[RECORD_FAULT_TEXT];
        if (!record_pair_valid(p, limits, text) || !record_pair_reaches(a, b, limits, text))
            status = refuse_pair(path, p, text, err);
    }
    return status;
}

void state_free(struct state *s)
{
    free(s->elements);
    free(s->pairs);
    memset(s, 0, sizeof *s);
}
