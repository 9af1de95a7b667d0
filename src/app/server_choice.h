/* The servers that a command of dm2-model measures on: local servers started for each measurement,
 * or named servers, of which a measurement with N takes the first N. */
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
    struct endpoints named;                     /* empty: local servers */
    int counts[SERVER_CHOICE_COUNTS], n_counts; /* ascending */
};

/* Clears *c and writes SERVER_CHOICE_OPTIONS entries to `table`. */
void server_choice_start(struct server_choice *c, struct option *table);

/* Reads the options after options_parse. The default numbers of servers are 1, 2, 4, 8, up to the number
 * of named servers. DM2_USAGE, DM2_IO, DM2_MEMORY. */
enum dm2_status server_choice_finish(struct server_choice *c, struct dm2_error *err);

/* Parses the options of a command without operands, then calls server_choice_finish. With --help (*help,
 * which `table` sets) prints `usage` and the options instead. DM2_USAGE, DM2_MEMORY and the errors of
 * server_choice_finish. */
enum dm2_status server_choice_parse(struct server_choice *c, const struct option *table, size_t n, int argc,
                                    char **argv, const bool *help, const char *usage, struct dm2_error *err);

void server_choice_free(struct server_choice *c);

/* Measures the cost of messages with `servers` servers over `turns` turns into *out. Local servers are
 * looked for beside argv0. A readable `cancel` ends the measurement: DM2_INTERRUPTED. Else DM2_MEMORY and
 * the errors of local_servers_start, client_measure_network and network_fit. */
enum dm2_status server_choice_measure(const struct server_choice *c, const char *argv0, int servers,
                                      int turns, int cancel, struct network_line *out, struct dm2_error *err);

#endif
