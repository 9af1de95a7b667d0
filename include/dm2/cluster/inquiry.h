/* Asking a server what it does (docs/protocol.md: STATUS); it answers also while it serves somebody else. */
#ifndef DM2_CLUSTER_INQUIRY_H
#define DM2_CLUSTER_INQUIRY_H

#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/hosts.h"
#include "dm2/cluster/messages.h"

/* Asks one server, and with a key (NULL: none) wants it to prove that it has the key, too. DM2_NET,
 * DM2_TIMEOUT or DM2_PROTOCOL with the reason where it does not answer or cannot be believed;
 * DM2_INTERRUPTED. */
enum dm2_status inquiry_ask(const struct endpoint *server, const struct auth_key *key, double seconds,
                            int cancel, struct report_message *out, struct dm2_error *err);

#endif
