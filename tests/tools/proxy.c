/* A TCP proxy of 127.0.0.1 between dm2-client and its servers that injects faults.
 *
 *     proxy [--fault KIND,SERVER,DIRECTION,FRAME,BYTE,ARG]... PORT...
 *
 * Prints one line with the ports that stand for the servers' PORTs, and one line per fault when the fault has
 * happened. A line of standard input names a process: "K PID" is the process of server K from 0, or of the
 * client where K is 8. The program ends with standard input.
 *
 * The proxy follows the frames of docs/protocol.md as a correct peer sends them. A fault happens in the
 * FRAME-th frame (from 0) of SERVER's connections in DIRECTION (up: to the server), counted from the fault
 * before it, at byte BYTE modulo the frame's length. The frame is collected whole, then changed:
 *
 *     reset     the bytes before BYTE go on, then both connections are reset
 *     halfclose the bytes before BYTE go on, then the end of the stream; the other direction stays open
 *     truncate  the bytes before BYTE go on, then both connections close in order
 *     delay     the rest, and all bytes after it, come ARG ms later
 *     silence   the rest never comes, nor any other byte in either direction
 *     slices    ARG bytes from BYTE on come one by one
 *     flip      one bit is turned
 *     drop      ARG bytes are left out
 *     double    ARG bytes come twice; at byte 0 the whole frame comes twice
 *     swap      the two halves of the rest change places; at byte 0 the frame comes after the next one
 *     miscount  in a STEP without key, one element too many, with the right checksum
 *     kill, stop                 SIGKILL, or SIGSTOP and ARG ms later SIGCONT, to the server
 *     kill-client, stop-client   the same to the client */
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "dm2/base/clock.h"
#include "dm2/base/crc32c.h"

enum { SERVERS = 8, FAULTS = 8, CONNS = 64, HEADER = 16, TAG = 16, CHUNK = 65536 };
enum { STEP = 7, PROOF = 22, GRANT = 23, OWNED_AT = 9 };

/* An array of bytes that grows. */
struct store {
    unsigned char *data;
    size_t n, cap;
};

/* One direction of a connection. */
struct stream {
    int server, direction;      /* 1: up */
    unsigned char head[HEADER]; /* header of the frame that comes in */
    size_t have, total;         /* bytes of that frame: those that have come, and all */
    bool keyed;
    struct store frame; /* the frame of a fault, as far as it has come */
    int fault;          /* index of that fault; -1: none */
    struct store later; /* a frame that goes out after the next one */
    struct store out;
    size_t slices;   /* bytes that still go one by one */
    double held;     /* clock_now() before which nothing goes out */
    bool eof, ended; /* end of the input, and of the output */
    bool deaf, shut; /* input is discarded; the output is closed */
};

struct conn {
    bool used, dead;
    int fd[2]; /* client, server; that of the server is -1 until the connection stands */
    double retry, give_up;
    struct stream stream[2]; /* down, up */
};

struct fault {
    char kind[16];
    int server, direction, frame;
    unsigned long byte, arg;
};

static struct conn conns[CONNS];
static struct fault faults[FAULTS];
static int n_faults, next_fault, n_servers;
static int listeners[SERVERS], ports[SERVERS];
static pid_t pids[SERVERS + 1];
static int counts[SERVERS][2]; /* frames since the last fault */
static struct {
    pid_t pid;
    double at;
} sleepers[FAULTS];
static int n_sleepers;

static void die(const char *what)
{
    (void)fprintf(stderr, "proxy: %s: %s\n", what, strerror(errno));
    exit(2);
}

static void append_bytes(struct store *s, const void *data, size_t n)
{
    if (s->n + n > s->cap) {
        s->cap = 2 * (s->n + n);
        s->data = realloc(s->data, s->cap);
        if (s->data == NULL)
            die("memory");
    }
    if (n > 0)
        memcpy(s->data + s->n, data, n);
    s->n += n;
}

static struct sockaddr_in local_address(int port)
{
    struct sockaddr_in a;
    memset(&a, 0, sizeof a);
    a.sin_family = AF_INET;
    a.sin_port = htons((uint16_t)port);
    a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return a;
}

static void set_options(int fd)
{
    int on = 1;
    (void)fcntl(fd, F_SETFL, O_NONBLOCK);
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

/* Writes the bytes that the connection takes; false where the connection is broken. */
static bool flush_stream(struct conn *c, struct stream *s)
{
    int fd = c->fd[s->direction];
    while (s->out.n > 0 && fd >= 0 && clock_now() >= s->held) {
        size_t want = s->slices > 0 ? 1 : s->out.n;
        ssize_t k = write(fd, s->out.data, want);
        if (k < 0)
            return errno == EAGAIN || errno == EINTR;
        s->out.n -= (size_t)k;
        memmove(s->out.data, s->out.data + k, s->out.n);
        if (s->slices > 0) {
            s->slices--;
            return true; /* the next byte follows after the next poll */
        }
    }
    if (s->out.n == 0 && s->ended && !s->shut && fd >= 0) {
        (void)shutdown(fd, SHUT_WR);
        s->shut = true;
    }
    return true;
}

static void close_conn(struct conn *c, bool reset)
{
    struct linger now = {1, 0};
    for (int k = 0; k < 2; k++) {
        if (c->fd[k] >= 0 && reset)
            (void)setsockopt(c->fd[k], SOL_SOCKET, SO_LINGER, &now, sizeof now);
        if (c->fd[k] >= 0)
            (void)close(c->fd[k]);
        free(c->stream[k].out.data);
        free(c->stream[k].frame.data);
        free(c->stream[k].later.data);
    }
    *c = (struct conn){0};
}

static void print_fault(const struct fault *f, const struct stream *s)
{
    (void)printf("injected %s: server %d, %s, type %d, %zu bytes\n", f->kind, f->server,
                 s->direction ? "up" : "down", s->head[6], s->total);
    (void)fflush(stdout);
}

/* Reads one line of standard input; false at its end. */
static bool read_pid(void)
{
    char line[32] = {0};
    size_t k = 0;
    int who;
    long pid;
    while (k + 1 < sizeof line && read(STDIN_FILENO, line + k, 1) == 1 && line[k] != '\n')
        k++;
    if (line[k] != '\n' || sscanf(line, "%d %ld", &who, &pid) != 2 || who < 0 || who > SERVERS)
        return false;
    pids[who] = (pid_t)pid;
    return true;
}

/* Sends the signal of a fault; false where the process has ended. */
static bool send_signal(const struct fault *f)
{
    bool client = strstr(f->kind, "-client") != NULL, stop = strncmp(f->kind, "stop", 4) == 0;
    int who = client ? SERVERS : f->server;
    while (pids[who] == 0 && read_pid())
        continue;
    if (pids[who] <= 1 || kill(pids[who], stop ? SIGSTOP : SIGKILL) != 0)
        return false;
    if (stop) {
        sleepers[n_sleepers].pid = pids[who];
        sleepers[n_sleepers++].at = clock_now() + 1e-3 * (double)f->arg;
    } else {
        pids[who] = -1; /* until the id of its successor is read */
    }
    return true;
}

/* Counts one element too many in a STEP, with the right checksum. False where the frame is no STEP. */
static bool miscount_elements(unsigned char *frame, size_t n)
{
    if (frame[6] != STEP || n < HEADER + OWNED_AT + 8)
        return false;
    frame[HEADER + OWNED_AT]++;
    uint32_t crc = crc32c(crc32c(0, frame, HEADER - 4), frame + HEADER, n - HEADER);
    for (int k = 0; k < 4; k++)
        frame[HEADER - 4 + k] = (unsigned char)(crc >> 8 * k & 0xff);
    return true;
}

/* Injects a fault into a complete frame and passes the rest on. False where the frame does not suit. */
static bool inject_fault(struct conn *c, struct stream *s, const struct fault *f)
{
    unsigned char *d = s->frame.data;
    size_t n = s->frame.n, at = f->byte % n, some = f->arg < n - at ? f->arg : n - at, half = (n - at) / 2;
    const char *k = f->kind;
    if (strncmp(k, "kill", 4) == 0 || strncmp(k, "stop", 4) == 0) {
        append_bytes(&s->out, d, n);
        return send_signal(f);
    } else if (strcmp(k, "flip") == 0) {
        d[at] ^= (unsigned char)(1u << f->arg % 8);
        append_bytes(&s->out, d, n);
    } else if (strcmp(k, "drop") == 0) {
        append_bytes(&s->out, d, at);
        append_bytes(&s->out, d + at + some, n - at - some);
    } else if (strcmp(k, "double") == 0) {
        append_bytes(&s->out, d, at == 0 ? n : at + some);
        append_bytes(&s->out, d + at, n - at);
    } else if (strcmp(k, "swap") == 0 && at == 0) {
        append_bytes(&s->later, d, n);
    } else if (strcmp(k, "swap") == 0) {
        if (memcmp(d + at, d + n - half, half) == 0) {
            append_bytes(&s->out, d, n);
            return false;
        }
        append_bytes(&s->out, d, at);
        append_bytes(&s->out, d + n - half, half);
        append_bytes(&s->out, d + at, n - at - half);
    } else if (strcmp(k, "slices") == 0) {
        append_bytes(&s->out, d, n);
        s->slices = f->arg;
    } else if (strcmp(k, "miscount") == 0) {
        bool done = miscount_elements(d, n);
        append_bytes(&s->out, d, n);
        return done;
    } else {
        append_bytes(&s->out, d, at);
        (void)flush_stream(c, s);
        if (strcmp(k, "delay") == 0) {
            s->held = clock_now() + 1e-3 * (double)f->arg;
            append_bytes(&s->out, d + at, n - at);
        } else if (strcmp(k, "silence") == 0) {
            for (int i = 0; i < 2; i++)
                c->stream[i].held = 1e300;
        } else if (strcmp(k, "halfclose") == 0) {
            s->ended = s->deaf = true;
        } else { /* reset, truncate: the caller closes */
            c->dead = true;
        }
    }
    return true;
}

/* Handles a frame with a fault, which has come whole. */
static void finish_frame(struct conn *c, struct stream *s)
{
    const struct fault *f = &faults[s->fault];
    s->fault = -1;
    if (!inject_fault(c, s, f)) {
        counts[s->server][s->direction] = f->frame; /* the fault waits for the next frame */
    } else {
        print_fault(f, s);
        next_fault++;
        memset(counts, 0, sizeof counts);
        if (c->dead) {
            (void)flush_stream(c, s);
            bool reset = strcmp(f->kind, "reset") == 0;
            close_conn(c, reset);
            return;
        }
    }
    s->frame.n = 0;
}

/* Handles a complete header: looks for a fault for this frame. */
static void start_frame(struct stream *s)
{
    s->total = HEADER + (s->keyed ? TAG : 0);
    for (int k = 0; k < 4; k++)
        s->total += (size_t)s->head[8 + k] << 8 * k;
    if (s->head[6] == (s->direction ? PROOF : GRANT))
        s->keyed = true;
    const struct fault *f = next_fault < n_faults ? &faults[next_fault] : NULL;
    bool mine = f != NULL && f->server == s->server && f->direction == s->direction;
    s->fault = mine && counts[s->server][s->direction] >= f->frame ? next_fault : -1;
    if (s->fault < 0)
        counts[s->server][s->direction]++;
}

/* Takes bytes that have come in. */
static void feed_stream(struct conn *c, struct stream *s, const unsigned char *data, size_t n)
{
    while (n > 0 && c->used && !s->deaf) {
        size_t k = 0;
        if (s->have < HEADER) {
            k = HEADER - s->have < n ? HEADER - s->have : n;
            memcpy(s->head + s->have, data, k);
            s->have += k;
            if (s->have < HEADER)
                return;
            start_frame(s);
            append_bytes(s->fault >= 0 ? &s->frame : &s->out, s->head, HEADER);
        } else {
            k = s->total - s->have < n ? s->total - s->have : n;
            append_bytes(s->fault >= 0 ? &s->frame : &s->out, data, k);
            s->have += k;
        }
        data += k;
        n -= k;
        if (s->have < s->total || s->have < HEADER)
            continue;
        s->have = 0;
        if (s->fault >= 0) {
            finish_frame(c, s);
        } else if (s->later.n > 0) {
            append_bytes(&s->out, s->later.data, s->later.n);
            s->later.n = 0;
        }
    }
}

static void take_connection(int server)
{
    int fd = accept(listeners[server], NULL, NULL);
    for (int k = 0; k < CONNS && fd >= 0; k++) {
        struct conn *c = &conns[k];
        if (c->used)
            continue;
        *c = (struct conn){.used = true, .fd = {fd, -1}, .give_up = clock_now() + 1};
        for (int d = 0; d < 2; d++)
            c->stream[d] = (struct stream){.server = server, .direction = d, .fault = -1};
        set_options(fd);
        return;
    }
    if (fd >= 0)
        (void)close(fd);
}

/* Connects to the server, which may be restarting. */
static void try_server(struct conn *c)
{
    struct sockaddr_in a = local_address(ports[c->stream[0].server]);
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    if (fd >= 0 && connect(fd, (struct sockaddr *)&a, sizeof a) == 0) {
        set_options(fd);
        c->fd[1] = fd;
        return;
    }
    if (fd >= 0)
        (void)close(fd);
    c->retry = clock_now() + 0.02;
    if (clock_now() > c->give_up)
        close_conn(c, true);
}

/* Reads one direction and passes on the bytes that the other end takes. */
static void serve_stream(struct conn *c, struct stream *s, bool readable)
{
    static unsigned char chunk[CHUNK];
    int from = c->fd[1 - s->direction];
    if (readable && !s->eof) {
        ssize_t k = read(from, chunk, sizeof chunk);
        if (k > 0) {
            feed_stream(c, s, chunk, (size_t)k);
        } else if (k == 0) {
            append_bytes(&s->out, s->head, s->have < HEADER ? s->have : 0);
            append_bytes(&s->out, s->frame.data, s->frame.n);
            append_bytes(&s->out, s->later.data, s->later.n);
            s->eof = s->ended = true;
        } else if (errno != EAGAIN && errno != EINTR) {
            close_conn(c, true);
            return;
        }
    }
    if (c->used && !flush_stream(c, s))
        close_conn(c, true);
    else if (c->used && c->stream[0].shut && c->stream[1].shut)
        close_conn(c, false);
}

static void wake_sleepers(bool all)
{
    for (int k = 0; k < n_sleepers; k++)
        if (sleepers[k].pid > 0 && (all || clock_now() >= sleepers[k].at)) {
            (void)kill(sleepers[k].pid, SIGCONT);
            sleepers[k].pid = 0;
        }
}

/* Polls once and handles all connections; false where standard input has ended. */
static bool poll_once(void)
{
    struct pollfd p[1 + SERVERS + 2 * CONNS];
    bool readable[2 * CONNS] = {0};
    int n = 0, wait = n_sleepers > 0 ? 10 : 1000;
    p[n++] = (struct pollfd){.fd = STDIN_FILENO, .events = POLLIN};
    for (int k = 0; k < n_servers; k++)
        p[n++] = (struct pollfd){.fd = listeners[k], .events = POLLIN};
    for (int k = 0; k < CONNS; k++)
        for (int side = 0; side < 2; side++) {
            struct conn *c = &conns[k];
            const struct stream *in = &c->stream[1 - side], *out = &c->stream[side];
            bool held = clock_now() < out->held;
            if (c->used && ((held && out->held < 1e300) || c->fd[1] < 0))
                wait = 5;
            short events = 0;
            if (c->used && c->fd[1] >= 0) {
                /* `in` is the stream that is read from this side */
                events = (short)((in->eof                  ? 0
                                  : in->out.n < 16 * CHUNK ? POLLIN
                                                           : 0) |
                                 (out->out.n > 0 && !held ? POLLOUT : 0));
            }
            p[n++] = (struct pollfd){.fd = events != 0 ? c->fd[side] : -1, .events = events};
        }
    if (poll(p, (nfds_t)n, wait) < 0 && errno != EINTR)
        die("poll");
    wake_sleepers(false);
    for (int k = 0; k < n_servers; k++)
        if (p[1 + k].revents != 0)
            take_connection(k);
    for (int k = 0; k < 2 * CONNS; k++)
        readable[k] = (p[1 + n_servers + k].revents & (POLLIN | POLLHUP | POLLERR)) != 0;
    for (int k = 0; k < CONNS; k++) {
        struct conn *c = &conns[k];
        if (c->used && c->fd[1] < 0 && clock_now() >= c->retry) {
            try_server(c);
            continue;
        }
        for (int d = 0; d < 2 && c->used && c->fd[1] >= 0; d++)
            serve_stream(c, &c->stream[d], readable[2 * k + 1 - d]);
    }
    if (p[0].revents == 0)
        return true;
    return read_pid();
}

static void read_options(int argc, char **argv)
{
    int k = 1;
    for (; k + 1 < argc && strncmp(argv[k], "--", 2) == 0; k += 2) {
        struct fault *f = &faults[n_faults];
        char direction[8];
        if (strcmp(argv[k], "--fault") == 0 && n_faults < FAULTS &&
            sscanf(argv[k + 1], "%15[a-z-],%d,%7[a-z],%d,%lu,%lu", f->kind, &f->server, direction, &f->frame,
                   &f->byte, &f->arg) == 6) {
            f->direction = strcmp(direction, "up") == 0;
            n_faults++;
        } else {
            errno = EINVAL;
            die(argv[k]);
        }
    }
    for (; k < argc && n_servers < SERVERS; k++)
        ports[n_servers++] = (int)strtol(argv[k], NULL, 10);
}

int main(int argc, char **argv)
{
    struct sigaction ignore;
    memset(&ignore, 0, sizeof ignore);
    ignore.sa_handler = SIG_IGN;
    (void)sigaction(SIGPIPE, &ignore, NULL);
    read_options(argc, argv);
    for (int k = 0; k < n_servers; k++) {
        struct sockaddr_in a = local_address(0);
        socklen_t length = sizeof a;
        listeners[k] = socket(AF_INET, SOCK_STREAM, 0);
        if (listeners[k] < 0 || bind(listeners[k], (struct sockaddr *)&a, sizeof a) != 0 ||
            listen(listeners[k], 16) != 0 || getsockname(listeners[k], (struct sockaddr *)&a, &length) != 0)
            die("listen");
        (void)fcntl(listeners[k], F_SETFL, O_NONBLOCK);
        (void)printf("%s%d", k > 0 ? " " : "", ntohs(a.sin_port));
    }
    (void)printf("\n");
    (void)fflush(stdout);
    while (poll_once())
        continue;
    wake_sleepers(true);
    return 0;
}
