/* Which addresses may connect: a list of networks as ADDRESS/BITS (CIDR), IPv4 or IPv6. */
#ifndef DM2_NET_ALLOW_H
#define DM2_NET_ALLOW_H

#include <stdbool.h>

#include "dm2/base/status.h"

enum { ALLOW_MOST = 64 };

struct allow_network {
    unsigned char address[16]; /* IPv4 as ::ffff:a.b.c.d */
    int bits;                  /* of the 128 */
};

/* Start from {0}; an empty list allows everybody. */
struct allow_list {
    struct allow_network items[ALLOW_MOST];
    int n;
};

/* Adds ADDRESS or ADDRESS/BITS. DM2_USAGE that says what is wrong, also where bits behind BITS are set. */
enum dm2_status allow_add(struct allow_list *list, const char *text, struct dm2_error *err);

/* Does the list allow this numeric address; the peer of this connection? What is neither IPv4 nor IPv6 is not
 * allowed. */
bool allow_address(const struct allow_list *list, const char *address);
bool allow_peer(const struct allow_list *list, int fd);

#endif
