/* Elements made and compared by the table of their fields. */
#ifndef DM2_TESTS_RECORD_HELP_H
#define DM2_TESTS_RECORD_HELP_H

#include <string.h>

#include "dm2/engine/record.h"

static inline size_t record_field_bytes(const struct element_field *f)
{
    static const size_t bytes[] = {
        [FIELD_U8] = 1, [FIELD_U16] = 2, [FIELD_U32] = 4, [FIELD_I32] = 4, [FIELD_F64] = 8};
    return (size_t)f->count * bytes[f->type];
}

/* The name of the first field whose bits differ; NULL: there is none. With `mirrors` the owner's fields are
 * not compared. */
static inline const char *record_difference(const struct element *a, const struct element *b, bool mirrors)
{
    for (size_t k = 0; k < ELEMENT_FIELDS; k++) {
        const struct element_field *f = &element_fields[k];
        if (!(mirrors && f->owner) &&
            memcmp((const char *)a + f->offset, (const char *)b + f->offset, record_field_bytes(f)) != 0)
            return f->name;
    }
    return NULL;
}

/* A valid element of a run with at least 3 bodies, 3 kinds and 2 probes. Its doubles are all different, and
 * no field is 0. */
static inline struct element record_sample(uint32_t id)
{
    struct element e = {0};
    double x = 0.5;
    for (size_t k = 0; k < ELEMENT_FIELDS; k++) {
        const struct element_field *f = &element_fields[k];
        char *at = (char *)&e + f->offset;
        uint32_t u32 = f->rule == RULE_ID ? id : 0x01020304;
        uint16_t u16 = f->rule == RULE_NONE ? 0x0506 : f->rule == RULE_BODY ? 2 : 1;
        for (int c = 0; c < f->count; c++, x += 1.0 / 64) {
            double value = f->rule == RULE_FRACTION ? 0.25 * x : x;
            if (f->type == FIELD_F64)
                memcpy(at + (size_t)c * sizeof value, &value, sizeof value);
        }
        const int32_t turns[2] = {3, -5};
        if (f->type == FIELD_I32)
            memcpy(at, turns, sizeof turns);
        if (f->type == FIELD_U32)
            memcpy(at, &u32, sizeof u32);
        if (f->type == FIELD_U16)
            memcpy(at, &u16, sizeof u16);
        if (f->type == FIELD_U8)
            *at = f->rule == RULE_FLAGS ? ELEMENT_FIXED_MOTION : 3;
    }
    return e;
}

#endif
