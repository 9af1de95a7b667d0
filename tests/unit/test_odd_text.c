/* A DECK message whose counts promise more than a deck may have is refused while it is read; tables and hosts
 * files may begin with a byte order mark. */
#include <stdlib.h>

#include "dm2/base/bytes.h"
#include "dm2/base/csv.h"
#include "dm2/cluster/hosts.h"
#include "dm2/cluster/messages.h"
#include "check.h"
#include "scratch.h"

/* The number of definitions that are held of a message with n empty ones; -1: the message is refused. */
static long held_definitions(uint32_t n)
{
    static const unsigned char digest[SHA256_BYTES];
    struct bytes_writer w = {0};
    struct deck_message m;
    bytes_put_u8(&w, 0);
    bytes_put_raw(&w, digest, sizeof digest);
    bytes_put_text(&w, "deck.dm2", 8);
    bytes_put_i64(&w, -1);
    bytes_put_u32(&w, n);
    for (uint32_t k = 0; k < n; k++)
        bytes_put_text(&w, "", 0);
    bytes_put_u32(&w, 0);
    struct bytes_reader r = {.data = w.data, .length = w.length};
    message_get_deck(&r, &m);
    long held = r.failed ? -1 : (long)m.source.n_defines;
    CHECK(!r.failed || m.source.n_defines == 0);
    message_free_deck(&m);
    bytes_free(&w);
    return held;
}

TEST(definitions_of_a_message)
{
    CHECK_EQ_INT(held_definitions(0), 0);
    CHECK_EQ_INT(held_definitions(1000), 1000);
    CHECK_EQ_INT(held_definitions(1001), -1);
    CHECK_EQ_INT(held_definitions(1000000), -1);
}

TEST(byte_order_marks)
{
    struct csv csv;
    struct endpoints hosts = {0};
    scratch_begin();
    scratch_write("table.csv", "\xef\xbb\xbfx,y\n1,2\n");
    CHECK_EQ_INT(csv_read(scratch_path("table.csv"), &csv, NULL), DM2_OK);
    CHECK_STR(csv_heading(&csv, 0), "x");
    csv_free(&csv);
    scratch_write("hosts", "\xef\xbb\xbflocalhost:4000\n");
    CHECK_EQ_INT(hosts_read(scratch_path("hosts"), &hosts, NULL), DM2_OK);
    CHECK_EQ_INT(hosts.n, 1);
    CHECK_STR(hosts.n == 1 ? hosts.items[0].host : "", "localhost");
    endpoints_free(&hosts);
    scratch_end();
}

TEST_MAIN(CASE(definitions_of_a_message), CASE(byte_order_marks))
