/* A server with a key, in its own process, and every kind of visitor without the key. After each of them
 * the server serves the next client that has the key, gives every visitor without the key the same answer,
 * and keeps neither memory nor descriptors. */
#include "check.h"

#include <dirent.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dm2/base/clock.h"
#include "dm2/base/random.h"
#include "dm2/cluster/messages.h"
#include "dm2/cluster/server.h"
#include "dm2/engine/self_test.h"
#include "cluster/lobby.h"

static const double HANDSHAKE = 2;
static const struct auth_key KEY = {{1, 2, 3}}, OTHER = {{1, 2, 4}};

static uint64_t many = 1000; /* visitors of each kind; DM2_STRANGERS=10000 for more */

static pid_t server_id;
static int port;

static void no_log(void *context, enum server_event event, const char *peer, const char *line)
{
    (void)context;
    (void)event;
    (void)peer;
    (void)line;
}

/* Starts the server. `descriptors`: how many it may open besides its listener; 0: as many as this
 * process. */
static void start_server(int descriptors)
{
    char bound[SOCKET_NAME];
    int listener = -1;
    if (socket_listen("127.0.0.1", 0, &listener, bound, NULL) != DM2_OK)
        exit(1);
    port = (int)strtol(strrchr(bound, ':') + 1, NULL, 10);
    (void)fflush(NULL);
    server_id = fork();
    if (server_id == 0) {
        const struct server_options options = {.deck_dir = ".",
                                               .version = "test",
                                               .handshake = HANDSHAKE,
                                               .timeout = 5,
                                               .cancel = -1,
                                               .key = &KEY};
        struct dm2_error err = {0};
        const struct rlimit most = {(rlim_t)(listener + 1 + descriptors),
                                    (rlim_t)(listener + 1 + descriptors)};
        if (descriptors > 0 && setrlimit(RLIMIT_NOFILE, &most) != 0)
            _exit(1);
        socket_ignore_sigpipe();
        (void)server_serve(listener, &options, false, no_log, NULL, &err);
        _exit(0);
    }
    socket_close(listener);
}

static void end_server(void)
{
    (void)kill(server_id, SIGKILL);
    (void)waitpid(server_id, NULL, 0);
}

static struct deadline soon(void)
{
    return deadline_in(10, -1);
}

static int connected(void)
{
    int fd = -1;
    if (socket_connect("127.0.0.1", port, soon(), &fd, NULL) != DM2_OK) {
        (void)printf("the server is gone\n");
        exit(1);
    }
    return fd;
}

static struct channel knock_on(const unsigned char nonce[AUTH_NONCE])
{
    struct channel ch;
    channel_open(&ch, connected(), PROTOCOL_VERSION, "server");
    CHECK_EQ_INT(channel_send(&ch, MESSAGE_KNOCK, 0, nonce, AUTH_NONCE, soon(), NULL), DM2_OK);
    return ch;
}

static bool take(struct channel *ch, enum message_type type, void *out, size_t n)
{
    struct frame f;
    if (channel_receive(ch, LIMIT_SMALL, soon(), &f, NULL) != DM2_OK || f.type != type || f.length != n)
        return false;
    memcpy(out, f.payload, n);
    return true;
}

/* A client's handshake with this key; true where the server grants it. The channel is open in any case. */
static bool enter(struct channel *ch, const struct auth_key *key)
{
    struct auth_nonces nonces;
    unsigned char code[AUTH_CODE], own[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    CHECK_EQ_INT(auth_nonce(nonces.client, NULL), DM2_OK);
    *ch = knock_on(nonces.client);
    if (!take(ch, MESSAGE_CHALLENGE, nonces.server, AUTH_NONCE))
        return false;
    auth_code(key, AUTH_CLIENT, PROTOCOL_VERSION, &nonces, own);
    CHECK_EQ_INT(channel_send(ch, MESSAGE_PROOF, 0, own, AUTH_CODE, soon(), NULL), DM2_OK);
    if (!take(ch, MESSAGE_GRANT, code, AUTH_CODE))
        return false;
    auth_code(key, AUTH_SERVER, PROTOCOL_VERSION, &nonces, own);
    CHECK(memcmp(code, own, AUTH_CODE) == 0);
    auth_session_key(key, AUTH_SERVER, PROTOCOL_VERSION, &nonces, in);
    auth_session_key(key, AUTH_CLIENT, PROTOCOL_VERSION, &nonces, out);
    channel_use_keys(ch, in, out);
    return true;
}

static void put_hello(struct bytes_writer *w)
{
    const struct hello_message m = {.turn = true, .fingerprint = SELF_TEST_FINGERPRINT, .version = "test"};
    message_put_hello(w, &m);
}

static int server_descriptors(void)
{
    char path[64];
    int n = 0;
    (void)snprintf(path, sizeof path, "/proc/%ld/fd", (long)server_id);
    DIR *dir = opendir(path);
    while (dir != NULL && readdir(dir) != NULL)
        n++;
    if (dir != NULL)
        (void)closedir(dir);
    return n;
}

/* Begins a session with the right key; the server serves it until the channel is closed. */
static struct channel begin_session(void)
{
    struct channel ch;
    struct frame f = {0};
    struct bytes_writer w = {0};
    put_hello(&w);
    CHECK(enter(&ch, &KEY));
    CHECK_EQ_INT(channel_send(&ch, MESSAGE_HELLO, 0, w.data, w.length, soon(), NULL), DM2_OK);
    CHECK_EQ_INT(channel_receive(&ch, LIMIT_HELLO, soon(), &f, NULL), DM2_OK);
    CHECK_EQ_INT(f.type, MESSAGE_WELCOME);
    bytes_free(&w);
    return ch;
}

/* The client in session sends a message and is answered. */
static bool is_served(struct channel *ch)
{
    struct frame f;
    return channel_send(ch, MESSAGE_ECHO, 0, "x", 1, soon(), NULL) == DM2_OK &&
           channel_receive(ch, LIMIT_SMALL, soon(), &f, NULL) == DM2_OK && f.type == MESSAGE_ECHO;
}

/* Returns the number of the server's descriptors during a session: all earlier connections are closed
 * then. */
static int visit(void)
{
    struct channel ch = begin_session();
    int descriptors = server_descriptors();
    channel_close(&ch);
    return descriptors;
}

/* Resident pages of the server; 0 where the system does not say. */
static long server_pages(void)
{
    char path[64], text[128] = "";
    (void)snprintf(path, sizeof path, "/proc/%ld/statm", (long)server_id);
    FILE *file = fopen(path, "r");
    long pages = 0;
    if (file != NULL && fgets(text, sizeof text, file) != NULL && strchr(text, ' ') != NULL)
        pages = strtol(strchr(text, ' '), NULL, 10);
    if (file != NULL)
        (void)fclose(file);
    return pages;
}

/* Reads until the server closes; returns the length, at most n. */
static size_t rest_of(int fd, unsigned char *out, size_t n)
{
    size_t have = 0, got = 0;
    int closed = 0;
    while (!closed && have < n && socket_wait(fd, POLLIN, soon(), NULL) == DM2_OK &&
           socket_read_some(fd, out + have, n - have, &got, &closed, NULL) == DM2_OK)
        have += got;
    return have;
}

/* The bytes of the answer to a visitor without the key. */
static size_t refusal(unsigned char *out, size_t n)
{
    int fd[2];
    struct channel ch;
    struct bytes_writer w = {0};
    const struct error_message m = {.status = DM2_PROTOCOL, .text = REFUSAL_TEXT};
    message_put_error(&w, &m);
    CHECK_EQ_INT(socketpair(AF_UNIX, SOCK_STREAM, 0, fd), 0);
    channel_open(&ch, fd[0], PROTOCOL_VERSION, "x");
    CHECK_EQ_INT(channel_send(&ch, MESSAGE_ERROR, 0, w.data, w.length, soon(), NULL), DM2_OK);
    channel_close(&ch);
    ssize_t got = read(fd[1], out, n);
    (void)close(fd[1]);
    bytes_free(&w);
    return got > 0 ? (size_t)got : 0;
}

/* Sends these bytes, then the end of the stream: the answer is the refusal, or nothing where the stream was
 * cut short. */
static void is_refused(const void *bytes, size_t n, bool answered)
{
    unsigned char want[256], got[256];
    size_t want_n = refusal(want, sizeof want);
    int fd = connected();
    struct iovec part = {(void *)(uintptr_t)bytes, n};
    CHECK_EQ_INT(socket_write_all(fd, &part, 1, soon(), NULL), DM2_OK);
    (void)shutdown(fd, SHUT_WR);
    size_t got_n = rest_of(fd, got, sizeof got);
    CHECK(got_n == 0 || (got_n == want_n && memcmp(got, want, want_n) == 0));
    CHECK(!answered || got_n > 0);
    socket_close(fd);
}

TEST(scanners_and_noise)
{
    int fds = visit();
    for (uint64_t k = 0; k < many; k++)
        socket_close(connected());
    is_refused("GET / HTTP/1.1\r\nHost: x\r\n\r\n", 27, true);
    is_refused("", 0, false);
    is_refused("DM2\032", 4, false);
    long pages = server_pages();
    for (uint64_t k = 0; k < many; k++) {
        unsigned char noise[512];
        size_t n = random_bits(1, k, 1) % sizeof noise;
        for (size_t i = 0; i < sizeof noise; i++)
            noise[i] = (unsigned char)random_bits(2, k, i);
        if (k % 2 == 0) { /* a header that is valid up to its length, or nearly so */
            const struct frame_header h = {.version = PROTOCOL_VERSION,
                                           .type = noise[6] % 27,
                                           .length = k % 4 == 0 ? AUTH_NONCE : noise[8]};
            frame_header_encode(&h, noise);
        }
        is_refused(noise, n, false);
    }
    CHECK_EQ_INT(visit(), fds);
#ifndef __SANITIZE_ADDRESS__ /* AddressSanitizer keeps freed memory on purpose */
    CHECK(server_pages() <= pages + 64);
#else
    CHECK(pages >= 0);
#endif
}

/* A byte now and then does not extend the time of a visitor without the key. */
TEST(slow_strangers_are_cut_off)
{
    unsigned char frame[FRAME_HEADER];
    const struct frame_header h = {.version = PROTOCOL_VERSION, .type = MESSAGE_KNOCK, .length = AUTH_NONCE};
    frame_header_encode(&h, frame);
    double start = clock_now();
    int fd = connected();
    bool open = true;
    for (size_t k = 0; open && clock_now() < start + 10; k++) {
        struct iovec part = {&frame[k % sizeof frame], k < sizeof frame ? 1 : 0};
        open = socket_write_all(fd, &part, 1, soon(), NULL) == DM2_OK &&
               socket_wait(fd, POLLIN, deadline_in(0.03, -1), NULL) == DM2_TIMEOUT;
    }
    CHECK(clock_now() - start < HANDSHAKE + 8);
    socket_close(fd);
    (void)visit();
}

/* More silent visitors than the lobby holds: the server sends them away, the next client gets its session,
 * and the server keeps nothing of the visitors. */
TEST(a_silent_crowd_is_sent_away)
{
    enum { CROWD = 2 * LOBBY_MOST + 8 };
    int fd[CROWD], fds = visit();
    for (int k = 0; k < CROWD; k++)
        fd[k] = connected();
    double start = clock_now();
    (void)visit();
    CHECK(clock_now() - start < 3 * HANDSHAKE + 8);
    for (int k = 0; k < CROWD; k++) {
        unsigned char got[256];
        CHECK(rest_of(fd[k], got, sizeof got) > 0); /* the refusal */
        socket_close(fd[k]);
    }
    CHECK_EQ_INT(visit(), fds);
}

/* During a session, visitors that look like clients keep out neither a status inquiry nor a client with the
 * key, and lose their places when they fall silent or close. */
TEST(a_crowd_does_not_silence_a_busy_server)
{
    const struct frame_header h = {.version = PROTOCOL_VERSION, .type = MESSAGE_KNOCK, .length = AUTH_NONCE};
    const unsigned char nonce[AUTH_NONCE] = {1};
    unsigned char head[FRAME_HEADER], got[256];
    int fd[LOBBY_MOST], fds = visit();
    struct channel served = begin_session(), crowd[LOBBY_MOST], asker, friend;
    frame_header_encode(&h, head);
    for (int k = 0; k < LOBBY_MOST; k++) {
        struct iovec part = {head, 7};
        fd[k] = connected();
        CHECK_EQ_INT(socket_write_all(fd[k], &part, 1, soon(), NULL), DM2_OK);
    }
    for (int k = 0; k < LOBBY_MOST; k++) {
        CHECK(rest_of(fd[k], got, sizeof got) > 0); /* the refusal */
        socket_close(fd[k]);
    }
    CHECK(is_served(&served));
    for (int k = 0; k < LOBBY_MOST; k++)
        crowd[k] = knock_on(nonce);
    channel_open(&asker, connected(), PROTOCOL_VERSION, "the server");
    CHECK_EQ_INT(channel_send(&asker, MESSAGE_STATUS, 0, nonce, AUTH_NONCE, soon(), NULL), DM2_OK);
    CHECK(take(&asker, MESSAGE_CHALLENGE, got, AUTH_NONCE));
    channel_close(&asker);
    CHECK(enter(&friend, &KEY));
    channel_close(&friend);
    CHECK(is_served(&served));
    for (int k = 0; k < LOBBY_MOST; k++)
        channel_close(&crowd[k]);
    for (double end = clock_now() + 3; server_descriptors() != fds && clock_now() < end;)
        CHECK(is_served(&served));
    CHECK_EQ_INT(server_descriptors(), fds);
    CHECK(is_served(&served));
    channel_close(&served);
    (void)visit();
}

/* A server without a free descriptor goes on with its session and then serves the next client. */
TEST(a_shortage_of_descriptors)
{
    enum { CROWD = 12, ROOM = 8 };
    unsigned char got[256];
    int fd[CROWD];
    start_server(ROOM);
    struct channel served = begin_session();
    for (int k = 0; k < CROWD; k++)
        fd[k] = connected();
    for (int k = 0; k < 2 * CROWD; k++) /* the server may accept one visitor each time */
        CHECK(is_served(&served));
    channel_close(&served);
    CHECK(rest_of(fd[0], got, sizeof got) > 0); /* the idle server was full until it sent this visitor away */
    for (int k = 0; k < CROWD; k++)
        socket_close(fd[k]);
    (void)visit();
    CHECK_EQ_INT(waitpid(server_id, NULL, WNOHANG), 0);
    end_server();
}

TEST(another_key_is_refused)
{
    struct channel ch;
    CHECK(!enter(&ch, &OTHER));
    channel_close(&ch);
    (void)visit();
}

/* A recorded handshake is refused, because the server's nonce differs each time. */
TEST(a_recorded_handshake_is_refused)
{
    struct auth_nonces first, second;
    unsigned char proof[AUTH_CODE], code[AUTH_CODE];
    CHECK_EQ_INT(auth_nonce(first.client, NULL), DM2_OK);
    for (int replay = 0; replay < 2; replay++) {
        struct channel ch = knock_on(first.client);
        CHECK(take(&ch, MESSAGE_CHALLENGE, replay ? second.server : first.server, AUTH_NONCE));
        if (!replay)
            auth_code(&KEY, AUTH_CLIENT, PROTOCOL_VERSION, &first, proof);
        CHECK_EQ_INT(channel_send(&ch, MESSAGE_PROOF, 0, proof, AUTH_CODE, soon(), NULL), DM2_OK);
        CHECK_EQ_INT(take(&ch, MESSAGE_GRANT, code, AUTH_CODE), !replay);
        channel_close(&ch);
    }
    CHECK(memcmp(first.server, second.server, AUTH_NONCE) != 0);
    (void)visit();
}

/* The proofs of a status inquiry and of a session differ in their purpose: a code for one is refused for
 * the other. */
TEST(a_code_for_another_purpose_is_refused)
{
    for (int k = 0; k < 2; k++) {
        struct auth_nonces nonces = {{0}, {0}};
        unsigned char code[AUTH_CODE];
        struct channel ch;
        channel_open(&ch, connected(), PROTOCOL_VERSION, "the server");
        CHECK_EQ_INT(channel_send(&ch, k == 0 ? MESSAGE_STATUS : MESSAGE_KNOCK, 0, nonces.client, AUTH_NONCE,
                                  soon(), NULL),
                     DM2_OK);
        CHECK(take(&ch, MESSAGE_CHALLENGE, nonces.server, AUTH_NONCE));
        auth_code(&KEY, k == 0 ? AUTH_CLIENT : AUTH_ASKER, PROTOCOL_VERSION, &nonces, code);
        CHECK_EQ_INT(channel_send(&ch, MESSAGE_PROOF, 0, code, AUTH_CODE, soon(), NULL), DM2_OK);
        CHECK(!take(&ch, MESSAGE_GRANT, code, AUTH_CODE));
        channel_close(&ch);
    }
    (void)visit();
}

/* A server's code for the same nonces is no client's code; nor is a code of another protocol version. */
TEST(a_reflected_code_is_refused)
{
    for (int k = 0; k < 2; k++) {
        struct auth_nonces nonces = {{0}, {0}};
        unsigned char code[AUTH_CODE];
        struct channel ch = knock_on(nonces.client);
        CHECK(take(&ch, MESSAGE_CHALLENGE, nonces.server, AUTH_NONCE));
        auth_code(&KEY, k == 0 ? AUTH_SERVER : AUTH_CLIENT, (uint16_t)(PROTOCOL_VERSION + k), &nonces, code);
        CHECK_EQ_INT(channel_send(&ch, MESSAGE_PROOF, 0, code, AUTH_CODE, soon(), NULL), DM2_OK);
        CHECK(!take(&ch, MESSAGE_GRANT, code, AUTH_CODE));
        channel_close(&ch);
    }
    (void)visit();
}

/* A relay that changes one bit of a client's message ends the session and nothing more. */
TEST(a_changed_bit_ends_the_session)
{
    struct bytes_writer w = {0};
    put_hello(&w);
    for (size_t bit = 3; bit < 8 * (FRAME_HEADER + FRAME_TAG + w.length); bit += 37) {
        struct channel ch;
        struct frame f = {0};
        unsigned char bytes[256];
        int fd[2];
        CHECK(enter(&ch, &KEY));
        CHECK_EQ_INT(socketpair(AF_UNIX, SOCK_STREAM, 0, fd), 0);
        int real = ch.fd;
        ch.fd = fd[0]; /* the frame as the client would send it, changed before it goes on */
        CHECK_EQ_INT(channel_send(&ch, MESSAGE_HELLO, 0, w.data, w.length, soon(), NULL), DM2_OK);
        ch.fd = real;
        ssize_t n = read(fd[1], bytes, sizeof bytes);
        bytes[bit / 8] ^= (unsigned char)(1 << bit % 8);
        struct iovec part = {bytes, n > 0 ? (size_t)n : 0};
        CHECK_EQ_INT(socket_write_all(ch.fd, &part, 1, soon(), NULL), DM2_OK);
        (void)shutdown(ch.fd, SHUT_WR);
        enum dm2_status status = channel_receive(&ch, LIMIT_SMALL, soon(), &f, NULL);
        CHECK(status != DM2_OK || f.type == MESSAGE_ERROR);
        channel_close(&ch);
        (void)close(fd[0]);
        (void)close(fd[1]);
    }
    bytes_free(&w);
    (void)visit();
}

/* A client with the key that sends nonsense under valid tags: every type, random payloads, before and after
 * HELLO. */
TEST(nonsense_from_a_friend)
{
    struct bytes_writer w = {0};
    put_hello(&w);
    int fds = visit();
    for (uint64_t k = 0; k < 100; k++) {
        unsigned char noise[600];
        struct channel ch;
        struct frame f = {0};
        CHECK(enter(&ch, &KEY));
        if (k % 2 == 1)
            CHECK_EQ_INT(channel_send(&ch, MESSAGE_HELLO, 0, w.data, w.length, soon(), NULL), DM2_OK);
        for (size_t i = 0; i < sizeof noise; i++)
            noise[i] = (unsigned char)(random_bits(3, k, i) % (k % 3 == 0 ? 4 : 256));
        (void)channel_send(&ch, (uint8_t)(k % 3 == 0 ? MESSAGE_DECK : k / 2), 0, noise, 6 * k, soon(), NULL);
        (void)shutdown(ch.fd, SHUT_WR);
        while (channel_receive(&ch, LIMIT_SMALL, soon(), &f, NULL) == DM2_OK && f.type != MESSAGE_ERROR)
            continue;
        channel_close(&ch);
    }
    bytes_free(&w);
    CHECK_EQ_INT(visit(), fds);
}

static void run_started(void)
{
    socket_ignore_sigpipe();
    start_server(0);
    test_scanners_and_noise();
    test_slow_strangers_are_cut_off();
    test_a_silent_crowd_is_sent_away();
    test_a_crowd_does_not_silence_a_busy_server();
    test_a_code_for_another_purpose_is_refused();
    test_another_key_is_refused();
    test_a_recorded_handshake_is_refused();
    test_a_reflected_code_is_refused();
    test_a_changed_bit_ends_the_session();
    test_nonsense_from_a_friend();
    CHECK_EQ_INT(waitpid(server_id, NULL, WNOHANG), 0); /* the server still runs */
    end_server();
}

TEST(a_server_among_strangers)
{
    const char *more = getenv("DM2_STRANGERS");
    many = more != NULL ? strtoul(more, NULL, 10) : many;
    run_started();
}

TEST_MAIN(CASE(a_server_among_strangers), CASE(a_shortage_of_descriptors))
