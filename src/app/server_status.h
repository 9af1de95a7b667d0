/* dm2-client --status: a line for each server, in any state of the server. */
#ifndef DM2_APP_SERVER_STATUS_H
#define DM2_APP_SERVER_STATUS_H

#include <stdio.h>

#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/hosts.h"

/* Asks the servers one after the other, each for `seconds` at most, and prints a line for each. DM2_NET
 * where one of them cannot be used; DM2_INTERRUPTED, DM2_MEMORY. */
enum dm2_status server_status_print(FILE *to, const struct endpoints *servers, const struct auth_key *key,
                                    double seconds, int cancel, struct dm2_error *err);

#endif
