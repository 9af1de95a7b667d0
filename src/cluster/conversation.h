/* The connections of one session: one message to every server, then one answer from every server.
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
};

struct conversation {
    /* Set before conversation_open. */
    int ranks;
    double timeout;                     /* seconds of a server's silence */
    int cancel;                         /* readable when the process is asked to end; -1: none */
    const struct client_events *events; /* of which `note` is used */
    const char *refusal;                /* explains to the user why a server may answer REFUSAL_TEXT */
    const char *advice;                 /* follows the text of DM2_NET; "": none */
    void *context;                      /* of `aside` and of every conversation_take */
    /* A frame of another type than `due`, the answer that the server owes. False: the frame has no place
     * here. True: it has been taken, *status says how that ended. */
    bool (*aside)(void *context, int rank, enum message_type due, const struct frame *frame,
                  enum dm2_status *status, struct dm2_error *err);
    /* For the texts of failures. */
    int64_t at;   /* the step; -1: before the first */
    int64_t from; /* the step that the session starts from */
    bool again;   /* the run had begun its steps before */
    /* NULL: a signal ends the wait with DM2_INTERRUPTED. Else a signal sets *stopping and the wait goes on.
     */
    bool *stopping;
    /* Results. */
    int culprit;   /* the rank that failed; -1: none */
    bool silent;   /* the culprit sent nothing for `timeout` seconds */
    double waited; /* seconds in conversation_gather, summed */
    /* The payload of the next conversation_send. */
    struct bytes_writer out;
    struct peer *peers;   /* [ranks] */
    struct pollfd *polls; /* [ranks + 1] */
    int *polled;          /* [ranks] the rank of each entry of polls */
};

/* Takes the payload of an answer. */
typedef enum dm2_status (*conversation_take)(void *context, int rank, struct bytes_reader *r,
                                             struct dm2_error *err);

/* Makes room for t->ranks connections, none of them open. DM2_MEMORY. */
enum dm2_status conversation_open(struct conversation *t, struct dm2_error *err);

/* Closes every connection and frees what *t owns. With a status other than DM2_OK each server is sent an
 * ERROR message with that status and the text of `err` (NULL: none); failures to send are ignored. */
void conversation_close(struct conversation *t, enum dm2_status status, const struct dm2_error *err);

/* Sends t->out to one server and awaits its answer. DM2_NET, DM2_TIMEOUT, DM2_INTERRUPTED, DM2_MEMORY (t->out
 * has failed). */
enum dm2_status conversation_send(struct conversation *t, int rank, enum message_type type,
                                  struct dm2_error *err);

/* The same with a payload in parts, as channel_send_parts takes it. */
enum dm2_status conversation_send_parts(struct conversation *t, int rank, enum message_type type,
                                        struct iovec *iov, size_t n_iov, struct dm2_error *err);

/* Sends to one server without awaiting another answer than the one that is due. */
enum dm2_status conversation_reply(struct conversation *t, int rank, enum message_type type,
                                   const void *payload, size_t length, struct dm2_error *err);

/* Takes one message of `type`, of at most `limit` bytes, from every awaited server, in whatever order they
 * come. With `note`, the user is told which servers have not answered after BUSY_SECONDS. What `take` and
 * `aside` return; DM2_NET, DM2_TIMEOUT (a server was silent for t->timeout seconds), DM2_PROTOCOL,
 * DM2_INTERRUPTED; the status of an ERROR message. */
enum dm2_status conversation_gather(struct conversation *t, enum message_type type, uint32_t limit,
                                    conversation_take take, bool note, struct dm2_error *err);

/* Fails with `status` because of one server: sets t->culprit and t->silent, and gives *err the server's rank,
 * name and step around `why`, which may lie in *err. Returns `status`. */
enum dm2_status conversation_failed(struct conversation *t, int rank, enum dm2_status status, const char *why,
                                    struct dm2_error *err);

/* The same for a payload that does not decode; `what` names the message. Returns DM2_PROTOCOL. */
enum dm2_status conversation_not_decoded(struct conversation *t, int rank, const char *what,
                                         struct dm2_error *err);

/* Writes which step the session is at, as texts of failures call it. */
void conversation_name_step(const struct conversation *t, char *out, size_t size);

#endif
