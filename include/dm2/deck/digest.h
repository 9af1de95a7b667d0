/* The digest of a deck: client and servers compare the digests of their decks, and a state file has the
 * digest of its deck. SHA-256 of the texts and of the -D definitions. Names and paths of files are not part
 * of the digest, nor is --steps, so that a run can be continued for more steps. */
#ifndef DM2_DECK_DIGEST_H
#define DM2_DECK_DIGEST_H

#include "dm2/base/sha256.h"
#include "dm2/deck/deck.h"

/* The digest of a deck with its -D definitions. */
void deck_digest(const struct deck_source *source, unsigned char out[SHA256_BYTES]);

#endif
