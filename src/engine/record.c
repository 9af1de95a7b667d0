/* One table of an element's fields, and loops over it.
 *
 * The table tiles struct element: the unit test finds a member without a row. A form takes room for its bytes
 * once, not once per number, because a rebuild packs every mirrored element. */
#include "dm2/engine/record.h"

#include <string.h>

#include "dm2/base/number.h"

#define ROW(field, unit, type, count, rule, owner)                                                           \
    {                                                                                                        \
#field, unit, offsetof(struct element, field), type, count, rule, owner                              \
    }
const struct element_field element_fields[ELEMENT_FIELDS] = {
    ROW(id, "", FIELD_U32, 1, RULE_ID, false),
    ROW(grain, "", FIELD_U32, 1, RULE_GRAIN, false),
    ROW(body, "", FIELD_U16, 1, RULE_BODY, false),
    ROW(kind, "", FIELD_U16, 1, RULE_KIND, false),
    ROW(flags, "", FIELD_U8, 1, RULE_FLAGS, false),
    ROW(probes, "", FIELD_U8, 1, RULE_PROBES, false),
    ROW(radius, "cm", FIELD_F64, 1, RULE_RADIUS, false),
    ROW(mass, "g", FIELD_F64, 1, RULE_MASS, false),
    ROW(r, "cm", FIELD_F64, 2, RULE_PLACE, false),
    ROW(v, "cm/us", FIELD_F64, 2, RULE_SPEED, false),
    ROW(w, "1/us", FIELD_F64, 1, RULE_SPIN, false),
    ROW(heat, "g cm2/us2", FIELD_F64, 1, RULE_HEAT, false),
    ROW(p, "Mbar", FIELD_F64, 1, RULE_PRESSURE, false),
    ROW(was, "", FIELD_U16, 1, RULE_KIND, false),
    ROW(share, "", FIELD_F64, 2, RULE_FRACTION, false),
    ROW(work, "g cm2/us2", FIELD_F64, 1, RULE_ENERGY, true),
    ROW(strain, "", FIELD_F64, 3, RULE_NONE, true),
    ROW(moved, "g cm2/us2", FIELD_F64, 1, RULE_ENERGY, true),
    ROW(image, "", FIELD_I32, 2, RULE_IMAGE, true),
    ROW(damped, "g cm2/us2", FIELD_F64, 1, RULE_ENERGY, true),
    ROW(bonds, "", FIELD_U16, 1, RULE_BONDS, true),
};
#undef ROW

/* The state file has the table's first thirteen, then work, strain, bonds, was, share, moved, image,
 * damped. */
static const uint8_t state_order[ELEMENT_FIELDS] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9, 10,
                                                    11, 12, 15, 16, 20, 13, 14, 17, 18, 19};

static const uint8_t field_bytes[] = {
    [FIELD_U8] = 1, [FIELD_U16] = 2, [FIELD_U32] = 4, [FIELD_I32] = 4, [FIELD_F64] = 8};

static const struct element_field *field_at(enum record_form form, size_t k)
{
    return &element_fields[form == RECORD_STATE ? state_order[k] : k];
}

static size_t form_bytes(enum record_form form)
{
    return form == RECORD_MIRROR ? RECORD_MIRROR_BYTES : RECORD_BYTES;
}

static const double *doubles_of(const struct element_field *f, const struct element *e)
{
    return (const double *)(const void *)((const unsigned char *)e + f->offset);
}

/* --- bytes --- */

static inline void store_number(unsigned char *to, uint64_t bits, size_t n)
{
    for (size_t k = 0; k < n; k++)
        to[k] = (unsigned char)(bits >> 8 * k & 0xff);
}

static inline uint64_t load_number(const unsigned char *from, size_t n)
{
    uint64_t bits = 0;
    for (size_t k = 0; k < n; k++)
        bits |= (uint64_t)from[k] << 8 * k;
    return bits;
}

/* One case per type, each of constant width, so that compilers make one store of it. */
static inline void put_number(unsigned char *to, const unsigned char *from, enum field_type type)
{
    uint16_t u16;
    uint32_t u32;
    uint64_t u64;
    double f64;
    switch (type) {
    case FIELD_U8:
        *to = *from;
        break;
    case FIELD_U16:
        memcpy(&u16, from, sizeof u16);
        store_number(to, u16, sizeof u16);
        break;
    case FIELD_U32:
    case FIELD_I32:
        memcpy(&u32, from, sizeof u32);
        store_number(to, u32, sizeof u32);
        break;
    case FIELD_F64:
        memcpy(&f64, from, sizeof f64);
        f64 = number_plus_zero(f64);
        memcpy(&u64, &f64, sizeof u64);
        store_number(to, u64, sizeof u64);
        break;
    }
}

static inline void get_number(const unsigned char *from, unsigned char *to, enum field_type type)
{
    uint16_t u16;
    uint32_t u32;
    uint64_t u64;
    switch (type) {
    case FIELD_U8:
        *to = *from;
        break;
    case FIELD_U16:
        u16 = (uint16_t)load_number(from, sizeof u16);
        memcpy(to, &u16, sizeof u16);
        break;
    case FIELD_U32:
    case FIELD_I32:
        u32 = (uint32_t)load_number(from, sizeof u32);
        memcpy(to, &u32, sizeof u32);
        break;
    case FIELD_F64:
        u64 = load_number(from, sizeof u64);
        memcpy(to, &u64, sizeof u64);
        break;
    }
}

void record_put(struct bytes_writer *w, enum record_form form, const struct element *e)
{
    unsigned char *to = bytes_put_room(w, form_bytes(form));
    if (to == NULL)
        return;
    for (size_t k = 0; k < ELEMENT_FIELDS; k++) {
        const struct element_field *f = field_at(form, k);
        if (form == RECORD_MIRROR && f->owner)
            continue;
        const unsigned char *from = (const unsigned char *)e + f->offset;
        size_t width = field_bytes[f->type];
        for (int c = 0; c < f->count; c++, from += width, to += width)
            put_number(to, from, f->type);
    }
}

void record_get(struct bytes_reader *r, enum record_form form, struct element *out)
{
    const unsigned char *from = bytes_get_raw(r, form_bytes(form));
    *out = (struct element){0};
    for (size_t k = 0; k < ELEMENT_FIELDS && from != NULL; k++) {
        const struct element_field *f = field_at(form, k);
        if (form == RECORD_MIRROR && f->owner)
            continue;
        unsigned char *to = (unsigned char *)out + f->offset;
        size_t width = field_bytes[f->type];
        for (int c = 0; c < f->count; c++, from += width, to += width)
            get_number(from, to, f->type);
    }
}

void record_doubles(const struct element *e, double out[ELEMENT_DOUBLES])
{
    for (size_t k = 0; k < ELEMENT_FIELDS; k++) {
        const struct element_field *f = field_at(RECORD_STATE, k);
        for (int c = 0; c < f->count && f->type == FIELD_F64; c++)
            *out++ = doubles_of(f, e)[c];
    }
}
