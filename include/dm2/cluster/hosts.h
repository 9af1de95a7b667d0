/* The addresses of servers: HOST[:PORT] and the hosts file.
 *
 * A hosts file has one line per machine, `host[:port] [slots=K] [spare]`; `#` starts a comment. `slots=K`
 * means K servers, on the ports port .. port+K-1. The servers of a line with `spare` replace lost servers. An
 * IPv6 address with a port is written [address]:port. */
#ifndef DM2_CLUSTER_HOSTS_H
#define DM2_CLUSTER_HOSTS_H

#include <stdbool.h>
#include <stddef.h>

#include "dm2/base/status.h"

enum { HOST_MAX = 255, HOSTS_MOST = 65535 };

struct endpoint {
    char host[HOST_MAX + 1];
    int port;
    bool spare; /* replaces a lost server */
    int line;   /* of the hosts file; 0: from the command line */
};

/* A growing list; start from {0}. */
struct endpoints {
    struct endpoint *items;
    size_t n, cap;
};

/* Appends a server that is no spare. The host is copied, at most HOST_MAX characters. DM2_MEMORY. */
enum dm2_status endpoints_add(struct endpoints *list, const char *host, int port, struct dm2_error *err);

/* Moves the spares behind the other servers and keeps the order within both groups; returns the number of
 * servers that are no spares. */
size_t endpoints_sort(struct endpoints *list);

/* Frees the list's items and empties the list. */
void endpoints_free(struct endpoints *list);

/* Appends HOST[:PORT]; the port is DEFAULT_PORT unless given. DM2_USAGE names the mistake, or the server that
 * the list has already; DM2_MEMORY. */
enum dm2_status hosts_parse_server(const char *text, struct endpoints *list, struct dm2_error *err);

/* Appends the servers of a hosts file's text; errors call the file `name`. DM2_USAGE names the line and the
 * mistake, the line of a server that is named before, or the file that names no host; DM2_MEMORY. */
enum dm2_status hosts_parse(const char *name, const char *text, struct endpoints *list,
                            struct dm2_error *err);

/* The same from the file at `path`. DM2_USAGE also for a file that cannot be read or holds a NUL byte;
 * DM2_MEMORY. */
enum dm2_status hosts_read(const char *path, struct endpoints *list, struct dm2_error *err);

#endif
