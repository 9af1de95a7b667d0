/* Routing without sockets: the segments for each destination, and refused messages. */
#include "check.h"

#include "dm2/base/bytes.h"
#include "cluster/relay.h"

enum { RANKS = 5 };

static struct bytes_writer sent[RANKS];
static struct relay_source sources[RANKS];

static void clear(void)
{
    for (int k = 0; k < RANKS; k++) {
        bytes_clear(&sent[k]);
        sources[k] = (struct relay_source){0};
    }
}

static void add(int rank, int from, int to, const char *text)
{
    bytes_put_u16(&sent[rank], (uint16_t)from);
    bytes_put_u16(&sent[rank], (uint16_t)to);
    bytes_put_text(&sent[rank], text, strlen(text)); /* the length as u32, then the text */
    sources[rank].count++;
}

static void finish(void)
{
    for (int k = 0; k < RANKS; k++) {
        sources[k].segments = sent[k].data;
        sources[k].length = sent[k].length;
    }
}

/* The destination's segments as "source:text source:text ". */
static void told(const struct relay_route *route, char *out, size_t size)
{
    struct bytes_writer w = {0};
    size_t used = 0;
    for (size_t k = RELAY_SPARE; k < route->n_iov; k++)
        bytes_put_raw(&w, route->iov[k].iov_base, route->iov[k].iov_len);
    CHECK_EQ_INT(w.length, route->bytes);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    out[0] = '\0';
    for (uint32_t k = 0; k < route->count; k++) {
        int from = bytes_get_u16(&r);
        (void)bytes_get_u16(&r);
        char *text = bytes_get_text(&r, 1000, NULL);
        used += (size_t)snprintf(out + used, size - used, "%d:%s ", from, text);
        free(text);
    }
    CHECK(bytes_done(&r));
    bytes_free(&w);
}

TEST(segments_reach_their_destinations_by_source)
{
    struct relay relay;
    struct dm2_error err = {0};
    char text[200];
    int culprit = -1;
    CHECK_EQ_INT(relay_open(&relay, RANKS, &err), DM2_OK);
    for (int round = 0; round < 3; round++) { /* the relay is used repeatedly */
        clear();
        add(3, 3, 0, "d");
        add(3, 3, 2, "dd");
        add(0, 0, 2, "a");
        add(0, 0, 4, "");
        add(2, 2, 0, "cc");
        finish();
        CHECK_EQ_INT(relay_run(&relay, sources, &culprit, &err), DM2_OK);
        told(&relay.route[0], text, sizeof text);
        CHECK_STR(text, "2:cc 3:d ");
        told(&relay.route[1], text, sizeof text);
        CHECK_STR(text, "");
        told(&relay.route[2], text, sizeof text);
        CHECK_STR(text, "0:a 3:dd ");
        told(&relay.route[4], text, sizeof text);
        CHECK_STR(text, "0: ");
        /* no copy: the bytes stay in their message */
        CHECK(relay.route[4].iov[RELAY_SPARE].iov_base == sent[0].data + 9);
    }
    relay_free(&relay);
}

static void refused(const char *part)
{
    struct relay relay;
    struct dm2_error err = {0};
    int culprit = -1;
    finish();
    CHECK_EQ_INT(relay_open(&relay, RANKS, &err), DM2_OK);
    CHECK_EQ_INT(relay_run(&relay, sources, &culprit, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, part);
    CHECK_EQ_INT(culprit, 1);
    relay_free(&relay);
}

TEST(what_cannot_be_is_refused)
{
    clear();
    add(1, 2, 3, "x");
    refused("from rank 2");
    clear();
    add(1, 1, 1, "x");
    refused("to rank 1");
    clear();
    add(1, 1, RANKS, "x");
    refused("to rank 5");
    clear();
    add(1, 1, 3, "x");
    add(1, 1, 3, "x");
    refused("to rank 3, after one to rank 3");
    clear();
    add(1, 1, 3, "x");
    add(1, 1, 2, "x");
    refused("to rank 2, after one to rank 3");
    clear();
    add(1, 1, 3, "abc");
    sent[1].length--;
    refused("longer than the message");
    clear();
    add(1, 1, 3, "abc");
    bytes_put_u8(&sent[1], 0);
    refused("1 bytes follow");
    clear();
    add(1, 1, 3, "abc");
    sources[1].count = 0xffffffffU;
    refused("longer than the message");
    clear();
    add(1, 1, 3, "abc");
    bytes_patch_u32(&sent[1], 4, 0xffffffffU);
    refused("longer than the message");
    for (int k = 0; k < RANKS; k++)
        bytes_free(&sent[k]);
}

TEST_MAIN(CASE(segments_reach_their_destinations_by_source), CASE(what_cannot_be_is_refused))
