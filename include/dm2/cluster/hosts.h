/* Which servers there are: host names with ports, and the hosts file.
 *
 * A hosts file has one line per machine, `host[:port] [slots=K] [spare]`, and `#` starts a comment. `slots=K`
 * stands for K servers, on the ports port .. port+K-1; those of a line with `spare` stand in for others that
 * are lost. An IPv6 address with a port is written [address]:port. */
#ifndef DM2_CLUSTER_HOSTS_H
#define DM2_CLUSTER_HOSTS_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/status.h"

enum { HOST_MAX = 255, HOSTS_MOST = 65535 };

struct endpoint {
    char host[HOST_MAX + 1];
    int port;
    bool spare;
};

/* A list that grows; start from {0}. */
struct endpoints {
    struct endpoint *items;
    size_t n, cap;
};

/* DM2_MEMORY. */
enum dm2_status endpoints_add(struct endpoints *list, const char *host, int port, struct dm2_error *err);
/* Puts the spares behind the others, both in their order; returns how many are none. */
size_t endpoints_sort(struct endpoints *list);
void endpoints_free(struct endpoints *list);

/* Adds HOST[:PORT]; without a port the default one. DM2_USAGE that says what is wrong. */
enum dm2_status hosts_parse_server(const char *text, struct endpoints *list, struct dm2_error *err);

/* Adds the servers of a hosts file's text; `name` is what messages call it. DM2_USAGE with name:line. An
 * empty file is an error too. */
enum dm2_status hosts_parse(const char *name, const char *text, struct endpoints *list,
                            struct dm2_error *err);

/* The same from a file. DM2_USAGE where it cannot be read. */
enum dm2_status hosts_read(const char *path, struct endpoints *list, struct dm2_error *err);

#endif
