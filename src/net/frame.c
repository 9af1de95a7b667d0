/* Frames on a channel.
 *
 * Receiving reads all bytes that have come into one buffer, header and payload in one system call, and may
 * stop at any byte, so that a client can serve many channels from one poll. Magic, version and length are
 * checked as they come, the checksum when the payload is complete; nothing is used before its check. The
 * buffer doubles when the bytes that have come fill it.
 *
 * Sending computes the checksum over the caller's parts, one after another, and hands header and parts to one
 * writev: a message is one system call, and its payload is not copied.
 *
 * With keys a tag replaces the checksum. The tag covers the number of the frame, so that a frame that is left
 * out, repeated or moved fails; each direction has its own key, so that a frame that is sent back fails. */
#include "dm2/net/frame.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "dm2/base/clock.h"
#include "dm2/base/crc32c.h"
#include "dm2/base/hmac.h"
#include "dm2/base/mem.h"

enum {
    BUFFER_FIRST = 65536,           /* first buffer, bytes */
    HANG_UP_MOST = 16 * 1024 * 1024 /* bytes of a peer that are discarded while hanging up */
};

static void put_le(unsigned char *p, uint32_t v, int n)
{
    for (int k = 0; k < n; k++)
        p[k] = (unsigned char)(v >> 8 * k & 0xff);
}

static uint32_t get_le(const unsigned char *p, int n)
{
    uint32_t v = 0;
    for (int k = 0; k < n; k++)
        v |= (uint32_t)p[k] << 8 * k;
    return v;
}

void frame_header_encode(const struct frame_header *h, unsigned char out[FRAME_HEADER])
{
    put_le(out, FRAME_MAGIC, 4);
    put_le(out + 4, h->version, 2);
    out[6] = h->type;
    out[7] = h->flags;
    put_le(out + 8, h->length, 4);
    put_le(out + 12, h->checksum, 4);
}

enum frame_fault frame_header_decode(const unsigned char in[FRAME_HEADER], uint16_t version, uint32_t limit,
                                     struct frame_header *out)
{
    out->version = (uint16_t)get_le(in + 4, 2);
    out->type = in[6];
    out->flags = in[7];
    out->length = get_le(in + 8, 4);
    out->checksum = get_le(in + 12, 4);
    if (get_le(in, 4) != FRAME_MAGIC)
        return FRAME_BAD_MAGIC;
    if (out->version != version)
        return FRAME_VERSION;
    if (out->length > limit || out->length > FRAME_LENGTH_MAX)
        return FRAME_TOO_LONG;
    return FRAME_GOOD;
}

void channel_open(struct channel *ch, int fd, uint16_t version, const char *name)
{
    *ch = (struct channel){.fd = fd, .version = version, .heard = clock_now()};
    (void)snprintf(ch->name, sizeof ch->name, "%s", name);
}

void channel_use_keys(struct channel *ch, const unsigned char in[SIPHASH_KEY],
                      const unsigned char out[SIPHASH_KEY])
{
    memcpy(ch->key_in, in, SIPHASH_KEY);
    memcpy(ch->key_out, out, SIPHASH_KEY);
    ch->keyed = true;
    ch->tags_in = ch->tags_out = 0;
}

void channel_close(struct channel *ch)
{
    socket_close(ch->fd);
    ch->fd = -1;
    free(ch->buffer);
    ch->buffer = NULL;
    ch->cap = ch->filled = ch->taken = 0;
}

void channel_hang_up(struct channel *ch, struct deadline until)
{
    char waste[4096];
    size_t total = 0, got = 0;
    int closed = 0;
    if (ch->fd >= 0 && shutdown(ch->fd, SHUT_WR) == 0) {
        while (!closed && total < HANG_UP_MOST && socket_wait(ch->fd, POLLIN, until, NULL) == DM2_OK &&
               socket_read_some(ch->fd, waste, sizeof waste, &got, &closed, NULL) == DM2_OK)
            total += got;
    }
    channel_close(ch);
}

/* Returns `status`; *err gets the peer's name and the text of *why, for DM2_INTERRUPTED the text alone. */
static enum dm2_status name_peer(const struct channel *ch, enum dm2_status status,
                                 const struct dm2_error *why, struct dm2_error *err)
{
    if (status == DM2_OK || status == DM2_INTERRUPTED) {
        if (err != NULL && status != DM2_OK)
            *err = *why;
        return status;
    }
    return dm2_fail(err, status, "%s: %s", ch->name, why->text);
}

static void start_tag(struct siphash *s, const unsigned char key[SIPHASH_KEY], uint64_t number)
{
    unsigned char count[8];
    put_le(count, (uint32_t)(number & 0xffffffffU), 4);
    put_le(count + 4, (uint32_t)(number >> 32), 4);
    siphash_start(s, key);
    siphash_add(s, count, sizeof count);
}

/* Writes the checksum or the tag of header and payload into `header`. */
static void seal_frame(struct channel *ch, unsigned char header[FRAME_HEADER + FRAME_TAG],
                       const struct iovec *iov, size_t n_iov)
{
    if (!ch->keyed) {
        uint32_t crc = crc32c(0, header, FRAME_HEADER - 4);
        for (size_t k = 1; k < n_iov; k++)
            crc = crc32c(crc, iov[k].iov_base, iov[k].iov_len);
        put_le(header + 12, crc, 4);
        return;
    }
    struct siphash s;
    start_tag(&s, ch->key_out, ch->tags_out++);
    siphash_add(&s, header, FRAME_HEADER);
    for (size_t k = 1; k < n_iov; k++)
        siphash_add(&s, iov[k].iov_base, iov[k].iov_len);
    siphash_finish(&s, header + FRAME_HEADER);
}

/* Bytes before the payload. */
static size_t head_length(const struct channel *ch)
{
    return FRAME_HEADER + (ch->keyed ? FRAME_TAG : 0);
}

enum dm2_status channel_send_parts(struct channel *ch, uint8_t type, uint8_t flags, struct iovec *iov,
                                   size_t n_iov, struct deadline until, struct dm2_error *err)
{
    size_t length = 0;
    for (size_t k = 1; k < n_iov; k++) {
        if (iov[k].iov_len > FRAME_LENGTH_MAX - length)
            return dm2_fail(err, DM2_PROTOCOL,
                            "%s: a message would be longer than %u bytes: use more servers", ch->name,
                            FRAME_LENGTH_MAX);
        length += iov[k].iov_len;
    }
    unsigned char header[FRAME_HEADER + FRAME_TAG];
    struct frame_header h = {
        .version = ch->version, .type = type, .flags = flags, .length = (uint32_t)length};
    frame_header_encode(&h, header);
    struct dm2_error why = {0};
    seal_frame(ch, header, iov, n_iov);
    iov[0] = (struct iovec){.iov_base = header, .iov_len = head_length(ch)};
    enum dm2_status status = socket_write_all(ch->fd, iov, n_iov, until, &why);
    if (status == DM2_OK) {
        ch->frames_out++;
        ch->bytes_out += head_length(ch) + length;
    }
    return name_peer(ch, status, &why, err);
}

enum dm2_status channel_send(struct channel *ch, uint8_t type, uint8_t flags, const void *payload,
                             size_t length, struct deadline until, struct dm2_error *err)
{
    struct iovec iov[2] = {{0}, {.iov_base = (void *)(uintptr_t)payload, .iov_len = length}};
    return channel_send_parts(ch, type, flags, iov, 2, until, err);
}

static enum dm2_status report_fault(const struct channel *ch, enum frame_fault fault,
                                    const struct frame_header *h, uint32_t limit, struct dm2_error *err)
{
    char start[5] = {0};
    switch (fault) {
    case FRAME_BAD_MAGIC:
        for (int k = 0; k < 4; k++)
            start[k] = ch->buffer[k] >= ' ' && ch->buffer[k] <= '~' ? (char)ch->buffer[k] : '.';
        return dm2_fail(err, DM2_PROTOCOL, "%s does not speak dm2's protocol: its message starts with '%s'",
                        ch->name, start);
    case FRAME_VERSION:
        return dm2_fail(
            err, DM2_PROTOCOL,
            "%s speaks protocol version %u, this program version %u: install the same dm2 on both machines",
            ch->name, h->version, ch->version);
    case FRAME_TOO_LONG:
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s announces a message (type %u) of %u bytes where at most %u are allowed", ch->name,
                        h->type, h->length, limit);
    case FRAME_CHECKSUM:
        return dm2_fail(err, DM2_PROTOCOL,
                        "%s: a message (type %u, %u bytes) arrived changed: its checksum differs", ch->name,
                        h->type, h->length);
    case FRAME_CUT:
        return dm2_fail(err, DM2_NET, "%s closed the connection in the middle of a message", ch->name);
    case FRAME_GOOD:
        break;
    }
    return DM2_OK;
}

/* Checks the header as far as it has come. */
static enum dm2_status check_header(struct channel *ch, uint32_t limit, struct dm2_error *err)
{
    if (ch->header_good || ch->filled < 4)
        return DM2_OK;
    if (get_le(ch->buffer, 4) != FRAME_MAGIC)
        return report_fault(ch, FRAME_BAD_MAGIC, &ch->in, limit, err);
    if (ch->filled < FRAME_HEADER)
        return DM2_OK;
    enum frame_fault fault = frame_header_decode(ch->buffer, ch->version, limit, &ch->in);
    ch->header_good = fault == FRAME_GOOD;
    return report_fault(ch, fault, &ch->in, limit, err);
}

/* Reads the bytes that have come into the buffer, which grows when it is full. */
static enum dm2_status read_bytes(struct channel *ch, size_t *got, struct dm2_error *err)
{
    struct dm2_error why = {0};
    int closed = 0;
    if (ch->filled == ch->cap) {
        size_t want = ch->cap > 0 ? 2 * ch->cap : BUFFER_FIRST;
        unsigned char *buffer = mem_grown(ch->buffer, &ch->cap, ch->filled, want, 1);
        if (buffer == NULL)
            return dm2_fail(err, DM2_MEMORY, "%s: no memory for a message of %u bytes", ch->name,
                            ch->in.length);
        ch->buffer = buffer;
    }
    enum dm2_status status =
        socket_read_some(ch->fd, ch->buffer + ch->filled, ch->cap - ch->filled, got, &closed, &why);
    if (status != DM2_OK)
        return name_peer(ch, status, &why, err);
    if (closed)
        return ch->filled > 0 ? report_fault(ch, FRAME_CUT, &ch->in, 0, err)
                              : dm2_fail(err, DM2_NET, "%s closed the connection", ch->name);
    if (*got > 0)
        ch->heard = clock_now();
    ch->filled += *got;
    ch->bytes_in += *got;
    return DM2_OK;
}

/* Drops the frame that was handed out; the bytes behind it move to the start of the buffer. */
static void drop_frame(struct channel *ch)
{
    if (ch->taken == 0)
        return;
    ch->filled -= ch->taken;
    memmove(ch->buffer, ch->buffer + ch->taken, ch->filled);
    ch->taken = 0;
    ch->header_good = false;
}

/* Does the checksum or the tag of the frame in the buffer match? */
static bool verify_frame(struct channel *ch, const unsigned char *payload)
{
    if (!ch->keyed)
        return crc32c(crc32c(0, ch->buffer, FRAME_HEADER - 4), payload, ch->in.length) == ch->in.checksum;
    struct siphash s;
    unsigned char tag[FRAME_TAG];
    start_tag(&s, ch->key_in, ch->tags_in++);
    siphash_add(&s, ch->buffer, FRAME_HEADER);
    siphash_add(&s, payload, ch->in.length);
    siphash_finish(&s, tag);
    return hmac_equal(tag, ch->buffer + FRAME_HEADER, FRAME_TAG);
}

/* Where the frame is complete: checks it and hands it out. */
static enum dm2_status take_frame(struct channel *ch, bool *complete, struct frame *out,
                                  struct dm2_error *err)
{
    size_t head = head_length(ch);
    *complete = ch->header_good && ch->filled >= head + ch->in.length;
    if (!*complete)
        return DM2_OK;
    const unsigned char *payload = ch->buffer + head;
    if (!verify_frame(ch, payload))
        return report_fault(ch, FRAME_CHECKSUM, &ch->in, 0, err);
    *out = (struct frame){
        .type = ch->in.type, .flags = ch->in.flags, .payload = payload, .length = ch->in.length};
    ch->taken = head + (size_t)ch->in.length;
    ch->frames_in++;
    return DM2_OK;
}

void channel_put_back(struct channel *ch)
{
    if (ch->taken == 0)
        return;
    ch->taken = 0;
    ch->frames_in--;
    ch->tags_in -= ch->keyed;
}

bool channel_pending(const struct channel *ch)
{
    return ch->filled > ch->taken;
}

enum dm2_status channel_receive_some(struct channel *ch, uint32_t limit, bool *complete, struct frame *out,
                                     struct dm2_error *err)
{
    drop_frame(ch);
    for (;;) {
        size_t got = 0;
        enum dm2_status status = check_header(ch, limit, err);
        if (status == DM2_OK)
            status = take_frame(ch, complete, out, err);
        if (status != DM2_OK || *complete)
            return status;
        status = read_bytes(ch, &got, err);
        if (status != DM2_OK || got == 0)
            return status;
    }
}

/* Waits before the first read, because right after a request its answer has not come yet. */
enum dm2_status channel_receive(struct channel *ch, uint32_t limit, struct deadline until, struct frame *out,
                                struct dm2_error *err)
{
    bool complete = false;
    drop_frame(ch);
    enum dm2_status status = check_header(ch, limit, err);
    if (status == DM2_OK)
        status = take_frame(ch, &complete, out, err);
    while (status == DM2_OK && !complete) {
        struct dm2_error why = {0};
        status = socket_wait(ch->fd, POLLIN, until, &why);
        if (status != DM2_OK)
            return name_peer(ch, status, &why, err);
        status = channel_receive_some(ch, limit, &complete, out, err);
    }
    return status;
}
