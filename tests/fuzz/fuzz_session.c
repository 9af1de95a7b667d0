/* The bytes are all that a client sends. Byte 0 says whether the server has a key, and whether it has time (bit 1: it has not, and
 * the bytes come from one who stands in the lobby); magic, version and checksum of frames are put right, so that what is
 * behind them is reached. */
#include "fuzz.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dm2/base/crc32c.h"
#include "dm2/dist/lobby.h"
#include "dm2/dist/messages.h"
#include "dm2/dist/server.h"
#include "dm2/net/frame.h"

enum { MOST = 60000 }; /* fits into the socket's buffer */

static void mend_headers(unsigned char *bytes, size_t n)
{
    struct frame_header h;
    for (size_t at = 0; n - at >= FRAME_HEADER; at += FRAME_HEADER + h.length) {
        (void)frame_header_decode(bytes + at, 0, UINT32_MAX, &h);
        h.version = PROTOCOL_VERSION;
        frame_header_encode(&h, bytes + at); /* the magic, too */
        if (h.length > n - at - FRAME_HEADER)
            return;
        h.checksum = crc32c(crc32c(0, bytes + at, FRAME_HEADER - 4), bytes + at + FRAME_HEADER, h.length);
        frame_header_encode(&h, bytes + at);
    }
}

/* A server that is busy looks at what has come; takes fd over. */
static void stand_outside(int fd, const struct server_options *options)
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
                                           .version = "fuzz",
                                           .handshake = 1,
                                           .timeout = 1,
                                           .cancel = -1,
                                           .key = data[0] % 2 == 1 ? &key : NULL,
                                           .max_elements = 10000,
                                           .max_steps = 10};
    unsigned char *bytes = malloc(size - 1);
    struct session_summary summary;
    struct dm2_error err = {0};
    socket_ignore_sigpipe();
    (void)fcntl(fd[0], F_SETFL, O_NONBLOCK);
    (void)fcntl(fd[1], F_SETFL, O_NONBLOCK);
    if (bytes != NULL) {
        memcpy(bytes, data + 1, size - 1);
        mend_headers(bytes, size - 1);
        if (write(fd[1], bytes, size - 1) > 0 && data[0] / 2 % 2 == 1)
            stand_outside(fd[0], &options);
        else if (shutdown(fd[1], SHUT_WR) == 0)
            (void)server_session(fd[0], "fuzz", &options, &summary, &err);
        else
            (void)close(fd[0]);
    } else {
        (void)close(fd[0]);
    }
    (void)close(fd[1]);
    free(bytes);
    return 0;
}
