/* The state file, which is also a checkpoint and final.dm2: all that the next step reads, in the same bytes
 * from every program and any number of servers.
 *
 * Format, version 6, numbers little-endian, doubles as their IEEE 754 bits, -0 as 0:
 *
 *   magic            8 bytes  "DM2STATE"
 *   version          u32
 *   digest          32 bytes  SHA-256 of the deck's meaning
 *   fingerprint      u64      of the release that computed the state (engine/self_test.h)
 *   step             i64
 *   n_start          i64      the step with which the stage began
 *   t_start          f64      its time, us
 *   next_id          u32      what the next element would be numbered
 *   next_grain       u32
 *   sections         u32      how many follow
 *   each section              4 bytes tag; u32 bytes per record; u64 records; the records
 *   crc              u32      CRC-32C of all bytes before it
 *
 * Sections come in this order; the first four are always there, the others only where they have records:
 *
 *   TEXT  1 byte each      the deck's meaning (deck/meaning.h)
 *   NAME  64 bytes each    u8 sort (0 kind, 1 body, 2 wall, 3 load), 63 bytes name, filled up with
 *                          NUL: the names in the order of their numbers, sorts ascending
 *   ELEM  162 bytes each   ids ascending: u32 id, grain; u16 body, kind; u8 flags, probes; f64 radius,
 *                          mass, r[2], v[2], w, heat, p, work, strain[3]; u16 bonds, was;
 *                          f64 share[2], moved; i32 image[2]; f64 damped
 *   PAIR  25 bytes each    (id_a, id_b) ascending: u32 id_a, id_b; u8 linked; f64 stretch, spring
 *   HOME  20 bytes each    ids ascending: u32 id; f64 home[2]
 *   BODY  218 bytes each   movers ascending: u16 mover; f64 displacement[2], velocity[2],
 *                          centroid[2], integral[2], angle, spin; of the last evaluation, then of the
 *                          one before: 4 sums (i64, u64) force[2], touched[2]; u32 contacts[2]
 *   WCON  17 bytes each    (id, feature) ascending: u32 id, feature; i8 sign; f64 spring
 */
#ifndef DM2_OUTPUT_STATE_H
#define DM2_OUTPUT_STATE_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/element.h"
#include "dm2/engine/record.h"
#include "dm2/engine/section.h"

enum { STATE_VERSION = 6 };

struct state {
    struct state_origin origin;
    int64_t step;
    struct element *elements;
    size_t n_elements;
    struct pair_record *pairs;
    size_t n_pairs;
    struct section_array sections[SECTION_COUNT];
};

/* The state for a reader, who borrows it. */
struct state_view state_view_of(const struct state *s);

/* Writes the state to `path`, atomically. *s has its origin, and its records in the order above. DM2_IO: the
 * file cannot be written; DM2_MEMORY. */
enum dm2_status state_write(const char *path, const struct state_view *s, struct dm2_error *err);

/* Reads and checks a state file; *out owns its arrays (state_free), and is empty after a failure:
 *   DM2_IO        the file cannot be opened or read
 *   DM2_MEMORY    no memory for the records; the file's length has confirmed their number
 *   DM2_PROTOCOL  not a state file, of another version, cut short, with bytes behind its end, with a
 *                 checksum that does not match; or with invalid content: sections that are unknown, missing
 * or out of order, records out of order, a pair of absent elements, a number that is not finite, a mass or
 * radius that is not positive, a share outside 0 to 1, an unknown flag; or computed with another arithmetic
 * than this program's, which would not go on to the same bytes Nothing is compared with a deck: see
 * state_check. */
enum dm2_status state_read(const char *path, struct state *out, struct dm2_error *err);

/* Compares the records of a state, read from `path` by state_read, with the limits of a run.
 * DM2_PROTOCOL: a record that the run cannot have; the message names the file, the element, pair
 * or section, the field, the value and what is expected. */
enum dm2_status state_check(const char *path, const struct state *s, const struct record_limits *limits,
                            struct dm2_error *err);

/* Frees the arrays and empties *s. */
void state_free(struct state *s);

#endif
