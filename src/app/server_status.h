/* dm2-client --status: a line for each server, whatever it does. */
#ifndef DM2_APP_SERVER_STATUS_H
#define DM2_APP_SERVER_STATUS_H

#include <stdio.h>

#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/hosts.h"

/* Asks all of them, one after the other, each for `seconds` at most, and prints a line for each. DM2_NET
 * where one could not be used, DM2_INTERRUPTED. */
enum dm2_status server_status_print(FILE *to, const struct endpoints *servers, const struct auth_key *key,
                                    double seconds, int cancel, struct dm2_error *err);

#endif
