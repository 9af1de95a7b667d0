/* Messages between a session and its client.
 *
 * While the session waits, lobby_wait answers visitors. During long work server_beat tells the client that
 * the server works; a failure of server_beat waits for the next server_send, because the engine that calls
 * server_beat cannot end the session. */
#include "server_parts.h"

#include <poll.h>

#include "dm2/base/clock.h"

struct deadline server_deadline(const struct session *s)
{
    return deadline_in(s->timeout, s->options->cancel);
}

enum dm2_status server_send(struct session *s, enum message_type type, struct dm2_error *err)
{
    if (s->alive_error.status != DM2_OK)
        return dm2_fail(err, s->alive_error.status, "%s", s->alive_error.text);
    if (s->out.failed)
        return dm2_fail(err, DM2_MEMORY, "no memory for a message");
    enum dm2_status status =
        channel_send(&s->channel, (uint8_t)type, 0, s->out.data, s->out.length, server_deadline(s), err);
    s->quiet_since = clock_now();
    return status;
}

/* Sets s->alive_error where the client has ended its stream or the process is asked to end. */
static void look_for_end(struct session *s)
{
    struct pollfd polls[2] = {{.fd = s->channel.fd, .events = SOCKET_ENDED},
                              {.fd = s->options->cancel, .events = POLLIN}};
    if (poll(polls, 2, 0) <= 0)
        return;
    if (polls[1].revents != 0)
        (void)dm2_fail(&s->alive_error, DM2_INTERRUPTED, "asked to end by a signal");
    else if (polls[0].revents != 0)
        (void)dm2_fail(&s->alive_error, DM2_NET, "%s closed the connection", s->channel.name);
}

bool server_stopped(void *context)
{
    const struct session *s = context;
    return s->alive_error.status != DM2_OK;
}

void server_beat(void *context)
{
    struct session *s = context;
    double now = clock_now();
    if (now - s->quiet_since < s->alive_every || s->alive_error.status != DM2_OK)
        return;
    s->quiet_since = now;
    look_for_end(s);
    if (s->alive_error.status != DM2_OK)
        return;
    (void)channel_send(&s->channel, MESSAGE_ALIVE, 0, NULL, 0, server_deadline(s), &s->alive_error);
    lobby_look(s->lobby);
}

enum dm2_status server_check_type(const struct frame *f, enum message_type type, struct bytes_reader *out,
                                  struct dm2_error *err)
{
    *out = bytes_reader_of(f->payload, f->length);
    if (f->type == type)
        return DM2_OK;
    char name[2][16];
    if (f->type == MESSAGE_ERROR) {
        struct error_message m;
        message_get_error(out, &m);
        return dm2_fail(err, DM2_NET, "the client ended the session: %s", m.text);
    }
    return dm2_fail(err, DM2_PROTOCOL, "the client sent %s where %s is due", message_name(f->type, name[0]),
                    message_name((uint8_t)type, name[1]));
}

/* Waits for a frame; lobby_wait answers visitors meanwhile. */
static enum dm2_status receive_frame(struct session *s, uint32_t limit, struct deadline until,
                                     struct frame *f, struct dm2_error *err)
{
    bool complete = false;
    enum dm2_status status = DM2_OK;
    if (channel_pending(&s->channel))
        status = channel_receive_some(&s->channel, limit, &complete, f, err);
    while (status == DM2_OK && !complete) {
        if (!lobby_wait(s->lobby, s->channel.fd, until))
            return channel_receive(&s->channel, limit, until, f, err); /* also tells why lobby_wait ended */
        status = channel_receive_some(&s->channel, limit, &complete, f, err);
    }
    return status;
}

enum dm2_status server_receive(struct session *s, uint32_t limit, struct deadline until, struct frame *f,
                               struct dm2_error *err)
{
    for (;;) {
        enum dm2_status status = receive_frame(s, limit, until, f, err);
        s->quiet_since = clock_now();
        if (status != DM2_OK || f->type != MESSAGE_ALIVE || f->length != 0 || !s->greeted)
            return status;
        until = server_deadline(s);
    }
}

enum dm2_status server_expect(struct session *s, enum message_type type, uint32_t limit,
                              struct deadline until, struct bytes_reader *out, struct dm2_error *err)
{
    struct frame f;
    enum dm2_status status = server_receive(s, limit, until, &f, err);
    return status == DM2_OK ? server_check_type(&f, type, out, err) : status;
}

enum dm2_status server_not_decoded(const char *what, struct dm2_error *err)
{
    return dm2_fail(err, DM2_PROTOCOL, "the client's %s message does not decode", what);
}
