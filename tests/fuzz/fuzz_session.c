/* Fuzz target: the bytes are all that a client sends. Bit 0 of byte 0: the server has a key. Bit 1: the
 * server is busy, and the bytes come from a visitor in the lobby. Magic, version and checksum of frames are
 * corrected, so that the input reaches the code behind their checks. The server's nonce is 0 (the Makefile's
 * FUZZ_WRAP). */
#include "fuzz.h"

#include <fcntl.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dm2/cluster/messages.h"
#include "dm2/cluster/server.h"
#include "dm2/net/frame.h"
#include "cluster/lobby.h"

enum { MOST = 60000 }; /* fits into the socket's buffer */

/* Sends the complete frames among the bytes, then the rest. A PROOF that begins with 0 gets the right code,
 * and the frames behind it get tags. */
static void send_frames(int fd, const unsigned char *bytes, size_t n, const struct auth_key *key)
{
    struct channel ch;
    struct frame_header h;
    struct auth_nonces nonces = {{0}, {0}};
    enum auth_role role = AUTH_CLIENT;
    unsigned char head[FRAME_HEADER], code[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    channel_open(&ch, fd, PROTOCOL_VERSION, "the server");
    while (n >= FRAME_HEADER) {
        (void)frame_header_decode(bytes, 0, UINT32_MAX, &h);
        if (h.length > n - FRAME_HEADER)
            break;
        const unsigned char *payload = bytes + FRAME_HEADER;
        if ((h.type == MESSAGE_KNOCK || h.type == MESSAGE_STATUS) && h.length == AUTH_NONCE) {
            memcpy(nonces.client, payload, AUTH_NONCE);
            role = h.type == MESSAGE_STATUS ? AUTH_ASKER : AUTH_CLIENT;
        }
        unsigned char hello[LIMIT_HELLO];
        if (h.type == MESSAGE_HELLO && h.length >= 8 && h.length <= LIMIT_HELLO) {
            memcpy(hello, payload, h.length);
            fuzz_renew_fingerprint(hello);
            payload = hello;
        }
        bool right = key != NULL && h.type == MESSAGE_PROOF && h.length == AUTH_CODE && payload[0] == 0;
        if (right)
            auth_code(key, role, PROTOCOL_VERSION, &nonces, code);
        (void)channel_send(&ch, h.type, h.flags, right ? code : payload, h.length, deadline_in(0, -1), NULL);
        if (right) {
            auth_session_key(key, AUTH_SERVER, PROTOCOL_VERSION, &nonces, in);
            auth_session_key(key, AUTH_CLIENT, PROTOCOL_VERSION, &nonces, out);
            channel_use_keys(&ch, in, out);
        }
        bytes += FRAME_HEADER + h.length;
        n -= FRAME_HEADER + h.length;
    }
    struct iovec rest[2] = {{(void *)(uintptr_t)bytes, n}, {NULL, 0}};
    if (n >= FRAME_HEADER) {
        h.version = PROTOCOL_VERSION;
        frame_header_encode(&h, head); /* with the right magic */
        rest[0] = (struct iovec){head, FRAME_HEADER};
        rest[1] = (struct iovec){(void *)(uintptr_t)(bytes + FRAME_HEADER), n - FRAME_HEADER};
    }
    (void)socket_write_all(fd, rest, 2, deadline_in(0, -1), NULL);
}

enum dm2_status __wrap_auth_nonce(unsigned char nonce[AUTH_NONCE], struct dm2_error *err);
enum dm2_status __wrap_auth_nonce(unsigned char nonce[AUTH_NONCE], struct dm2_error *err)
{
    (void)err;
    memset(nonce, 0, AUTH_NONCE);
    return DM2_OK;
}

/* Lets a busy server handle a visitor with the connection fd, which is closed. */
static void visit_lobby(int fd, const struct server_options *options)
{
    struct lobby lobby;
    const struct session_summary session = {.deck = "a deck", .rank = 1, .ranks = 2, .steps = 3};
    lobby_open(&lobby, -1, options, NULL, NULL);
    lobby.business = (struct lobby_business){.peer = "a friend", .session = &session};
    lobby_enter(&lobby, fd, "fuzz");
    for (int k = 0; k < 4; k++)
        (void)lobby_wait(&lobby, -1, deadline_in(1e-6, -1));
    lobby_close(&lobby);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct auth_key key = {{1}};
    int fd[2];
    if (size < 2 || size > MOST || socketpair(AF_UNIX, SOCK_STREAM, 0, fd) != 0)
        return 0;
    const struct server_options options = {.deck_dir = "/nonexistent",
                                           .version = "1.0.0", /* that of the inputs */
                                           .handshake = 1,
                                           .timeout = 1,
                                           .cancel = -1,
                                           .key = data[0] % 2 == 1 ? &key : NULL,
                                           .max_elements = 10000,
                                           .max_steps = 10};
    struct session_summary summary;
    struct dm2_error err = {0};
    socket_ignore_sigpipe();
    (void)fcntl(fd[0], F_SETFL, O_NONBLOCK);
    (void)fcntl(fd[1], F_SETFL, O_NONBLOCK);
    send_frames(fd[1], data + 1, size - 1, options.key);
    if (data[0] / 2 % 2 == 1) {
        visit_lobby(fd[0], &options);
    } else {
        (void)shutdown(fd[1], SHUT_WR);
        (void)server_session(fd[0], "fuzz", &options, &summary, &err);
    }
    (void)close(fd[1]);
    return 0;
}
