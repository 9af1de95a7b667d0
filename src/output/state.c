/* The state file.
 *
 * Every field is encoded by itself, so that the bytes do not depend on the layout of structs. The writer
 * encodes into a block that is checksummed and written when full. The reader holds the whole file in memory
 * and checks magic, version, the lengths of the sections against the file's, checksum, fingerprint, and then
 * every section and record, in this order, so that a message names the first error. Memory is allocated only
 * for counts that the file's length confirms. */
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
#include "dm2/base/sha256.h"
#include "dm2/base/text.h"
#include "dm2/engine/self_test.h"

static const char magic[8] = {'D', 'M', '2', 'S', 'T', 'A', 'T', 'E'};

/* The sections before the further ones, with their bytes per record. */
enum { TEXT, NAME, ELEM, PAIR, ALWAYS };
static const char tags[ALWAYS][SECTION_TAG + 1] = {"TEXT", "NAME", "ELEM", "PAIR"};
static const uint32_t widths[ALWAYS] = {1, STATE_NAME_BYTES, RECORD_BYTES, 25};

enum { HEADER_BYTES = 8 + 4 + STATE_DIGEST_BYTES + 4 * 8 + 3 * 4, CRC_BYTES = 4, BLOCK_BYTES = 1 << 16 };

/* --- writing --- */

struct encoder {
    struct file_out file;
    struct bytes_writer bytes;
    uint32_t crc;
};

static void put_header(struct bytes_writer *w, const struct state_view *s)
{
    uint32_t sections = ALWAYS;
    for (int k = 0; k < SECTION_COUNT; k++)
        sections += s->sections[k].n > 0;
    bytes_put_raw(w, magic, sizeof magic);
    bytes_put_u32(w, STATE_VERSION);
    bytes_put_raw(w, s->origin->digest, STATE_DIGEST_BYTES);
    bytes_put_u64(w, SELF_TEST_FINGERPRINT);
    bytes_put_i64(w, s->step);
    bytes_put_i64(w, s->origin->n_start);
    bytes_put_f64(w, s->origin->t_start);
    bytes_put_u32(w, s->origin->next_id);
    bytes_put_u32(w, s->origin->next_grain);
    bytes_put_u32(w, sections);
}

/* TEXT and NAME. */
static void put_origin(struct bytes_writer *w, const struct state_origin *o)
{
    section_put_head(w, tags[TEXT], widths[TEXT], o->text_length);
    bytes_put_raw(w, o->text, o->text_length);
    section_put_head(w, tags[NAME], widths[NAME], o->n_names);
    for (size_t k = 0; k < o->n_names; k++) {
        char text[STATE_NAME_BYTES - 1] = {0};
        memcpy(text, o->names[k].text, strlen(o->names[k].text));
        bytes_put_u8(w, (uint8_t)o->names[k].sort);
        bytes_put_raw(w, text, sizeof text);
    }
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

static void encode_elements(struct encoder *e, const struct state_view *s, bool given)
{
    struct element element;
    uint32_t before = 0;
    section_put_head(&e->bytes, tags[ELEM], widths[ELEM], s->n_elements);
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
}

static void encode_pairs(struct encoder *e, const struct state_view *s, bool given)
{
    struct pair_record pair;
    section_put_head(&e->bytes, tags[PAIR], widths[PAIR], s->n_pairs);
    for (size_t i = 0; i < s->n_pairs; i++) {
        if (given)
            s->pair(s->records, i, &pair);
        else
            pair = s->pairs[i];
        put_pair(&e->bytes, &pair);
        write_block(e, BLOCK_BYTES);
    }
}

static void encode_state(struct encoder *e, const struct state_view *s)
{
    bool given = s->elements == NULL && s->element != NULL;
    put_header(&e->bytes, s);
    put_origin(&e->bytes, s->origin);
    encode_elements(e, s, given);
    encode_pairs(e, s, given);
    for (int k = 0; k < SECTION_COUNT; k++) {
        const struct section_array *a = &s->sections[k];
        if (a->n > 0)
            section_put_head(&e->bytes, section_kinds[k].tag, section_kinds[k].bytes, a->n);
        for (size_t i = 0; i < a->n; i++) {
            section_kinds[k].put(&e->bytes, section_record((enum section)k, a, i));
            write_block(e, BLOCK_BYTES);
        }
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

/* What the header says beside struct state. */
struct header {
    uint64_t fingerprint;
    uint32_t sections;
};

/* Reads the header; *r is then at the first section. */
static enum dm2_status get_header(struct bytes_reader *r, const char *path, struct state *out,
                                  struct header *header, struct dm2_error *err)
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
    memcpy(out->origin.digest, bytes_get_raw(r, STATE_DIGEST_BYTES), STATE_DIGEST_BYTES);
    header->fingerprint = bytes_get_u64(r);
    out->step = bytes_get_i64(r);
    out->origin.n_start = bytes_get_i64(r);
    out->origin.t_start = bytes_get_f64(r);
    out->origin.next_id = bytes_get_u32(r);
    out->origin.next_grain = bytes_get_u32(r);
    header->sections = bytes_get_u32(r);
    return DM2_OK;
}

/* Compares the lengths of the sections with the file's length. *r is at the first section. */
static enum dm2_status check_lengths(struct bytes_reader r, const char *path, uint32_t sections,
                                     struct dm2_error *err)
{
    for (uint32_t k = 0; k < sections; k++) {
        struct section_head head;
        size_t left = bytes_remaining(&r) - CRC_BYTES;
        if (left < SECTION_HEAD)
            return dm2_fail(err, DM2_PROTOCOL,
                            "%s: is cut short: its header announces %" PRIu32 " sections, and it ends in "
                            "section %" PRIu32,
                            path, sections, k + 1);
        section_get_head(&r, &head);
        text_make_printable(head.tag, false);
        left -= SECTION_HEAD;
        if (head.bytes > 0 && head.records > left / head.bytes)
            return dm2_fail(err, DM2_PROTOCOL,
                            "%s: is cut short: its section %s announces %" PRIu64 " records, more than its "
                            "%zu bytes hold",
                            path, head.tag, head.records, r.length);
        (void)bytes_get_raw(&r, head.bytes > 0 ? (size_t)head.records * head.bytes : 0);
    }
    size_t extra = bytes_remaining(&r) - CRC_BYTES;
    if (extra != 0)
        return dm2_fail(err, DM2_PROTOCOL, "%s: has %zu bytes behind the end of the state", path, extra);
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

static enum dm2_status get_text(struct bytes_reader *r, const char *path, struct state_origin *o, size_t n,
                                struct dm2_error *err)
{
    const unsigned char *text = bytes_get_raw(r, n);
    o->text = mem_zalloc(n + 1, 1);
    if (o->text == NULL)
        return dm2_fail(err, DM2_MEMORY, "%s: no memory for its text", path);
    memcpy(o->text, text, n);
    o->text_length = n;
    unsigned char digest[SHA256_BYTES];
    struct sha256 s;
    sha256_start(&s);
    sha256_add(&s, text, n);
    sha256_finish(&s, digest);
    if (memcmp(digest, o->digest, sizeof digest) != 0)
        return refuse_file(path, err, "section TEXT is not the text of the state's digest");
    if (memchr(text, 0, n) != NULL)
        return refuse_file(path, err, "section TEXT has a byte that is no text");
    return DM2_OK;
}

/* A name is filled up with NUL bytes and has at least one of them. */
static bool get_name(struct bytes_reader *r, struct state_name *name)
{
    uint8_t sort = bytes_get_u8(r);
    const unsigned char *text = bytes_get_raw(r, STATE_NAME_BYTES - 1);
    const unsigned char *end = memchr(text, 0, STATE_NAME_BYTES - 1);
    size_t length = end == NULL ? STATE_NAME_BYTES - 1 : (size_t)(end - text);
    if (sort >= NAME_SORTS || length == 0 || length >= sizeof name->text)
        return false;
    for (size_t k = length; k < STATE_NAME_BYTES - 1; k++)
        if (text[k] != 0)
            return false;
    name->sort = (enum name_sort)sort;
    memcpy(name->text, text, length);
    for (size_t k = 0; k < length; k++)
        if (text[k] <= ' ' || text[k] == 0x7f)
            return false;
    return true;
}

static enum dm2_status get_names(struct bytes_reader *r, const char *path, struct state_origin *o, size_t n,
                                 struct dm2_error *err)
{
    o->names = mem_zalloc(n, sizeof *o->names);
    if (o->names == NULL)
        return dm2_fail(err, DM2_MEMORY, "%s: no memory for its %zu names", path, n);
    for (; o->n_names < n; o->n_names++) {
        struct state_name *name = &o->names[o->n_names];
        if (!get_name(r, name) || (o->n_names > 0 && name->sort < name[-1].sort))
            return dm2_fail(err, DM2_PROTOCOL, "%s: section NAME: record %zu is no name, or out of order",
                            path, o->n_names);
    }
    return DM2_OK;
}

static enum dm2_status get_elements(struct bytes_reader *r, const char *path, struct state *s, size_t n,
                                    struct dm2_error *err)
{
    s->elements = mem_zalloc(n, sizeof *s->elements);
    if (s->elements == NULL)
        return dm2_fail(err, DM2_MEMORY, "%s: no memory for its %zu elements", path, n);
    s->n_elements = n;
    for (size_t i = 0; i < n; i++) {
        struct element *e = &s->elements[i];
        record_get(r, RECORD_STATE, e);
        if (i > 0 && e->id <= e[-1].id)
            return dm2_fail(err, DM2_PROTOCOL, "%s: element %" PRIu32 " is out of order or there twice", path,
                            e->id);
        enum dm2_status status = check_element(path, e, NULL, err);
        if (status != DM2_OK)
            return status;
        if (e->id >= s->origin.next_id || e->grain >= s->origin.next_grain)
            return dm2_fail(err, DM2_PROTOCOL,
                            "%s: element %" PRIu32 " of grain %" PRIu32
                            " is beyond the next element, %" PRIu32 ", or the next grain, %" PRIu32,
                            path, e->id, e->grain, s->origin.next_id, s->origin.next_grain);
    }
    return DM2_OK;
}

static enum dm2_status get_pairs(struct bytes_reader *r, const char *path, struct state *s, size_t n,
                                 struct dm2_error *err)
{
    s->pairs = mem_zalloc(n, sizeof *s->pairs);
    if (s->pairs == NULL)
        return dm2_fail(err, DM2_MEMORY, "%s: no memory for its %zu pairs", path, n);
    s->n_pairs = n;
    for (size_t i = 0; i < n; i++) {
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

/* A further section, whose records name elements of the state. */
static enum dm2_status get_further(struct bytes_reader *r, const char *path, struct state *s,
                                   enum section kind, size_t n, struct dm2_error *err)
{
    struct dm2_error why = {0};
    if (n == 0)
        return dm2_fail(err, DM2_PROTOCOL, "%s: section %s has no records: then it is to be absent", path,
                        section_kinds[kind].tag);
    enum dm2_status status = section_get(kind, r, n, NULL, &s->sections[kind], &why);
    if (status == DM2_OK)
        status = section_check(kind, &s->sections[kind], NULL, s->elements, s->n_elements, &why);
    return status == DM2_OK ? DM2_OK : dm2_fail(err, status, "%s: %s", path, why.text);
}

/* The number of a section among all, by its tag; ALWAYS + SECTION_COUNT: unknown. *width: its bytes per
 * record. */
static int find_section(const char *tag, uint32_t *width)
{
    for (int k = 0; k < ALWAYS + SECTION_COUNT; k++) {
        *width = k < ALWAYS ? widths[k] : section_kinds[k - ALWAYS].bytes;
        if (strcmp(tag, k < ALWAYS ? tags[k] : section_kinds[k - ALWAYS].tag) == 0)
            return k;
    }
    return ALWAYS + SECTION_COUNT;
}

/* Reads a section's head. `before` is the number of the section before, -1: none; *which becomes this one's.
 */
static enum dm2_status get_section_head(struct bytes_reader *r, const char *path, int before, int *which,
                                        size_t *n, struct dm2_error *err)
{
    struct section_head head;
    uint32_t width;
    section_get_head(r, &head);
    *which = find_section(head.tag, &width);
    *n = (size_t)head.records;
    if (*which == ALWAYS + SECTION_COUNT) {
        text_make_printable(head.tag, false);
        return dm2_fail(err, DM2_PROTOCOL, "%s: has a section '%s', which this program does not know", path,
                        head.tag);
    }
    if (head.bytes != width)
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s: section %s has records of %" PRIu32 " bytes, %" PRIu32 " are expected", path,
                        head.tag, head.bytes, width);
    if (*which <= before)
        return dm2_fail(err, DM2_PROTOCOL, "%s: section %s is out of order or there twice", path, head.tag);
    if (before + 1 < ALWAYS && *which != before + 1)
        return dm2_fail(err, DM2_PROTOCOL, "%s: section %s is missing", path, tags[before + 1]);
    return DM2_OK;
}

static enum dm2_status get_sections(struct bytes_reader *r, const char *path, uint32_t sections,
                                    struct state *s, struct dm2_error *err)
{
    int which = -1;
    enum dm2_status status = DM2_OK;
    for (uint32_t k = 0; k < sections && status == DM2_OK; k++) {
        size_t n;
        status = get_section_head(r, path, which, &which, &n, err);
        if (status != DM2_OK)
            return status;
        status = which == TEXT   ? get_text(r, path, &s->origin, n, err)
                 : which == NAME ? get_names(r, path, &s->origin, n, err)
                 : which == ELEM ? get_elements(r, path, s, n, err)
                 : which == PAIR ? get_pairs(r, path, s, n, err)
                                 : get_further(r, path, s, (enum section)(which - ALWAYS), n, err);
    }
    if (status == DM2_OK && which + 1 < ALWAYS)
        return dm2_fail(err, DM2_PROTOCOL, "%s: section %s is missing", path, tags[which + 1]);
    return status;
}

static enum dm2_status decode_state(const unsigned char *bytes, size_t n, const char *path, struct state *out,
                                    struct dm2_error *err)
{
    struct bytes_reader r = bytes_reader_of(bytes, n);
    struct header header = {.sections = 0};
    enum dm2_status status = get_header(&r, path, out, &header, err);
    if (status == DM2_OK)
        status = check_lengths(r, path, header.sections, err);
    if (status == DM2_OK)
        status = check_crc(&r, path, err);
    if (status == DM2_OK)
        status = check_fingerprint(header.fingerprint, path, err);
    if (status != DM2_OK)
        return status;
    if (out->step < 0)
        return refuse_file(path, err, "has a negative step");
    if (out->origin.n_start < 0 || out->origin.n_start > out->step)
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s: is of step %" PRId64 " of a stage that begins with step %" PRId64, path,
                        out->step, out->origin.n_start);
    if (!isfinite(out->origin.t_start))
        return refuse_file(path, err, "has a stage that begins at a time that is not finite");
    return get_sections(&r, path, header.sections, out, err);
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
    for (int k = 0; k < SECTION_COUNT && status == DM2_OK; k++) {
        struct dm2_error why = {0};
        status = section_check((enum section)k, &s->sections[k], limits, s->elements, s->n_elements, &why);
        if (status != DM2_OK)
            (void)dm2_fail(err, status, "%s: %s", path, why.text);
    }
    return status;
}

struct state_view state_view_of(const struct state *s)
{
    struct state_view view = {.origin = &s->origin,
                              .step = s->step,
                              .elements = s->elements,
                              .n_elements = s->n_elements,
                              .pairs = s->pairs,
                              .n_pairs = s->n_pairs};
    memcpy(view.sections, s->sections, sizeof view.sections);
    return view;
}

void state_free(struct state *s)
{
    state_origin_free(&s->origin);
    section_free(s->sections);
    free(s->elements);
    free(s->pairs);
    memset(s, 0, sizeof *s);
}
