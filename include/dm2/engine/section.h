/* The sections of a state: each has a tag of four letters, the bytes per record, and records in one order.
 * The state file (dm2/output/state.h) and the STATE message (docs/protocol.md) hold the same sections.
 *
 * Every state has TEXT, NAME, ELEM and PAIR. The further sections, enum section, are there only where the
 * deck has what they hold. A new one takes: its struct, its entry in enum section, its row in section_kinds
 * with the functions that the row names; then, in the engine, its bit in section_has, its records in
 * subdomain_collect_sections and subdomain_restore. Files, messages, shares of ranks, merging, hashes and
 * checks loop over the table. */
#ifndef DM2_ENGINE_SECTION_H
#define DM2_ENGINE_SECTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/bytes.h"
#include "dm2/base/exact.h"
#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "dm2/engine/element.h"
#include "dm2/engine/record.h"

/* --- further sections --- */

/* In the order of files and messages. */
enum section {
    SECTION_HOME, /* struct home_record */
    SECTION_BODY, /* struct body_record */
    SECTION_WCON, /* struct wall_contact */
    SECTION_WFOR, /* struct wall_force; of snapshots alone */
    SECTION_COUNT
};

/* The place of an element of a body under a load, against the body's centroid when the load began. */
struct home_record {
    uint32_t id;
    double home[2]; /* cm */
};

/* What forces have made of a body or wall that moves as a whole. */
struct body_record {
    uint16_t mover;                              /* bodies in deck order, then walls */
    double displacement[2], velocity[2];         /* since the stage began, cm; cm/us */
    double centroid[2];                          /* when the load began, cm */
    double integral[2];                          /* force that the mean error has built up, g cm/us2 */
    double angle, spin;                          /* since the stage began; 1/us */
    struct exact_sum force[2][2], touched[2][2]; /* of the last evaluation and the one before: x and y of the
                                                    force, of the speed summed over touched elements */
    uint32_t contacts[2];                        /* likewise */
};

/* The memory of an element at a feature of a wall. */
struct wall_contact {
    uint32_t id, feature;
    int8_t sign;   /* 1 or -1 */
    double spring; /* tangential, cm */
};

/* The force of a wall on an element at a feature, at the last evaluation, which was that of a snapshot. */
struct wall_force {
    uint32_t id, feature;
    uint16_t wall;             /* of the config */
    double foot[2];            /* where the feature touches the image of the element at r, cm */
    double force[2];           /* on the element, Mbar cm2; a whole multiple of the sums' quantum */
    double normal, tangential; /* along n and t = (-n_y, n_x), n from the foot to the element; n > 0 pushes */
};

/* Records of one section, in an array of its struct. */
struct section_array {
    void *records;
    size_t n, cap;
};

struct section_kind {
    char tag[5];
    uint32_t bytes;  /* of a record in files and messages */
    size_t size;     /* of its struct */
    bool of_element; /* the struct begins with the id of an element, whose owner has the record; false: every
                        rank has all records */
    void (*put)(struct bytes_writer *w, const void *record);
    void (*get)(struct bytes_reader *r, void *record);
    /* Negative: a comes before b; 0: the two cannot be in one state. */
    int (*compare)(const void *a, const void *b);
    /* False: the record is invalid; where text is not NULL, *text is the end of a sentence that begins with
     * the section. limits NULL: any index is valid. */
    bool (*valid)(const void *record, const struct record_limits *limits, char text[RECORD_FAULT_TEXT]);
};

extern const struct section_kind section_kinds[SECTION_COUNT];

/* The id of the element of a record of a kind with of_element. */
uint32_t section_element(const void *record);

/* Record k of an array. */
static inline void *section_record(enum section kind, const struct section_array *a, size_t k)
{
    return (char *)a->records + k * section_kinds[kind].size;
}

/* Appends n records, zeroed where `from` is NULL. False without memory. */
bool section_append(enum section kind, struct section_array *a, const void *from, size_t n);

/* Reads n records and appends them. DM2_PROTOCOL with a sentence that begins with the section: a record is
 * invalid, or the run's deck has nothing for the section; the reader fails where bytes are missing.
 * DM2_MEMORY. */
enum dm2_status section_get(enum section kind, struct bytes_reader *r, size_t n,
                            const struct record_limits *limits, struct section_array *out,
                            struct dm2_error *err);

/* Sorts the records. DM2_PROTOCOL: two records compare as equal. */
enum dm2_status section_sort(enum section kind, struct section_array *a, struct dm2_error *err);

/* Checks the records against the limits of a run and their order; an element is looked up in elements[n]. The
 * sentence begins with the section. DM2_PROTOCOL. */
enum dm2_status section_check(enum section kind, const struct section_array *a,
                              const struct record_limits *limits, const struct element *elements, size_t n,
                              struct dm2_error *err);

/* Frees the records of SECTION_COUNT arrays and empties these. */
void section_free(struct section_array arrays[SECTION_COUNT]);

/* The bits 1 << kind of the sections that the states of a config have. */
unsigned section_has(const struct config *config);

/* Likewise of the sections of a snapshot, which has no state to go on from. */
unsigned section_in_snapshot(const struct config *config);

/* --- the head of a section in a file --- */

enum { SECTION_TAG = 4, SECTION_HEAD = SECTION_TAG + 4 + 8 };

struct section_head {
    char tag[SECTION_TAG + 1]; /* any bytes */
    uint32_t bytes;
    uint64_t records;
};

void section_put_head(struct bytes_writer *w, const char *tag, uint32_t bytes, uint64_t records);
void section_get_head(struct bytes_reader *r, struct section_head *out);

/* --- a whole state --- */

enum name_sort { NAME_KIND, NAME_BODY, NAME_WALL, NAME_LOAD, NAME_SORTS };

/* The name of a kind of elements, a body, a wall or a load. Numbers in records count the names of one sort,
 * in their order. */
struct state_name {
    enum name_sort sort;
    char text[2 * NAME_MAX_LENGTH + 2];
};
enum { STATE_NAME_BYTES = 64, STATE_DIGEST_BYTES = 32 };

/* What all states of a run have in common. */
struct state_origin {
    uint8_t digest[STATE_DIGEST_BYTES]; /* of the deck's meaning */
    int64_t n_start;                    /* the step with which the run's stage began */
    double t_start;                     /* the time of that step, us */
    uint32_t next_id, next_grain;       /* what the next element and grain would be numbered */
    char *text;                         /* the deck's meaning, not terminated */
    size_t text_length;
    struct state_name *names; /* by sort, then by number */
    size_t n_names;
};

/* The origin of the states of a model's run. The caller frees *out with state_origin_free. DM2_MEMORY. */
struct model;
enum dm2_status state_origin_build(const struct model *model, struct state_origin *out,
                                   struct dm2_error *err);
void state_origin_free(struct state_origin *origin);

/* A whole state, or a part of a state, for a reader; all pointers are borrowed. Elements are in id order,
 * pairs in (id_a, id_b) order, records of sections in the order of their kind. Where `elements` is NULL, the
 * two functions give record k. */
struct state_view {
    const struct state_origin *origin; /* NULL: not known */
    int64_t step;
    const struct element *elements;
    size_t n_elements;
    const struct pair_record *pairs;
    size_t n_pairs;
    const void *records;
    void (*element)(const void *records, size_t k, struct element *out);
    void (*pair)(const void *records, size_t k, struct pair_record *out);
    struct section_array sections[SECTION_COUNT];
};

#endif
