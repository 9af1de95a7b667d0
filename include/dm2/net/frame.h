/* Frames: bounded, checked messages on a byte stream.
 *
 * A frame is a header of 16 bytes and a payload (docs/protocol.md):
 *
 *     0  u32  magic "DM2" 0x1a
 *     4  u16  protocol version
 *     6  u8   type of the message
 *     7  u8   flags of the message
 *     8  u32  length of the payload in bytes
 *    12  u32  CRC-32C of header bytes 0..11 and the payload
 *
 * Once a channel has keys (channel_use_keys) the CRC is 0, and a tag of 16 bytes follows the header:
 * SipHash-2-4-128 of the number of the frame in its direction (u64, from 0), the header and the payload.
 *
 * Reading a frame fails in exactly the ways of enum frame_fault, apart from deadlines and broken connections.
 * The magic is checked as soon as four bytes have come, the version and the length before any payload is
 * read; memory grows with the bytes that arrive, never with the length in the header. */
#ifndef DM2_NET_FRAME_H
#define DM2_NET_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/uio.h>

#include "dm2/base/siphash.h"
#include "dm2/base/status.h"
#include "dm2/net/socket.h"

enum { FRAME_HEADER = 16, FRAME_TAG = SIPHASH_BYTES };
#define FRAME_MAGIC      0x1a324d44U /* "DM2" 0x1a, little-endian */
#define FRAME_LENGTH_MAX 0x40000000U /* of any payload */

enum frame_fault {
    FRAME_GOOD = 0,
    FRAME_BAD_MAGIC, /* another magic: the peer speaks another protocol */
    FRAME_VERSION,   /* another protocol version */
    FRAME_TOO_LONG,  /* the length exceeds what the reader allows here */
    FRAME_CHECKSUM,  /* checksum or tag differs: the bytes were changed on the way */
    FRAME_CUT        /* the stream ended inside a frame */
};

struct frame_header {
    uint16_t version;
    uint8_t type, flags;
    uint32_t length, checksum;
};

void frame_header_encode(const struct frame_header *h, unsigned char out[FRAME_HEADER]);
/* FRAME_BAD_MAGIC, FRAME_VERSION, FRAME_TOO_LONG or FRAME_GOOD; *out is filled in all cases. */
enum frame_fault frame_header_decode(const unsigned char in[FRAME_HEADER], uint16_t version, uint32_t limit,
                                     struct frame_header *out);

/* A complete frame; the payload belongs to the channel and lasts until its next receive. */
struct frame {
    uint8_t type, flags;
    const unsigned char *payload;
    size_t length;
};

/* One end of a connection. */
struct channel {
    int fd;
    uint16_t version;
    char name[SOCKET_NAME]; /* of the peer, for error texts */
    unsigned char *buffer;  /* received bytes: a frame at the start, then the bytes that follow it */
    size_t cap, filled;
    size_t taken;     /* bytes of the frame that was handed out last; the next receive drops them */
    bool header_good; /* the header at the start of buffer is checked, and `in` holds it */
    struct frame_header in;
    double heard; /* clock_now() when the last byte came */
    uint64_t frames_in, frames_out, bytes_in, bytes_out;
    bool keyed; /* frames have tags under these keys */
    unsigned char key_in[SIPHASH_KEY], key_out[SIPHASH_KEY];
    uint64_t tags_in, tags_out; /* frames with tags so far: the number of the next one */
};

/* Makes a channel of a connected descriptor, which is the channel's from then on. */
void channel_open(struct channel *ch, int fd, uint16_t version, const char *name);

/* Closes the descriptor and frees the buffer. */
void channel_close(struct channel *ch);

/* From the next frame on, frames of both directions have tags in place of checksums. The peer must change at
 * the same frame. */
void channel_use_keys(struct channel *ch, const unsigned char in[SIPHASH_KEY],
                      const unsigned char out[SIPHASH_KEY]);

/* channel_close, but so that the peer can read the last message: ends the stream and discards the bytes that
 * still come, until the peer ends its stream or the deadline. */
void channel_hang_up(struct channel *ch, struct deadline until);

/* Sends one frame, in one write where the connection takes it. The payload is gathered from iov[1 ..
 * n_iov-1]; iov[0] becomes the header; the contents of iov are undefined afterwards. The texts of failures
 * name the peer. DM2_NET, DM2_TIMEOUT, DM2_INTERRUPTED; DM2_PROTOCOL where the payload exceeds
 * FRAME_LENGTH_MAX. */
enum dm2_status channel_send_parts(struct channel *ch, uint8_t type, uint8_t flags, struct iovec *iov,
                                   size_t n_iov, struct deadline until, struct dm2_error *err);
/* The same, with the payload in one part. */
enum dm2_status channel_send(struct channel *ch, uint8_t type, uint8_t flags, const void *payload,
                             size_t length, struct deadline until, struct dm2_error *err);

/* Puts the frame that was received last back: the next receive hands the frame out again. */
void channel_put_back(struct channel *ch);

/* Does the buffer hold bytes behind the last frame? They must be taken before a poll, because poll does not
 * see them. */
bool channel_pending(const struct channel *ch);

/* Takes the bytes that have come, without waiting. *complete tells whether *out is a whole frame, whose
 * payload has at most `limit` bytes. DM2_PROTOCOL with the fault; DM2_NET where the peer closed or the
 * connection broke; DM2_MEMORY. */
enum dm2_status channel_receive_some(struct channel *ch, uint32_t limit, bool *complete, struct frame *out,
                                     struct dm2_error *err);

/* Waits for a whole frame. The deadline holds for the frame, not for each byte. Failures as of
 * channel_receive_some, DM2_TIMEOUT, DM2_INTERRUPTED. */
enum dm2_status channel_receive(struct channel *ch, uint32_t limit, struct deadline until, struct frame *out,
                                struct dm2_error *err);

#endif
