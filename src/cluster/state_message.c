/* The head of a STATE message: which sections the part of a state has, in the order of one table, and that
 * their records fill the message. The records are read by their own functions (dm2/cluster/wire.h,
 * engine/section). */
#include <string.h>

#include "dm2/cluster/messages.h"
#include "dm2/cluster/wire.h"

static void require(struct bytes_reader *r, bool holds)
{
    if (!holds)
        r->failed = true;
}

/* The sections of a STATE message before the further ones. */
enum { PART_ELEM, PART_MEAS, PART_PAIR, PART_FORC, PART_ALWAYS };
static const char part_tags[PART_ALWAYS][SECTION_TAG + 1] = {"ELEM", "MEAS", "PAIR", "FORC"};
static const uint32_t part_widths[PART_ALWAYS] = {WIRE_ELEMENT, WIRE_MEASURED, WIRE_PAIR, WIRE_FORCE};

static const char *part_tag(int part)
{
    return part < PART_ALWAYS ? part_tags[part] : section_kinds[part - PART_ALWAYS].tag;
}

static uint32_t part_width(int part)
{
    return part < PART_ALWAYS ? part_widths[part] : section_kinds[part - PART_ALWAYS].bytes;
}

static size_t part_records(const struct state_message *m, int part)
{
    return part == PART_ELEM   ? m->n_elements
           : part == PART_MEAS ? (m->purpose == STATE_SNAPSHOT ? m->n_elements : 0)
           : part == PART_PAIR ? m->n_pairs
           : part == PART_FORC ? (m->purpose == STATE_SNAPSHOT ? m->n_pairs : 0)
                               : m->sections[part - PART_ALWAYS];
}

void message_put_state(struct bytes_writer *w, const struct state_message *m)
{
    unsigned parts = 0;
    for (int k = 0; k < PART_ALWAYS + SECTION_COUNT; k++)
        parts += part_records(m, k) > 0;
    bytes_put_i64(w, m->step);
    bytes_put_u8(w, (uint8_t)m->purpose);
    bytes_put_u8(w, m->last);
    bytes_put_u8(w, (uint8_t)parts);
    for (int k = 0; k < PART_ALWAYS + SECTION_COUNT; k++)
        if (part_records(m, k) > 0)
            section_put_head(w, part_tag(k), part_width(k), part_records(m, k));
}

void message_get_state(struct bytes_reader *r, struct state_message *m)
{
    *m = (struct state_message){.step = bytes_get_i64(r)};
    uint8_t purpose = bytes_get_u8(r);
    require(r, purpose >= STATE_SNAPSHOT && purpose <= STATE_COPY);
    m->purpose = r->failed ? STATE_FINAL : (enum state_purpose)purpose;
    uint8_t last = bytes_get_u8(r);
    require(r, last <= 1);
    m->last = last != 0;
    size_t n[PART_ALWAYS + SECTION_COUNT] = {0};
    uint64_t total = 0;
    uint8_t parts = bytes_get_u8(r);
    for (int k = 0, part = 0; k < parts && !r->failed; k++, part++) {
        struct section_head head;
        section_get_head(r, &head);
        while (part < PART_ALWAYS + SECTION_COUNT && strcmp(part_tag(part), head.tag) != 0)
            part++;
        require(r, part < PART_ALWAYS + SECTION_COUNT && head.bytes == part_width(part) && head.records > 0 &&
                       head.records <= UINT32_MAX);
        if (r->failed)
            return;
        n[part] = (size_t)head.records;
        total += head.records * head.bytes; /* at most 8 products below 2^40 */
    }
    m->n_elements = n[PART_ELEM];
    m->n_pairs = n[PART_PAIR];
    memcpy(m->sections, n + PART_ALWAYS, sizeof m->sections);
    require(r, n[PART_MEAS] == part_records(m, PART_MEAS) && n[PART_FORC] == part_records(m, PART_FORC) &&
                   total == bytes_remaining(r));
}

bool state_message_empty(const struct state_message *m)
{
    bool empty = true;
    for (int k = 0; k < PART_ALWAYS + SECTION_COUNT; k++)
        empty &= part_records(m, k) == 0;
    return empty;
}
