/* Servers on this machine that a client starts for one run and ends with it. */
#ifndef DM2_APP_LOCAL_SERVERS_H
#define DM2_APP_LOCAL_SERVERS_H

#include <stdbool.h>
#include <sys/types.h>

#include "dm2/base/status.h"
#include "dm2/cluster/hosts.h"

struct local_server {
    pid_t pid;
    int out; /* its standard output; ends when it does */
};

struct local_servers {
    struct local_server *items;
    int n;
};

/* Starts n dm2-servers on free loopback ports and adds them to *list. The program is looked for beside
 * `argv0`, the path by which the caller was started, else on PATH. Each runs in a process group of its own,
 * so that an interrupt from the terminal reaches the caller alone. On failure those that were started are
 * ended. DM2_NET: the program is missing or did not say where it listens; DM2_INTERRUPTED; DM2_MEMORY. */
enum dm2_status local_servers_start(const char *argv0, int n, bool verbose, int cancel,
                                    struct local_servers *out, struct endpoints *list, struct dm2_error *err);

/* Ends them, at last by SIGKILL, and waits for them. */
void local_servers_stop(struct local_servers *servers);

/* How many servers make sense on this machine: one per core. */
int local_servers_cores(void);

#endif
