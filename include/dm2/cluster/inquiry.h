/* Asks a server for its status (docs/protocol.md: STATUS). A server answers also during another client's
 * session. */
#ifndef DM2_CLUSTER_INQUIRY_H
#define DM2_CLUSTER_INQUIRY_H

#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/hosts.h"
#include "dm2/cluster/messages.h"

/* Asks one server for its report, within `seconds`. key: the server must prove that it has the same key;
 * NULL: none. cancel: readable when the process is asked to end; -1: none. DM2_NET or DM2_TIMEOUT: the server
 * does not answer; DM2_PROTOCOL: its answer is wrong, or the server refuses, or the proof fails;
 * DM2_INTERRUPTED. */
enum dm2_status inquiry_ask(const struct endpoint *server, const struct auth_key *key, double seconds,
                            int cancel, struct report_message *out, struct dm2_error *err);

#endif
