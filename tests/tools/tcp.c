/* The ends of a connection that the tests play themselves.
 *
 *     tcp send PORT     connects to 127.0.0.1, sends standard input, ends its stream, prints the answer
 *     tcp hold PORT     connects, sends HELLO, prints "connected" after WELCOME, and does nothing more
 *                       until standard input ends: a server without a key is busy meanwhile
 *     tcp silent PORT   the same without HELLO and WELCOME
 *     tcp mirror        listens on a free port, prints the port, takes one connection, sends back its
 *                       bytes
 *     tcp answer        listens on a free port, prints the port, takes one connection, sends standard
 *                       input at once, and waits for the other end to close
 *
 * Each ends after 30 seconds. Exit status 0 unless there was no connection. */
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dm2/base/version.h"
#include "dm2/cluster/messages.h"
#include "dm2/engine/self_test.h"
#include "dm2/net/socket.h"

static struct deadline until;

/* Copies standard input to the connection. */
static void send_input(int fd)
{
    char buffer[4096];
    for (;;) {
        ssize_t n = read(STDIN_FILENO, buffer, sizeof buffer);
        struct iovec part = {buffer, n > 0 ? (size_t)n : 0};
        if (n <= 0 || socket_write_all(fd, &part, 1, until, NULL) != DM2_OK)
            return;
    }
}

/* Prints the bytes that come until the other end closes. */
static void print_received(int fd)
{
    char buffer[4096];
    size_t got = 0;
    int closed = 0;
    while (!closed && socket_wait(fd, POLLIN, until, NULL) == DM2_OK &&
           socket_read_some(fd, buffer, sizeof buffer, &got, &closed, NULL) == DM2_OK)
        (void)fwrite(buffer, 1, got, stdout);
}

/* Sends back the bytes that come until the other end closes. */
static void send_back(int fd)
{
    char buffer[4096];
    size_t got = 0;
    int closed = 0;
    while (!closed && socket_wait(fd, POLLIN, until, NULL) == DM2_OK &&
           socket_read_some(fd, buffer, sizeof buffer, &got, &closed, NULL) == DM2_OK) {
        struct iovec part = {buffer, got};
        if (socket_write_all(fd, &part, 1, until, NULL) != DM2_OK)
            return;
    }
}

static int serve_connection(bool mirror)
{
    int listener = -1, fd = -1;
    char bound[SOCKET_NAME], peer[SOCKET_NAME];
    if (socket_listen("127.0.0.1", 0, &listener, bound, NULL) != DM2_OK)
        return 1;
    (void)printf("%s\n", strrchr(bound, ':') + 1);
    (void)fflush(stdout);
    if (socket_accept(listener, until, &fd, peer, NULL) != DM2_OK || fd < 0)
        return 1;
    if (mirror) {
        send_back(fd);
        return 0;
    }
    send_input(fd);
    print_received(fd);
    return 0;
}

/* Sends HELLO. True: WELCOME has come, so that the server's session has begun. */
static bool is_welcome(int fd)
{
    const struct hello_message m = {
        .turn = true, .fingerprint = SELF_TEST_FINGERPRINT, .version = DM2_VERSION};
    struct bytes_writer w = {0};
    struct channel ch;
    struct frame f = {0};
    message_put_hello(&w, &m);
    channel_open(&ch, fd, PROTOCOL_VERSION, "the server");
    bool welcome = channel_send(&ch, MESSAGE_HELLO, 0, w.data, w.length, until, NULL) == DM2_OK &&
                   channel_receive(&ch, LIMIT_HELLO, until, &f, NULL) == DM2_OK && f.type == MESSAGE_WELCOME;
    bytes_free(&w);
    return welcome;
}

int main(int argc, char **argv)
{
    struct dm2_error err = {0};
    int fd = -1;
    until = deadline_in(30, -1);
    socket_ignore_sigpipe();
    if (argc == 2 && (strcmp(argv[1], "answer") == 0 || strcmp(argv[1], "mirror") == 0))
        return serve_connection(strcmp(argv[1], "mirror") == 0);
    if (argc != 3)
        return 2;
    if (socket_connect("127.0.0.1", (int)strtol(argv[2], NULL, 10), until, &fd, &err) != DM2_OK) {
        (void)fprintf(stderr, "%s\n", err.text);
        return 1;
    }
    if (strcmp(argv[1], "hold") == 0 || strcmp(argv[1], "silent") == 0) {
        char waste[256];
        if (argv[1][0] == 'h' && !is_welcome(fd))
            return 1;
        (void)printf("connected\n");
        (void)fflush(stdout);
        while (read(STDIN_FILENO, waste, sizeof waste) > 0)
            continue;
        return 0;
    }
    send_input(fd);
    (void)shutdown(fd, SHUT_WR);
    print_received(fd);
    return 0;
}
