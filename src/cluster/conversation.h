/* The connections of one session. A stage of the session sends one message to every server and gathers one
 * answer from every server.
 *
 * The conversation takes ERROR and ALIVE frames itself. A frame of another type than the answer that is due
 * goes to `aside`; a frame that `aside` refuses ends the session. Every failure names the server and the
 * step. */
#ifndef DM2_CLUSTER_CONVERSATION_H
#define DM2_CLUSTER_CONVERSATION_H

#include <poll.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/uio.h>

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/cluster/messages.h"
#include "dm2/net/frame.h"

struct client_events;

/* The connection to one server. */
struct peer {
    struct channel channel;
    bool open;    /* the channel holds a connection */
    bool awaited; /* an answer is due */
    bool greeted; /* WELCOME has come: the session has begun */
};

struct conversation {
    /* Set before conversation_open. */
    int ranks;
    double timeout;                     /* seconds of a server's silence */
    int cancel;                         /* readable when the process is asked to end; -1: none */
    const struct client_events *events; /* only `note` is called */
    const char *refusal;                /* the reason that the user reads when a server sends REFUSAL_TEXT */
    const char *advice;                 /* follows the reason of a DM2_NET failure; "": none */
    void *context;                      /* the first argument of `aside` and of every conversation_take */
    /* Takes a frame of another type than `due`, the type that the server owes. False: the frame is not
     * allowed here. True: the frame has been taken, *status is the result. */
    bool (*aside)(void *context, int rank, enum message_type due, const struct frame *frame,
                  enum dm2_status *status, struct dm2_error *err);
    /* For the texts of failures; the caller updates `at` during the steps. */
    int64_t at;   /* the step; -1: before the first */
    int64_t from; /* the step that the session starts from */
    bool again;   /* the run has been in its steps before */
    /* NULL: a signal ends a wait with DM2_INTERRUPTED. Else a signal sets *stopping, the wait goes on. */
    bool *stopping;
    /* Set by the functions below. */
    int culprit;   /* the rank that failed; -1: none */
    bool silent;   /* the culprit sent nothing for `timeout` seconds */
    double waited; /* seconds spent in conversation_gather */
    /* The payload of the next conversation_send. */
    struct bytes_writer out;
    struct peer *peers;   /* [ranks] */
    struct pollfd *polls; /* [ranks + 1] */
    int *polled;          /* [ranks] the rank of each entry of polls */
};

/* Takes the payload of an answer. */
typedef enum dm2_status (*conversation_take)(void *context, int rank, struct bytes_reader *r,
                                             struct dm2_error *err);

/* Allocates t->ranks connections, none of them open, and sets t->at and t->culprit to -1. DM2_MEMORY. */
enum dm2_status conversation_open(struct conversation *t, struct dm2_error *err);

/* Closes every connection and frees the memory of *t. With a status other than DM2_OK, each connected server
 * is first sent an ERROR message with `status` and the text of `err` (NULL: none); failures to send are
 * ignored. */
void conversation_close(struct conversation *t, enum dm2_status status, const struct dm2_error *err);

/* Sends t->out to one server; an answer of that server is due from then on. DM2_NET, DM2_TIMEOUT,
 * DM2_INTERRUPTED, DM2_MEMORY (t->out has failed). */
enum dm2_status conversation_send(struct conversation *t, int rank, enum message_type type,
                                  struct dm2_error *err);

/* Like conversation_send, with the payload in iov[1 .. n_iov-1], as channel_send_parts takes it. */
enum dm2_status conversation_send_parts(struct conversation *t, int rank, enum message_type type,
                                        struct iovec *iov, size_t n_iov, struct dm2_error *err);

/* Sends a payload of `length` bytes to one server without changing whether its answer is due. DM2_NET,
 * DM2_TIMEOUT, DM2_INTERRUPTED. */
enum dm2_status conversation_reply(struct conversation *t, int rank, enum message_type type,
                                   const void *payload, size_t length, struct dm2_error *err);

/* Receives one message of `type`, of at most `limit` bytes, from every awaited server, in the order of
 * arrival, and gives each to `take`. With `note`, the user is told after BUSY_SECONDS which servers have not
 * answered. DM2_NET, DM2_TIMEOUT (a server was silent for t->timeout seconds), DM2_PROTOCOL, DM2_INTERRUPTED;
 * the status of a server's ERROR message; any status of `take` and `aside`. */
enum dm2_status conversation_gather(struct conversation *t, enum message_type type, uint32_t limit,
                                    conversation_take take, bool note, struct dm2_error *err);

/* Fails with `status` because of one server: sets t->culprit and t->silent, and *err to `why` with the
 * server's rank, name and step. `why` may lie in *err. Returns `status`. */
enum dm2_status conversation_failed(struct conversation *t, int rank, enum dm2_status status, const char *why,
                                    struct dm2_error *err);

/* conversation_failed for a message of type `what` that does not decode. Returns DM2_PROTOCOL. */
enum dm2_status conversation_not_decoded(struct conversation *t, int rank, const char *what,
                                         struct dm2_error *err);

/* Writes the present step, as texts of failures name it, to out[size]. */
void conversation_name_step(const struct conversation *t, char *out, size_t size);

#endif
