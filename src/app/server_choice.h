/* Which servers a command of dm2-model measures on: local ones that it starts for each measurement, or those
 * that are named, of which a measurement with N takes the first N. */
#ifndef DM2_APP_SERVER_CHOICE_H
#define DM2_APP_SERVER_CHOICE_H

#include <stdbool.h>

#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/hosts.h"
#include "network.h"
#include "options.h"

enum { SERVER_CHOICE_OPTIONS = 4, SERVER_CHOICE_COUNTS = 32, SERVER_CHOICE_MOST = 1024 };

struct server_choice {
    const char *hosts, *key_file;
    struct option_list servers, counts_texts;
    struct auth_key key;
    struct endpoints named;                     /* none: local ones */
    int counts[SERVER_CHOICE_COUNTS], n_counts; /* rising */
};

/* Writes SERVER_CHOICE_OPTIONS entries to `table`; clears *c. */
void server_choice_start(struct server_choice *c, struct option *table);

/* After options_parse. Without numbers of servers they are 1, 2, 4, 8, as far as named servers go. DM2_USAGE.
 */
enum dm2_status server_choice_finish(struct server_choice *c, struct dm2_error *err);

/* options_parse for a command that takes no operands, then server_choice_finish. With --help (*help, which
 * `table` sets) prints `usage` and the options instead. DM2_USAGE, DM2_MEMORY and what server_choice_finish
 * fails with. */
enum dm2_status server_choice_parse(struct server_choice *c, const struct option *table, size_t n, int argc,
                                    char **argv, const bool *help, const char *usage, struct dm2_error *err);

void server_choice_free(struct server_choice *c);

/* The cost of messages with `servers` servers. argv0 is where local servers are looked for. */
enum dm2_status server_choice_measure(const struct server_choice *c, const char *argv0, int servers,
                                      int turns, int cancel, struct network_line *out, struct dm2_error *err);

#endif
