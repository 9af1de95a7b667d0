/* The digest of a deck: by it client and servers tell whether they read the same, and a state file tells what
 * it belongs to. SHA-256 over the texts and the -D changes; names and paths have no part in it, nor has
 * --steps, so that a run may be continued. */
#ifndef DM2_DECK_DIGEST_H
#define DM2_DECK_DIGEST_H

#include "dm2/base/sha256.h"
#include "dm2/deck/deck.h"

/* The digest of a deck with its changes. */
void deck_digest(const struct deck_source *source, unsigned char out[SHA256_BYTES]);

#endif
