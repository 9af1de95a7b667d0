/* Frames over a socket pair: whole frames, frames in pieces, and every fault of enum frame_fault. */
#include "check.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dm2/base/clock.h"
#include "dm2/base/crc32c.h"
#include "dm2/net/frame.h"

enum { VERSION = 3 };

static struct channel left, right;

static void open_pair(void)
{
    int fd[2];
    socket_ignore_sigpipe();
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, fd) != 0)
        exit(1);
    for (int k = 0; k < 2; k++)
        (void)fcntl(fd[k], F_SETFL, O_NONBLOCK);
    channel_open(&left, fd[0], VERSION, "left");
    channel_open(&right, fd[1], VERSION, "right");
}

static void close_pair(void)
{
    channel_close(&left);
    channel_close(&right);
}

/* A whole frame as bytes; returns its length. */
static size_t frame_bytes(unsigned char *out, uint16_t version, uint8_t type, const void *payload,
                          size_t length)
{
    struct frame_header h = {.version = version, .type = type, .length = (uint32_t)length};
    frame_header_encode(&h, out);
    h.checksum = crc32c(crc32c(0, out, FRAME_HEADER - 4), payload, length);
    frame_header_encode(&h, out);
    memcpy(out + FRAME_HEADER, payload, length);
    return FRAME_HEADER + length;
}

static void raw(const void *data, size_t n)
{
    CHECK_EQ_INT(write(left.fd, data, n), n);
}

/* The reader's message for these bytes followed by the end of the stream. */
static struct dm2_error fault_of(const void *data, size_t n, uint32_t limit)
{
    struct dm2_error err = {0};
    struct frame f;
    open_pair();
    raw(data, n);
    (void)shutdown(left.fd, SHUT_WR);
    err.status = channel_receive(&right, limit, deadline_in(5, -1), &f, &err);
    close_pair();
    return err;
}

TEST(frames_arrive)
{
    struct dm2_error err = {0};
    struct frame f;
    open_pair();
    char one[] = "abc", two[] = "defgh";
    struct iovec parts[4] = {{0}, {one, 3}, {one, 0}, {two, 5}};
    CHECK_EQ_INT(channel_send_parts(&left, 7, 1, parts, 4, deadline_in(5, -1), &err), DM2_OK);
    CHECK_EQ_INT(channel_send(&left, 8, 0, NULL, 0, deadline_in(5, -1), &err), DM2_OK);
    CHECK_EQ_INT(channel_receive(&right, 100, deadline_in(5, -1), &f, &err), DM2_OK);
    CHECK_EQ_INT(f.type, 7);
    CHECK_EQ_INT(f.flags, 1);
    CHECK_EQ_INT(f.length, 8);
    CHECK(memcmp(f.payload, "abcdefgh", 8) == 0);
    CHECK_EQ_INT(channel_receive(&right, 100, deadline_in(5, -1), &f, &err), DM2_OK);
    CHECK_EQ_INT(f.type, 8);
    CHECK_EQ_INT(f.length, 0);
    CHECK_EQ_INT(right.bytes_in, left.bytes_out);
    CHECK_EQ_INT(right.frames_in, 2);
    close_pair();
}

TEST(frames_arrive_byte_by_byte)
{
    unsigned char bytes[64];
    struct dm2_error err = {0};
    struct frame f;
    bool complete = false;
    size_t n = frame_bytes(bytes, VERSION, 9, "payload", 7);
    open_pair();
    for (size_t k = 0; k < n; k++) {
        CHECK_EQ_INT(channel_receive_some(&right, 100, &complete, &f, &err), DM2_OK);
        CHECK(!complete);
        raw(bytes + k, 1);
    }
    CHECK_EQ_INT(channel_receive_some(&right, 100, &complete, &f, &err), DM2_OK);
    CHECK(complete);
    CHECK_EQ_INT(f.length, 7);
    close_pair();
}

/* Three frames and a half in one piece, then the rest: each frame comes out separately. */
TEST(frames_that_arrive_together)
{
    unsigned char bytes[200];
    struct dm2_error err = {0};
    struct frame f;
    bool complete = false;
    size_t n = 0, last = 0;
    for (int k = 0; k < 4; k++) {
        last = n;
        n += frame_bytes(bytes + n, VERSION, (uint8_t)(10 + k), "payload", (size_t)k);
    }
    open_pair();
    raw(bytes, last + 17);
    for (int k = 0; k < 3; k++) {
        CHECK_EQ_INT(channel_receive(&right, 100, deadline_in(5, -1), &f, &err), DM2_OK);
        CHECK_EQ_INT(f.type, 10 + k);
        CHECK_EQ_INT(f.length, k);
        CHECK(memcmp(f.payload, "payload", (size_t)k) == 0);
    }
    CHECK_EQ_INT(channel_receive_some(&right, 100, &complete, &f, &err), DM2_OK);
    CHECK(!complete);
    raw(bytes + last + 17, n - last - 17);
    CHECK_EQ_INT(channel_receive_some(&right, 100, &complete, &f, &err), DM2_OK);
    CHECK(complete && f.length == 3);
    close_pair();
}

/* Larger than the socket's buffers: both ends must take turns. */
TEST(a_large_frame_in_many_pieces)
{
    enum { BIG = 3000000 };
    unsigned char *data = malloc(BIG);
    unsigned char *bytes = malloc(BIG + FRAME_HEADER);
    for (size_t k = 0; k < BIG; k++)
        data[k] = (unsigned char)(k * 2654435761U >> 13);
    size_t n = frame_bytes(bytes, VERSION, 1, data, BIG), sent = 0;
    struct dm2_error err = {0};
    struct frame f = {0};
    bool complete = false;
    open_pair();
    while (!complete && err.status == DM2_OK) {
        struct iovec iov = {bytes + sent, n - sent};
        size_t put = 0;
        if (sent < n)
            CHECK_EQ_INT(socket_write_some(left.fd, &iov, 1, &put, &err), DM2_OK);
        sent += put;
        CHECK_EQ_INT(channel_receive_some(&right, BIG, &complete, &f, &err), DM2_OK);
    }
    CHECK_EQ_INT(f.length, BIG);
    CHECK(complete && memcmp(f.payload, data, BIG) == 0);
    close_pair();
    free(data);
    free(bytes);
}

TEST(strangers_are_told_at_once)
{
    struct dm2_error err = fault_of("GET / HTTP/1.1\r\n\r\n", 18, 100);
    CHECK_EQ_INT(err.status, DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "'GET '");
    err = fault_of("\1\2\3\4", 4, 100); /* less than a header is enough */
    CHECK_EQ_INT(err.status, DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "does not speak dm2's protocol");
}

TEST(another_version_is_named)
{
    unsigned char bytes[64];
    size_t n = frame_bytes(bytes, VERSION + 1, 1, "x", 1);
    struct dm2_error err = fault_of(bytes, n, 100);
    CHECK_EQ_INT(err.status, DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "version 4, this program version 3");
}

TEST(a_length_above_the_limit_is_refused_unread)
{
    unsigned char bytes[64];
    struct frame_header h = {.version = VERSION, .type = 2, .length = 0xfffffff0U};
    frame_header_encode(&h, bytes);
    struct dm2_error err = fault_of(bytes, FRAME_HEADER, UINT32_MAX);
    CHECK_EQ_INT(err.status, DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "4294967280 bytes");
    size_t n = frame_bytes(bytes, VERSION, 1, "12345", 5);
    CHECK_EQ_INT(fault_of(bytes, n, 4).status, DM2_PROTOCOL);
    CHECK_EQ_INT(fault_of(bytes, n, 5).status, DM2_OK);
}

/* A claimed gigabyte costs nothing until its bytes come. */
TEST(memory_grows_with_what_arrives)
{
    unsigned char bytes[64] = {0};
    struct frame_header h = {.version = VERSION, .type = 2, .length = FRAME_LENGTH_MAX};
    struct dm2_error err = {0};
    struct frame f;
    bool complete;
    frame_header_encode(&h, bytes);
    open_pair();
    raw(bytes, sizeof bytes);
    CHECK_EQ_INT(channel_receive_some(&right, FRAME_LENGTH_MAX, &complete, &f, &err), DM2_OK);
    CHECK(!complete);
    CHECK(right.cap <= 1 << 20);
    close_pair();
}

TEST(every_changed_bit_is_noticed)
{
    unsigned char good[64], bytes[64];
    size_t n = frame_bytes(good, VERSION, 5, "some payload", 12);
    for (size_t bit = 0; bit < 8 * n; bit++) {
        memcpy(bytes, good, n);
        bytes[bit / 8] ^= (unsigned char)(1U << bit % 8);
        struct dm2_error err = fault_of(bytes, n, 1000);
        /* a longer length waits for bytes that never come: the frame is cut */
        CHECK(err.status == DM2_PROTOCOL || err.status == DM2_NET);
    }
}

TEST(a_cut_frame_is_an_error_everywhere)
{
    unsigned char bytes[64];
    size_t n = frame_bytes(bytes, VERSION, 5, "some payload", 12);
    struct dm2_error err = fault_of(bytes, 0, 1000);
    CHECK_EQ_INT(err.status, DM2_NET);
    CHECK_STR(err.text, "right closed the connection");
    for (size_t k = 1; k < n; k++) {
        err = fault_of(bytes, k, 1000);
        CHECK_EQ_INT(err.status, DM2_NET);
        CHECK_CONTAINS(err.text, "in the middle of a message");
    }
}

TEST(deadlines_end_waits)
{
    struct dm2_error err = {0};
    struct frame f;
    int cancel[2];
    open_pair();
    double start = clock_now();
    CHECK_EQ_INT(channel_receive(&right, 100, deadline_in(0.05, -1), &f, &err), DM2_TIMEOUT);
    CHECK(clock_now() - start >= 0.049);
    CHECK_CONTAINS(err.text, "right: ");
    CHECK(pipe(cancel) == 0 && write(cancel[1], "x", 1) == 1);
    CHECK_EQ_INT(channel_receive(&right, 100, deadline_in(60, cancel[0]), &f, &err), DM2_INTERRUPTED);
    /* a peer that does not read: the write ends at the deadline too */
    static unsigned char big[4000000];
    CHECK_EQ_INT(channel_send(&left, 1, 0, big, sizeof big, deadline_in(0.05, -1), &err), DM2_TIMEOUT);
    (void)close(cancel[0]);
    (void)close(cancel[1]);
    close_pair();
}

TEST(writing_to_a_closed_peer_is_an_error_not_a_signal)
{
    struct dm2_error err = {0};
    open_pair();
    channel_close(&right);
    CHECK_EQ_INT(channel_send(&left, 1, 0, "x", 1, deadline_in(5, -1), &err), DM2_NET);
    CHECK_CONTAINS(err.text, "left: the connection broke");
    close_pair();
}

TEST(loopback_addresses)
{
    int is = -1;
    CHECK(socket_is_loopback("127.0.0.1", &is, NULL) == DM2_OK && is == 1);
    CHECK(socket_is_loopback("127.9.9.9", &is, NULL) == DM2_OK && is == 1);
    CHECK(socket_is_loopback("0.0.0.0", &is, NULL) == DM2_OK && is == 0);
    CHECK(socket_is_loopback("10.0.0.1", &is, NULL) == DM2_OK && is == 0);
    CHECK(socket_is_loopback("::1", &is, NULL) == DM2_OK && is == 1);
    CHECK(socket_is_loopback("::", &is, NULL) == DM2_OK && is == 0);
}

TEST(listen_connect_accept)
{
    int listener = -1, a = -1, b = -1;
    char bound[SOCKET_NAME], peer[SOCKET_NAME];
    struct dm2_error err = {0};
    CHECK_EQ_INT(socket_listen("127.0.0.1", 0, &listener, bound, &err), DM2_OK);
    int port = atoi(strrchr(bound, ':') + 1);
    CHECK(port > 0);
    CHECK_EQ_INT(socket_connect("127.0.0.1", port, deadline_in(5, -1), &a, &err), DM2_OK);
    CHECK_EQ_INT(socket_accept(listener, deadline_in(5, -1), &b, peer, &err), DM2_OK);
    CHECK(b >= 0);
    CHECK(strncmp(peer, "127.0.0.1:", 10) == 0);
    CHECK((fcntl(a, F_GETFD) & FD_CLOEXEC) != 0 && (fcntl(b, F_GETFD) & FD_CLOEXEC) != 0);
    int second;
    CHECK_EQ_INT(socket_listen("127.0.0.1", port, &second, bound, &err), DM2_NET);
    CHECK_CONTAINS(err.text, "cannot listen on 127.0.0.1 port");
    socket_close(a);
    socket_close(b);
    socket_close(listener);
    CHECK_EQ_INT(socket_connect("127.0.0.1", port, deadline_in(5, -1), &a, &err), DM2_NET);
    CHECK_CONTAINS(err.text, "no dm2-server listens there");
}

static void open_keyed_pair(void)
{
    unsigned char a[SIPHASH_KEY], b[SIPHASH_KEY];
    memset(a, 1, sizeof a);
    memset(b, 2, sizeof b);
    open_pair();
    channel_use_keys(&left, a, b);
    channel_use_keys(&right, b, a);
}

TEST(keyed_frames_arrive)
{
    struct dm2_error err = {0};
    struct frame f;
    open_keyed_pair();
    for (int k = 0; k < 3; k++) {
        CHECK_EQ_INT(channel_send(&left, 7, 0, "payload", (size_t)k, deadline_in(5, -1), &err), DM2_OK);
        CHECK_EQ_INT(channel_receive(&right, 100, deadline_in(5, -1), &f, &err), DM2_OK);
        CHECK(f.type == 7 && f.length == (size_t)k && memcmp(f.payload, "payload", (size_t)k) == 0);
        CHECK_EQ_INT(channel_send(&right, 8, 0, NULL, 0, deadline_in(5, -1), &err), DM2_OK);
        CHECK_EQ_INT(channel_receive(&left, 100, deadline_in(5, -1), &f, &err), DM2_OK);
    }
    CHECK_EQ_INT(right.bytes_in, left.bytes_out);
    close_pair();
}

/* The bytes that the left end sends: `count` frames of one length. */
static size_t keyed_bytes(unsigned char *out, size_t cap, int count)
{
    size_t n = 0;
    open_keyed_pair();
    for (int k = 0; k < count; k++)
        CHECK_EQ_INT(channel_send(&left, 3, 0, "abc", 3, deadline_in(5, -1), NULL), DM2_OK);
    ssize_t got = read(right.fd, out, cap);
    n = got > 0 ? (size_t)got : 0;
    close_pair();
    return n;
}

/* The number of these frames that the right end accepts. */
static int taken_of(const unsigned char *bytes, size_t n)
{
    struct frame f;
    int taken = 0;
    open_keyed_pair();
    raw(bytes, n);
    (void)shutdown(left.fd, SHUT_WR);
    while (channel_receive(&right, 100, deadline_in(5, -1), &f, NULL) == DM2_OK)
        taken++;
    close_pair();
    return taken;
}

/* No bit can be changed; no frame can be left out, sent twice, moved, sent back, or made without the
 * key. */
TEST(keyed_frames_cannot_be_forged)
{
    enum { ONE = FRAME_HEADER + FRAME_TAG + 3 };
    unsigned char good[2 * ONE], bad[3 * ONE];
    CHECK_EQ_INT(keyed_bytes(good, sizeof good, 2), sizeof good);
    CHECK_EQ_INT(taken_of(good, sizeof good), 2);
    for (size_t bit = 0; bit < 8 * (size_t)ONE; bit++) {
        memcpy(bad, good, ONE);
        bad[bit / 8] ^= (unsigned char)(1 << bit % 8);
        CHECK_EQ_INT(taken_of(bad, ONE), 0);
    }
    CHECK_EQ_INT(taken_of(good + ONE, ONE), 0);
    memcpy(bad, good, ONE);
    memcpy(bad + ONE, good, ONE);
    CHECK_EQ_INT(taken_of(bad, 2 * ONE), 1);
    size_t n = frame_bytes(bad, VERSION, 3, "abc and more than a tag of it", 29);
    CHECK_EQ_INT(taken_of(bad, n), 0);
    struct frame f;
    struct dm2_error err = {0};
    open_keyed_pair(); /* a frame of the left end, sent back to the left end */
    CHECK_EQ_INT(write(right.fd, good, ONE), ONE);
    CHECK_EQ_INT(channel_receive(&left, 100, deadline_in(5, -1), &f, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "arrived changed");
    close_pair();
}

TEST_MAIN(CASE(keyed_frames_arrive), CASE(keyed_frames_cannot_be_forged), CASE(frames_arrive),
          CASE(frames_arrive_byte_by_byte), CASE(a_large_frame_in_many_pieces),
          CASE(frames_that_arrive_together), CASE(strangers_are_told_at_once), CASE(another_version_is_named),
          CASE(a_length_above_the_limit_is_refused_unread), CASE(memory_grows_with_what_arrives),
          CASE(every_changed_bit_is_noticed), CASE(a_cut_frame_is_an_error_everywhere),
          CASE(deadlines_end_waits), CASE(writing_to_a_closed_peer_is_an_error_not_a_signal),
          CASE(loopback_addresses), CASE(listen_connect_accept))
