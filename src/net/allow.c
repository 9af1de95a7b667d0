/* Every address becomes 16 bytes. An IPv4 address takes the mapped form in which it also arrives at a socket
 * for both families, so that one comparison of leading bits serves all. A network with bits behind its length
 * is an error, because 10.1.2.3/8 may have been meant as a single machine. */
#include "dm2/net/allow.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

static const unsigned char MAPPED[12] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};

/* Returns the number of bits in an address of this family, 32 or 128; 0 where the text is no address. */
static int parse_address(const char *text, unsigned char out[16])
{
    if (inet_pton(AF_INET6, text, out) == 1)
        return 128;
    memcpy(out, MAPPED, sizeof MAPPED);
    return inet_pton(AF_INET, text, out + sizeof MAPPED) == 1 ? 32 : 0;
}

static bool same_leading_bits(const unsigned char *a, const unsigned char *b, int bits)
{
    int whole = bits / 8, rest = bits % 8;
    return memcmp(a, b, (size_t)whole) == 0 && (rest == 0 || (a[whole] ^ b[whole]) >> (8 - rest) == 0);
}

static bool host_bits_clear(const struct allow_network *net)
{
    for (int bit = net->bits; bit < 128; bit++)
        if ((net->address[bit / 8] >> (7 - bit % 8) & 1) != 0)
            return false;
    return true;
}

enum dm2_status allow_add(struct allow_list *list, const char *text, struct dm2_error *err)
{
    char address[64];
    const char *slash = strchr(text, '/');
    size_t length = slash == NULL ? strlen(text) : (size_t)(slash - text);
    struct allow_network net;
    if (list->n == ALLOW_MOST)
        return dm2_fail(err, DM2_USAGE, "--allow %s: at most %d networks are taken", text, ALLOW_MOST);
    (void)snprintf(address, sizeof address, "%.*s", length < sizeof address ? (int)length : 0, text);
    int family = parse_address(address, net.address);
    if (family == 0)
        return dm2_fail(err, DM2_USAGE,
                        "--allow %s: an address or a network such as 192.168.1.0/24 or fd00::/8 is expected",
                        text);
    long bits = family;
    if (slash != NULL) {
        char *end = NULL;
        bits = strtol(slash + 1, &end, 10);
        if (slash[1] < '0' || slash[1] > '9' || *end != '\0' || bits > family)
            return dm2_fail(err, DM2_USAGE,
                            "--allow %s: a number of bits from 0 to %d is expected behind the slash", text,
                            family);
    }
    net.bits = 128 - family + (int)bits;
    if (!host_bits_clear(&net))
        return dm2_fail(err, DM2_USAGE,
                        "--allow %s: the address has bits behind the first %ld: give the network's own", text,
                        bits);
    list->items[list->n++] = net;
    return DM2_OK;
}

static bool list_holds(const struct allow_list *list, const unsigned char address[16])
{
    for (int k = 0; k < list->n; k++)
        if (same_leading_bits(list->items[k].address, address, list->items[k].bits))
            return true;
    return list->n == 0;
}

bool allow_address(const struct allow_list *list, const char *address)
{
    unsigned char bytes[16];
    return parse_address(address, bytes) != 0 && list_holds(list, bytes);
}

bool allow_peer(const struct allow_list *list, int fd)
{
    struct sockaddr_storage name;
    socklen_t length = sizeof name;
    unsigned char bytes[16];
    if (list->n == 0)
        return true;
    if (getpeername(fd, (struct sockaddr *)&name, &length) != 0)
        return false;
    if (name.ss_family == AF_INET6) {
        struct sockaddr_in6 in6;
        memcpy(&in6, &name, sizeof in6);
        memcpy(bytes, &in6.sin6_addr, sizeof bytes);
    } else if (name.ss_family == AF_INET) {
        struct sockaddr_in in;
        memcpy(&in, &name, sizeof in);
        memcpy(bytes, MAPPED, sizeof MAPPED);
        memcpy(bytes + sizeof MAPPED, &in.sin_addr, 4);
    } else {
        return false;
    }
    return list_holds(list, bytes);
}
