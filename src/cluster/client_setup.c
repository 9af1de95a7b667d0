/* Each stage sends one message to every server and gathers one answer from each (docs/protocol.md). */
#include "client_parts.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "dm2/base/bytes.h"
#include "dm2/base/clock.h"
#include "dm2/base/hmac.h"
#include "dm2/base/mem.h"
#include "dm2/cluster/inquiry.h"
#include "dm2/deck/meaning.h"
#include "dm2/deck/start.h"
#include "dm2/engine/self_test.h"
#include "state_parts.h"

static const double CONNECT_SECONDS = 10.0; /* for one attempt to connect, at most */
static const double RETRY_SECONDS = 0.05;   /* between attempts to reach a lost server */
static const double BUSY_ASK_SECONDS = 1.0; /* for a busy server to say whom it serves */

/* --- connections --- */

/* Connects to one server, and repeats failed attempts until the time `until`, because a lost server may be
 * started anew. */
static enum dm2_status connect_server(struct client *c, const struct endpoint *e, double until, int *fd,
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

enum dm2_status client_connect(struct client *c, struct dm2_error *err)
{
    double last = c->course->stepping ? clock_now() + c->options->reconnect : 0;
    for (int k = 0; k < c->ranks; k++) {
        const struct endpoint *e = &c->course->stations[k].at;
        char name[SOCKET_NAME];
        int fd;
        struct dm2_error why = {0};
        (void)snprintf(name, sizeof name, "%s:%d", e->host, e->port);
        enum dm2_status status = connect_server(c, e, last, &fd, &why);
        if (status != DM2_OK) {
            char step[64];
            conversation_name_step(&c->talk, step, sizeof step);
            c->talk.culprit = k;
            channel_open(&c->talk.peers[k].channel, -1, PROTOCOL_VERSION, name);
            return dm2_fail(err, status, "server %d of %d, %s: %s", k, c->ranks, step, why.text);
        }
        channel_open(&c->talk.peers[k].channel, fd, PROTOCOL_VERSION, name);
        c->talk.peers[k].open = true;
    }
    return DM2_OK;
}

/* --- the hand-shake --- */

enum dm2_status client_answer_challenge(struct client *c, int rank, struct bytes_reader *r,
                                        struct dm2_error *err)
{
    struct server_answers *a = &c->answers[rank];
    unsigned char code[AUTH_CODE];
    const unsigned char *nonce = bytes_get_raw(r, AUTH_NONCE);
    if (!bytes_done(r))
        return conversation_not_decoded(&c->talk, rank, "CHALLENGE", err);
    memcpy(a->nonces.server, nonce, AUTH_NONCE);
    a->challenged = true;
    auth_code(c->options->key, AUTH_CLIENT, PROTOCOL_VERSION, &a->nonces, code);
    return conversation_reply(&c->talk, rank, MESSAGE_PROOF, code, AUTH_CODE, err);
}

/* Checks the proof of one server; from here on the session's keys check every frame. */
static enum dm2_status take_grant(void *context, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct client *c = context;
    struct server_answers *a = &c->answers[rank];
    unsigned char code[AUTH_CODE], in[SIPHASH_KEY], out[SIPHASH_KEY];
    const unsigned char *proof = bytes_get_raw(r, AUTH_CODE);
    if (!bytes_done(r) || !a->challenged)
        return conversation_not_decoded(&c->talk, rank, "GRANT", err);
    auth_code(c->options->key, AUTH_SERVER, PROTOCOL_VERSION, &a->nonces, code);
    if (!hmac_equal(code, proof, AUTH_CODE))
        return conversation_failed(&c->talk, rank, DM2_PROTOCOL,
                                   "it does not have the key: is this the right machine?", err);
    auth_session_key(c->options->key, AUTH_SERVER, PROTOCOL_VERSION, &a->nonces, in);
    auth_session_key(c->options->key, AUTH_CLIENT, PROTOCOL_VERSION, &a->nonces, out);
    channel_use_keys(&c->talk.peers[rank].channel, in, out);
    return DM2_OK;
}

/* Sends KNOCK to every server and gathers GRANT; CHALLENGE comes between the two. */
static enum dm2_status prove_key(struct client *c, struct dm2_error *err)
{
    for (int k = 0; k < c->ranks; k++) {
        struct server_answers *a = &c->answers[k];
        enum dm2_status status = auth_nonce(a->nonces.client, err);
        a->challenged = false;
        bytes_clear(&c->talk.out);
        bytes_put_raw(&c->talk.out, a->nonces.client, AUTH_NONCE);
        if (status == DM2_OK)
            status = conversation_send(&c->talk, k, MESSAGE_KNOCK, err);
        if (status != DM2_OK)
            return status;
    }
    return conversation_gather(&c->talk, MESSAGE_GRANT, LIMIT_HELLO, take_grant, true, err);
}

static enum dm2_status take_place(void *context, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct client *c = context;
    message_get_place(r, &c->answers[rank].place);
    return r->failed ? conversation_not_decoded(&c->talk, rank, "PLACE", err) : DM2_OK;
}

static enum dm2_status take_welcome(void *context, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct client *c = context;
    struct hello_message m;
    char text[300];
    message_get_hello(r, &m);
    if (r->failed)
        return conversation_not_decoded(&c->talk, rank, "WELCOME", err);
    c->talk.peers[rank].greeted = true;
    if (strcmp(m.version, c->options->version) != 0) {
        (void)snprintf(
            text, sizeof text,
            "the releases differ: dm2 %s there, dm2 %s here: install the same dm2 on both machines",
            m.version, c->options->version);
        return conversation_failed(&c->talk, rank, DM2_PROTOCOL, text, err);
    }
    if (m.fingerprint == SELF_TEST_FINGERPRINT)
        return DM2_OK;
    (void)snprintf(text, sizeof text,
                   "the arithmetic differs: fingerprint %016llx there (dm2 %s), %016llx here (dm2 %s)",
                   (unsigned long long)m.fingerprint, m.version, (unsigned long long)SELF_TEST_FINGERPRINT,
                   c->options->version);
    return conversation_failed(&c->talk, rank, DM2_PROTOCOL, text, err);
}

/* Sends HELLO to one server: for its place, or for the client's turn. */
static enum dm2_status send_hello(struct client *c, int rank, bool turn, struct dm2_error *err)
{
    struct hello_message m = {.turn = turn, .fingerprint = SELF_TEST_FINGERPRINT};
    (void)snprintf(m.version, sizeof m.version, "%s", c->options->version);
    bytes_clear(&c->talk.out);
    message_put_hello(&c->talk.out, &m);
    return conversation_send(&c->talk, rank, MESSAGE_HELLO, err);
}

/* Fails because ranks a and b are one server under two names; says where a hosts file names them. */
static enum dm2_status refuse_same_server(struct client *c, int a, int b, struct dm2_error *err)
{
    const int line[2] = {c->course->stations[a].at.line, c->course->stations[b].at.line};
    char text[SOCKET_NAME + 150], lines[80] = "";
    if (line[0] > 0 && line[1] > 0)
        (void)snprintf(lines, sizeof lines, " (lines %d and %d of the hosts file)", line[0], line[1]);
    (void)snprintf(text, sizeof text,
                   "it is the same server as %s, under another name%s: name each server once",
                   c->talk.peers[a].channel.name, lines);
    return conversation_failed(&c->talk, b, DM2_PROTOCOL, text, err);
}

/* Sorts the ranks into order[ranks] by the ids of their servers. DM2_PROTOCOL: two are one server. */
static enum dm2_status order_servers(struct client *c, int *order, struct dm2_error *err)
{
    for (int k = 0; k < c->ranks; k++) {
        const unsigned char *id = c->answers[k].place.id;
        int at = k;
        for (; at > 0 && memcmp(c->answers[order[at - 1]].place.id, id, SERVER_ID) > 0; at--)
            order[at] = order[at - 1];
        order[at] = k;
        if (at > 0 && memcmp(c->answers[order[at - 1]].place.id, id, SERVER_ID) == 0)
            return refuse_same_server(c, order[at - 1], k, err);
    }
    return DM2_OK;
}

/* After a wait in vain for a turn: says in *err whom the server serves, as far as the server tells. */
static void blame_other_client(struct client *c, int rank, struct dm2_error *err)
{
    struct report_message m;
    char text[SOCKET_NAME + 400];
    if (inquiry_ask(&c->course->stations[rank].at, c->options->key, BUSY_ASK_SECONDS, c->options->cancel, &m,
                    NULL) != DM2_OK ||
        !m.busy)
        return;
    (void)snprintf(text, sizeof text,
                   "it serves %s (%s, step %lld) for %.0f s already, longer than --timeout %g waits", m.peer,
                   m.deck[0] != '\0' ? m.deck : "no deck yet", (long long)m.step, m.seconds,
                   c->options->timeout);
    (void)conversation_failed(&c->talk, rank, DM2_TIMEOUT, text, err);
}

/* Takes the client's turn at every server. */
static enum dm2_status take_turns(struct client *c, const int *order, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < c->ranks && status == DM2_OK; k++) {
        status = send_hello(c, order[k], true, err);
        if (status == DM2_OK)
            status = conversation_gather(&c->talk, MESSAGE_WELCOME, LIMIT_HELLO, take_welcome, true, err);
        if (status == DM2_TIMEOUT)
            blame_other_client(c, order[k], err);
    }
    return status;
}

enum dm2_status client_greet(struct client *c, struct dm2_error *err)
{
    enum dm2_status status = c->options->key != NULL ? prove_key(c, err) : DM2_OK;
    int *order = mem_alloc((size_t)c->ranks, sizeof *order);
    if (status == DM2_OK && order == NULL)
        status = dm2_fail(err, DM2_MEMORY, "no memory for %d servers", c->ranks);
    for (int k = 0; k < c->ranks && status == DM2_OK; k++)
        status = send_hello(c, k, false, err);
    if (status == DM2_OK)
        status = conversation_gather(&c->talk, MESSAGE_PLACE, LIMIT_HELLO, take_place, true, err);
    if (status == DM2_OK)
        status = order_servers(c, order, err);
    if (status == DM2_OK)
        status = take_turns(c, order, err);
    free(order);
    return status;
}

/* --- round trips --- */

static enum dm2_status take_echo(void *context, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct client *c = context;
    if (bytes_remaining(r) == c->talk.out.length &&
        memcmp(r->data + r->at, c->talk.out.data, c->talk.out.length) == 0)
        return DM2_OK;
    return conversation_failed(&c->talk, rank, DM2_PROTOCOL, "it did not send the same bytes back", err);
}

/* Sends one message of n bytes to every server and back; *seconds is the time for all. A pause comes first,
 * because in a time step the messages also reach sleeping processes, and waking the processes is a good part
 * of b_N. */
static enum dm2_status send_echo(struct client *c, uint32_t n, double *seconds, struct dm2_error *err)
{
    const struct timespec pause = {.tv_nsec = 200000};
    (void)nanosleep(&pause, NULL);
    bytes_clear(&c->talk.out);
    for (uint32_t k = 0; k < n; k++)
        bytes_put_u8(&c->talk.out, (uint8_t)(k * 31));
    enum dm2_status status = DM2_OK;
    double start = clock_now();
    for (int k = 0; k < c->ranks && status == DM2_OK; k++)
        status = conversation_send(&c->talk, k, MESSAGE_ECHO, err);
    if (status == DM2_OK)
        status = conversation_gather(&c->talk, MESSAGE_ECHO, LIMIT_DECK, take_echo, false, err);
    *seconds = clock_now() - start;
    return status;
}

enum dm2_status client_echo(struct client *c, struct client_echo *e, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    double start = clock_now();
    for (e->done = 0; e->done < e->repeats && status == DM2_OK; e->done++) {
        if (e->done >= 2 && clock_now() - start > e->budget)
            break;
        for (int k = 0; k < e->sizes && status == DM2_OK; k++)
            status = send_echo(c, e->bytes[k], &e->seconds[e->done * e->sizes + k], err);
    }
    return status;
}

/* --- the deck --- */

static enum dm2_status take_deck_answer(void *context, int rank, struct bytes_reader *r,
                                        struct dm2_error *err)
{
    struct client *c = context;
    c->answers[rank].loaded = bytes_get_u8(r);
    return bytes_done(r) ? DM2_OK : conversation_not_decoded(&c->talk, rank, "ANSWER", err);
}

/* The name under which a server may find the deck: the path, if it is relative and without "..", else its
 * last part. */
static const char *name_deck(const char *path)
{
    const char *slash = strrchr(path, '/'), *up = strstr(path, "..");
    while (path[0] == '.' && path[1] == '/')
        path += 2;
    return path[0] == '/' || up != NULL ? (slash == NULL ? path : slash + 1) : path;
}

/* Sends DECK to the servers that have not loaded the deck, and gathers their answers. */
static enum dm2_status send_deck(struct client *c, bool texts, struct dm2_error *err)
{
    struct deck_message m = {.with_texts = texts, .source = *c->job->source};
    char name[DECK_NAME_MAX + 1];
    (void)snprintf(name, sizeof name, "%s", name_deck(c->options->deck_path));
    m.name = name;
    struct deck_meaning meaning;
    struct config config = *c->job->config;
    config.steps = config.deck_steps; /* the server does not know yet that the run ends earlier */
    enum dm2_status status = meaning_build(&config, PARTS_ALL, &meaning, err);
    if (status != DM2_OK)
        return status;
    memcpy(m.digest, meaning.digest, sizeof m.digest);
    meaning_free(&meaning);
    bytes_clear(&c->talk.out);
    message_put_deck(&c->talk.out, &m);
    if (c->talk.out.length > LIMIT_DECK)
        return dm2_fail(err, DM2_DECK, "the deck's texts have %zu bytes, at most %d can be sent",
                        c->talk.out.length, (int)LIMIT_DECK);
    for (int k = 0; k < c->ranks; k++) {
        status = c->answers[k].loaded == 0 ? conversation_send(&c->talk, k, MESSAGE_DECK, err) : DM2_OK;
        if (status != DM2_OK)
            return status;
    }
    return conversation_gather(&c->talk, MESSAGE_ANSWER, LIMIT_SMALL, take_deck_answer, false, err);
}

enum dm2_status client_share_deck(struct client *c, struct dm2_error *err)
{
    bool whole =
        c->options->send_deck || deck_source_start(c->job->source) != NULL; /* no server has the start */
    enum dm2_status status = whole ? DM2_OK : send_deck(c, false, err);
    int missing = 0;
    for (int k = 0; k < c->ranks; k++)
        missing += c->answers[k].loaded == 0;
    if (status == DM2_OK && missing > 0)
        status = send_deck(c, true, err);
    for (int k = 0; k < c->ranks && status == DM2_OK; k++)
        if (c->answers[k].loaded == 0)
            status = conversation_failed(&c->talk, k, DM2_PROTOCOL, "it did not take the deck", err);
    return status;
}

/* --- ranks --- */

static enum dm2_status take_ready(void *context, int rank, struct bytes_reader *r, struct dm2_error *err)
{
    struct client *c = context;
    message_get_ready(r, &c->answers[rank].ready);
    return r->failed ? conversation_not_decoded(&c->talk, rank, "READY", err) : DM2_OK;
}

/* Sends one rank its share of the state. */
static enum dm2_status send_share(struct client *c, int rank, const struct state_view *s,
                                  struct dm2_error *err)
{
    struct state_parts parts = {.head = {.step = s->step, .purpose = STATE_COPY}};
    struct state_share share;
    enum dm2_status status = state_parts_share(c->decomposition, rank, s, &share, err);
    parts.state = state_share_view(&share, s->step);
    while (status == DM2_OK && state_parts_next(&parts, &c->talk.out))
        status = conversation_send(&c->talk, rank, MESSAGE_STATE, err);
    state_share_free(&share);
    return status;
}

/* The servers have all elements, and no two of them too close; tells the user of pressed pairs and the hash.
 */
static enum dm2_status check_ready(const struct client *c, uint64_t elements, struct dm2_error *err)
{
    uint64_t owned = 0, hash = 0;
    struct overlap overlap = {0};
    for (int k = 0; k < c->ranks; k++) {
        owned += c->answers[k].ready.owned;
        hash += c->answers[k].ready.hash;
        overlap_merge(&overlap, &c->answers[k].ready.overlap);
    }
    if (owned != elements)
        return dm2_fail(err, DM2_PROTOCOL,
                        "the servers generated %llu elements, the deck makes %llu: is the same dm2 "
                        "installed everywhere?",
                        (unsigned long long)owned, (unsigned long long)elements);
    enum dm2_status status = overlap_check(&overlap, c->job->config, err);
    if (status != DM2_OK)
        return status;
    char line[OVERLAP_LINE];
    if (!c->talk.again && overlap_describe(&overlap, c->job->config, line))
        course_tell_user(c->options, line);
    int64_t start = course_step(c->course, c->job), every = c->options->hash_every;
    if (every > 0 && (start % every == 0 || start == c->job->config->steps))
        course_tell_hash(c->course, c->options, start, hash);
    return DM2_OK;
}

enum dm2_status client_assign(struct client *c, struct dm2_error *err)
{
    const struct decomposition *d = c->decomposition;
    struct state_view from = {0};
    bool restored = course_state(c->course, c->job, &from);
    c->copy_due = course_wants_copy(c->course, c->job, course_step(c->course, c->job) + 1);
    struct assign_message m = {.ranks = c->ranks,
                               .cx = d->grid.cx,
                               .cy = d->grid.cy,
                               .elements = model_elements(c->job->model),
                               .rects = d->rect,
                               .timeout = c->options->timeout,
                               .hash_every = c->options->hash_every,
                               .rebuild_first = rebuild_plan_expected(&c->plan),
                               .copy_first = c->copy_due,
                               .end = c->job->config->steps,
                               .start = restored ? from.step : -1};
    for (m.rank = 0; m.rank < c->ranks; m.rank++) {
        decomposition_interfaces(d, m.rank, m.interfaces);
        bytes_clear(&c->talk.out);
        message_put_assign(&c->talk.out, &m);
        enum dm2_status status = conversation_send(&c->talk, m.rank, MESSAGE_ASSIGN, err);
        if (status == DM2_OK && restored)
            status = send_share(c, m.rank, &from, err);
        if (status != DM2_OK)
            return status;
    }
    enum dm2_status status =
        conversation_gather(&c->talk, MESSAGE_READY, LIMIT_SMALL, take_ready, false, err);
    return status == DM2_OK ? check_ready(c, m.elements, err) : status;
}
