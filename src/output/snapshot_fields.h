/* The values that a snapshot has of each element, in one table, for the writers of both formats. */
#ifndef DM2_OUTPUT_SNAPSHOT_FIELDS_H
#define DM2_OUTPUT_SNAPSHOT_FIELDS_H

#include <stdbool.h>
#include <stddef.h>

#include "snapshot.h"

enum number_type { TYPE_U8, TYPE_U16, TYPE_U32, TYPE_I32, TYPE_I64, TYPE_F64 };

struct snapshot_field {
    const char *name;
    const char *xyz_name; /* NULL: one column per component, named NAME_COMPONENT */
    enum number_type type;
    int components;
    const char *component[3]; /* names, NULL: none */
    void (*get)(const struct snapshot *s, size_t i, double out[3]);
    bool (*present)(const struct snapshot *s); /* NULL: always */
};

/* The place of an element: x, y and 0. */
extern const struct snapshot_field snapshot_position;

/* All other fields, in the order of the files. */
enum { SNAPSHOT_FIELDS = 19 };
extern const struct snapshot_field snapshot_fields[SNAPSHOT_FIELDS];

/* Is a field of the table in the files of this snapshot, and the one of this name? Bit k of output.fields is
 * field k. */
bool snapshot_has(const struct snapshot *s, const struct snapshot_field *f);
bool snapshot_writes(const struct snapshot *s, const char *name);

/* Are the pairs in the .vtp? The bit behind those of the fields. */
bool snapshot_has_pairs(const struct snapshot *s);

/* Is element i shown? */
bool snapshot_shows(const struct snapshot *s, size_t i);

#endif
