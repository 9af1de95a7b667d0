/* Answers are gathered with poll. A server that sends no byte for t->timeout seconds has failed. Servers that
 * have answered get ALIVE messages while another server takes long, because a server ends its session when
 * the client is silent. */
#include "conversation.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/clock.h"
#include "dm2/base/mem.h"
#include "dm2/cluster/client.h"

static const double LOOK_SECONDS = 5e-5;   /* of looking before sleeping: a server may need the processor */
static const double BUSY_SECONDS = 1.0;    /* without an answer in the hand-shake until the user is told */
static const double PARTING_SECONDS = 0.2; /* to send a server the reason why its session ends */

/* --- failures --- */

void conversation_name_step(const struct conversation *t, char *out, size_t size)
{
    if (t->at < 0 && t->again)
        (void)snprintf(out, size, "set-up again from step %lld", (long long)t->from);
    else if (t->at < 0)
        (void)snprintf(out, size, "before the first step");
    else
        (void)snprintf(out, size, "step %lld", (long long)t->at);
}

enum dm2_status conversation_failed(struct conversation *t, int rank, enum dm2_status status, const char *why,
                                    struct dm2_error *err)
{
    const char *name = t->peers[rank].channel.name;
    char step[64], text[600];
    conversation_name_step(t, step, sizeof step);
    t->culprit = rank;
    t->silent = status == DM2_TIMEOUT;
    (void)snprintf(text, sizeof text, "%s", why); /* a copy, because `why` may lie in *err */
    if (status == DM2_INTERRUPTED || status == DM2_MEMORY)
        return dm2_fail(err, status, "%s", text);
    bool named = strncmp(text, name, strlen(name)) == 0;
    return dm2_fail(err, status, "server %d of %d, %s: %s%s%s%s", rank, t->ranks, step, named ? "" : name,
                    named ? "" : ": ", text, status == DM2_NET ? t->advice : "");
}

enum dm2_status conversation_not_decoded(struct conversation *t, int rank, const char *what,
                                         struct dm2_error *err)
{
    char text[100];
    (void)snprintf(text, sizeof text, "its %s message does not decode", what);
    return conversation_failed(t, rank, DM2_PROTOCOL, text, err);
}

/* Fails with the reason of a server's ERROR message. */
static enum dm2_status take_error(struct conversation *t, int rank, struct bytes_reader r,
                                  struct dm2_error *err)
{
    struct error_message m;
    char text[600];
    message_get_error(&r, &m);
    if (!r.failed && strcmp(m.text, REFUSAL_TEXT) == 0)
        return conversation_failed(t, rank, DM2_PROTOCOL, t->refusal, err);
    (void)snprintf(text, sizeof text, "ended the session: %.560s",
                   r.failed ? "its reason does not decode" : m.text);
    /* A server that was interrupted, timed out or lacks memory is lost (DM2_NET): another server may do its
     * work. Other statuses are kept: DM2_DECK, for instance, would come from every server. */
    bool unusable = m.status == DM2_INTERRUPTED || m.status == DM2_TIMEOUT || m.status == DM2_MEMORY;
    enum dm2_status status = unusable ? DM2_NET : m.status;
    return conversation_failed(t, rank, status, text, err);
}

/* --- sending --- */

/* A deadline for sending: once the steps run, a signal does not cut a message off. */
static struct deadline send_deadline(const struct conversation *t)
{
    return deadline_in(t->timeout, t->stopping != NULL ? -1 : t->cancel);
}

enum dm2_status conversation_send(struct conversation *t, int rank, enum message_type type,
                                  struct dm2_error *err)
{
    struct peer *p = &t->peers[rank];
    struct dm2_error why = {0};
    if (t->out.failed)
        return dm2_fail(err, DM2_MEMORY, "no memory for a message");
    enum dm2_status status =
        channel_send(&p->channel, (uint8_t)type, 0, t->out.data, t->out.length, send_deadline(t), &why);
    p->awaited = true;
    return status == DM2_OK ? DM2_OK : conversation_failed(t, rank, status, why.text, err);
}

enum dm2_status conversation_send_parts(struct conversation *t, int rank, enum message_type type,
                                        struct iovec *iov, size_t n_iov, struct dm2_error *err)
{
    struct peer *p = &t->peers[rank];
    struct dm2_error why = {0};
    enum dm2_status status =
        channel_send_parts(&p->channel, (uint8_t)type, 0, iov, n_iov, send_deadline(t), &why);
    p->awaited = true;
    return status == DM2_OK ? DM2_OK : conversation_failed(t, rank, status, why.text, err);
}

enum dm2_status conversation_reply(struct conversation *t, int rank, enum message_type type,
                                   const void *payload, size_t length, struct dm2_error *err)
{
    struct dm2_error why = {0};
    enum dm2_status status =
        channel_send(&t->peers[rank].channel, (uint8_t)type, 0, payload, length, send_deadline(t), &why);
    return status == DM2_OK ? DM2_OK : conversation_failed(t, rank, status, why.text, err);
}

/* --- gathering --- */

/* Does a server work before an answer of this type? Then the server sends ALIVE messages meanwhile. */
static bool answer_takes_long(enum message_type type)
{
    return type == MESSAGE_ANSWER || type == MESSAGE_READY || type == MESSAGE_STEP || type == MESSAGE_DONE;
}

/* Takes all frames that have arrived from one server. */
static enum dm2_status take_frames(struct conversation *t, int rank, enum message_type type, uint32_t limit,
                                   conversation_take take, struct dm2_error *err)
{
    struct peer *p = &t->peers[rank];
    while (p->awaited) {
        bool complete;
        struct frame f;
        struct dm2_error why = {0};
        enum dm2_status status = channel_receive_some(&p->channel, limit, &complete, &f, &why);
        if (status != DM2_OK)
            return conversation_failed(t, rank, status, why.text, err);
        if (!complete)
            return DM2_OK;
        struct bytes_reader r = bytes_reader_of(f.payload, f.length);
        if (f.type == MESSAGE_ERROR)
            return take_error(t, rank, r, err);
        if (f.type == MESSAGE_ALIVE && f.length == 0 && answer_takes_long(type))
            continue; /* channel.heard has been renewed */
        if (f.type == type) {
            p->awaited = false;
            status = take(t->context, rank, &r, err);
        } else if (!t->aside(t->context, rank, type, &f, &status, err)) {
            char names[2][16], text[100];
            (void)snprintf(text, sizeof text, "it sent %s where %s is due", message_name(f.type, names[0]),
                           message_name((uint8_t)type, names[1]));
            status = conversation_failed(t, rank, DM2_PROTOCOL, text, err);
        }
        if (status != DM2_OK)
            return status;
    }
    return DM2_OK;
}

/* Waits until bytes from an awaited server have come, but no longer than until wake_at. DM2_TIMEOUT: an
 * awaited server has been silent for t->timeout seconds, counted from `since` at the earliest. t->polls[0 ..
 * *n-1] then has the events of the servers t->polled[0 .. *n-1]. */
static enum dm2_status wait_for_answers(struct conversation *t, double since, double wake_at, int *n,
                                        struct dm2_error *err)
{
    double first = INFINITY, now = clock_now();
    int silent = -1;
    *n = 0;
    for (int k = 0; k < t->ranks; k++) {
        const struct channel *ch = &t->peers[k].channel;
        if (!t->peers[k].awaited)
            continue;
        double end = fmax(ch->heard, since) + t->timeout;
        if (end < first) {
            first = end;
            silent = k;
        }
        t->polled[*n] = k;
        t->polls[(*n)++] = (struct pollfd){.fd = ch->fd, .events = POLLIN};
    }
    if (silent < 0)
        return DM2_OK;
    double until = fmin(wake_at, first);
    t->polls[*n] =
        (struct pollfd){.fd = t->stopping != NULL && *t->stopping ? -1 : t->cancel, .events = POLLIN};
    double wait = until > now ? ceil(1000 * (until - now)) : 0;
    int ready = socket_poll(t->polls, (nfds_t)*n + 1, wait < 1e9 ? (int)wait : 1000000000, LOOK_SECONDS);
    if (ready < 0 && errno != EINTR && errno != EAGAIN)
        return dm2_fail(err, DM2_NET, "poll: %s", strerror(errno));
    bool asked = ready > 0 && t->polls[*n].revents != 0;
    if (asked && t->stopping != NULL)
        *t->stopping = true;
    else if (asked)
        return dm2_fail(err, DM2_INTERRUPTED, "the run was interrupted by a signal");
    if (ready <= 0 && clock_now() >= first) {
        char text[200];
        (void)snprintf(text, sizeof text,
                       "no answer for %g s: it is stopped, overloaded or cut off; see its log, or allow "
                       "more with --timeout",
                       t->timeout);
        return conversation_failed(t, silent, DM2_TIMEOUT, text, err);
    }
    if (ready <= 0)
        *n = 0;
    return DM2_OK;
}

/* Tells the user which awaited servers have not answered yet. */
static void note_busy_servers(const struct conversation *t)
{
    char line[SOCKET_NAME + 100];
    for (int k = 0; k < t->ranks && t->events->note != NULL; k++)
        if (t->peers[k].awaited) {
            (void)snprintf(line, sizeof line, "waiting for %s, which may be serving another client",
                           t->peers[k].channel.name);
            t->events->note(t->events->context, line);
        }
}

/* Sends ALIVE to every server that has answered and whose session has begun. Not while DONE is gathered,
 * because a server closes its connection after DONE. */
static enum dm2_status send_alive(struct conversation *t, struct dm2_error *err)
{
    for (int k = 0; k < t->ranks; k++) {
        enum dm2_status status = t->peers[k].awaited || !t->peers[k].greeted
                                     ? DM2_OK
                                     : conversation_reply(t, k, MESSAGE_ALIVE, NULL, 0, err);
        if (status != DM2_OK)
            return status;
    }
    return DM2_OK;
}

enum dm2_status conversation_gather(struct conversation *t, enum message_type type, uint32_t limit,
                                    conversation_take take, bool note, struct dm2_error *err)
{
    double since = clock_now(), note_at = note ? since + BUSY_SECONDS : INFINITY;
    double every = alive_every(t->timeout);
    bool long_wait = type == MESSAGE_WELCOME || (answer_takes_long(type) && type != MESSAGE_DONE);
    double alive_at = long_wait ? since + every : INFINITY;
    int awaited = 0;
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < t->ranks && status == DM2_OK; k++) {
        if (t->peers[k].awaited && channel_pending(&t->peers[k].channel)) /* bytes behind the last message */
            status = take_frames(t, k, type, limit, take, err);
        awaited += t->peers[k].awaited;
    }
    while (awaited > 0 && status == DM2_OK) {
        int n;
        status = wait_for_answers(t, since, fmin(note_at, alive_at), &n, err);
        for (int k = 0; k < n && status == DM2_OK; k++) {
            if (t->polls[k].revents == 0)
                continue;
            status = take_frames(t, t->polled[k], type, limit, take, err);
            awaited -= !t->peers[t->polled[k]].awaited;
        }
        if (status == DM2_OK && clock_now() >= note_at) {
            note_busy_servers(t);
            note_at = INFINITY;
        }
        if (status == DM2_OK && clock_now() >= alive_at) {
            status = send_alive(t, err);
            alive_at = clock_now() + every;
        }
    }
    t->waited += clock_now() - since;
    return status;
}

/* --- connections --- */

enum dm2_status conversation_open(struct conversation *t, struct dm2_error *err)
{
    size_t n = (size_t)t->ranks;
    t->at = t->culprit = -1;
    t->peers = mem_zalloc(n, sizeof *t->peers);
    t->polls = mem_zalloc(n + 1, sizeof *t->polls);
    t->polled = mem_zalloc(n, sizeof *t->polled);
    if (t->peers == NULL || t->polls == NULL || t->polled == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %d servers", t->ranks);
    return DM2_OK;
}

void conversation_close(struct conversation *t, enum dm2_status status, const struct dm2_error *err)
{
    struct error_message m = {.status = status};
    if (status != DM2_OK && err != NULL)
        (void)snprintf(m.text, sizeof m.text, "%s", err->text);
    bytes_clear(&t->out);
    message_put_error(&t->out, &m);
    for (int k = 0; k < t->ranks && t->peers != NULL; k++) {
        struct peer *p = &t->peers[k];
        if (!p->open)
            continue;
        if (status != DM2_OK && !t->out.failed)
            (void)channel_send(&p->channel, MESSAGE_ERROR, 0, t->out.data, t->out.length,
                               deadline_in(PARTING_SECONDS, -1), NULL);
        channel_close(&p->channel);
    }
    bytes_free(&t->out);
    free(t->peers);
    free(t->polls);
    free(t->polled);
}
