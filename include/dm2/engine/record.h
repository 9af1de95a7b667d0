/* The fields of an element in one table: their types, units, valid values, and the forms in which a record
 * becomes bytes. Messages, the state file and the hash of a state loop over the table; no struct is ever
 * copied to or from bytes. A new field of struct element takes one row here and one place in the order of the
 * state file. */
#ifndef DM2_ENGINE_RECORD_H
#define DM2_ENGINE_RECORD_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/bytes.h"
#include "dm2/engine/element.h"

struct model;

enum field_type { FIELD_U8, FIELD_U16, FIELD_U32, FIELD_I32, FIELD_F64 };

/* Valid values of a field. A FIELD_F64 is finite in any case. */
enum field_rule {
    RULE_NONE,
    RULE_POSITIVE, /* > 0 */
    RULE_FRACTION, /* 0 to 1 */
    RULE_FLAGS,    /* bits of enum element_flag */
    RULE_PROBES,   /* bits below record_limits.probes */
    RULE_ID,       /* below record_limits.elements */
    RULE_BODY,     /* below record_limits.bodies */
    RULE_KIND,     /* below record_limits.kinds */
    RULE_IMAGE     /* at most IMAGE_MOST either way; 0 where record_limits.periodic is not set */
};

struct element_field {
    const char *name, *unit; /* unit: "" where the field has none */
    size_t offset;           /* of the first number in struct element */
    enum field_type type;
    int count; /* numbers, one after the other */
    enum field_rule rule;
    bool owner; /* known to the owner alone, 0 in a mirror */
};

enum { ELEMENT_FIELDS = 20, ELEMENT_DOUBLES = 16 };

/* In the order of messages (docs/protocol.md). */
extern const struct element_field element_fields[ELEMENT_FIELDS];

/* The form of a record: its fields and their order. All numbers are little-endian, doubles as their IEEE
 * 754 bits, -0 as 0. */
enum record_form {
    RECORD_MIRROR, /* a mirrored element: all but the owner's fields, in the order of the table */
    RECORD_OWNED,  /* all fields, in the order of the table */
    RECORD_STATE   /* all fields, in the order of the state file (dm2/output/state.h) */
};

enum { RECORD_MIRROR_BYTES = 104, RECORD_BYTES = RECORD_MIRROR_BYTES + 50 };

/* Appends an element: RECORD_MIRROR_BYTES or RECORD_BYTES bytes. Without memory the writer fails. */
void record_put(struct bytes_writer *w, enum record_form form, const struct element *e);

/* The next element of the reader; a field that the form lacks is 0. Where bytes are missing, the reader fails
 * and *out is all 0. The values are not checked: see record_fault. */
void record_get(struct bytes_reader *r, enum record_form form, struct element *out);

/* The numbers of elements, bodies, kinds and probes of a run, which bound the indices in an element. */
struct record_limits {
    size_t elements, bodies, kinds, probes; /* probes: at most PROBE_MAX */
    bool periodic[2];
};

/* The limits of a run. */
struct record_limits record_limits_of(const struct model *model);

/* The first field, in the order of the table, with an invalid value; NULL: there is none. Indices are
 * compared with *limits; limits NULL: any index is valid. */
const struct element_field *record_fault(const struct element *e, const struct record_limits *limits);

enum { RECORD_FAULT_TEXT = 160 };

/* Says what is wrong with the field that record_fault named, as the end of a sentence that begins with the
 * element: "has share 7, 0 to 1 is expected". The limits are those that record_fault was given. */
void record_describe_fault(const struct element_field *fault, const struct element *e,
                           const struct record_limits *limits, char text[RECORD_FAULT_TEXT]);

/* The ELEMENT_DOUBLES doubles of an element in the order of the state file. */
void record_doubles(const struct element *e, double out[ELEMENT_DOUBLES]);

#endif
