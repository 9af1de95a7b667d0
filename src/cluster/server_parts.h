/* One session, as the files of the server's role share it.
 *
 * server.c opens and closes a session and calls its stages in order:
 *
 *     server_talk   messages to and from the session's client
 *     server_deck   the deck: found, compared, loaded
 *     server_setup  the rank, its subdomain, its exchange
 *     server_steps  the time steps and the last messages
 *
 * A function below that fails sends no ERROR: server.c sends it, once for all of them. Each function that
 * receives or sends has the failures of server_receive and server_send besides those it names. */
#ifndef DM2_CLUSTER_SERVER_PARTS_H
#define DM2_CLUSTER_SERVER_PARTS_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/cluster/decomposition.h"
#include "dm2/cluster/messages.h"
#include "dm2/cluster/server.h"
#include "dm2/engine/subdomain.h"
#include "exchange.h"
#include "lobby.h"

/* Times are seconds, points in time those of clock_now(). */
struct session {
    const struct server_options *options;
    struct lobby *lobby; /* answers visitors while the session waits for its client */
    struct session_summary *summary;
    struct channel channel;  /* to the client */
    bool greeted;            /* WELCOME is sent: the client may send ALIVE */
    struct bytes_writer out; /* the payload of the next message */
    struct deck_message deck;
    struct config config;
    bool loaded; /* config holds a deck and has to be freed */
    struct model *model;
    struct assign_message assign;
    struct decomposition decomposition;
    struct domain_map map;
    struct subdomain *sd;
    struct exchange exchange;
    double timeout;               /* silence of the client after which the session ends */
    double quiet_since;           /* when the last message went either way */
    double alive_every;           /* from quiet_since to ALIVE, and from one ALIVE to the next */
    struct dm2_error alive_error; /* why the session ends during work; the next server_send returns it */
    double heard;                 /* when the last NEXT came: work since then is `busy` of STEP */
    double ahead;                 /* work on this step before `heard` */
    bool cpu_on;                  /* times.cpu counts, from cpu_since (clock_cpu) on; see count_cpu */
    double cpu_since;
    struct server_times times;
};

/* --- server_talk --- */

/* s->timeout from now, or when the process is asked to end. */
struct deadline server_deadline(const struct session *s);

/* Sends s->out as the payload of a message. s->alive_error, where an ALIVE failed before; DM2_MEMORY where
 * s->out could not grow; otherwise as channel_send. */
enum dm2_status server_send(struct session *s, enum message_type type, struct dm2_error *err);

/* Sends ALIVE and answers visitors, where the last message is s->alive_every old. To be called during work
 * that may take longer than the client's timeout; `context` is the session, so that a struct pulse can hold
 * this function. A failure, the end of the client's stream and the wish of the process to end go to
 * s->alive_error. */
void server_beat(void *context);

/* Has server_beat found a reason to end the session? */
bool server_stopped(void *context);

/* Makes *out a reader of the payload of f. DM2_PROTOCOL where f is not of this type, DM2_NET where f is the
 * client's ERROR. */
enum dm2_status server_check_type(const struct frame *f, enum message_type type, struct bytes_reader *out,
                                  struct dm2_error *err);

/* Waits for a message of any type but ALIVE, with a payload of at most `limit` bytes, and answers visitors
 * meanwhile. Each ALIVE after WELCOME sets the deadline to server_deadline(s). The payload of *f belongs to
 * the channel and lasts until the next receive. Failures as of channel_receive. */
enum dm2_status server_receive(struct session *s, uint32_t limit, struct deadline until, struct frame *f,
                               struct dm2_error *err);

/* server_receive, then server_check_type. */
enum dm2_status server_expect(struct session *s, enum message_type type, uint32_t limit,
                              struct deadline until, struct bytes_reader *out, struct dm2_error *err);

/* DM2_PROTOCOL: the client's message `what` does not decode. */
enum dm2_status server_not_decoded(const char *what, struct dm2_error *err);

/* --- server_deck --- */

/* Receives DECK, sends ANSWER, and repeats both where the texts of the deck are missing; sets s->deck,
 * s->config and s->model. Each ECHO before DECK is sent back; an empty ECHO sets s->summary->measured, and
 * the function returns DM2_OK without a deck. DM2_PROTOCOL where the digests differ; DM2_DECK where the deck
 * does not load or exceeds the limits of s->options; DM2_MEMORY. */
enum dm2_status server_get_deck(struct session *s, struct dm2_error *err);

/* --- server_setup --- */

/* Receives ASSIGN, and the state to start from where ASSIGN announces one; sets s->assign, s->decomposition,
 * s->map, s->sd, s->exchange, s->timeout and s->alive_every. DM2_PROTOCOL where the client's grid, number of
 * elements, interfaces or state do not fit the server's model; DM2_MEMORY; otherwise as subdomain_create and
 * subdomain_restore. */
enum dm2_status server_get_assignment(struct session *s, struct dm2_error *err);

/* Sends READY. DM2_MEMORY. */
enum dm2_status server_send_ready(struct session *s, struct dm2_error *err);

/* --- server_steps --- */

/* Takes all time steps from that of s->sd to the deck's last. DM2_PROTOCOL where a NEXT or its segments do
 * not fit the step; otherwise as the functions of the engine. */
enum dm2_status server_run_steps(struct session *s, struct dm2_error *err);

/* Sends the final state, the last snapshot and profiles where they are due, and DONE. */
enum dm2_status server_send_done(struct session *s, struct dm2_error *err);

#endif
