/* A 64-bit hash of the whole state: the sum, modulo 2^64, of one hash per element and one per pair with
 * memory. Each server hashes its own elements and pairs and the client adds the parts, so the hash does not
 * depend on the decomposition. `--hash-every` prints the hash, by which the first step is found at which two
 * runs differ. */
#ifndef DM2_OUTPUT_STATE_HASH_H
#define DM2_OUTPUT_STATE_HASH_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/element.h"
#include "dm2/engine/section.h"
#include "dm2/engine/subdomain.h"

/* The hash of one record: equal bits of the fields give equal hashes. */
uint64_t state_hash_element(const struct element *e);
uint64_t state_hash_pair(const struct pair_record *p);

uint64_t state_hash_section(enum section kind, const void *record);

/* The part of a subdomain: its own elements, the pairs of whose two elements it owns that of lower id, and
 * the records of subdomain_collect_sections. DM2_MEMORY. */
enum dm2_status state_hash_subdomain(const struct subdomain *sd, uint64_t *out, struct dm2_error *err);

#endif
