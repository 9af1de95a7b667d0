/* The canonical state file (final.dm2), a checkpoint: all that the next step reads, the same bytes whoever
 * wrote it.
 *
 * Format, version 4, numbers little-endian, doubles as their IEEE 754 bits:
 *
 *   magic            8 bytes  "DM2STATE"
 *   version          u32
 *   digest          32 bytes  of the deck that the state belongs to, as the caller gave it
 *   fingerprint      u64      of the arithmetic that computed it (base/fingerprint.h)
 *   step             u64
 *   n_elements       u64
 *   n_pairs          u64
 *   elements         ids ascending, 146 bytes each: id u32, grain u32, body u16, kind u16, flags u8, probes
 * u8, then as f64 radius, mass, r[2], v[2], w, heat, p, work, strain[3], then bonds u16, was u16, and as f64
 *                    share[2], moved
 *   pairs            (id_a, id_b) ascending, 25 bytes each: id_a u32, id_b u32, linked u8, stretch f64,
 * spring f64 crc              u32      CRC-32C of all bytes before it
 */
#ifndef DM2_OUTPUT_STATE_H
#define DM2_OUTPUT_STATE_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/element.h"
#include "dm2/engine/record.h"

enum { STATE_DIGEST_BYTES = 32, STATE_VERSION = 4 };

struct state {
    uint8_t digest[STATE_DIGEST_BYTES];
    int64_t step;
    struct element *elements;
    size_t n_elements;
    struct pair_record *pairs;
    size_t n_pairs;
};

/* Writes the state to `path`, atomically. Elements and pairs in the order above. DM2_IO, DM2_MEMORY. */
enum dm2_status state_write(const char *path, const struct state_view *s, struct dm2_error *err);

/* Reads and checks a state file; *out owns its arrays (state_free). *out is empty after a failure:
 *   DM2_IO        the file cannot be opened or read
 *   DM2_MEMORY    no memory for what it announces (which its length already confirmed)
 *   DM2_PROTOCOL  not a state file, of another version, cut short, with bytes behind its end, with a checksum
 * that does not match, or with content that cannot be: records out of order, a pair of absent elements, a
 *                 number that is not finite, a mass or radius that is not positive, an unknown flag;
 *                 or computed with another arithmetic than this program's, which would not go on to the
 *                 same bytes */
enum dm2_status state_read(const char *path, struct state *out, struct dm2_error *err);
/* Does each element of a state that was read from `path` fit into a run? DM2_PROTOCOL: one has a body, a kind
 * or a probe that *limits excludes; the message names file and element, what was found and what is expected.
 */
enum dm2_status state_check(const char *path, const struct state *s, const struct record_limits *limits,
                            struct dm2_error *err);
void state_free(struct state *s);

#endif
