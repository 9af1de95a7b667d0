/* One run, from the first connection to the last result.
 *
 * The stages follow the flow of the paper's Fig. 7 and of docs/protocol.md; in each the client sends every
 * server its message and then gathers one answer from each with poll, in whatever order they come. During the
 * steps
 *
 *     gather   STEP from every rank, with the STATE parts of a snapshot and PROFILE sums before it where they
 * are due decide   sums of counts, dmax, surveys: was this exchange of the right kind, what will the next one
 * be route    segments to their destinations, straight out of the buffers they came in send     NEXT to every
 * rank write    history, snapshots, while the servers compute
 *
 * Any failure closes all connections, which ends all sessions. What lasts from one to the next is struct
 * course: after the loss of a server another session starts, with servers that are there, from the last copy
 * of the state that the course holds. Results know which steps they have, so steps that are done again leave
 * no trace. */
#include "dm2/cluster/client.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "dm2/base/clock.h"
#include "dm2/base/fingerprint.h"
#include "dm2/base/hmac.h"
#include "dm2/base/mem.h"
#include "dm2/cluster/messages.h"
#include "dm2/deck/digest.h"
#include "dm2/engine/rebuild.h"
#include "dm2/engine/subdomain.h"
#include "copies.h"
#include "relay.h"
#include "state_merge.h"
#include "state_parts.h"

static const double LOOK_SECONDS = 5e-5; /* for messages before sleeping; a server may need the processor */
static const double CONNECT_SECONDS = 10.0; /* at most, to open one connection */
static const double BUSY_SECONDS = 1.0;     /* of silence after HELLO until the user is told */
static const double RETRY_SECONDS = 0.05;   /* between attempts to reach a server that was lost */
static const double PARTING_SECONDS = 0.2;  /* to tell a server why its session ends */

/* A server as the client knows it. */
struct peer {
    struct channel channel;
    bool open;
    bool awaited;   /* an answer is due */
    uint8_t answer; /* ANSWER: loaded or not */
    struct auth_nonces nonces;
    bool challenged;
    struct ready_message ready;
    struct step_message step;
    struct relay_source segments; /* of the last STEP message, in the channel's buffer */
    struct done_message done;
    bool whole[3]; /* its part of the final state, the copy, the snapshot has come: all of it */
};

/* A state on its way in. */
struct compilation {
    struct state_merge merge;
    bool due;     /* parts may come now, */
    int64_t step; /* of this step */
};

/* The sums of a profile on their way in. */
struct profile_part {
    struct profile_bin *bins;
    bool *came; /* from which server */
    bool due;
};

enum { LOSSES_MOST = 3 }; /* of one server without a new copy between, before it is given up */

/* A server of the course. */
struct station {
    struct endpoint at;
    int losses; /* since the last copy */
};

/* What lasts from session to session. */
struct course {
    struct station *stations; /* ranks of them */
    size_t spares_used;
    struct decomposition cut;                  /* for fewer servers than at first, */
    const struct decomposition *decomposition; /* or the job's */
    struct state_merge copy;                   /* the state of the step copy_step; -1: none */
    int64_t copy_step;
    struct copy_plan plan;
    int64_t hashed; /* the newest step whose hash was told; -1: none */
    bool stepping;  /* all servers of the first session were ready */
    bool stopping;  /* a signal came while the steps ran */
    int renewals;   /* of all servers, since the last copy */
    struct run_report report;
};

struct client {
    const struct client_job *job;
    const struct client_options *options;
    struct course *course;
    const struct decomposition *decomposition;
    bool stepping; /* all servers are ready: a signal is obeyed after the step */
    bool copy_due; /* the state comes with this step */
    bool survey;   /* the spread comes with this step */
    int culprit;   /* the rank that failed; -1: none */
    bool silent;   /* by its silence */
    int ranks;
    struct peer *peers;
    struct pollfd *polls; /* ranks + 1 */
    int *polled;          /* whose they are */
    struct bytes_writer out;
    struct relay relay;
    struct relay_source *sources;
    struct compilation snapshot, final, copy;
    struct profile_part *profiles; /* of the deck */
    int64_t profile_step;          /* that they are of */
    struct rebuild_plan plan;
    int64_t at; /* step for messages: -1 before the first */
    struct run_report report;
};

/* --- failures --- */

static int64_t starting_step(const struct client *c);

static void when(const struct client *c, char *out, size_t size)
{
    if (c->at < 0 && c->course->stepping)
        (void)snprintf(out, size, "set-up again from step %lld", (long long)starting_step(c));
    else if (c->at < 0)
        (void)snprintf(out, size, "before the first step");
    else
        (void)snprintf(out, size, "step %lld", (long long)c->at);
}

/* The failure of one server, with step and advice around `why`. */
static enum dm2_status peer_failed(struct client *c, int rank, enum dm2_status status, const char *why,
                                   struct dm2_error *err)
{
    const char *name = c->peers[rank].channel.name;
    char step[64], text[600];
    when(c, step, sizeof step);
    c->culprit = rank;
    c->silent = status == DM2_TIMEOUT;
    (void)snprintf(text, sizeof text, "%s", why); /* *err may be what `why` lies in */
    if (status == DM2_INTERRUPTED || status == DM2_MEMORY)
        return dm2_fail(err, status, "%s", text);
    const char *advice = status == DM2_NET && !c->options->recover
                             ? "; see that server's log, start it again and repeat the run"
                             : "";
    bool named = strncmp(text, name, strlen(name)) == 0;
    return dm2_fail(err, status, "server %d of %d, %s: %s%s%s%s", rank, c->ranks, step, named ? "" : name,
                    named ? "" : ": ", text, advice);
}

/* The server said ERROR itself. */
static enum dm2_status peer_error(struct client *c, int rank, struct bytes_reader r, struct dm2_error *err)
{
    struct error_message m;
    char text[600];
    message_get_error(&r, &m);
    if (!r.failed && strcmp(m.text, REFUSAL_TEXT) == 0)
        return peer_failed(
            c, rank, DM2_PROTOCOL,
            c->options->key == NULL
                ? "it refuses the connection: it wants a key (--key FILE), or does not admit this machine"
                : "it refuses the connection: it has another key, or does not admit this machine",
            err);
    (void)snprintf(text, sizeof text, "ended the session: %.560s",
                   r.failed ? "its reason does not decode" : m.text);
    /* a server that was asked to end, or has no memory left, could not be used; one that found the deck wrong
     * found the deck wrong */
    bool unusable = m.status == DM2_INTERRUPTED || m.status == DM2_TIMEOUT || m.status == DM2_MEMORY;
    enum dm2_status status = unusable ? DM2_NET : m.status;
    return peer_failed(c, rank, status, text, err);
}

/* --- one message to, and one answer from, every server --- */

typedef enum dm2_status (*take_answer)(struct client *c, int rank, struct bytes_reader *r,
                                       struct dm2_error *err);

static struct deadline patience(const struct client *c)
{
    return deadline_in(c->options->timeout, c->stepping ? -1 : c->options->cancel);
}

static enum dm2_status send_out(struct client *c, int rank, enum message_type type, struct dm2_error *err)
{
    struct peer *p = &c->peers[rank];
    struct dm2_error why = {0};
    if (c->out.failed)
        return dm2_fail(err, DM2_MEMORY, "no memory for a message");
    enum dm2_status status =
        channel_send(&p->channel, (uint8_t)type, 0, c->out.data, c->out.length, patience(c), &why);
    p->awaited = true;
    return status == DM2_OK ? DM2_OK : peer_failed(c, rank, status, why.text, err);
}

static enum dm2_status not_decoded(struct client *c, int rank, const char *what, struct dm2_error *err)
{
    char text[100];
    (void)snprintf(text, sizeof text, "its %s message does not decode", what);
    return peer_failed(c, rank, DM2_PROTOCOL, text, err);
}

/* Which entry of peer.whole is this state's? */
static int which_state(const struct client *c, const struct compilation *state)
{
    return state == &c->final ? 0 : state == &c->copy ? 1 : 2;
}

static enum dm2_status take_state(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct state_message m;
    struct dm2_error why = {0};
    message_get_state(r, &m);
    if (r->failed)
        return not_decoded(c, rank, "STATE", err);
    struct compilation *state = m.purpose == STATE_FINAL  ? &c->final
                                : m.purpose == STATE_COPY ? &c->copy
                                                          : &c->snapshot;
    bool *whole = &c->peers[rank].whole[which_state(c, state)];
    if (!state->due || m.step != state->step || *whole)
        return peer_failed(c, rank, DM2_PROTOCOL, "it sent a state that is not due", err);
    if (!m.last && m.n_elements == 0 && m.n_pairs == 0)
        return peer_failed(c, rank, DM2_PROTOCOL, "it sent an empty part of a state", err);
    enum dm2_status status = state_merge_add(&state->merge, &m, r, &why);
    *whole = m.last;
    return status == DM2_OK ? DM2_OK : peer_failed(c, rank, status, why.text, err);
}

/* The server is told that this client has the key. */
static enum dm2_status answer_challenge(struct client *c, int rank, struct bytes_reader *r,
                                        struct dm2_error *err)
{
    struct peer *p = &c->peers[rank];
    struct dm2_error why = {0};
    unsigned char code[AUTH_CODE];
    const unsigned char *nonce = bytes_get_raw(r, AUTH_NONCE);
    if (!bytes_done(r))
        return not_decoded(c, rank, "CHALLENGE", err);
    memcpy(p->nonces.server, nonce, AUTH_NONCE);
    p->challenged = true;
    auth_code(c->options->key, AUTH_CLIENT, PROTOCOL_VERSION, &p->nonces, code);
    enum dm2_status status = channel_send(&p->channel, MESSAGE_PROOF, 0, code, AUTH_CODE, patience(c), &why);
    return status == DM2_OK ? DM2_OK : peer_failed(c, rank, status, why.text, err);
}

static enum dm2_status take_profile(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    const struct config *config =
        c->job != NULL ? c->job->config : NULL; /* NULL: it only measures the network */
    struct profile_message m;
    message_get_profile(r, &m);
    if (r->failed)
        return not_decoded(c, rank, "PROFILE", err);
    if (config == NULL || m.which >= config->n_profiles || !c->profiles[m.which].due ||
        c->profiles[m.which].came[rank] || m.step != c->profile_step ||
        m.n_bins != (size_t)config->profiles[m.which].bins)
        return peer_failed(c, rank, DM2_PROTOCOL, "it sent a profile that is not due", err);
    struct profile_part *p = &c->profiles[m.which];
    for (size_t k = 0; k < m.n_bins; k++) {
        struct profile_bin bin;
        wire_get_bin(r, &bin);
        profile_merge(&p->bins[k], &bin, 1);
    }
    p->came[rank] = true;
    return DM2_OK;
}

/* Work comes before an answer of this type, and the server says meanwhile that it is alive. */
static bool takes_long(enum message_type type)
{
    return type == MESSAGE_ANSWER || type == MESSAGE_READY || type == MESSAGE_STEP || type == MESSAGE_DONE;
}

/* Takes all frames that have arrived from one server. */
static enum dm2_status take_frames(struct client *c, int rank, enum message_type type, uint32_t limit,
                                   take_answer take, struct dm2_error *err)
{
    struct peer *p = &c->peers[rank];
    while (p->awaited) {
        bool complete;
        struct frame f;
        struct dm2_error why = {0};
        enum dm2_status status = channel_receive_some(&p->channel, limit, &complete, &f, &why);
        if (status != DM2_OK)
            return peer_failed(c, rank, status, why.text, err);
        if (!complete)
            return DM2_OK;
        struct bytes_reader r = bytes_reader_of(f.payload, f.length);
        if (f.type == MESSAGE_ERROR)
            return peer_error(c, rank, r, err);
        if (f.type == MESSAGE_ALIVE && f.length == 0 && takes_long(type))
            continue; /* the channel knows when it was heard */
        if (f.type == MESSAGE_STATE) {
            status = take_state(c, rank, &r, err);
        } else if (f.type == MESSAGE_CHALLENGE && type == MESSAGE_GRANT && !p->challenged) {
            status = answer_challenge(c, rank, &r, err);
        } else if (f.type == MESSAGE_PROFILE) {
            status = take_profile(c, rank, &r, err);
        } else if (f.type == type) {
            p->awaited = false;
            status = take(c, rank, &r, err);
        } else {
            char names[2][16], text[100];
            (void)snprintf(text, sizeof text, "it sent %s where %s is due", message_name(f.type, names[0]),
                           message_name((uint8_t)type, names[1]));
            status = peer_failed(c, rank, DM2_PROTOCOL, text, err);
        }
        if (status != DM2_OK)
            return status;
    }
    return DM2_OK;
}

/* Waits until an awaited server has something, or the first of them has been silent too long since `since`,
 * but no longer than until wake_at. */
static enum dm2_status wait_for_any(struct client *c, double since, double wake_at, int *n,
                                    struct dm2_error *err)
{
    double first = INFINITY, now = clock_now();
    int silent = -1;
    *n = 0;
    for (int k = 0; k < c->ranks; k++) {
        const struct channel *ch = &c->peers[k].channel;
        if (!c->peers[k].awaited)
            continue;
        double end = fmax(ch->heard, since) + c->options->timeout;
        if (end < first) {
            first = end;
            silent = k;
        }
        c->polled[*n] = k;
        c->polls[(*n)++] = (struct pollfd){.fd = ch->fd, .events = POLLIN};
    }
    if (silent < 0)
        return DM2_OK;
    double until = fmin(wake_at, first);
    c->polls[*n] = (struct pollfd){.fd = c->course->stopping ? -1 : c->options->cancel, .events = POLLIN};
    double wait = until > now ? ceil(1000 * (until - now)) : 0;
    int ready = socket_poll(c->polls, (nfds_t)*n + 1, wait < 1e9 ? (int)wait : 1000000000, LOOK_SECONDS);
    if (ready < 0 && errno != EINTR && errno != EAGAIN)
        return dm2_fail(err, DM2_NET, "poll: %s", strerror(errno));
    bool asked = ready > 0 && c->polls[*n].revents != 0;
    c->course->stopping |= asked;
    if (asked && !c->stepping)
        return dm2_fail(err, DM2_INTERRUPTED, "the run was interrupted by a signal");
    if (ready <= 0 && clock_now() >= first) {
        char text[200];
        (void)snprintf(text, sizeof text,
                       "no answer for %g s: it is stopped, overloaded or cut off; see its log, or allow "
                       "more with --timeout",
                       c->options->timeout);
        return peer_failed(c, silent, DM2_TIMEOUT, text, err);
    }
    if (ready <= 0)
        *n = 0;
    return DM2_OK;
}

static void note_busy(const struct client *c)
{
    char line[SOCKET_NAME + 100];
    for (int k = 0; k < c->ranks && c->options->events.note != NULL; k++)
        if (c->peers[k].awaited) {
            (void)snprintf(line, sizeof line, "waiting for %s, which may be serving another client",
                           c->peers[k].channel.name);
            c->options->events.note(c->options->events.context, line);
        }
}

/* To the servers that have answered, while another one takes long: they have a patience, too. Not after DONE,
 * which they hang up after. */
static enum dm2_status tell_alive(struct client *c, struct dm2_error *err)
{
    struct dm2_error why = {0};
    for (int k = 0; k < c->ranks; k++) {
        if (c->peers[k].awaited)
            continue;
        enum dm2_status status =
            channel_send(&c->peers[k].channel, MESSAGE_ALIVE, 0, NULL, 0, patience(c), &why);
        if (status != DM2_OK)
            return peer_failed(c, k, status, why.text, err);
    }
    return DM2_OK;
}

/* One message of `type` from every awaited server. With `note`, the user is told of those that do not answer
 * soon. */
static enum dm2_status gather(struct client *c, enum message_type type, uint32_t limit, take_answer take,
                              bool note, struct dm2_error *err)
{
    double since = clock_now(), note_at = note ? since + BUSY_SECONDS : INFINITY;
    double every = alive_every(c->options->timeout);
    double alive_at = takes_long(type) && type != MESSAGE_DONE ? since + every : INFINITY;
    int awaited = 0;
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < c->ranks && status == DM2_OK; k++) {
        if (c->peers[k].awaited && channel_pending(&c->peers[k].channel)) /* came with the message before */
            status = take_frames(c, k, type, limit, take, err);
        awaited += c->peers[k].awaited;
    }
    while (awaited > 0 && status == DM2_OK) {
        int n;
        status = wait_for_any(c, since, fmin(note_at, alive_at), &n, err);
        for (int k = 0; k < n && status == DM2_OK; k++) {
            if (c->polls[k].revents == 0)
                continue;
            status = take_frames(c, c->polled[k], type, limit, take, err);
            awaited -= !c->peers[c->polled[k]].awaited;
        }
        if (status == DM2_OK && clock_now() >= note_at) {
            note_busy(c);
            note_at = INFINITY;
        }
        if (status == DM2_OK && clock_now() >= alive_at) {
            status = tell_alive(c, err);
            alive_at = clock_now() + every;
        }
    }
    c->report.wait += clock_now() - since;
    return status;
}

/* --- before the steps --- */

/* Connects, after a loss again and again until `until`: the server may be started anew. */
static enum dm2_status connect_one(struct client *c, const struct endpoint *e, double until, int *fd,
                                   struct dm2_error *err)
{
    int cancel = c->options->cancel;
    for (;;) {
        double now = clock_now();
        enum dm2_status status = socket_connect(
            e->host, e->port, deadline_in(fmin(CONNECT_SECONDS, c->options->timeout), cancel), fd, err);
        if (status == DM2_OK || status == DM2_INTERRUPTED || clock_now() >= until)
            return status;
        if (clock_now() - now < RETRY_SECONDS) {
            struct pollfd asked = {.fd = cancel, .events = POLLIN};
            (void)poll(&asked, 1, (int)(1000 * RETRY_SECONDS));
        }
    }
}

static enum dm2_status connect_all(struct client *c, struct dm2_error *err)
{
    double last = c->course->stepping ? clock_now() + c->options->reconnect : 0;
    for (int k = 0; k < c->ranks; k++) {
        const struct endpoint *e = &c->course->stations[k].at;
        char name[SOCKET_NAME];
        int fd;
        struct dm2_error why = {0};
        (void)snprintf(name, sizeof name, "%s:%d", e->host, e->port);
        enum dm2_status status = connect_one(c, e, last, &fd, &why);
        if (status != DM2_OK) {
            char step[64];
            when(c, step, sizeof step);
            c->culprit = k;
            channel_open(&c->peers[k].channel, -1, PROTOCOL_VERSION, name);
            return dm2_fail(err, status, "server %d of %d, %s: %s", k, c->ranks, step, why.text);
        }
        channel_open(&c->peers[k].channel, fd, PROTOCOL_VERSION, name);
        c->peers[k].open = true;
    }
    return DM2_OK;
}

/* The server has proved that it has the key, too: from here on every frame is checked with the session's
 * keys. */
static enum dm2_status take_grant(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct peer *p = &c->peers[rank];
    unsigned char code[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    const unsigned char *proof = bytes_get_raw(r, AUTH_CODE);
    if (!bytes_done(r) || !p->challenged)
        return not_decoded(c, rank, "GRANT", err);
    auth_code(c->options->key, AUTH_SERVER, PROTOCOL_VERSION, &p->nonces, code);
    if (!hmac_equal(code, proof, AUTH_CODE))
        return peer_failed(c, rank, DM2_PROTOCOL, "it does not have the key: is this the right machine?",
                           err);
    auth_session_key(c->options->key, AUTH_SERVER, PROTOCOL_VERSION, &p->nonces, in);
    auth_session_key(c->options->key, AUTH_CLIENT, PROTOCOL_VERSION, &p->nonces, out);
    channel_use_keys(&p->channel, in, out);
    return DM2_OK;
}

static enum dm2_status authenticate(struct client *c, struct dm2_error *err)
{
    for (int k = 0; k < c->ranks; k++) {
        struct peer *p = &c->peers[k];
        enum dm2_status status = auth_nonce(p->nonces.client, err);
        p->challenged = false;
        bytes_clear(&c->out);
        bytes_put_raw(&c->out, p->nonces.client, AUTH_NONCE);
        if (status == DM2_OK)
            status = send_out(c, k, MESSAGE_KNOCK, err);
        if (status != DM2_OK)
            return status;
    }
    return gather(c, MESSAGE_GRANT, LIMIT_HELLO, take_grant, true, err);
}

static enum dm2_status take_welcome(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct hello_message m;
    char text[300];
    message_get_hello(r, &m);
    if (r->failed)
        return not_decoded(c, rank, "WELCOME", err);
    if (m.fingerprint == fingerprint_compute())
        return DM2_OK;
    (void)snprintf(text, sizeof text,
                   "the arithmetic differs: fingerprint %016llx there (dm2 %s), %016llx here (dm2 %s)",
                   (unsigned long long)m.fingerprint, m.version, (unsigned long long)fingerprint_compute(),
                   c->options->version);
    return peer_failed(c, rank, DM2_PROTOCOL, text, err);
}

static enum dm2_status shake_hands(struct client *c, struct dm2_error *err)
{
    struct hello_message m = {.fingerprint = fingerprint_compute()};
    enum dm2_status admitted = c->options->key != NULL ? authenticate(c, err) : DM2_OK;
    if (admitted != DM2_OK)
        return admitted;
    (void)snprintf(m.version, sizeof m.version, "%s", c->options->version);
    bytes_clear(&c->out);
    message_put_hello(&c->out, &m);
    for (int k = 0; k < c->ranks; k++) {
        enum dm2_status status = send_out(c, k, MESSAGE_HELLO, err);
        if (status != DM2_OK)
            return status;
    }
    return gather(c, MESSAGE_WELCOME, LIMIT_HELLO, take_welcome, true, err);
}

static enum dm2_status take_echo(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    if (bytes_remaining(r) == c->out.length && memcmp(r->data + r->at, c->out.data, c->out.length) == 0)
        return DM2_OK;
    return peer_failed(c, rank, DM2_PROTOCOL, "it did not send the same bytes back", err);
}

/* One message of n bytes to every server, and back from every one. A pause comes first: in a time step, too,
 * the messages find processes that have gone to sleep while others computed, and waking them up is a good
 * part of b_N. */
static enum dm2_status echo_once(struct client *c, uint32_t n, double *seconds, struct dm2_error *err)
{
    const struct timespec pause = {.tv_nsec = 200000};
    (void)nanosleep(&pause, NULL);
    bytes_clear(&c->out);
    for (uint32_t k = 0; k < n; k++)
        bytes_put_u8(&c->out, (uint8_t)(k * 31));
    enum dm2_status status = DM2_OK;
    double start = clock_now();
    for (int k = 0; k < c->ranks && status == DM2_OK; k++)
        status = send_out(c, k, MESSAGE_ECHO, err);
    if (status == DM2_OK)
        status = gather(c, MESSAGE_ECHO, LIMIT_DECK, take_echo, false, err);
    *seconds = clock_now() - start;
    return status;
}

static enum dm2_status echo_all(struct client *c, struct client_echo *e, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    double start = clock_now();
    for (e->done = 0; e->done < e->repeats && status == DM2_OK; e->done++) {
        if (e->done >= 2 && clock_now() - start > e->budget)
            break;
        for (int k = 0; k < e->sizes && status == DM2_OK; k++)
            status = echo_once(c, e->bytes[k], &e->seconds[e->done * e->sizes + k], err);
    }
    return status;
}

static enum dm2_status take_deck_answer(struct client *c, int rank, struct bytes_reader *r,
                                        struct dm2_error *err)
{
    c->peers[rank].answer = bytes_get_u8(r);
    return bytes_done(r) ? DM2_OK : not_decoded(c, rank, "ANSWER", err);
}

/* The name by which a server may have the deck: the path as given, where it can lie below another directory
 * too. */
static const char *deck_name(const char *path)
{
    const char *slash = strrchr(path, '/'), *up = strstr(path, "..");
    while (path[0] == '.' && path[1] == '/')
        path += 2;
    return path[0] == '/' || up != NULL ? (slash == NULL ? path : slash + 1) : path;
}

static enum dm2_status send_deck(struct client *c, bool texts, struct dm2_error *err)
{
    struct deck_message m = {.with_texts = texts, .source = *c->job->source};
    char name[DECK_NAME_MAX + 1];
    (void)snprintf(name, sizeof name, "%s", deck_name(c->options->deck_path));
    m.name = name;
    deck_digest(c->job->source, m.digest);
    bytes_clear(&c->out);
    message_put_deck(&c->out, &m);
    if (c->out.length > LIMIT_DECK)
        return dm2_fail(err, DM2_DECK, "the deck's texts have %zu bytes, at most %d can be sent",
                        c->out.length, (int)LIMIT_DECK);
    for (int k = 0; k < c->ranks; k++) {
        enum dm2_status status = c->peers[k].answer == 0 ? send_out(c, k, MESSAGE_DECK, err) : DM2_OK;
        if (status != DM2_OK)
            return status;
    }
    return gather(c, MESSAGE_ANSWER, LIMIT_SMALL, take_deck_answer, false, err);
}

static enum dm2_status share_deck(struct client *c, struct dm2_error *err)
{
    enum dm2_status status = c->options->send_deck ? DM2_OK : send_deck(c, false, err);
    int missing = 0;
    for (int k = 0; k < c->ranks; k++)
        missing += c->peers[k].answer == 0;
    if (status == DM2_OK && missing > 0)
        status = send_deck(c, true, err);
    for (int k = 0; k < c->ranks && status == DM2_OK; k++)
        if (c->peers[k].answer == 0)
            status = peer_failed(c, k, DM2_PROTOCOL, "it did not take the deck", err);
    return status;
}

/* Each hash is told once, however often its step is done. */
static void tell_hash(struct client *c, int64_t step, uint64_t hash)
{
    if (step > c->course->hashed && c->options->events.hash != NULL)
        c->options->events.hash(c->options->events.context, step, hash);
    if (step > c->course->hashed)
        c->course->hashed = step;
}

static enum dm2_status take_ready(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    message_get_ready(r, &c->peers[rank].ready);
    return r->failed ? not_decoded(c, rank, "READY", err) : DM2_OK;
}

/* The state to start from: the last copy, else the job's. False: the beginning. */
static bool starting_state(const struct client *c, struct state_view *out)
{
    const struct course *course = c->course;
    const struct state_merge *m = &course->copy;
    const struct state *s = c->job->start;
    if (course->copy_step >= 0)
        *out = (struct state_view){.step = course->copy_step,
                                   .elements = m->elements,
                                   .n_elements = m->n_seen,
                                   .pairs = m->pairs,
                                   .n_pairs = m->n_pairs};
    else if (s != NULL)
        *out = (struct state_view){.digest = s->digest,
                                   .step = s->step,
                                   .elements = s->elements,
                                   .n_elements = s->n_elements,
                                   .pairs = s->pairs,
                                   .n_pairs = s->n_pairs};
    return course->copy_step >= 0 || s != NULL;
}

static int64_t starting_step(const struct client *c)
{
    struct state_view s = {0};
    return starting_state(c, &s) ? s.step : 0;
}

/* Sends one rank what it owns and mirrors of the state. */
static enum dm2_status send_share(struct client *c, int rank, const struct state_view *s,
                                  struct dm2_error *err)
{
    struct state_parts parts = {.head = {.step = s->step, .purpose = STATE_COPY}};
    struct element *elements;
    struct pair_record *pairs;
    enum dm2_status status =
        state_share(c->decomposition, rank, s->elements, s->n_elements, s->pairs, s->n_pairs, &elements,
                    &parts.n_elements, &pairs, &parts.n_pairs, err);
    parts.elements = elements;
    parts.pairs = pairs;
    while (status == DM2_OK && state_parts_next(&parts, &c->out))
        status = send_out(c, rank, MESSAGE_STATE, err);
    free(elements);
    free(pairs);
    return status;
}

/* Whether the state at `step` is to come with its STEP message; if so, it will be asked for. */
static bool wants_copy(struct client *c, int64_t step)
{
    const struct config *config = c->job->config;
    bool wanted =
        step < config->steps && (c->course->stopping || copy_plan_due(&c->course->plan, step) ||
                                 results_checkpoint_due(config, c->options->checkpoint_every, step));
    if (wanted)
        copy_plan_asked(&c->course->plan, step);
    return wanted;
}

static enum dm2_status assign_ranks(struct client *c, struct dm2_error *err)
{
    const struct decomposition *d = c->decomposition;
    struct state_view from = {0};
    bool restored = starting_state(c, &from);
    c->copy_due = wants_copy(c, starting_step(c) + 1);
    struct assign_message m = {.ranks = c->ranks,
                               .cx = d->grid.cx,
                               .cy = d->grid.cy,
                               .elements = model_elements(c->job->model),
                               .rects = d->rect,
                               .timeout = c->options->timeout,
                               .hash_every = c->options->hash_every,
                               .rebuild_first = rebuild_plan_expected(&c->plan),
                               .copy_first = c->copy_due,
                               .start = restored ? from.step : -1};
    for (m.rank = 0; m.rank < c->ranks; m.rank++) {
        decomposition_interfaces(d, m.rank, m.interfaces);
        bytes_clear(&c->out);
        message_put_assign(&c->out, &m);
        enum dm2_status status = send_out(c, m.rank, MESSAGE_ASSIGN, err);
        if (status == DM2_OK && restored)
            status = send_share(c, m.rank, &from, err);
        if (status != DM2_OK)
            return status;
    }
    enum dm2_status status = gather(c, MESSAGE_READY, LIMIT_SMALL, take_ready, false, err);
    uint64_t owned = 0, hash = 0;
    for (int k = 0; k < c->ranks; k++) {
        owned += c->peers[k].ready.owned;
        hash += c->peers[k].ready.hash;
    }
    if (status == DM2_OK && owned != m.elements)
        return dm2_fail(err, DM2_PROTOCOL,
                        "the servers generated %llu elements, the deck makes %llu: is the same dm2 "
                        "installed everywhere?",
                        (unsigned long long)owned, (unsigned long long)m.elements);
    int64_t start = starting_step(c);
    if (status == DM2_OK && m.hash_every > 0 && (start % m.hash_every == 0 || start == c->job->config->steps))
        tell_hash(c, start, hash);
    return status;
}

/* --- steps --- */

static enum dm2_status take_step(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct peer *p = &c->peers[rank];
    message_get_step(r, &p->step);
    if (r->failed)
        return not_decoded(c, rank, "STEP", err);
    p->segments = (struct relay_source){
        .segments = r->data + r->at, .length = bytes_remaining(r), .count = p->step.n_segments};
    return DM2_OK;
}

/* What the step messages of all ranks say together. */
struct step_sum {
    double dmax, busy;
    int slowest;
    uint64_t hash;
    struct spread spread;
    struct measures measures;
};

static enum dm2_status sum_up(struct client *c, bool rebuild, bool measured, bool hashed, bool surveyed,
                              struct step_sum *sum, struct dm2_error *err)
{
    uint64_t elements = 0;
    *sum = (struct step_sum){.spread = spread_none()};
    measures_clear(&sum->measures);
    for (int k = 0; k < c->ranks; k++) {
        const struct step_message *m = &c->peers[k].step;
        if (m->step != c->at || m->rebuild != rebuild || m->measured != measured || m->hashed != hashed ||
            m->surveyed != surveyed) {
            char text[160];
            (void)snprintf(
                text, sizeof text,
                "its STEP message is of step %lld (rebuild %d, measures %d, hash %d, survey %d), not as "
                "asked for (%d, %d, %d, %d)",
                (long long)m->step, m->rebuild, m->measured, m->hashed, m->surveyed, rebuild, measured,
                hashed, surveyed);
            return peer_failed(c, k, DM2_PROTOCOL, text, err);
        }
        elements += m->owned;
        sum->dmax = m->dmax > sum->dmax ? m->dmax : sum->dmax;
        if (m->busy > sum->busy || k == 0) {
            sum->busy = m->busy;
            sum->slowest = k;
        }
        if (surveyed)
            spread_merge(&sum->spread, &m->spread);
        sum->hash += m->hash;
        if (measured)
            measures_merge(&sum->measures, &m->measures);
    }
    if (elements != model_elements(c->job->model))
        return dm2_fail(err, DM2_NUMERIC, "step %lld: the servers hold %llu elements together instead of %zu",
                        (long long)c->at, (unsigned long long)elements, model_elements(c->job->model));
    return DM2_OK;
}

static enum dm2_status send_next(struct client *c, struct next_message m, bool segments,
                                 struct dm2_error *err)
{
    int culprit = -1;
    struct dm2_error why = {0};
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < c->ranks && segments; k++)
        c->sources[k] = c->peers[k].segments;
    if (segments)
        status = relay_run(&c->relay, c->sources, &culprit, &why);
    if (status != DM2_OK)
        return culprit >= 0 ? peer_failed(c, culprit, status, why.text, err)
                            : dm2_fail(err, status, "%s", why.text);
    for (int k = 0; k < c->ranks; k++) {
        struct iovec bare[RELAY_SPARE], *iov = segments ? c->relay.route[k].iov : bare;
        m.n_segments = segments ? c->relay.route[k].count : 0;
        bytes_clear(&c->out);
        message_put_next(&c->out, &m);
        if (c->out.failed)
            return dm2_fail(err, DM2_MEMORY, "no memory for a message");
        iov[1] = (struct iovec){.iov_base = c->out.data, .iov_len = c->out.length};
        status = channel_send_parts(&c->peers[k].channel, MESSAGE_NEXT, 0, iov,
                                    segments ? c->relay.route[k].n_iov : RELAY_SPARE, patience(c), &why);
        c->peers[k].awaited = true;
        if (status != DM2_OK)
            return peer_failed(c, k, status, why.text, err);
    }
    return DM2_OK;
}

/* The copy in hand, to disk. */
static enum dm2_status write_checkpoint(struct client *c, struct dm2_error *err)
{
    const struct state_merge *m = &c->course->copy;
    return results_checkpoint(c->job->results,
                              &(struct state_view){.step = c->course->copy_step,
                                                   .elements = m->elements,
                                                   .n_elements = m->n_seen,
                                                   .pairs = m->pairs,
                                                   .n_pairs = m->n_pairs},
                              err);
}

static void expect_state(struct client *c, struct compilation *state, bool due, int64_t step)
{
    state->due = due;
    state->step = step;
    for (int k = 0; k < c->ranks; k++)
        c->peers[k].whole[which_state(c, state)] = false;
    if (due)
        state_merge_clear(&state->merge);
}

/* The copy that came becomes the one to go back to, and where one is due, a checkpoint. */
static enum dm2_status keep_copy(struct client *c, struct dm2_error *err)
{
    struct course *course = c->course;
    struct state_merge old = course->copy;
    course->copy = c->copy.merge;
    c->copy.merge = old;
    course->copy_step = c->copy.step;
    course->renewals = 0;
    for (int k = 0; k < c->ranks; k++)
        course->stations[k].losses = 0;
    bool due = course->stopping ||
               results_checkpoint_due(c->job->config, c->options->checkpoint_every, course->copy_step);
    return due ? write_checkpoint(c, err) : DM2_OK;
}

static enum dm2_status write_state(struct client *c, struct compilation *state, struct dm2_error *err)
{
    struct state_merge *m = &state->merge;
    struct dm2_error why = {0};
    state->due = false;
    for (int k = 0; k < c->ranks; k++)
        if (!c->peers[k].whole[which_state(c, state)])
            return peer_failed(c, k, DM2_PROTOCOL, "it did not finish sending its part of the state", err);
    enum dm2_status status = state_merge_finish(m, &why);
    if (status != DM2_OK)
        return dm2_fail(err, status, "compiling the state of step %lld: %s", (long long)state->step,
                        why.text);
    if (state == &c->copy)
        return keep_copy(c, err);
    if (state == &c->final)
        return results_final(c->job->results,
                             &(struct state_view){.step = state->step,
                                                  .elements = m->elements,
                                                  .n_elements = m->n_seen,
                                                  .pairs = m->pairs,
                                                  .n_pairs = m->n_pairs},
                             err);
    return results_snapshot(c->job->results, state->step, m->elements, m->measured, m->n_seen, m->pairs,
                            m->n_pairs, err);
}

static void expect_profiles(struct client *c, int64_t step)
{
    const struct config *config = c->job->config;
    c->profile_step = step;
    for (size_t k = 0; k < config->n_profiles; k++) {
        struct profile_part *p = &c->profiles[k];
        p->due = results_profile_due(config, k, step);
        memset(p->bins, 0, (size_t)config->profiles[k].bins * sizeof *p->bins);
        memset(p->came, 0, (size_t)c->ranks * sizeof *p->came);
    }
}

static enum dm2_status write_profiles(struct client *c, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < c->job->config->n_profiles && status == DM2_OK; k++) {
        struct profile_part *p = &c->profiles[k];
        if (!p->due)
            continue;
        p->due = false;
        for (int rank = 0; rank < c->ranks; rank++)
            if (!p->came[rank])
                return peer_failed(c, rank, DM2_PROTOCOL, "it did not send its part of a profile", err);
        status = results_profile(c->job->results, k, c->profile_step, p->bins, err);
    }
    return status;
}

/* Decides, routes and sends: what ends one step and starts the next. *rebuild is how this exchange was asked
 * for, and becomes how the next one will be. */
static enum dm2_status exchange_step(struct client *c, bool *rebuild, const struct step_sum *sum,
                                     struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    bool last = c->at == c->job->config->steps;
    if (rebuild_plan_step(&c->plan, sum->dmax, c->survey ? &sum->spread : NULL) && !*rebuild) {
        struct step_sum again;
        *rebuild = true;
        c->report.redone++;
        status = send_next(c, (struct next_message){.step = c->at, .redo = true}, false, err);
        if (status == DM2_OK)
            status = gather(c, MESSAGE_STEP, LIMIT_STEP, take_step, false, err);
        if (status == DM2_OK)
            status = sum_up(c, true, false, false, false, &again, err);
        if (status != DM2_OK)
            return status;
    }
    if (*rebuild) {
        rebuild_plan_done(&c->plan);
        c->report.rebuilds++;
    }
    *rebuild = !last && rebuild_plan_expected(&c->plan);
    c->survey = !last && rebuild_plan_survey(&c->plan);
    double start = clock_now();
    c->copy_due = wants_copy(c, c->at + 1);
    const struct next_message next = {
        .step = c->at, .rebuild_next = *rebuild, .copy_next = c->copy_due, .survey_next = c->survey};
    status = send_next(c, next, true, err);
    c->report.relay += clock_now() - start;
    return status;
}

/* Is the copy of the present step there for a checkpoint? */
static bool checkpointed(const struct client *c)
{
    return c->course->stopping || results_checkpoint_due(c->job->config, c->options->checkpoint_every, c->at);
}

/* What a step took, for the distance of copies and for the report. */
static void note_copy(struct client *c, bool copy, bool snapshot, double seconds)
{
    struct copy_plan *plan = &c->course->plan;
    if (!copy) {
        copy_plan_plain(plan, snapshot, seconds);
    } else if (!checkpointed(c)) {
        c->report.copies++;
        c->report.copying += copy_plan_done(plan, snapshot, seconds);
    }
}

static enum dm2_status step(struct client *c, int64_t n, bool *rebuild, struct dm2_error *err)
{
    const struct config *config = c->job->config;
    const struct client_events *events = &c->options->events;
    bool history = results_history_due(config, n), snapshot = results_snapshot_due(config, n);
    int64_t every = c->options->hash_every;
    bool hashed = every > 0 && ((n + 1) % every == 0 || n + 1 == config->steps);
    struct step_sum sum;
    double start = clock_now();
    bool copy = c->copy_due;
    c->at = n + 1;
    expect_state(c, &c->snapshot, snapshot, n);
    expect_state(c, &c->copy, copy, n + 1);
    expect_profiles(c, n);
    enum dm2_status status = gather(c, MESSAGE_STEP, LIMIT_STEP, take_step, false, err);
    if (status == DM2_OK)
        status = sum_up(c, *rebuild, results_measure_due(config, n), hashed, c->survey, &sum, err);
    if (status == DM2_OK)
        status = exchange_step(c, rebuild, &sum, err);
    if (status != DM2_OK)
        return status;
    double sent = clock_now();
    if (!snapshot && !copy) { /* a step with a snapshot or a copy is not a time step alone */
        c->report.stepping += sent - start;
        c->report.timed++;
    }
    if (history)
        status = results_history(c->job->results, n, &sum.measures, err);
    if (status == DM2_OK)
        status = write_profiles(c, err);
    if (snapshot && status == DM2_OK)
        status = write_state(c, &c->snapshot, err);
    c->report.output += clock_now() - sent;
    if (copy && status == DM2_OK)
        status = write_state(c, &c->copy, err);
    note_copy(c, copy && status == DM2_OK, snapshot, clock_now() - start);
    c->report.steps = c->at;
    if (hashed && status == DM2_OK)
        tell_hash(c, c->at, sum.hash);
    if (events->step != NULL && status == DM2_OK)
        events->step(events->context, c->at, c->ranks > 1 ? c->peers[sum.slowest].channel.name : NULL,
                     sum.busy);
    if (copy && c->course->stopping && status == DM2_OK)
        status = dm2_fail(err, DM2_INTERRUPTED, "the run was interrupted by a signal at step %lld",
                          (long long)c->at);
    return status;
}

static enum dm2_status take_done(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct peer *p = &c->peers[rank];
    message_get_done(r, &p->done);
    if (r->failed)
        return not_decoded(c, rank, "DONE", err);
    struct server_report *s = &c->report.servers[rank];
    (void)snprintf(s->name, sizeof s->name, "%s", p->channel.name);
    s->cells = decomposition_cells(c->decomposition, rank);
    s->owned = p->ready.owned;
    s->mirrored = p->ready.mirrored;
    s->bytes = p->ready.bytes;
    s->times = p->done.times;
    return DM2_OK;
}

/* The last state, which the servers send unasked: as it is, then evaluated once more for the last measures.
 */
static enum dm2_status finish(struct client *c, struct dm2_error *err)
{
    const struct config *config = c->job->config;
    struct measures sum;
    double start = clock_now();
    bool snapshot = results_snapshot_due(config, config->steps);
    expect_state(c, &c->final, true, config->steps);
    expect_state(c, &c->snapshot, snapshot, config->steps);
    expect_profiles(c, config->steps);
    for (int k = 0; k < c->ranks; k++)
        c->peers[k].awaited = true;
    enum dm2_status status = gather(c, MESSAGE_DONE, LIMIT_STATE, take_done, false, err);
    measures_clear(&sum);
    for (int k = 0; k < c->ranks; k++)
        measures_merge(&sum, &c->peers[k].done.measures);
    if (status == DM2_OK && results_history_due(config, config->steps))
        status = results_history(c->job->results, config->steps, &sum, err);
    if (status == DM2_OK)
        status = write_profiles(c, err);
    if (status == DM2_OK && snapshot)
        status = write_state(c, &c->snapshot, err);
    if (status == DM2_OK)
        status = write_state(c, &c->final, err);
    c->report.output += clock_now() - start;
    return status;
}

/* --- the run --- */

static enum dm2_status run_steps(struct client *c, struct dm2_error *err)
{
    bool rebuild = rebuild_plan_expected(&c->plan); /* as ASSIGN said */
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < c->ranks; k++)
        c->peers[k].awaited = true; /* the servers start without being asked */
    c->stepping = c->course->stepping = true;
    for (int64_t n = starting_step(c); n < c->job->config->steps && status == DM2_OK; n++)
        status = step(c, n, &rebuild, err);
    return status;
}

static enum dm2_status open_profiles(struct client *c, struct dm2_error *err)
{
    const struct config *config = c->job->config;
    c->profiles = mem_zalloc(config->n_profiles, sizeof *c->profiles);
    for (size_t k = 0; k < config->n_profiles && c->profiles != NULL; k++) {
        struct profile_part *p = &c->profiles[k];
        p->bins = mem_zalloc((size_t)config->profiles[k].bins, sizeof *p->bins);
        p->came = mem_zalloc((size_t)c->ranks, sizeof *p->came);
        if (p->bins == NULL || p->came == NULL)
            return dm2_fail(err, DM2_MEMORY, "no memory for the profile '%s'", config->profiles[k].name);
    }
    return c->profiles != NULL ? DM2_OK : dm2_fail(err, DM2_MEMORY, "no memory for profiles");
}

static void close_profiles(struct client *c)
{
    for (size_t k = 0; c->profiles != NULL && k < c->job->config->n_profiles; k++) {
        free(c->profiles[k].bins);
        free(c->profiles[k].came);
    }
    free(c->profiles);
}

/* What connections need. */
static enum dm2_status open_peers(struct client *c, struct dm2_error *err)
{
    size_t n = (size_t)c->ranks;
    c->peers = mem_zalloc(n, sizeof *c->peers);
    c->polls = mem_zalloc(n + 1, sizeof *c->polls);
    c->polled = mem_zalloc(n, sizeof *c->polled);
    if (c->peers == NULL || c->polls == NULL || c->polled == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %d servers", c->ranks);
    return DM2_OK;
}

/* What a run needs beside them. */
static enum dm2_status open_client(struct client *c, struct dm2_error *err)
{
    size_t n = (size_t)c->ranks;
    struct wire_limits limits = wire_limits_of(c->job->model);
    enum dm2_status status = open_peers(c, err);
    if (status != DM2_OK)
        return status;
    c->sources = mem_zalloc(n, sizeof *c->sources);
    c->report.servers = mem_zalloc(n, sizeof *c->report.servers);
    if (c->sources == NULL || c->report.servers == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %d servers", c->ranks);
    state_merge_open(&c->snapshot.merge, limits);
    state_merge_open(&c->final.merge, limits);
    state_merge_open(&c->copy.merge, limits);
    rebuild_plan_start(&c->plan, c->job->config, model_margins(c->job->model));
    status = open_profiles(c, err);
    return status != DM2_OK ? status : relay_open(&c->relay, c->ranks, err);
}

/* Closes every connection; after a failure the servers learn why, as far as they listen. */
static void close_client(struct client *c, enum dm2_status status, const struct dm2_error *err)
{
    struct error_message m = {.status = status};
    if (status != DM2_OK && err != NULL)
        (void)snprintf(m.text, sizeof m.text, "%s", err->text);
    bytes_clear(&c->out);
    message_put_error(&c->out, &m);
    for (int k = 0; k < c->ranks && c->peers != NULL; k++) {
        struct peer *p = &c->peers[k];
        if (!p->open)
            continue;
        if (status != DM2_OK && !c->out.failed)
            (void)channel_send(&p->channel, MESSAGE_ERROR, 0, c->out.data, c->out.length,
                               deadline_in(PARTING_SECONDS, -1), NULL);
        channel_close(&p->channel);
    }
    relay_free(&c->relay);
    state_merge_free(&c->snapshot.merge);
    state_merge_free(&c->final.merge);
    state_merge_free(&c->copy.merge);
    close_profiles(c);
    bytes_free(&c->out);
    free(c->peers);
    free(c->polls);
    free(c->polled);
    free(c->sources);
}

/* How a session failed. */
struct loss {
    int culprit;   /* the rank that it failed by; -1: none */
    bool silent;   /* by its silence */
    bool stepping; /* once all servers were ready */
};

/* One session with every server, from the first connection on. */
static enum dm2_status run_session(const struct client_job *job, const struct client_options *options,
                                   struct course *course, struct loss *loss, struct dm2_error *err)
{
    struct client c = {.job = job,
                       .options = options,
                       .course = course,
                       .decomposition = course->decomposition,
                       .ranks = course->decomposition->ranks,
                       .at = -1,
                       .culprit = -1,
                       .report = course->report};
    double start = clock_now(), wait = c.report.wait;
    enum dm2_status status = open_client(&c, err);
    if (status == DM2_OK)
        status = connect_all(&c, err);
    if (status == DM2_OK)
        status = shake_hands(&c, err);
    if (status == DM2_OK && options->echo != NULL && !course->stepping)
        status = echo_all(&c, options->echo, err);
    if (status == DM2_OK)
        status = share_deck(&c, err);
    if (status == DM2_OK)
        status = assign_ranks(&c, err);
    c.report.set_up += clock_now() - start;
    c.report.wait = wait; /* of the steps alone */
    if (status == DM2_OK)
        status = run_steps(&c, err);
    if (status == DM2_OK)
        status = finish(&c, err);
    close_client(&c, status, err);
    c.report.ranks = c.ranks;
    if (status != DM2_OK) {
        free(c.report.servers);
        c.report.servers = NULL;
    }
    course->report = c.report;
    *loss = (struct loss){c.culprit, c.silent, c.stepping};
    return status;
}

/* --- after a loss --- */

static void tell(const struct client_options *options, const char *text)
{
    if (options->events.note != NULL)
        options->events.note(options->events.context, text);
}

/* Can the run go on after this failure? */
static bool is_loss(const struct client_options *o, const struct course *course, enum dm2_status status,
                    int culprit)
{
    return o->recover && course->stepping && !course->stopping && culprit >= 0 &&
           (status == DM2_NET || status == DM2_TIMEOUT || status == DM2_PROTOCOL);
}

/* Elements per cell in the last copy; model_cell_counts where there is none. */
static enum dm2_status weigh(const struct client_job *job, const struct course *course, uint32_t *weights,
                             struct dm2_error *err)
{
    const struct grid *g = model_grid(job->model);
    const struct state_merge *m = &course->copy;
    if (course->copy_step < 0)
        return model_cell_counts(job->model, weights, err);
    for (size_t k = 0; k < m->n_seen; k++)
        weights[grid_cell(g, m->elements[k].r[0], m->elements[k].r[1])]++;
    return DM2_OK;
}

/* Takes a server out and cuts the domain for those that remain. */
static enum dm2_status do_without(const struct client_job *job, struct course *course, int lost,
                                  struct dm2_error *err)
{
    const struct grid *g = model_grid(job->model);
    int ranks = course->decomposition->ranks - 1;
    uint32_t *weights = NULL;
    struct decomposition cut = {0};
    enum dm2_status status = DM2_OK;
    if (job->by_particles) {
        weights = mem_zalloc((size_t)g->cx * (size_t)g->cy, sizeof *weights);
        status = weights == NULL ? dm2_fail(err, DM2_MEMORY, "no memory for %d x %d cells", g->cx, g->cy)
                                 : weigh(job, course, weights, err);
    }
    if (status == DM2_OK)
        status = decomposition_bisect(g, ranks, weights, &cut, err);
    free(weights);
    if (status != DM2_OK)
        return status;
    memmove(&course->stations[lost], &course->stations[lost + 1],
            (size_t)(ranks - lost) * sizeof *course->stations);
    decomposition_free(&course->cut);
    course->cut = cut;
    course->decomposition = &course->cut;
    return DM2_OK;
}

/* All servers anew, where this program's caller started them. */
static enum dm2_status renew(const struct client_options *options, struct course *course,
                             struct dm2_error *err)
{
    int ranks = course->decomposition->ranks;
    if (++course->renewals > LOSSES_MOST)
        return dm2_fail(err, DM2_NET, "servers were lost %d times without a new copy of the state between",
                        course->renewals);
    struct endpoint *servers = mem_zalloc((size_t)ranks, sizeof *servers);
    enum dm2_status status = servers == NULL ? dm2_fail(err, DM2_MEMORY, "no memory for %d servers", ranks)
                                             : options->renew(options->renew_context, ranks, servers, err);
    for (int k = 0; k < ranks && status == DM2_OK; k++)
        course->stations[k].at = servers[k];
    free(servers);
    return status;
}

/* Decides who takes the place of a server that was lost; `absent`: it is not there any more, or silent. */
static enum dm2_status replace(const struct client_job *job, const struct client_options *options,
                               struct course *course, int lost, bool absent, struct dm2_error *err)
{
    struct station *s = &course->stations[lost];
    char line[2 * HOST_MAX + 200], from[32] = "the beginning";
    if (course->copy_step >= 0)
        (void)snprintf(from, sizeof from, "step %lld", (long long)course->copy_step);
    else if (job->start != NULL)
        (void)snprintf(from, sizeof from, "step %lld", (long long)job->start->step);
    course->report.losses++;
    if (options->renew != NULL) {
        (void)snprintf(line, sizeof line, "going on from %s with servers started anew", from);
        tell(options, line);
        return renew(options, course, err);
    }
    if (!absent && ++s->losses <= LOSSES_MOST) {
        (void)snprintf(line, sizeof line, "going on from %s, waiting up to %g s for %s:%d", from,
                       options->reconnect, s->at.host, s->at.port);
        tell(options, line);
        return DM2_OK;
    }
    if (course->spares_used < options->n_spares) {
        const struct endpoint *spare = &options->spares[course->spares_used++];
        (void)snprintf(line, sizeof line, "going on from %s with the spare %s:%d in place of %s:%d", from,
                       spare->host, spare->port, s->at.host, s->at.port);
        *s = (struct station){.at = *spare};
        tell(options, line);
        return DM2_OK;
    }
    if (course->decomposition->ranks == 1)
        return dm2_fail(err, DM2_NET, "no server is left");
    (void)snprintf(line, sizeof line, "going on from %s without %s:%d, with %d of the servers", from,
                   s->at.host, s->at.port, course->decomposition->ranks - 1);
    tell(options, line);
    return do_without(job, course, lost, err);
}

/* Sessions, until one comes to the end of the run or nobody is left. */
static enum dm2_status run_course(const struct client_job *job, const struct client_options *options,
                                  struct course *course, struct dm2_error *err)
{
    for (;;) {
        struct loss loss;
        struct dm2_error why = {0}, end = {0};
        enum dm2_status status = run_session(job, options, course, &loss, &why);
        if (status == DM2_OK || !is_loss(options, course, status, loss.culprit))
            return status == DM2_OK ? DM2_OK : dm2_fail(err, status, "%s", why.text);
        tell(options, why.text);
        status = replace(job, options, course, loss.culprit, loss.silent || !loss.stepping, &end);
        if (status != DM2_OK)
            return dm2_fail(err, status, "%.250s: %.340s", end.text, why.text);
        copy_plan_start(&course->plan, options->copy_every, course->copy_step >= 0 ? course->copy_step : 0);
    }
}

/* A run that cannot go on leaves the newest state that is in hand, unless the disk is what failed. */
static void leave_checkpoint(const struct client_job *job, struct course *course, enum dm2_status status)
{
    const struct state_merge *m = &course->copy;
    if (status != DM2_IO && course->copy_step > results_checkpoint_step(job->results))
        (void)results_checkpoint(job->results,
                                 &(struct state_view){.step = course->copy_step,
                                                      .elements = m->elements,
                                                      .n_elements = m->n_seen,
                                                      .pairs = m->pairs,
                                                      .n_pairs = m->n_pairs},
                                 NULL);
}

enum dm2_status client_run(const struct client_job *job, const struct client_options *options,
                           struct run_report *report, struct dm2_error *err)
{
    int ranks = job->decomposition->ranks;
    double start = clock_now();
    struct course course = {.stations = mem_zalloc((size_t)ranks, sizeof *course.stations),
                            .decomposition = job->decomposition,
                            .copy_step = -1,
                            .hashed = -1};
    *report = (struct run_report){0};
    if (course.stations == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %d servers", ranks);
    for (int k = 0; k < ranks; k++)
        course.stations[k].at = options->servers[k];
    state_merge_open(&course.copy, wire_limits_of(job->model));
    copy_plan_start(&course.plan, options->recover ? options->copy_every : 0,
                    job->start != NULL ? job->start->step : 0);
    enum dm2_status status = run_course(job, options, &course, err);
    if (status != DM2_OK)
        leave_checkpoint(job, &course, status);
    decomposition_free(&course.cut);
    state_merge_free(&course.copy);
    free(course.stations);
    if (status != DM2_OK)
        return status;
    course.report.program = "dm2-client";
    course.report.version = options->version;
    course.report.deck = options->deck_path;
    course.report.elements = model_elements(job->model);
    course.report.update_bytes = 8 * subdomain_update_width(job->model);
    course.report.total = clock_now() - start;
    *report = course.report;
    return DM2_OK;
}

enum dm2_status client_measure_network(const struct client_options *options, int ranks, struct dm2_error *err)
{
    struct course course = {.stations = mem_zalloc((size_t)ranks, sizeof *course.stations), .copy_step = -1};
    struct client c = {.options = options, .course = &course, .ranks = ranks, .at = -1, .culprit = -1};
    struct dm2_error why = {0};
    for (int k = 0; k < ranks && course.stations != NULL; k++)
        course.stations[k].at = options->servers[k];
    enum dm2_status status = course.stations != NULL
                                 ? open_peers(&c, &why)
                                 : dm2_fail(&why, DM2_MEMORY, "no memory for %d servers", ranks);
    if (status == DM2_OK)
        status = connect_all(&c, &why);
    if (status == DM2_OK)
        status = shake_hands(&c, &why);
    if (status == DM2_OK)
        status = echo_all(&c, options->echo, &why);
    bytes_clear(&c.out);
    for (int k = 0; k < ranks && status == DM2_OK; k++) /* an empty one: that was all */
        status = send_out(&c, k, MESSAGE_ECHO, &why);
    close_client(&c, status, &why);
    free(course.stations);
    return status == DM2_OK ? DM2_OK : dm2_fail(err, status, "%s", why.text);
}
