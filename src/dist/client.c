/* One run, from the first connection to the last result.
 *
 * The stages follow the flow of the paper's Fig. 7 and of docs/protocol.md; in each the client sends every
 * server its message and then gathers one answer from each with poll, in whatever order they come. During the
 * steps
 *
 *     gather   STEP from every rank, with the STATE parts of a snapshot and PROFILE sums before it where they are due
 *     decide   sums of counts, dmax, dumax: was this exchange of the right kind, what will the next one be
 *     route    segments to their destinations, straight out of the buffers they came in
 *     send     NEXT to every rank
 *     write    history, snapshots, while the servers compute
 *
 * Any failure closes all connections, which ends all sessions. */
#include "dm2/dist/client.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/clock.h"
#include "dm2/base/fingerprint.h"
#include "dm2/base/hmac.h"
#include "dm2/base/mem.h"
#include "dm2/dist/messages.h"
#include "dm2/dist/relay.h"
#include "dm2/dist/state_merge.h"
#include "dm2/sim/deck_digest.h"
#include "dm2/sim/rebuild.h"
#include "dm2/sim/subdomain.h"

static const double CONNECT_SECONDS = 10.0; /* at most, to open one connection */
static const double BUSY_SECONDS = 1.0;     /* of silence after HELLO until the user is told */
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
};

/* A state on its way in. */
struct compilation {
    struct state_merge merge;
    bool due;     /* parts may come now, */
    int64_t step; /* of this step */
    int left;     /* servers whose part is not complete */
};

/* The sums of a profile on their way in. */
struct profile_part {
    struct profile_bin *bins;
    bool *came;   /* from which server */
    bool due;
    int left;     /* servers whose part has not come */
};

struct client {
    const struct client_job *job;
    const struct client_options *options;
    int ranks;
    struct peer *peers;
    struct pollfd *polls; /* ranks + 1 */
    int *polled;          /* whose they are */
    struct bytes_writer out;
    struct relay relay;
    struct relay_source *sources;
    struct compilation snapshot, final;
    struct profile_part *profiles; /* of the deck */
    int64_t profile_step;          /* that they are of */
    struct rebuild_plan plan;
    int64_t at; /* step for messages: -1 before the first */
    struct run_report report;
};

/* --- failures ---------------------------------------------------------------------------------------------
 */

static void when(const struct client *c, char *out, size_t size)
{
    if (c->at < 0)
        (void)snprintf(out, size, "before the first step");
    else
        (void)snprintf(out, size, "step %lld", (long long)c->at);
}

/* The failure of one server, with step and advice around `why`. */
static enum dm2_status peer_failed(const struct client *c, int rank, enum dm2_status status, const char *why,
                                   struct dm2_error *err)
{
    const char *name = c->peers[rank].channel.name;
    char step[64], text[600];
    when(c, step, sizeof step);
    (void)snprintf(text, sizeof text, "%s", why); /* *err may be what `why` lies in */
    if (status == DM2_INTERRUPTED || status == DM2_MEMORY)
        return dm2_fail(err, status, "%s", text);
    const char *advice =
        status == DM2_NET ? "; see that server's log, start it again and repeat the run" : "";
    bool named = strncmp(text, name, strlen(name)) == 0;
    return dm2_fail(err, status, "server %d of %d, %s: %s%s%s%s", rank, c->ranks, step, named ? "" : name,
                    named ? "" : ": ", text, advice);
}

/* The server said ERROR itself. */
static enum dm2_status peer_error(const struct client *c, int rank, struct bytes_reader r,
                                  struct dm2_error *err)
{
    struct error_message m;
    char text[600];
    message_get_error(&r, &m);
    if (!r.failed && strcmp(m.text, REFUSAL_TEXT) == 0)
        return peer_failed(c, rank, DM2_PROTOCOL,
                           c->options->key == NULL
                               ? "it refuses the connection: it wants a key (--key FILE), or does not admit this machine"
                               : "it refuses the connection: it has another key, or does not admit this machine",
                           err);
    (void)snprintf(text, sizeof text, "ended the session: %.560s",
                   r.failed ? "its reason does not decode" : m.text);
    /* a server that was asked to end could not be used; one that found the deck wrong found the deck wrong */
    enum dm2_status status = m.status == DM2_INTERRUPTED || m.status == DM2_TIMEOUT ? DM2_NET : m.status;
    return peer_failed(c, rank, status, text, err);
}

/* --- one message to, and one answer from, every server -----------------------------------------------------
 */

typedef enum dm2_status (*take_answer)(struct client *c, int rank, struct bytes_reader *r,
                                       struct dm2_error *err);

static struct deadline patience(const struct client *c)
{
    return deadline_in(c->options->timeout, c->options->cancel);
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

static enum dm2_status not_decoded(const struct client *c, int rank, const char *what, struct dm2_error *err)
{
    char text[100];
    (void)snprintf(text, sizeof text, "its %s message does not decode", what);
    return peer_failed(c, rank, DM2_PROTOCOL, text, err);
}

static enum dm2_status take_state(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct state_message m;
    struct dm2_error why = {0};
    message_get_state(r, &m);
    if (r->failed)
        return not_decoded(c, rank, "STATE", err);
    struct compilation *state = m.purpose == STATE_FINAL ? &c->final : &c->snapshot;
    if (!state->due || m.step != state->step)
        return peer_failed(c, rank, DM2_PROTOCOL, "it sent a state that is not due", err);
    enum dm2_status status = state_merge_add(&state->merge, &m, r, &why);
    state->left -= m.last;
    return status == DM2_OK ? DM2_OK : peer_failed(c, rank, status, why.text, err);
}

/* The server is told that this client has the key. */
static enum dm2_status answer_challenge(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
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
    const struct config *config = c->job->config;
    struct profile_message m;
    message_get_profile(r, &m);
    if (r->failed)
        return not_decoded(c, rank, "PROFILE", err);
    if (m.which >= config->n_profiles || !c->profiles[m.which].due || c->profiles[m.which].came[rank] ||
        m.step != c->profile_step || m.n_bins != (size_t)config->profiles[m.which].bins)
        return peer_failed(c, rank, DM2_PROTOCOL, "it sent a profile that is not due", err);
    struct profile_part *p = &c->profiles[m.which];
    for (size_t k = 0; k < m.n_bins; k++) {
        struct profile_bin bin;
        wire_get_bin(r, &bin);
        profile_merge(&p->bins[k], &bin, 1);
    }
    p->came[rank] = true;
    p->left--;
    return DM2_OK;
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

/* Waits until an awaited server has something, or the first of them has been silent too long since `since`.
 */
static enum dm2_status wait_for_any(struct client *c, double since, double note_at, int *n,
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
    double until = note_at > now && note_at < first ? note_at : first;
    c->polls[*n] = (struct pollfd){.fd = c->options->cancel, .events = POLLIN};
    double wait = until > now ? ceil(1000 * (until - now)) : 0;
    int ready = poll(c->polls, (nfds_t)*n + 1, wait < 1e9 ? (int)wait : 1000000000);
    if (ready < 0 && errno != EINTR && errno != EAGAIN)
        return dm2_fail(err, DM2_NET, "poll: %s", strerror(errno));
    if (ready > 0 && c->options->cancel >= 0 && c->polls[*n].revents != 0)
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

/* One message of `type` from every awaited server. With `note`, the user is told of those that do not answer
 * soon. */
static enum dm2_status gather(struct client *c, enum message_type type, uint32_t limit, take_answer take,
                              bool note, struct dm2_error *err)
{
    double since = clock_now(), note_at = note ? since + BUSY_SECONDS : -1;
    int awaited = 0;
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < c->ranks && status == DM2_OK; k++) {
        if (c->peers[k].awaited && channel_pending(&c->peers[k].channel)) /* came with the message before */
            status = take_frames(c, k, type, limit, take, err);
        awaited += c->peers[k].awaited;
    }
    while (awaited > 0 && status == DM2_OK) {
        int n;
        status = wait_for_any(c, since, note_at, &n, err);
        for (int k = 0; k < n && status == DM2_OK; k++) {
            if (c->polls[k].revents == 0)
                continue;
            status = take_frames(c, c->polled[k], type, limit, take, err);
            awaited -= !c->peers[c->polled[k]].awaited;
        }
        if (note_at > 0 && status == DM2_OK && clock_now() >= note_at) {
            note_busy(c);
            note_at = -1;
        }
    }
    c->report.wait += clock_now() - since;
    return status;
}

/* --- before the steps --------------------------------------------------------------------------------------
 */

static enum dm2_status connect_all(struct client *c, struct dm2_error *err)
{
    for (int k = 0; k < c->ranks; k++) {
        const struct endpoint *e = &c->options->servers[k];
        char name[SOCKET_NAME];
        int fd;
        struct dm2_error why = {0};
        struct deadline until = deadline_in(fmin(CONNECT_SECONDS, c->options->timeout), c->options->cancel);
        (void)snprintf(name, sizeof name, "%s:%d", e->host, e->port);
        enum dm2_status status = socket_connect(e->host, e->port, until, &fd, &why);
        if (status != DM2_OK) {
            channel_open(&c->peers[k].channel, -1, PROTOCOL_VERSION, name);
            return dm2_fail(err, status, "server %d of %d, before the first step: %s", k, c->ranks, why.text);
        }
        channel_open(&c->peers[k].channel, fd, PROTOCOL_VERSION, name);
        c->peers[k].open = true;
    }
    return DM2_OK;
}

/* The server has proved that it has the key, too: from here on every frame is checked with the session's keys. */
static enum dm2_status take_grant(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct peer *p = &c->peers[rank];
    unsigned char code[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    const unsigned char *proof = bytes_get_raw(r, AUTH_CODE);
    if (!bytes_done(r) || !p->challenged)
        return not_decoded(c, rank, "GRANT", err);
    auth_code(c->options->key, AUTH_SERVER, PROTOCOL_VERSION, &p->nonces, code);
    if (!hmac_equal(code, proof, AUTH_CODE))
        return peer_failed(c, rank, DM2_PROTOCOL, "it does not have the key: is this the right machine?", err);
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

static enum dm2_status take_ready(struct client *c, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    message_get_ready(r, &c->peers[rank].ready);
    return r->failed ? not_decoded(c, rank, "READY", err) : DM2_OK;
}

static enum dm2_status assign_ranks(struct client *c, struct dm2_error *err)
{
    const struct decomposition *d = c->job->decomposition;
    struct assign_message m = {.ranks = c->ranks,
                               .cx = d->grid.cx,
                               .cy = d->grid.cy,
                               .elements = model_elements(c->job->model),
                               .rects = d->rect,
                               .timeout = c->options->timeout,
                               .hash_every = c->options->hash_every,
                               .rebuild_first = rebuild_plan_expected(&c->plan)};
    for (m.rank = 0; m.rank < c->ranks; m.rank++) {
        decomposition_interfaces(d, m.rank, m.interfaces);
        bytes_clear(&c->out);
        message_put_assign(&c->out, &m);
        enum dm2_status status = send_out(c, m.rank, MESSAGE_ASSIGN, err);
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
    if (status == DM2_OK && m.hash_every > 0 && c->options->events.hash != NULL)
        c->options->events.hash(c->options->events.context, 0, hash);
    return status;
}

/* --- steps -------------------------------------------------------------------------------------------------
 */

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
    struct measures measures;
};

static enum dm2_status sum_up(struct client *c, bool rebuild, bool measured, bool hashed,
                              struct step_sum *sum, struct dm2_error *err)
{
    uint64_t elements = 0;
    *sum = (struct step_sum){0};
    measures_clear(&sum->measures);
    for (int k = 0; k < c->ranks; k++) {
        const struct step_message *m = &c->peers[k].step;
        if (m->step != c->at || m->rebuild != rebuild || m->measured != measured || m->hashed != hashed) {
            char text[160];
            (void)snprintf(text, sizeof text,
                           "its STEP message is of step %lld (rebuild %d, measures %d, hash %d), not as "
                           "asked for (%d, %d, %d)",
                           (long long)m->step, m->rebuild, m->measured, m->hashed, rebuild, measured, hashed);
            return peer_failed(c, k, DM2_PROTOCOL, text, err);
        }
        elements += m->owned;
        sum->dmax = m->dmax > sum->dmax ? m->dmax : sum->dmax;
        if (m->busy > sum->busy || k == 0) {
            sum->busy = m->busy;
            sum->slowest = k;
        }
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

static void expect_state(struct client *c, struct compilation *state, bool due, int64_t step)
{
    state->due = due;
    state->step = step;
    state->left = due ? c->ranks : 0;
    if (due)
        state_merge_clear(&state->merge);
}

static enum dm2_status write_state(struct client *c, struct compilation *state, struct dm2_error *err)
{
    struct state_merge *m = &state->merge;
    struct dm2_error why = {0};
    enum dm2_status status = state->left == 0
                                 ? state_merge_finish(m, &why)
                                 : dm2_fail(&why, DM2_PROTOCOL, "a server did not finish sending its part");
    state->due = false;
    if (status != DM2_OK)
        return dm2_fail(err, status, "compiling the state of step %lld: %s", (long long)state->step,
                        why.text);
    if (state == &c->final)
        return results_final(c->job->results, state->step, m->elements, m->n_seen, m->pairs, m->n_pairs, err);
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
        p->left = p->due ? c->ranks : 0;
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
        if (p->left > 0)
            return dm2_fail(err, DM2_PROTOCOL, "step %lld: a server did not send its part of the profile '%s'",
                            (long long)c->profile_step, c->job->config->profiles[k].name);
        status = results_profile(c->job->results, k, c->profile_step, p->bins, err);
    }
    return status;
}

/* Decides, routes and sends: what ends one step and starts the next. *rebuild is how this exchange was asked
 * for, and becomes how the next one will be. */
static enum dm2_status exchange_step(struct client *c, bool *rebuild, double dmax, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    bool last = c->at == c->job->config->steps;
    if (rebuild_plan_step(&c->plan, dmax) && !*rebuild) {
        struct step_sum again;
        *rebuild = true;
        c->report.redone++;
        status = send_next(c, (struct next_message){.step = c->at, .redo = true}, false, err);
        if (status == DM2_OK)
            status = gather(c, MESSAGE_STEP, LIMIT_STEP, take_step, false, err);
        if (status == DM2_OK)
            status = sum_up(c, true, false, false, &again, err);
        if (status != DM2_OK)
            return status;
    }
    if (*rebuild) {
        rebuild_plan_done(&c->plan);
        c->report.rebuilds++;
    }
    *rebuild = !last && rebuild_plan_expected(&c->plan);
    double start = clock_now();
    status = send_next(c, (struct next_message){.step = c->at, .rebuild_next = *rebuild}, true, err);
    c->report.relay += clock_now() - start;
    return status;
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
    c->at = n + 1;
    expect_state(c, &c->snapshot, snapshot, n);
    expect_profiles(c, n);
    enum dm2_status status = gather(c, MESSAGE_STEP, LIMIT_STEP, take_step, false, err);
    if (status == DM2_OK)
        status = sum_up(c, *rebuild, results_measure_due(config, n), hashed, &sum, err);
    if (status == DM2_OK)
        status = exchange_step(c, rebuild, sum.dmax, err);
    if (status != DM2_OK)
        return status;
    double sent = clock_now();
    if (!snapshot) { /* a step with a snapshot is not a time step alone */
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
    c->report.steps = c->at;
    if (hashed && events->hash != NULL && status == DM2_OK)
        events->hash(events->context, c->at, sum.hash);
    if (events->step != NULL && status == DM2_OK)
        events->step(events->context, c->at, sum.slowest, sum.busy);
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
    s->cells = decomposition_cells(c->job->decomposition, rank);
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

/* --- the run -----------------------------------------------------------------------------------------------
 */

static enum dm2_status run_steps(struct client *c, struct dm2_error *err)
{
    bool rebuild = rebuild_plan_expected(&c->plan); /* as ASSIGN said */
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < c->ranks; k++)
        c->peers[k].awaited = true; /* the servers start without being asked */
    for (int64_t n = 0; n < c->job->config->steps && status == DM2_OK; n++)
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

static enum dm2_status open_client(struct client *c, struct dm2_error *err)
{
    size_t n = (size_t)c->ranks;
    struct wire_limits limits = wire_limits_of(c->job->model);
    c->peers = mem_zalloc(n, sizeof *c->peers);
    c->polls = mem_zalloc(n + 1, sizeof *c->polls);
    c->polled = mem_zalloc(n, sizeof *c->polled);
    c->sources = mem_zalloc(n, sizeof *c->sources);
    c->report.servers = mem_zalloc(n, sizeof *c->report.servers);
    if (c->peers == NULL || c->polls == NULL || c->polled == NULL || c->sources == NULL ||
        c->report.servers == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %d servers", c->ranks);
    state_merge_open(&c->snapshot.merge, limits);
    state_merge_open(&c->final.merge, limits);
    rebuild_plan_start(&c->plan, c->job->config);
    enum dm2_status status = open_profiles(c, err);
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
    close_profiles(c);
    bytes_free(&c->out);
    free(c->peers);
    free(c->polls);
    free(c->polled);
    free(c->sources);
}

enum dm2_status client_run(const struct client_job *job, const struct client_options *options,
                           struct run_report *report, struct dm2_error *err)
{
    struct client c = {.job = job, .options = options, .ranks = job->decomposition->ranks, .at = -1};
    struct dm2_error why = {0};
    double start = clock_now();
    *report = (struct run_report){0};
    enum dm2_status status = open_client(&c, &why);
    if (status == DM2_OK)
        status = connect_all(&c, &why);
    if (status == DM2_OK)
        status = shake_hands(&c, &why);
    if (status == DM2_OK)
        status = share_deck(&c, &why);
    if (status == DM2_OK)
        status = assign_ranks(&c, &why);
    c.report.set_up = clock_now() - start;
    c.report.wait = 0; /* of the steps alone */
    if (status == DM2_OK)
        status = run_steps(&c, &why);
    if (status == DM2_OK)
        status = finish(&c, &why);
    close_client(&c, status, &why);
    if (status != DM2_OK) {
        free(c.report.servers);
        return dm2_fail(err, status, "%s", why.text);
    }
    c.report.program = "dm2-client";
    c.report.version = options->version;
    c.report.deck = options->deck_path;
    c.report.elements = model_elements(job->model);
    c.report.ranks = c.ranks;
    c.report.update_bytes = 8 * subdomain_update_width(job->model);
    c.report.total = clock_now() - start;
    *report = c.report;
    return DM2_OK;
}
