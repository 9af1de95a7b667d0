/* One poll for everybody: the connection that the server waits for, the listener, and those visitors that owe
 * something.
 *
 * With a key a visitor proves it here, also while the server is busy, so that only who has it waits for its
 * turn. Without one, what a visitor wants is seen from the header of its first message, which is looked at
 * and not taken: a client's bytes stay where they are until its session reads them. Clients are not polled
 * any more, so that what they sent wakes nobody; neither is a visitor whose few bytes do not tell yet, which
 * is looked at again every 50 ms instead. A client that has closed, or whose first message is not there to
 * its end in time, loses its place.
 *
 * In a full lobby the oldest of those who may be strangers makes room for the next connection as soon as it
 * has had a second. What has come from it by then is read first: a server that computes for longer takes
 * nobody's turn away.
 *
 * Where a connection could not be taken, for want of descriptors for instance, it still makes the listener
 * readable: that one is left alone for 100 ms then, so that the wait for the session's client is none that
 * spins.
 *
 * A server that is free and has a client at hand turns to it before it says anything to those behind: it is
 * not free.
 *
 * Everything is sent with a deadline of now: it is small and the connection is fresh, so it goes or the
 * visitor is none. A visitor that is refused gets the same words whatever the reason; the log has the reason.
 */
#include "lobby.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "dm2/base/clock.h"
#include "dm2/base/hmac.h"
#include "dm2/base/machine.h"
#include "dm2/cluster/messages.h"

static const double VAGUE_SECONDS = 0.05, DEAF_SECONDS = 0.1;

/* How long to look for the client's next message before sleeping. A processor whose server sleeps falls
 * asleep too, and waking it up takes longer than all that the client does in a step; one that looks lets the
 * client run at once. */
static const double LOOK_SECONDS = 2e-3;

enum { TYPE_AT = 6 }; /* in the header of a frame */

void lobby_open(struct lobby *l, int listener, const struct server_options *options, server_log log,
                void *log_context)
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

static enum dm2_status send_out(struct lobby *l, struct visitor *v, enum message_type type,
                                struct dm2_error *err)
{
    if (l->out.failed)
        return dm2_fail(err, DM2_MEMORY, "no memory for a message");
    return channel_send(&v->channel, (uint8_t)type, 0, l->out.data, l->out.length, deadline_in(0, -1), err);
}

/* `told` is what the visitor gets to know, `why` is for the log. */
static void send_away(struct lobby *l, size_t k, enum dm2_status status, const char *told, const char *why)
{
    struct visitor *v = &l->visitors[k];
    struct error_message m = {.status = status};
    (void)snprintf(m.text, sizeof m.text, "%s", told);
    bytes_clear(&l->out);
    message_put_error(&l->out, &m);
    (void)send_out(l, v, MESSAGE_ERROR, NULL);
    say(l, SERVER_FAILED, v->channel.name, why);
    channel_hang_up(&v->channel, deadline_in(0, -1));
    leave(l, k);
}

static void refuse(struct lobby *l, size_t k, const char *why)
{
    send_away(l, k, DM2_PROTOCOL, REFUSAL_TEXT, why);
}

void lobby_close(struct lobby *l)
{
    while (l->n > 0)
        channel_close(&l->visitors[--l->n].channel);
    bytes_free(&l->out);
}

static size_t clients(const struct lobby *l)
{
    size_t n = 0;
    for (size_t k = 0; k < l->n; k++)
        n += l->visitors[k].kind == VISITOR_CLIENT;
    return n;
}

/* The visitor wants to be served. False: as many wait as may. */
static bool let_wait(const struct lobby *l, struct visitor *v)
{
    if (l->business.peer != NULL && clients(l) >= LOBBY_CLIENTS)
        return false;
    v->kind = VISITOR_CLIENT;
    return true;
}

/* --- who asks for the status, and who has to prove the key --- */

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

static enum dm2_status send_grant(struct lobby *l, struct visitor *v, struct dm2_error *err)
{
    const struct auth_key *key = l->options->key;
    unsigned char code[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    auth_code(key, AUTH_SERVER, PROTOCOL_VERSION, &v->nonces, code);
    bytes_clear(&l->out);
    bytes_put_raw(&l->out, code, AUTH_CODE);
    enum dm2_status status = send_out(l, v, MESSAGE_GRANT, err);
    auth_session_key(key, AUTH_CLIENT, PROTOCOL_VERSION, &v->nonces, in);
    auth_session_key(key, AUTH_SERVER, PROTOCOL_VERSION, &v->nonces, out);
    channel_use_keys(&v->channel, in, out);
    return status;
}

/* What becomes of a visitor. */
enum turn_out { STAYS, IS_ANSWERED, IS_ONE_TOO_MANY };

/* The visitor proves first: a stranger gets a random number from this server and nothing that depends on the
 * key. */
static enum dm2_status admit(struct lobby *l, struct visitor *v, const unsigned char proof[AUTH_CODE],
                             enum turn_out *what, struct dm2_error *err)
{
    bool asks = v->role == AUTH_ASKER;
    unsigned char code[AUTH_CODE];
    auth_code(l->options->key, v->role, PROTOCOL_VERSION, &v->nonces, code);
    if (!hmac_equal(code, proof, AUTH_CODE))
        return dm2_fail(err, DM2_PROTOCOL, "%s has another key",
                        asks ? "who asks for the status" : "the client");
    *what = asks ? IS_ANSWERED : let_wait(l, v) ? STAYS : IS_ONE_TOO_MANY;
    v->whole = v->kind == VISITOR_CLIENT;
    enum dm2_status status = *what == IS_ONE_TOO_MANY ? DM2_OK : send_grant(l, v, err);
    return status == DM2_OK && asks ? send_report(l, v, err) : status;
}

/* The first message, or the answer to the challenge: a nonce and a code are of one length. */
static enum dm2_status take_message(struct lobby *l, struct visitor *v, const struct frame *f,
                                    enum turn_out *what, struct dm2_error *err)
{
    char name[2][16];
    bool keyed = l->options->key != NULL, proves = v->kind == VISITOR_PROVES,
         asks = f->type == MESSAGE_STATUS;
    const char *who = (proves ? v->role == AUTH_ASKER : asks) ? "who asks for the status" : "the client";
    enum message_type due = proves ? MESSAGE_PROOF : asks || !keyed ? MESSAGE_STATUS : MESSAGE_KNOCK;
    if (f->type != due)
        return dm2_fail(err, DM2_PROTOCOL, "%s sent %s where %s is due", who, message_name(f->type, name[0]),
                        message_name((uint8_t)due, name[1]));
    if (f->length != AUTH_NONCE)
        return dm2_fail(err, DM2_PROTOCOL, "%s sent a %s message of %zu bytes", who,
                        message_name(f->type, name[0]), f->length);
    if (proves)
        return admit(l, v, f->payload, what, err);
    if (!keyed) {
        *what = IS_ANSWERED;
        return send_report(l, v, err);
    }
    v->role = asks ? AUTH_ASKER : AUTH_CLIENT;
    memcpy(v->nonces.client, f->payload, AUTH_NONCE);
    return send_challenge(l, v, err);
}

/* What has come from a visitor that says what it wants, or proves the key. */
static enum dm2_status attend(struct lobby *l, struct visitor *v, enum turn_out *what, struct dm2_error *err)
{
    bool complete;
    struct frame f;
    enum dm2_status status = channel_receive_some(&v->channel, LIMIT_AUTH, &complete, &f, err);
    return status == DM2_OK && complete ? take_message(l, v, &f, what, err) : status;
}

/* --- without a key: who has not said what it wants --- */

/* What cannot become a session is told apart only while the server is busy: otherwise the session says what
 * was wrong, also of one that is vague at the second look. */
static const char *look_at(struct lobby *l, struct visitor *v, enum turn_out *what)
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
    else if ((broken || stranger || got == sizeof head || (still && v->vague && l->business.peer == NULL)) &&
             !let_wait(l, v))
        *what = IS_ONE_TOO_MANY;
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

/* --- all together --- */

static bool is_free(const struct lobby *l)
{
    return l->business.peer == NULL;
}

/* One visitor's turn. Returns why it is refused, or NULL. */
static const char *look_after(struct lobby *l, struct visitor *v, enum turn_out *what, struct dm2_error *err)
{
    const char *why = v->gone ? "closed the connection" : NULL;
    bool keyed = l->options->key != NULL;
    if (why == NULL && v->kind == VISITOR_NEW && !keyed)
        why = look_at(l, v, what);
    if (why == NULL && v->kind == VISITOR_CLIENT && !v->whole)
        v->whole = has_first_message(v);
    if (why == NULL && v->kind != VISITOR_CLIENT && (v->kind != VISITOR_NEW || keyed) &&
        attend(l, v, what, err) != DM2_OK)
        why = err->text;
    if (why == NULL && *what == STAYS && !v->whole && clock_now() >= v->until)
        why = "no answer in time";
    return why;
}

/* Goes through the visitors once. */
static void make_rounds(struct lobby *l)
{
    for (size_t k = 0; k < l->n && (!is_free(l) || clients(l) == 0);) {
        struct visitor *v = &l->visitors[k];
        struct dm2_error err = {0};
        enum turn_out what = STAYS;
        const char *why = look_after(l, v, &what, &err);
        if (why != NULL) {
            refuse(l, k, why);
        } else if (what == IS_ONE_TOO_MANY) {
            send_away(l, k, DM2_NET, "too many clients wait for it already",
                      "refused: as many clients wait as may");
        } else if (what == IS_ANSWERED) {
            say(l, SERVER_CONNECTED, v->channel.name, "asked for the status");
            channel_hang_up(&v->channel, deadline_in(0, -1));
            leave(l, k);
        } else {
            k++;
        }
    }
}

void lobby_enter(struct lobby *l, int fd, const char *peer)
{
    struct visitor *v = &l->visitors[l->n++];
    double now = clock_now();
    *v = (struct visitor){.kind = VISITOR_NEW, .came = now, .until = now + l->options->handshake};
    channel_open(&v->channel, fd, PROTOCOL_VERSION, peer);
}

/* The oldest of those who may be strangers: who has not proved the key, without one who has not said a whole
 * message. */
static size_t oldest_unknown(const struct lobby *l)
{
    size_t k = 0;
    while (k < l->n && l->visitors[k].whole)
        k++;
    return k;
}

/* From when on the lobby has, or makes, room for one more; a time of clock_now(). */
static double room_from(const struct lobby *l)
{
    size_t oldest = oldest_unknown(l);
    double room = l->n < LOBBY_MOST ? 0 : oldest < l->n ? l->visitors[oldest].came + LOBBY_GRACE : INFINITY;
    return fmax(room, l->deaf_until);
}

/* Takes one connection, if one is there. What had come from the visitors has been read. */
static enum dm2_status take_visitor(struct lobby *l, struct dm2_error *err)
{
    char peer[SOCKET_NAME];
    int fd = -1;
    size_t oldest = oldest_unknown(l);
    if (l->n == LOBBY_MOST && oldest < l->n)
        refuse(l, oldest, "no answer while others want to come in");
    if (l->n == LOBBY_MOST)
        return DM2_OK;
    enum dm2_status status = socket_accept(l->listener, deadline_in(0, -1), &fd, peer, err);
    if (status == DM2_TIMEOUT || fd < 0) {
        l->deaf_until = clock_now() + DEAF_SECONDS;
        return status == DM2_TIMEOUT ? DM2_OK : status;
    }
    lobby_enter(l, fd, peer);
    if (l->options->allow != NULL && !allow_peer(l->options->allow, fd))
        refuse(l, l->n - 1, "refused: its address is not among those of --allow");
    return DM2_OK;
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
    double room = room_from(l);
    bool shut = clock_now() < room;
    polls[n++] = (struct pollfd){.fd = fd, .events = POLLIN};
    polls[n++] = (struct pollfd){.fd = until.cancel, .events = POLLIN};
    polls[n++] = (struct pollfd){.fd = shut ? -1 : l->listener, .events = POLLIN};
    for (size_t k = 0; k < l->n; k++) {
        const struct visitor *v = &l->visitors[k];
        polls[n++] = (struct pollfd){.fd = v->kind == VISITOR_NEW && v->vague ? -1 : v->channel.fd,
                                     .events = v->kind == VISITOR_CLIENT ? SOCKET_ENDED : POLLIN};
    }
    double left = next_round(l, shut ? fmin(room, until.at) : until.at) - clock_now();
    int timeout = left <= 0 ? 0 : left > 1e6 ? 1000000000 : (int)ceil(left * 1000);
    int ready = socket_poll(polls, n, timeout, fd >= 0 ? LOOK_SECONDS : 0.0);
    if (ready < 0 && errno != EINTR && errno != EAGAIN) {
        (void)dm2_fail(err, DM2_NET, "poll: %s", strerror(errno));
        return WAKE_BROKEN;
    }
    bool more = ready > 0 && polls[2].revents != 0;
    for (size_t k = 0; k < l->n; k++)
        l->visitors[k].gone = ready > 0 && l->visitors[k].kind == VISITOR_CLIENT && polls[3 + k].revents != 0;
    if (ready > 0 && polls[1].revents != 0)
        return WAKE_CANCEL;
    make_rounds(l);
    more = more && clock_now() >= room_from(l);
    if (more && take_visitor(l, err) != DM2_OK)
        return WAKE_BROKEN;
    if (more)
        make_rounds(l); /* what it wants may be there already */
    return ready > 0 && polls[0].revents != 0 ? WAKE_FD : WAKE_NONE;
}

bool lobby_wait(struct lobby *l, int fd, struct deadline until)
{
    enum lobby_wake wake = WAKE_NONE;
    while (wake == WAKE_NONE && clock_now() < until.at)
        wake = turn(l, fd, until, NULL);
    return wake == WAKE_FD;
}

void lobby_look(struct lobby *l)
{
    (void)turn(l, -1, deadline_in(0, -1), NULL); /* what broke, the next wait finds out */
}

/* The first client in the order of coming. */
static bool take_client(struct lobby *l, struct channel *out)
{
    for (size_t k = 0; k < l->n; k++) {
        if (l->visitors[k].kind != VISITOR_CLIENT)
            continue;
        *out = l->visitors[k].channel;
        leave(l, k);
        return true;
    }
    return false;
}

enum dm2_status lobby_next(struct lobby *l, struct deadline until, struct channel *out, struct dm2_error *err)
{
    l->business = (struct lobby_business){0};
    while (!take_client(l, out)) {
        if (l->listener < 0 && l->n == 0)
            return dm2_fail(err, DM2_PROTOCOL, "who came was refused");
        enum lobby_wake wake = turn(l, -1, until, err);
        if (wake == WAKE_CANCEL)
            return dm2_fail(err, DM2_INTERRUPTED, "asked to end by a signal");
        if (wake == WAKE_BROKEN)
            return DM2_NET;
        if (clock_now() >= until.at && clients(l) == 0)
            return dm2_fail(err, DM2_TIMEOUT, "no client came in time");
    }
    return DM2_OK;
}
