/* The addresses that may connect: a list of networks as ADDRESS/BITS (CIDR), IPv4 or IPv6. */
#ifndef DM2_NET_ALLOW_H
#define DM2_NET_ALLOW_H

#include <stdbool.h>

#include "dm2/base/status.h"

enum { ALLOW_MOST = 64 };

struct allow_network {
    unsigned char address[16]; /* IPv4 as ::ffff:a.b.c.d */
    int bits;                  /* leading bits of the 128 that count */
};

/* {0} is an empty list, which allows every address. */
struct allow_list {
    struct allow_network items[ALLOW_MOST];
    int n;
};

/* Adds ADDRESS or ADDRESS/BITS. DM2_USAGE where the text is neither, a bit behind BITS is set, or the list is
 * full. */
enum dm2_status allow_add(struct allow_list *list, const char *text, struct dm2_error *err);

/* Does the list allow a numeric address, or the peer of a connection? A list that is not empty allows only
 * IPv4 and IPv6; a text that is no address is never allowed. */
bool allow_address(const struct allow_list *list, const char *address);
bool allow_peer(const struct allow_list *list, int fd);

#endif
