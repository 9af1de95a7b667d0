/* A 64-bit hash of the whole state, made of parts that add up: the sum (modulo 2^64) of one hash per element
 * and one per pair with memory. Servers hash what they own, the client adds, and the result does not depend
 * on who owned what.
 * `--hash-every` prints it: the tool that finds the first step at which two runs differ. */
#ifndef DM2_OUTPUT_STATE_HASH_H
#define DM2_OUTPUT_STATE_HASH_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/element.h"
#include "dm2/engine/subdomain.h"

/* The hash of one record; equal for equal bits. */
uint64_t state_hash_element(const struct element *e);
uint64_t state_hash_pair(const struct pair_record *p);

/* The part of a subdomain: its own elements, and the pairs whose lower id it owns. DM2_MEMORY. */
enum dm2_status state_hash_subdomain(const struct subdomain *sd, uint64_t *out, struct dm2_error *err);

#endif
