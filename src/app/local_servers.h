/* Servers on this machine that a client starts for one run and ends after it. */
#ifndef DM2_APP_LOCAL_SERVERS_H
#define DM2_APP_LOCAL_SERVERS_H

#include <stdbool.h>
#include <sys/types.h>

#include "dm2/base/status.h"
#include "dm2/cluster/hosts.h"

struct local_server {
    pid_t pid;
    int out; /* its standard output; end of file when the server ends */
};

struct local_servers {
    struct local_server *items;
    int n;
};

/* Starts n dm2-servers on free loopback ports and adds their addresses to *list. The program is looked for
 * beside `argv0`, the path by which the caller was started, else on PATH. Each server runs in a process
 * group of its own, so that an interrupt from the terminal reaches the caller alone. After a failure the
 * servers that were started are ended. DM2_NET: the program is missing or did not print its address;
 * DM2_INTERRUPTED; DM2_MEMORY. End *out with local_servers_stop. */
enum dm2_status local_servers_start(const char *argv0, int n, bool verbose, int cancel,
                                    struct local_servers *out, struct endpoints *list, struct dm2_error *err);

/* Ends the servers by SIGTERM, after some seconds by SIGKILL, waits for them, and frees *servers. */
void local_servers_stop(struct local_servers *servers);

/* The number of servers that this machine can run at full speed: its cores, at most 1024. */
int local_servers_cores(void);

#endif
