/* How client and server prove to each other that they have the same key (docs/security.md, docs/protocol.md).
 *
 *     client                          server
 *     KNOCK  client nonce   ->
 *                           <-        CHALLENGE  server nonce
 *     PROOF  code           ->
 *                           <-        GRANT  code
 *
 * A code is the HMAC-SHA-256, under the key, of a label for the sender's role, the protocol version and both
 * nonces. A code of an earlier session fails because its nonces differ, a code that is sent back because its
 * role differs. The frames that follow have tags under session keys, which are made in the same way, one per
 * direction. */
#ifndef DM2_CLUSTER_AUTH_H
#define DM2_CLUSTER_AUTH_H

#include <stdint.h>

#include "dm2/base/sha256.h"
#include "dm2/base/siphash.h"
#include "dm2/base/status.h"

enum { AUTH_KEY = 32, AUTH_NONCE = 32, AUTH_CODE = SHA256_BYTES };

struct auth_key {
    unsigned char bytes[AUTH_KEY];
};

/* Both nonces of a session. */
struct auth_nonces {
    unsigned char client[AUTH_NONCE], server[AUTH_NONCE];
};

enum auth_role {
    AUTH_CLIENT,
    AUTH_SERVER,
    AUTH_ASKER /* a client that asks only for the status: its code opens no session, and the code of
                  AUTH_CLIENT gets no status */
};

/* Makes a key of random bytes and writes it to a new file that only its owner can read. DM2_USAGE where the
 * file exists already, DM2_IO. */
enum dm2_status auth_key_create(const char *path, struct dm2_error *err);

/* Reads a key from its file. DM2_USAGE, with advice, where the file cannot be read, can be accessed by other
 * users, or holds no key. */
enum dm2_status auth_key_read(const char *path, struct auth_key *key, struct dm2_error *err);

/* Fills the nonce with random bytes of the system. DM2_IO. */
enum dm2_status auth_nonce(unsigned char nonce[AUTH_NONCE], struct dm2_error *err);

/* The code with which `role` proves that it has the key. */
void auth_code(const struct auth_key *key, enum auth_role role, uint16_t version,
               const struct auth_nonces *nonces, unsigned char code[AUTH_CODE]);

/* The key for the tags of the frames that `role` sends. */
void auth_session_key(const struct auth_key *key, enum auth_role role, uint16_t version,
                      const struct auth_nonces *nonces, unsigned char out[SIPHASH_KEY]);

#endif
