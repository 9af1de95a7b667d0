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

/* Valid values of a field. A FIELD_F64 is finite in any case. "Deck": where record_limits.model is given. */
enum field_rule {
    RULE_NONE,
    RULE_ID,       /* below record_limits.elements */
    RULE_GRAIN,    /* deck: the grain of the id */
    RULE_BODY,     /* below record_limits.bodies; deck: the body of the id */
    RULE_KIND,     /* below record_limits.kinds; deck: a kind that the material of the id can become */
    RULE_FLAGS,    /* bits of enum element_flag; deck: those of the body's motion */
    RULE_PROBES,   /* bits below record_limits.probes */
    RULE_RADIUS,   /* > 0; deck: the body's times the size of the kind */
    RULE_MASS,     /* > 0; deck: that of the body's radius and the material */
    RULE_PLACE,    /* deck: in the half-open domain along a periodic direction */
    RULE_SPEED,    /* deck: less than a cell edge per step */
    RULE_SPIN,     /* deck: its energy is one that the sums can hold */
    RULE_HEAT,     /* deck: likewise; below 0 K, too, where a run becomes unstable */
    RULE_PRESSURE, /* deck: likewise, times the volume at rest */
    RULE_FRACTION, /* 0 to 1, the sum at most 1; deck: 0 of a reactant that the element did not start with */
    RULE_ENERGY,   /* deck: one that the sums can hold */
    RULE_IMAGE,    /* at most IMAGE_MOST either way; 0 where record_limits.periodic is not set */
    RULE_BONDS     /* deck: as many as there is room for; 0 where nothing links */
};

struct element_field {
    const char *name, *unit; /* unit: "" where the field has none */
    size_t offset;           /* of the first number in struct element */
    enum field_type type;
    int count; /* numbers, one after the other */
    enum field_rule rule;
    bool owner; /* known to the owner alone, 0 in a mirror */
};

enum { ELEMENT_FIELDS = 21, ELEMENT_DOUBLES = 17 };

/* In the order of messages (docs/protocol.md). */
extern const struct element_field element_fields[ELEMENT_FIELDS];

/* The form of a record: its fields and their order. All numbers are little-endian, doubles as their IEEE
 * 754 bits, -0 as 0. */
enum record_form {
    RECORD_MIRROR, /* a mirrored element: all but the owner's fields, in the order of the table */
    RECORD_OWNED,  /* all fields, in the order of the table */
    RECORD_STATE   /* all fields, in the order of the state file (dm2/output/state.h) */
};

enum { RECORD_MIRROR_BYTES = 104, RECORD_BYTES = RECORD_MIRROR_BYTES + 58 };

/* Appends an element: RECORD_MIRROR_BYTES or RECORD_BYTES bytes. Without memory the writer fails. */
void record_put(struct bytes_writer *w, enum record_form form, const struct element *e);

/* The next element of the reader; a field that the form lacks is 0. Where bytes are missing, the reader fails
 * and *out is all 0. The values are not checked: see record_fault. */
void record_get(struct bytes_reader *r, enum record_form form, struct element *out);

/* The bounds of the records of a run: a number that all ids are below, how many of these are no element's;
 * the numbers of bodies, kinds, probes, bodies with walls, features of walls; the sections; the deck. */
struct record_limits {
    size_t elements, holes;
    size_t bodies, kinds, probes; /* probes: those of regions, at most REGION_MAX */
    size_t movers, features;
    unsigned sections; /* section_has */
    bool periodic[2];
    const struct model *model; /* borrowed; NULL: records are not compared with the deck */
};

/* The limits of a run. */
struct record_limits record_limits_of(const struct model *model);

/* The first field, in the order of the table, with an invalid value; NULL: there is none. Every reader of
 * element records asks this one function. Limits NULL: any index is valid, and nothing is compared with the
 * deck. */
const struct element_field *record_fault(const struct element *e, const struct record_limits *limits);

enum { RECORD_FAULT_TEXT = 160 };

/* Says what is wrong with the field that record_fault named, as the end of a sentence that begins with the
 * element: "has share 7, 0 to 1 is expected". Takes the limits of that call. */
void record_describe_fault(const struct element_field *fault, const struct element *e,
                           const struct record_limits *limits, char text[RECORD_FAULT_TEXT]);

/* Writes what is wrong with a record, unless `text` is NULL, at most RECORD_FAULT_TEXT bytes. Returns false.
 */
bool record_refuse(char *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Of the springs of records, in r_c: a spring that never slips grows with the way of its contact points, turn
 * by turn of a wheel. */
#define RECORD_SPRING_MOST 0x1p30

/* Contacts per element of the run, far more than fit around an element. */
enum { RECORD_CONTACTS_MOST = 64 };

/* Is the pair valid by itself: ids in order and below limits->elements, linked 0 or 1, stretch and spring
 * finite and, by the deck, below r_c, the spring below 2^30 r_c? Where not, and text is not NULL, *text is
 * the end of a sentence that begins with the pair. */
bool record_pair_valid(const struct pair_record *p, const struct record_limits *limits,
                       char text[RECORD_FAULT_TEXT]);

/* Did the two elements of a pair, of valid records, touch or stand within the reach of their links, now or a
 * step before? True where limits->model is NULL. Where not, *text as for record_pair_valid. */
bool record_pair_reaches(const struct element *a, const struct element *b, const struct record_limits *limits,
                         char text[RECORD_FAULT_TEXT]);

/* The ELEMENT_DOUBLES doubles of an element in the order of the state file. */
void record_doubles(const struct element *e, double out[ELEMENT_DOUBLES]);

#endif
