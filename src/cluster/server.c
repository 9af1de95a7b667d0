/* One session, from HELLO to DONE, and the daemon that serves one session after another.
 *
 * The order of messages is that of docs/protocol.md and of the paper's Fig. 7. The first stage that fails
 * ends the session: serve_client then sends ERROR and frees everything. Nothing lasts from one session to the
 * next. */
#include "dm2/cluster/server.h"

#include <stdio.h>
#include <string.h>

#include "dm2/base/clock.h"
#include "dm2/base/text.h"
#include "dm2/engine/self_test.h"
#include "server_parts.h"

static const double HANG_UP_SECONDS = 2.0; /* for the client to read the last message */

static enum dm2_status exchange_hellos(struct session *s, struct dm2_error *err)
{
    struct bytes_reader r;
    struct hello_message hello, own = {.turn = true, .fingerprint = SELF_TEST_FINGERPRINT};
    struct deadline until = deadline_in(s->options->handshake, s->options->cancel);
    enum dm2_status status = server_expect(s, MESSAGE_HELLO, LIMIT_HELLO, until, &r, err);
    if (status != DM2_OK)
        return status;
    message_get_hello(&r, &hello);
    if (r.failed)
        return server_not_decoded("HELLO", err);
    (void)snprintf(own.version, sizeof own.version, "%s", s->options->version);
    if (!hello.turn)
        return dm2_fail(err, DM2_PROTOCOL, "the client asks for its place where HELLO for its turn is due");
    if (strcmp(hello.version, own.version) != 0)
        return dm2_fail(
            err, DM2_PROTOCOL,
            "the releases differ: dm2 %s on the client, dm2 %s on the server: install the same dm2 on "
            "both machines",
            hello.version, own.version);
    if (hello.fingerprint != own.fingerprint)
        return dm2_fail(
            err, DM2_PROTOCOL,
            "the arithmetic differs: fingerprint %016llx on the client (dm2 %s), %016llx on the server (dm2 "
            "%s): build both with the Makefile's flags for IEEE 754 doubles",
            (unsigned long long)hello.fingerprint, hello.version, (unsigned long long)own.fingerprint,
            own.version);
    bytes_clear(&s->out);
    message_put_hello(&s->out, &own);
    return server_send(s, MESSAGE_WELCOME, err);
}

/* --- the session --- */

static void send_error(struct session *s, const struct dm2_error *err)
{
    struct error_message m = {.status = err->status};
    (void)snprintf(m.text, sizeof m.text, "%s", err->text);
    bytes_clear(&s->out);
    message_put_error(&s->out, &m);
    if (!s->out.failed)
        (void)channel_send(&s->channel, MESSAGE_ERROR, 0, s->out.data, s->out.length,
                           deadline_in(HANG_UP_SECONDS, -1), NULL);
}

static void free_session(struct session *s)
{
    exchange_free(&s->exchange);
    subdomain_free(s->sd);
    decomposition_free(&s->decomposition);
    message_free_assign(&s->assign);
    model_free(s->model);
    if (s->loaded)
        config_free(&s->config);
    message_free_deck(&s->deck);
    bytes_free(&s->out);
}

/* The stages after the deck. */
static enum dm2_status serve_run(struct session *s, struct dm2_error *err)
{
    enum dm2_status status = server_get_assignment(s, err);
    if (status == DM2_OK)
        status = server_send_ready(s, err);
    if (status == DM2_OK)
        status = server_run_steps(s, err);
    return status == DM2_OK ? server_send_done(s, err) : status;
}

/* Serves the client of a channel from the lobby and closes the channel. */
static enum dm2_status serve_client(const struct channel *client, const struct server_options *options,
                                    struct lobby *lobby, struct session_summary *summary,
                                    struct dm2_error *err)
{
    struct session s = {.options = options,
                        .lobby = lobby,
                        .summary = summary,
                        .timeout = options->timeout,
                        .channel = *client,
                        .alive_every = ALIVE_SECONDS};
    double start = s.quiet_since = clock_now();
    *summary = (struct session_summary){.rank = -1};
    lobby->business = (struct lobby_business){.peer = client->name, .since = start, .session = summary};
    enum dm2_status status = exchange_hellos(&s, err);
    s.greeted = status == DM2_OK;
    if (status == DM2_OK)
        status = server_get_deck(&s, err);
    if (status == DM2_OK && !summary->measured)
        status = serve_run(&s, err);
    if (status == DM2_INTERRUPTED && server_stopped(&s)) /* the reason of the engine's end */
        status = dm2_fail(err, s.alive_error.status, "%s", s.alive_error.text);
    if (status != DM2_OK && status != DM2_NET)
        send_error(&s, err);
    /* without s.options->cancel, because a signal must not cut the last message */
    channel_hang_up(&s.channel, deadline_in(HANG_UP_SECONDS, -1));
    free_session(&s);
    summary->seconds = clock_now() - start;
    return status;
}

enum dm2_status server_session(int fd, const char *peer, const struct server_options *options,
                               struct session_summary *summary, struct dm2_error *err)
{
    struct lobby lobby;
    struct channel client;
    *summary = (struct session_summary){.rank = -1};
    lobby_open(&lobby, -1, options, NULL, NULL);
    lobby_enter(&lobby, fd, peer);
    enum dm2_status status =
        lobby_next(&lobby, deadline_in(options->handshake, options->cancel), &client, err);
    if (status == DM2_OK)
        status = serve_client(&client, options, &lobby, summary, err);
    lobby_close(&lobby);
    return status;
}

static void log_session(const struct session_summary *sum, enum dm2_status status,
                        const struct dm2_error *err, server_log log, void *context, const char *peer)
{
    char line[1100], what[320] = "";
    if (sum->rank >= 0)
        (void)snprintf(what, sizeof what, "%s, rank %d of %d, %lld steps in %.3f s", sum->deck, sum->rank,
                       sum->ranks, (long long)sum->steps, sum->seconds);
    if (sum->measured)
        (void)snprintf(what, sizeof what, "network measured, %llu round trips in %.3f s",
                       (unsigned long long)sum->echoes, sum->seconds);
    if (status == DM2_OK)
        (void)snprintf(line, sizeof line, "done: %s", what);
    else
        (void)snprintf(line, sizeof line, "%s%s%s", err->text, what[0] != '\0' ? "; " : "", what);
    text_make_printable(line, false); /* parts of the line are the client's */
    log(context, status == DM2_OK ? SERVER_DONE : SERVER_FAILED, peer, line);
}

enum dm2_status server_serve(int listener, const struct server_options *options, bool once, server_log log,
                             void *context, struct dm2_error *err)
{
    const double for_ever = 1e9;
    enum dm2_status status = DM2_OK;
    struct lobby lobby;
    lobby_open(&lobby, listener, options, log, context);
    for (bool over = false; !over;) {
        struct channel client;
        struct session_summary summary;
        status = lobby_next(&lobby, deadline_in(once ? options->timeout : for_ever, options->cancel), &client,
                            err);
        if (status == DM2_TIMEOUT && !once)
            continue;
        if (status == DM2_TIMEOUT)
            status = dm2_fail(err, DM2_TIMEOUT, "no client came within %g s", options->timeout);
        if (status != DM2_OK)
            break;
        log(context, SERVER_CONNECTED, client.name, "connected");
        status = serve_client(&client, options, &lobby, &summary, err);
        log_session(&summary, status, err, log, context, client.name);
        over = once || status == DM2_INTERRUPTED;
    }
    lobby_close(&lobby);
    return status;
}
