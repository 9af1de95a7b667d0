/* One poll covers all descriptors: the session's client, the listener, and the visitors that may send.
 *
 * With a key a visitor proves the key here, also while the server is busy, so that only visitors with the key
 * wait for their turn. Without a key the header of a visitor's first message shows the visitor's purpose. The
 * header is peeked at and not taken, because the session reads a client's bytes from the first on. HELLO is
 * read here: one that asks is answered by PLACE, one that takes its turn is put back for the session. Clients
 * are polled for the end of their stream alone, so that bytes from them do not wake the server. A visitor
 * whose bytes do not reach the type of the message is not polled either, but peeked at every PARTIAL_SECONDS.
 * A client that has closed, or whose first message is not complete in time, loses its place.
 *
 * In a full lobby the oldest visitor that is not verified makes room for the next connection, LOBBY_GRACE
 * seconds after it came. The bytes of that visitor are read first, so that no visitor loses its place because
 * the server computed for longer.
 *
 * A connection that could not be taken, for want of descriptors for instance, keeps the listener readable.
 * The listener is then not polled for ACCEPT_PAUSE seconds, so that the wait for the session's client does
 * not spin.
 *
 * A free server with a waiting client starts its session before it answers other visitors, because it is busy
 * from then on.
 *
 * A message to a visitor has a deadline of now: the message is short and the connection is fresh, so a
 * connection that does not take it is not a client's. A visitor that is refused gets the same text whatever
 * the reason; the log has the reason. */
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

static const double PARTIAL_SECONDS = 0.05, ACCEPT_PAUSE = 0.1;

/* Seconds for which poll is repeated before it sleeps. A processor whose server sleeps falls asleep, too, and
 * takes longer to wake up than the client takes for its part of a step; a server that repeats poll yields to
 * the client at once. */
static const double LOOK_SECONDS = 2e-3;

enum { TYPE_AT = 6 }; /* byte of the type in the header of a frame */

void lobby_open(struct lobby *l, int listener, const struct server_options *options, server_log log,
                void *log_context)
{
    *l = (struct lobby){.options = options, .listener = listener, .log = log, .log_context = log_context};
}

static void log_event(const struct lobby *l, enum server_event event, const char *peer, const char *line)
{
    if (l->log != NULL)
        l->log(l->log_context, event, peer, line);
}

static void remove_visitor(struct lobby *l, size_t k)
{
    memmove(&l->visitors[k], &l->visitors[k + 1], (--l->n - k) * sizeof l->visitors[0]);
}

static enum dm2_status send_message(struct lobby *l, struct visitor *v, enum message_type type,
                                    struct dm2_error *err)
{
    if (l->out.failed)
        return dm2_fail(err, DM2_MEMORY, "no memory for a message");
    return channel_send(&v->channel, (uint8_t)type, 0, l->out.data, l->out.length, deadline_in(0, -1), err);
}

/* Sends ERROR with the text `told`, logs the reason `why`, and closes the connection. */
static void dismiss_visitor(struct lobby *l, size_t k, enum dm2_status status, const char *told,
                            const char *why)
{
    struct visitor *v = &l->visitors[k];
    struct error_message m = {.status = status};
    (void)snprintf(m.text, sizeof m.text, "%s", told);
    bytes_clear(&l->out);
    message_put_error(&l->out, &m);
    (void)send_message(l, v, MESSAGE_ERROR, NULL);
    log_event(l, SERVER_FAILED, v->channel.name, why);
    channel_hang_up(&v->channel, deadline_in(0, -1));
    remove_visitor(l, k);
}

static void refuse_visitor(struct lobby *l, size_t k, const char *why)
{
    dismiss_visitor(l, k, DM2_PROTOCOL, REFUSAL_TEXT, why);
}

void lobby_close(struct lobby *l)
{
    while (l->n > 0)
        channel_close(&l->visitors[--l->n].channel);
    bytes_free(&l->out);
}

/* The clients that wait for their turn. */
static size_t count_clients(const struct lobby *l)
{
    size_t n = 0;
    for (size_t k = 0; k < l->n; k++)
        n += l->visitors[k].kind == VISITOR_CLIENT;
    return n;
}

static bool has_place(const struct visitor *v)
{
    return v->kind == VISITOR_CLIENT || (v->kind == VISITOR_PLACED && v->verified);
}

/* The clients with a place: those that wait for their turn here, or at another server first. */
static size_t count_places(const struct lobby *l)
{
    size_t n = 0;
    for (size_t k = 0; k < l->n; k++)
        n += has_place(&l->visitors[k]);
    return n;
}

/* Makes a visitor VISITOR_PLACED or VISITOR_CLIENT. False where LOBBY_CLIENTS others have a place. */
static bool give_place(const struct lobby *l, struct visitor *v, enum visitor_kind kind)
{
    if (!has_place(v) && count_places(l) >= LOBBY_CLIENTS)
        return false;
    v->kind = kind;
    return true;
}

/* --- status and proof of the key --- */

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
    m.waiting = (uint32_t)count_places(l);
    bytes_clear(&l->out);
    message_put_report(&l->out, &m);
    return send_message(l, v, MESSAGE_REPORT, err);
}

static enum dm2_status send_challenge(struct lobby *l, struct visitor *v, struct dm2_error *err)
{
    enum dm2_status status = auth_nonce(v->nonces.server, err);
    bytes_clear(&l->out);
    bytes_put_raw(&l->out, v->nonces.server, AUTH_NONCE);
    v->kind = VISITOR_PROVES;
    return status == DM2_OK ? send_message(l, v, MESSAGE_CHALLENGE, err) : status;
}

static enum dm2_status send_grant(struct lobby *l, struct visitor *v, struct dm2_error *err)
{
    const struct auth_key *key = l->options->key;
    unsigned char code[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    auth_code(key, AUTH_SERVER, PROTOCOL_VERSION, &v->nonces, code);
    bytes_clear(&l->out);
    bytes_put_raw(&l->out, code, AUTH_CODE);
    enum dm2_status status = send_message(l, v, MESSAGE_GRANT, err);
    auth_session_key(key, AUTH_CLIENT, PROTOCOL_VERSION, &v->nonces, in);
    auth_session_key(key, AUTH_SERVER, PROTOCOL_VERSION, &v->nonces, out);
    channel_use_keys(&v->channel, in, out);
    return status;
}

enum visit_result {
    VISIT_GOES_ON,
    VISIT_ANSWERED, /* REPORT is sent: the connection closes */
    VISIT_SURPLUS   /* a client beyond LOBBY_CLIENTS */
};

/* --- HELLO: the place of a client --- */

static enum dm2_status send_place(struct lobby *l, struct visitor *v, struct dm2_error *err)
{
    const struct lobby_business *b = &l->business;
    struct place_message m = {.before = (uint32_t)count_clients(l) + (b->peer != NULL)};
    unsigned char random[AUTH_NONCE];
    enum dm2_status status = l->named ? DM2_OK : auth_nonce(random, err);
    if (status != DM2_OK)
        return status;
    if (!l->named)
        memcpy(l->id, random, SERVER_ID);
    l->named = true;
    memcpy(m.id, l->id, SERVER_ID);
    if (b->peer != NULL) {
        (void)snprintf(m.peer, sizeof m.peer, "%s", b->peer);
        (void)snprintf(m.deck, sizeof m.deck, "%s", b->session->deck);
        m.step = b->session->steps;
    }
    bytes_clear(&l->out);
    message_put_place(&l->out, &m);
    return send_message(l, v, MESSAGE_PLACE, err);
}

/* Answers a HELLO that asks. Every other message is left to the session, which reports a fault. */
static enum dm2_status take_hello(struct lobby *l, struct visitor *v, const struct frame *f,
                                  enum visit_result *result, struct dm2_error *err)
{
    struct bytes_reader r = bytes_reader_of(f->payload, f->length);
    struct hello_message hello;
    message_get_hello(&r, &hello);
    bool asks = f->type == MESSAGE_HELLO && !r.failed && !hello.turn && !v->asked;
    if (!asks)
        channel_put_back(&v->channel);
    if (!give_place(l, v, asks ? VISITOR_PLACED : VISITOR_CLIENT)) {
        *result = VISIT_SURPLUS;
        return DM2_OK;
    }
    v->verified = true;
    v->asked |= asks;
    return asks ? send_place(l, v, err) : DM2_OK;
}

/* --- proof of the key, messages --- */

/* Compares the code of a PROOF with the right one. GRANT and REPORT follow only then, so that a visitor
 * without the key gets a random number from this server and nothing that depends on the key. DM2_PROTOCOL
 * where the codes differ. */
static enum dm2_status check_proof(struct lobby *l, struct visitor *v, const unsigned char proof[AUTH_CODE],
                                   enum visit_result *result, struct dm2_error *err)
{
    bool asks = v->role == AUTH_ASKER;
    unsigned char code[AUTH_CODE];
    auth_code(l->options->key, v->role, PROTOCOL_VERSION, &v->nonces, code);
    if (!hmac_equal(code, proof, AUTH_CODE))
        return dm2_fail(err, DM2_PROTOCOL, "%s has another key",
                        asks ? "who asks for the status" : "the client");
    *result = asks ? VISIT_ANSWERED : give_place(l, v, VISITOR_PLACED) ? VISIT_GOES_ON : VISIT_SURPLUS;
    v->verified = v->kind == VISITOR_PLACED;
    enum dm2_status status = *result == VISIT_SURPLUS ? DM2_OK : send_grant(l, v, err);
    return status == DM2_OK && asks ? send_report(l, v, err) : status;
}

/* Takes a STATUS, KNOCK or PROOF. One check of the length serves all three, because a nonce and a code are of
 * one length. */
static enum dm2_status take_message(struct lobby *l, struct visitor *v, const struct frame *f,
                                    enum visit_result *result, struct dm2_error *err)
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
        return check_proof(l, v, f->payload, result, err);
    if (!keyed) {
        *result = VISIT_ANSWERED;
        return send_report(l, v, err);
    }
    v->role = asks ? AUTH_ASKER : AUTH_CLIENT;
    memcpy(v->nonces.client, f->payload, AUTH_NONCE);
    return send_challenge(l, v, err);
}

/* Reads the bytes that have come from a visitor, and takes the messages that are complete. While the server
 * is free, a client without a place whose first message has a fault waits for its turn, because the session
 * reports the fault. */
static enum dm2_status read_visitor(struct lobby *l, struct visitor *v, enum visit_result *result,
                                    struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    bool complete = true;
    while (status == DM2_OK && complete && v->kind != VISITOR_CLIENT && *result == VISIT_GOES_ON) {
        bool greets = v->kind == VISITOR_PLACED;
        struct frame f;
        status = channel_receive_some(&v->channel, greets ? LIMIT_HELLO : LIMIT_AUTH, &complete, &f, err);
        if (status != DM2_OK && greets && !v->verified && l->business.peer == NULL) {
            v->kind = VISITOR_CLIENT;
            status = DM2_OK;
        } else if (status == DM2_OK && complete) {
            status = greets ? take_hello(l, v, &f, result, err) : take_message(l, v, &f, result, err);
        }
    }
    return status;
}

/* --- without a key: the first message --- */

/* Peeks at the header of a visitor's first message: the lobby reads STATUS and HELLO. While the server is
 * busy, a visitor that has closed or whose bytes are not dm2's protocol is refused for the reason returned.
 * While the server is free, such a visitor becomes a client, as does one whose header is partial at the
 * second look, because the session reports the fault. */
static const char *peek_header(struct lobby *l, struct visitor *v, enum visit_result *result)
{
    unsigned char head[TYPE_AT + 1], magic[4];
    const struct frame_header none = {.version = PROTOCOL_VERSION};
    unsigned char own[FRAME_HEADER];
    size_t got;
    int closed;
    frame_header_encode(&none, own);
    memcpy(magic, own, sizeof magic);
    bool broken = socket_peek(v->channel.fd, head, sizeof head, &got, &closed, NULL) != DM2_OK || closed;
    bool foreign = memcmp(head, magic, got < sizeof magic ? got : sizeof magic) != 0;
    bool was_partial = v->partial;
    v->partial = got > 0 && got < sizeof head && !foreign && !broken;
    if ((broken || foreign) && l->business.peer != NULL)
        return broken ? "closed the connection" : "does not speak dm2's protocol";
    if (got == sizeof head && !foreign && head[TYPE_AT] == MESSAGE_STATUS)
        v->kind = VISITOR_ASKS;
    else if (got == sizeof head && memcmp(head, own, TYPE_AT) == 0 && head[TYPE_AT] == MESSAGE_HELLO)
        v->kind = VISITOR_PLACED;
    else if ((broken || foreign || got == sizeof head ||
              (was_partial && v->partial && l->business.peer == NULL)) &&
             !give_place(l, v, VISITOR_CLIENT))
        *result = VISIT_SURPLUS;
    return NULL;
}

/* Is the first message of a client complete? Its bytes are peeked at, not taken. */
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

/* --- all visitors --- */

static bool is_server_free(const struct lobby *l)
{
    return l->business.peer == NULL;
}

/* Reads from one visitor and answers. Returns the reason why the visitor is refused, or NULL. */
static const char *handle_visitor(struct lobby *l, struct visitor *v, enum visit_result *result,
                                  struct dm2_error *err)
{
    const char *why = v->closed ? "closed the connection" : NULL;
    bool keyed = l->options->key != NULL;
    if (why == NULL && v->kind == VISITOR_NEW && !keyed)
        why = peek_header(l, v, result);
    if (why == NULL && v->kind == VISITOR_CLIENT && !v->verified)
        v->verified = has_first_message(v);
    if (why == NULL && v->kind != VISITOR_CLIENT && (v->kind != VISITOR_NEW || keyed) &&
        read_visitor(l, v, result, err) != DM2_OK)
        why = err->text;
    if (why == NULL && *result == VISIT_GOES_ON && !v->verified && clock_now() >= v->until)
        why = "no answer in time";
    return why;
}

/* Handles each visitor once; of a free server, up to the first client. */
static void handle_visitors(struct lobby *l)
{
    for (size_t k = 0; k < l->n && (!is_server_free(l) || count_clients(l) == 0);) {
        struct visitor *v = &l->visitors[k];
        struct dm2_error err = {0};
        enum visit_result result = VISIT_GOES_ON;
        const char *why = handle_visitor(l, v, &result, &err);
        if (why != NULL) {
            refuse_visitor(l, k, why);
        } else if (result == VISIT_SURPLUS) {
            dismiss_visitor(l, k, DM2_NET, "too many clients wait for it already",
                            "refused: as many clients wait as may");
        } else if (result == VISIT_ANSWERED) {
            log_event(l, SERVER_CONNECTED, v->channel.name, "asked for the status");
            channel_hang_up(&v->channel, deadline_in(0, -1));
            remove_visitor(l, k);
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

/* Index of the oldest visitor that is not verified; l->n where all are. */
static size_t oldest_unverified(const struct lobby *l)
{
    size_t k = 0;
    while (k < l->n && l->visitors[k].verified)
        k++;
    return k;
}

/* The time of clock_now() from which on the lobby has or makes room for one more visitor. */
static double accept_time(const struct lobby *l)
{
    size_t oldest = oldest_unverified(l);
    double room = l->n < LOBBY_MOST ? 0 : oldest < l->n ? l->visitors[oldest].came + LOBBY_GRACE : INFINITY;
    return fmax(room, l->accept_after);
}

/* Takes one connection where there is one; the caller has handled all visitors. DM2_NET where the listener
 * failed. */
static enum dm2_status accept_visitor(struct lobby *l, struct dm2_error *err)
{
    char peer[SOCKET_NAME];
    int fd = -1;
    size_t oldest = oldest_unverified(l);
    if (l->n == LOBBY_MOST && oldest < l->n)
        refuse_visitor(l, oldest, "no answer while others want to come in");
    if (l->n == LOBBY_MOST)
        return DM2_OK;
    enum dm2_status status = socket_accept(l->listener, deadline_in(0, -1), &fd, peer, err);
    if (status == DM2_TIMEOUT || fd < 0) {
        l->accept_after = clock_now() + ACCEPT_PAUSE;
        return status == DM2_TIMEOUT ? DM2_OK : status;
    }
    lobby_enter(l, fd, peer);
    if (l->options->allow != NULL && !allow_peer(l->options->allow, fd))
        refuse_visitor(l, l->n - 1, "refused: its address is not among those of --allow");
    return DM2_OK;
}

/* The earliest time, at most `until`, at which a visitor must be handled that may have sent nothing. */
static double next_deadline(const struct lobby *l, double until)
{
    for (size_t k = 0; k < l->n; k++) {
        const struct visitor *v = &l->visitors[k];
        if (!v->verified && v->until < until)
            until = v->until;
        if (v->partial && v->kind == VISITOR_NEW && clock_now() + PARTIAL_SECONDS < until)
            until = clock_now() + PARTIAL_SECONDS;
    }
    return until;
}

enum lobby_wake { WAKE_NONE, WAKE_FD, WAKE_CANCEL, WAKE_BROKEN };

/* Polls once and handles visitors and new connections; fd may be -1. */
static enum lobby_wake poll_once(struct lobby *l, int fd, struct deadline until, struct dm2_error *err)
{
    struct pollfd polls[LOBBY_MOST + 3];
    nfds_t n = 0;
    double room = accept_time(l);
    bool shut = clock_now() < room;
    polls[n++] = (struct pollfd){.fd = fd, .events = POLLIN};
    polls[n++] = (struct pollfd){.fd = until.cancel, .events = POLLIN};
    polls[n++] = (struct pollfd){.fd = shut ? -1 : l->listener, .events = POLLIN};
    for (size_t k = 0; k < l->n; k++) {
        const struct visitor *v = &l->visitors[k];
        polls[n++] = (struct pollfd){.fd = v->kind == VISITOR_NEW && v->partial ? -1 : v->channel.fd,
                                     .events = v->kind == VISITOR_CLIENT ? SOCKET_ENDED : POLLIN};
    }
    double left = next_deadline(l, shut ? fmin(room, until.at) : until.at) - clock_now();
    int timeout = left <= 0 ? 0 : left > 1e6 ? 1000000000 : (int)ceil(left * 1000);
    int ready = socket_poll(polls, n, timeout, fd >= 0 ? LOOK_SECONDS : 0.0);
    if (ready < 0 && errno != EINTR && errno != EAGAIN) {
        (void)dm2_fail(err, DM2_NET, "poll: %s", strerror(errno));
        return WAKE_BROKEN;
    }
    bool more = ready > 0 && polls[2].revents != 0;
    for (size_t k = 0; k < l->n; k++)
        l->visitors[k].closed =
            ready > 0 && l->visitors[k].kind == VISITOR_CLIENT && polls[3 + k].revents != 0;
    if (ready > 0 && polls[1].revents != 0)
        return WAKE_CANCEL;
    handle_visitors(l);
    more = more && clock_now() >= accept_time(l);
    if (more && accept_visitor(l, err) != DM2_OK)
        return WAKE_BROKEN;
    if (more)
        handle_visitors(l); /* the first message of the new visitor may have come */
    return ready > 0 && polls[0].revents != 0 ? WAKE_FD : WAKE_NONE;
}

bool lobby_wait(struct lobby *l, int fd, struct deadline until)
{
    enum lobby_wake wake = WAKE_NONE;
    while (wake == WAKE_NONE && clock_now() < until.at)
        wake = poll_once(l, fd, until, NULL);
    return wake == WAKE_FD;
}

void lobby_look(struct lobby *l)
{
    (void)poll_once(l, -1, deadline_in(0, -1), NULL); /* the next wait reports a failure */
}

/* Hands over the channel of the client that came first. False where no client waits. */
static bool take_client(struct lobby *l, struct channel *out)
{
    for (size_t k = 0; k < l->n; k++) {
        if (l->visitors[k].kind != VISITOR_CLIENT)
            continue;
        *out = l->visitors[k].channel;
        remove_visitor(l, k);
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
        enum lobby_wake wake = poll_once(l, -1, until, err);
        if (wake == WAKE_CANCEL)
            return dm2_fail(err, DM2_INTERRUPTED, "asked to end by a signal");
        if (wake == WAKE_BROKEN)
            return DM2_NET;
        if (clock_now() >= until.at && count_clients(l) == 0)
            return dm2_fail(err, DM2_TIMEOUT, "no client came in time");
    }
    return DM2_OK;
}
