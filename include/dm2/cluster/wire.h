/* Elements, pairs and measures as bytes: the only place that knows both a record of the engine and a byte
 * buffer. Field by field, in the order of docs/protocol.md; no struct is ever copied to or from a message.
 *
 * The get functions check what they read: numbers finite, ids and indices within the run's limits, radius and
 * mass positive, pairs ordered. A record that fails makes the reader fail (r->failed), as a cut message does.
 */
#ifndef DM2_CLUSTER_WIRE_H
#define DM2_CLUSTER_WIRE_H

#include "dm2/base/bytes.h"
#include "dm2/engine/element.h"
#include "dm2/engine/measures.h"
#include "dm2/engine/record.h"
#include "dm2/engine/subdomain.h"

enum {
    WIRE_MIRROR = RECORD_MIRROR_BYTES, /* bytes of an element that is mirrored, */
    WIRE_ELEMENT = RECORD_BYTES,       /* of one with what only its owner knows, */
    WIRE_PAIR = 25,                    /* of the memory of a pair, */
    WIRE_MEASURED = 56,                /* of what was measured of an element, */
    WIRE_BIN = 8 + 8 * 16              /* of a bin of a profile */
};

/* Per element, in a state that somebody sends: far more than fit around one. */
enum { WIRE_PAIRS_MOST = 64 };

/* The owner's part of a mirror is neither sent nor kept: it reads as 0. */
void wire_put_mirror(struct bytes_writer *w, const struct element *e);
void wire_get_mirror(struct bytes_reader *r, const struct record_limits *limits, struct element *out);

/* The state of an element. */
void wire_put_element(struct bytes_writer *w, const struct element *e);
void wire_get_element(struct bytes_reader *r, const struct record_limits *limits, struct element *out);

/* The memory of a pair. */
void wire_put_pair(struct bytes_writer *w, const struct pair_record *p);
void wire_get_pair(struct bytes_reader *r, const struct record_limits *limits, struct pair_record *out);

/* What was measured of an element. */
void wire_put_measured(struct bytes_writer *w, const struct element_measure *m);
void wire_get_measured(struct bytes_reader *r, struct element_measure *out);

/* What was measured of a whole subdomain. */
void wire_put_measures(struct bytes_writer *w, const struct measures *m);
void wire_get_measures(struct bytes_reader *r, struct measures *out);

void wire_put_bin(struct bytes_writer *w, const struct profile_bin *b);
void wire_get_bin(struct bytes_reader *r, struct profile_bin *out);

/* Counts, then migrants, pairs and mirrors. The arrays of a parcel that is read are malloc'd:
 * wire_parcel_free. Lack of memory fails the reader too. */
void wire_put_parcel(struct bytes_writer *w, const struct parcel *p);
void wire_get_parcel(struct bytes_reader *r, const struct record_limits *limits, struct parcel *out);
void wire_parcel_free(struct parcel *p);

#endif
