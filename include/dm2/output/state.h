/* The state file, which is also a checkpoint and final.dm2: all that the next step reads, in the same bytes
 * from every program and any number of servers.
 *
 * Format, version 5, numbers little-endian, doubles as their IEEE 754 bits, -0 as 0:
 *
 *   magic            8 bytes  "DM2STATE"
 *   version          u32
 *   digest          32 bytes  of the state's deck, as the caller gave it
 *   fingerprint      u64      of the release that computed the state (engine/self_test.h)
 *   step             u64
 *   n_elements       u64
 *   n_pairs          u64
 *   elements         ids ascending, 154 bytes each:
 *                    u32 id, grain; u16 body, kind; u8 flags, probes;
 *                    f64 radius, mass, r[2], v[2], w, heat, p, work, strain[3];
 *                    u16 bonds, was; f64 share[2], moved; i32 image[2]
 *   pairs            (id_a, id_b) ascending, 25 bytes each:
 *                    u32 id_a, id_b; u8 linked; f64 stretch, spring
 *   crc              u32      CRC-32C of all bytes before it
 */
#ifndef DM2_OUTPUT_STATE_H
#define DM2_OUTPUT_STATE_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/element.h"
#include "dm2/engine/record.h"

enum { STATE_DIGEST_BYTES = 32, STATE_VERSION = 5 };

struct state {
    uint8_t digest[STATE_DIGEST_BYTES];
    int64_t step;
    struct element *elements;
    size_t n_elements;
    struct pair_record *pairs;
    size_t n_pairs;
};

/* Writes the state to `path`, atomically. *s has its elements and pairs in the order above. DM2_IO: the file
 * cannot be written; DM2_MEMORY. */
enum dm2_status state_write(const char *path, const struct state_view *s, struct dm2_error *err);

/* Reads and checks a state file; *out owns its arrays (state_free), and is empty after a failure:
 *   DM2_IO        the file cannot be opened or read
 *   DM2_MEMORY    no memory for the elements and pairs; the file's length has confirmed their number
 *   DM2_PROTOCOL  not a state file, of another version, cut short, with bytes behind its end, with a
 *                 checksum that does not match; or with invalid content: records out of order, a pair of
 *                 absent elements, a number that is not finite, a mass or radius that is not positive, a
 *                 share outside 0 to 1, an unknown flag; or computed with another arithmetic than this
 *                 program's, which would not go on to the same bytes
 * Nothing is compared with a deck: see state_check. */
enum dm2_status state_read(const char *path, struct state *out, struct dm2_error *err);

/* Compares the elements and pairs of a state, read from `path` by state_read, with the limits of a run.
 * DM2_PROTOCOL: a record that the run cannot have; the message names the file, the element or pair, the
 * field, the value and what is expected. */
enum dm2_status state_check(const char *path, const struct state *s, const struct record_limits *limits,
                            struct dm2_error *err);

/* Frees the arrays and empties *s. */
void state_free(struct state *s);

#endif
