/* One poll for everybody: the connection that the server waits for, the listener, and those visitors that owe something.
 *
 * What a visitor wants is seen from the header of its first message, which is looked at and not taken: a client's bytes
 * stay where they are until its session reads them. Clients are not polled any more, so that what they sent wakes nobody;
 * neither is a visitor whose few bytes do not tell yet, which is looked at again every 50 ms instead. A client that has
 * closed, or whose first message is not there to its end in time, loses its place.
 *
 * Where a connection could not be taken, for want of descriptors for instance, it still makes the listener readable: that
 * one is left alone for 100 ms then, so that the wait for the session's client is none that spins.
 *
 * Everything is sent with a deadline of now: it is small and the connection is fresh, so it goes or the visitor is none.
 * A visitor that is refused gets the same words as in a session, whatever the reason; the log has the reason. */
#include "dm2/dist/lobby.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "dm2/base/clock.h"
#include "dm2/base/hmac.h"
#include "dm2/base/machine.h"
#include "dm2/dist/messages.h"

static const double VAGUE_SECONDS = 0.05, DEAF_SECONDS = 0.1;

enum { TYPE_AT = 6 }; /* in the header of a frame */

void lobby_open(struct lobby *l, int listener, const struct server_options *options, server_log log, void *log_context)
{
    *l = (struct lobby){.options = options, .listener = listener, .log = log, .log_context = log_context};
}

static void say(const struct lobby *l, enum server_event event, const char *peer, const char *line)
{
    if (l->log != NULL)
        l->log(l->log_context, event, peer, line);
}

static void leave(struct lobby *l, size_t k)
{
    memmove(&l->visitors[k], &l->visitors[k + 1], (--l->n - k) * sizeof l->visitors[0]);
}

static enum dm2_status send_out(struct lobby *l, struct visitor *v, enum message_type type, struct dm2_error *err)
{
    if (l->out.failed)
        return dm2_fail(err, DM2_MEMORY, "no memory for a message");
    return channel_send(&v->channel, (uint8_t)type, 0, l->out.data, l->out.length, deadline_in(0, -1), err);
}

static void refuse(struct lobby *l, size_t k, const char *why)
{
    struct visitor *v = &l->visitors[k];
    struct error_message m = {.status = DM2_PROTOCOL, .text = REFUSAL_TEXT};
    bytes_clear(&l->out);
    message_put_error(&l->out, &m);
    (void)send_out(l, v, MESSAGE_ERROR, NULL);
    say(l, SERVER_FAILED, v->channel.name, why);
    channel_hang_up(&v->channel, deadline_in(0, -1));
    leave(l, k);
}

void lobby_close(struct lobby *l)
{
    while (l->n > 0)
        channel_close(&l->visitors[--l->n].channel);
    bytes_free(&l->out);
}

/* --- who asks for the status -------------------------------------------------------------------------------
 */

static size_t clients(const struct lobby *l)
{
    size_t n = 0;
    for (size_t k = 0; k < l->n; k++)
        n += l->visitors[k].kind == VISITOR_CLIENT;
    return n;
}

static enum dm2_status send_report(struct lobby *l, struct visitor *v, struct dm2_error *err)
{
    const struct lobby_business *b = &l->business;
    struct report_message m = {.busy = b->peer != NULL, .load = machine_load(), .cores = machine_cores()};
    (void)snprintf(m.version, sizeof m.version, "%s", l->options->version);
    if (m.busy) {
        (void)snprintf(m.peer, sizeof m.peer, "%s", b->peer);
        (void)snprintf(m.deck, sizeof m.deck, "%s", b->session->deck);
        m.seconds = clock_now() - b->since;
        m.rank = b->session->rank < 0 ? 0 : b->session->rank;
        m.ranks = b->session->rank < 0 ? 0 : b->session->ranks;
        m.step = b->session->steps;
    }
    m.waiting = (uint32_t)clients(l);
    bytes_clear(&l->out);
    message_put_report(&l->out, &m);
    return send_out(l, v, MESSAGE_REPORT, err);
}

static enum dm2_status send_challenge(struct lobby *l, struct visitor *v, struct dm2_error *err)
{
    enum dm2_status status = auth_nonce(v->nonces.server, err);
    bytes_clear(&l->out);
    bytes_put_raw(&l->out, v->nonces.server, AUTH_NONCE);
    v->kind = VISITOR_PROVES;
    return status == DM2_OK ? send_out(l, v, MESSAGE_CHALLENGE, err) : status;
}

static enum dm2_status admit(struct lobby *l, struct visitor *v, const unsigned char proof[AUTH_CODE],
                             struct dm2_error *err)
{
    const struct auth_key *key = l->options->key;
    unsigned char code[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    auth_code(key, AUTH_ASKER, PROTOCOL_VERSION, &v->nonces, code);
    if (!hmac_equal(code, proof, AUTH_CODE))
        return dm2_fail(err, DM2_PROTOCOL, "who asks for the status has another key");
    auth_code(key, AUTH_SERVER, PROTOCOL_VERSION, &v->nonces, code);
    bytes_clear(&l->out);
    bytes_put_raw(&l->out, code, AUTH_CODE);
    enum dm2_status status = send_out(l, v, MESSAGE_GRANT, err);
    auth_session_key(key, AUTH_CLIENT, PROTOCOL_VERSION, &v->nonces, in);
    auth_session_key(key, AUTH_SERVER, PROTOCOL_VERSION, &v->nonces, out);
    channel_use_keys(&v->channel, in, out);
    return status == DM2_OK ? send_report(l, v, err) : status;
}

/* What has come from a visitor that asks. *over: it has its answer. */
static enum dm2_status attend(struct lobby *l, struct visitor *v, bool *over, struct dm2_error *err)
{
    bool complete;
    struct frame f;
    char name[16];
    enum dm2_status status = channel_receive_some(&v->channel, LIMIT_AUTH, &complete, &f, err);
    *over = false;
    if (status != DM2_OK || !complete)
        return status;
    enum message_type due = v->kind == VISITOR_ASKS ? MESSAGE_STATUS : MESSAGE_PROOF;
    if (f.type != due || f.length != AUTH_NONCE) /* as long as AUTH_CODE */
        return dm2_fail(err, DM2_PROTOCOL, "who asks for the status sent a %s message of %zu bytes",
                        message_name(f.type, name), f.length);
    *over = v->kind == VISITOR_PROVES || l->options->key == NULL;
    if (v->kind == VISITOR_PROVES)
        return admit(l, v, f.payload, err);
    memcpy(v->nonces.client, f.payload, AUTH_NONCE);
    return l->options->key == NULL ? send_report(l, v, err) : send_challenge(l, v, err);
}

/* --- who has not said what it wants ------------------------------------------------------------------------
 */

/* What cannot become a session is told apart only while the server is busy: otherwise the session says what was wrong,
 * also of one that is vague at the second look. */
static const char *look_at(struct lobby *l, struct visitor *v)
{
    unsigned char head[TYPE_AT + 1], magic[4];
    const struct frame_header none = {.version = PROTOCOL_VERSION};
    unsigned char own[FRAME_HEADER];
    size_t got;
    int closed;
    frame_header_encode(&none, own);
    memcpy(magic, own, sizeof magic);
    bool broken = socket_peek(v->channel.fd, head, sizeof head, &got, &closed, NULL) != DM2_OK || closed;
    bool stranger = memcmp(head, magic, got < sizeof magic ? got : sizeof magic) != 0;
    bool still = v->vague;
    v->vague = got > 0 && got < sizeof head && !stranger && !broken;
    if ((broken || stranger) && l->business.peer != NULL)
        return broken ? "closed the connection" : "does not speak dm2's protocol";
    if (got == sizeof head && !stranger && head[TYPE_AT] == MESSAGE_STATUS)
        v->kind = VISITOR_ASKS;
    else if (broken || stranger || got == sizeof head || (still && v->vague && l->business.peer == NULL)) {
        if (l->business.peer != NULL && clients(l) >= LOBBY_CLIENTS)
            return "refused: as many clients wait as may";
        v->kind = VISITOR_CLIENT;
    }
    return NULL;
}

/* Is the first message of a client there to its end? It is looked at, not taken. */
static bool has_first_message(const struct visitor *v)
{
    unsigned char bytes[FRAME_HEADER + LIMIT_HELLO];
    struct frame_header h;
    size_t got;
    int closed;
    if (socket_peek(v->channel.fd, bytes, sizeof bytes, &got, &closed, NULL) != DM2_OK || got < FRAME_HEADER)
        return false;
    (void)frame_header_decode(bytes, PROTOCOL_VERSION, LIMIT_HELLO, &h);
    return h.length <= got - FRAME_HEADER;
}

/* Takes one connection, if one is there. */
static enum dm2_status take_visitor(struct lobby *l, struct dm2_error *err)
{
    char peer[SOCKET_NAME];
    int fd = -1;
    enum dm2_status status = socket_accept(l->listener, deadline_in(0, -1), &fd, peer, err);
    if (status == DM2_TIMEOUT || fd < 0) {
        l->deaf_until = clock_now() + DEAF_SECONDS;
        return status == DM2_TIMEOUT ? DM2_OK : status;
    }
    struct visitor *v = &l->visitors[l->n++];
    *v = (struct visitor){.kind = VISITOR_NEW, .until = clock_now() + l->options->handshake};
    channel_open(&v->channel, fd, PROTOCOL_VERSION, peer);
    if (l->options->allow != NULL && !allow_peer(l->options->allow, fd))
        refuse(l, l->n - 1, "refused: its address is not among those of --allow");
    return DM2_OK;
}

/* --- all together ------------------------------------------------------------------------------------------
 */

/* Goes through the visitors once. */
static void make_rounds(struct lobby *l)
{
    for (size_t k = 0; k < l->n;) {
        struct visitor *v = &l->visitors[k];
        struct dm2_error err = {0};
        bool over = false;
        const char *why = v->gone ? "closed the connection" : v->kind == VISITOR_NEW ? look_at(l, v) : NULL;
        if (why == NULL && v->kind == VISITOR_CLIENT && !v->whole)
            v->whole = has_first_message(v);
        if (why == NULL && (v->kind == VISITOR_ASKS || v->kind == VISITOR_PROVES) &&
            attend(l, v, &over, &err) != DM2_OK)
            why = err.text;
        if (why == NULL && !over && !v->whole && clock_now() >= v->until)
            why = "no answer in time";
        if (why != NULL) {
            refuse(l, k, why);
        } else if (over) {
            say(l, SERVER_CONNECTED, v->channel.name, "asked for the status");
            channel_hang_up(&v->channel, deadline_in(0, -1));
            leave(l, k);
        } else {
            k++;
        }
    }
}

/* The time by which somebody has to be looked at who may not have sent anything. */
static double next_round(const struct lobby *l, double until)
{
    for (size_t k = 0; k < l->n; k++) {
        const struct visitor *v = &l->visitors[k];
        if (!v->whole && v->until < until)
            until = v->until;
        if (v->vague && v->kind == VISITOR_NEW && clock_now() + VAGUE_SECONDS < until)
            until = clock_now() + VAGUE_SECONDS;
    }
    return until;
}

enum lobby_wake { WAKE_NONE, WAKE_FD, WAKE_CANCEL, WAKE_BROKEN };

/* One poll, and what follows from it; fd may be -1. */
static enum lobby_wake turn(struct lobby *l, int fd, struct deadline until, struct dm2_error *err)
{
    struct pollfd polls[LOBBY_MOST + 3];
    nfds_t n = 0;
    polls[n++] = (struct pollfd){.fd = fd, .events = POLLIN};
    polls[n++] = (struct pollfd){.fd = until.cancel, .events = POLLIN};
    bool deaf = clock_now() < l->deaf_until;
    polls[n++] = (struct pollfd){.fd = l->n < LOBBY_MOST && !deaf ? l->listener : -1, .events = POLLIN};
    for (size_t k = 0; k < l->n; k++) {
        const struct visitor *v = &l->visitors[k];
        polls[n++] = (struct pollfd){.fd = v->kind == VISITOR_NEW && v->vague ? -1 : v->channel.fd,
                                     .events = v->kind == VISITOR_CLIENT ? SOCKET_ENDED : POLLIN};
    }
    double next = next_round(l, deaf && l->deaf_until < until.at ? l->deaf_until : until.at), left = next - clock_now();
    int ready = socket_poll(polls, n, left <= 0 ? 0 : left > 1e6 ? 1000000000 : (int)ceil(left * 1000));
    if (ready < 0 && errno != EINTR && errno != EAGAIN) {
        (void)dm2_fail(err, DM2_NET, "poll: %s", strerror(errno));
        return WAKE_BROKEN;
    }
    bool more = ready > 0 && polls[2].revents != 0;
    for (size_t k = 0; k < l->n; k++)
        l->visitors[k].gone = ready > 0 && l->visitors[k].kind == VISITOR_CLIENT && polls[3 + k].revents != 0;
    if (ready > 0 && polls[1].revents != 0)
        return WAKE_CANCEL;
    if (more && take_visitor(l, err) != DM2_OK)
        return WAKE_BROKEN;
    make_rounds(l);
    return ready > 0 && polls[0].revents != 0 ? WAKE_FD : WAKE_NONE;
}

bool lobby_wait(struct lobby *l, int fd, struct deadline until)
{
    enum lobby_wake wake = WAKE_NONE;
    while (wake == WAKE_NONE && clock_now() < until.at)
        wake = turn(l, fd, until, NULL);
    return wake == WAKE_FD;
}

/* The first client in the order of coming. */
static bool take_client(struct lobby *l, int *fd, char peer[SOCKET_NAME])
{
    for (size_t k = 0; k < l->n; k++) {
        struct visitor *v = &l->visitors[k];
        if (v->kind != VISITOR_CLIENT)
            continue;
        *fd = v->channel.fd;
        (void)snprintf(peer, SOCKET_NAME, "%s", v->channel.name);
        v->channel.fd = -1;
        channel_close(&v->channel);
        leave(l, k);
        return true;
    }
    return false;
}

enum dm2_status lobby_next(struct lobby *l, struct deadline until, int *fd, char peer[SOCKET_NAME],
                           struct dm2_error *err)
{
    l->business = (struct lobby_business){0};
    while (!take_client(l, fd, peer)) {
        enum lobby_wake wake = turn(l, -1, until, err);
        if (wake == WAKE_CANCEL)
            return dm2_fail(err, DM2_INTERRUPTED, "asked to end by a signal");
        if (wake == WAKE_BROKEN)
            return DM2_NET;
        if (clock_now() >= until.at)
            return dm2_fail(err, DM2_TIMEOUT, "no client came in time");
    }
    return DM2_OK;
}
