/* Elements, pairs, measures and parcels as bytes of messages, field by field in the order of
 * docs/protocol.md; the fields of an element are the table of engine/record. No struct is ever copied to or
 * from a message.
 *
 * The get functions check each record: elements by record_fault, pairs for their order and for ids below
 * limits->elements, every double of an element, a pair and a measure for being finite. An invalid record
 * makes the reader fail (r->failed), as a cut message does; r->why then names element, field, value and what
 * is expected, and is "" where the message is cut or there is no memory. */
#ifndef DM2_CLUSTER_WIRE_H
#define DM2_CLUSTER_WIRE_H

#include "dm2/base/bytes.h"
#include "dm2/engine/element.h"
#include "dm2/engine/load_totals.h"
#include "dm2/engine/measures.h"
#include "dm2/engine/record.h"
#include "dm2/engine/subdomain.h"

enum {
    /* bytes of */
    WIRE_MIRROR = RECORD_MIRROR_BYTES, /* a mirrored element */
    WIRE_ELEMENT = RECORD_BYTES,       /* an element with the fields of its owner */
    WIRE_PAIR = 25,                    /* a struct pair_record */
    WIRE_CRACK = 34,                   /* a struct crack */
    WIRE_MEASURED = 56,                /* a struct element_measure */
    WIRE_FORCE = 32,                   /* a struct pair_measure */
    WIRE_MEASURES = 338,               /* the measures without their probes */
    WIRE_BIN = 8 + 9 * 16              /* a struct profile_bin */
};

/* Most pairs per element of the run in a state that arrives: far more than fit around an element. */
enum { WIRE_PAIRS_MOST = 64 };

/* A mirrored element, without the owner's fields; in *out these are 0. */
void wire_put_mirror(struct bytes_writer *w, const struct element *e);
void wire_get_mirror(struct bytes_reader *r, const struct record_limits *limits, struct element *out);

/* An element with all its fields. */
void wire_put_element(struct bytes_writer *w, const struct element *e);
void wire_get_element(struct bytes_reader *r, const struct record_limits *limits, struct element *out);

/* The memory of a pair. */
void wire_put_pair(struct bytes_writer *w, const struct pair_record *p);
void wire_get_pair(struct bytes_reader *r, const struct record_limits *limits, struct pair_record *out);

void wire_put_force(struct bytes_writer *w, const struct pair_measure *f);
void wire_get_force(struct bytes_reader *r, struct pair_measure *out);
/* The totals of a body under force. */
void wire_put_load(struct bytes_writer *w, const struct load_totals *t);
void wire_get_load(struct bytes_reader *r, struct load_totals *t);

/* A broken link. elements: of the whole run, more than any id. */
void wire_put_crack(struct bytes_writer *w, const struct crack *c);
void wire_get_crack(struct bytes_reader *r, uint64_t elements, struct crack *out);

void wire_put_measured(struct bytes_writer *w, const struct element_measure *m);
void wire_get_measured(struct bytes_reader *r, struct element_measure *out);

/* The measures of a whole subdomain; of each probe 12 bytes and 16 for each sum that it needs. Extremes are
 * infinite where there is no element, but never NaN. */
void wire_put_measures(struct bytes_writer *w, const struct measures *m);
void wire_get_measures(struct bytes_reader *r, struct measures *out);

/* The pairs of a subdomain that start pressed together. */
void wire_put_overlap(struct bytes_writer *w, const struct overlap *o);
void wire_get_overlap(struct bytes_reader *r, struct overlap *out);

/* A bin of a profile; any bits are valid. */
void wire_put_bin(struct bytes_writer *w, const struct profile_bin *b);
void wire_get_bin(struct bytes_reader *r, struct profile_bin *out);

/* Migrants, pairs, mirrors and wall contacts, each behind its count as u32; a count above UINT32_MAX fails
 * the writer. wire_get_parcel gives arrays that the caller frees with wire_parcel_free; where the reader
 * fails, also for lack of memory, *out is empty. */
void wire_put_parcel(struct bytes_writer *w, const struct parcel *p);
void wire_get_parcel(struct bytes_reader *r, const struct record_limits *limits, struct parcel *out);
void wire_parcel_free(struct parcel *p);

#endif
