/* Inside the server's role: one session, which server.c opens and closes, and the stages between.
 *
 *     server_talk   messages to and from the session's client
 *     server_deck   the deck: found, compared, loaded
 *     server_setup  the assignment of a rank, the subdomain of it
 *     server_steps  the steps and the last messages
 *
 * A function below that fails has said nothing to the client: server.c does that once, for all of them. */
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

struct session {
    const struct server_options *options;
    struct lobby *lobby; /* looked after while the client is waited for */
    struct session_summary *summary;
    struct channel channel;
    bool greeted; /* WELCOME is sent: the client may say that it is at work */
    struct bytes_writer out;
    struct deck_message deck;
    struct config config;
    bool loaded; /* config is to be freed */
    struct model *model;
    struct assign_message assign;
    struct decomposition decomposition;
    struct domain_map map;
    struct subdomain *sd;
    struct exchange exchange;
    double timeout;
    double quiet_since;           /* the last message, from here or from there */
    double alive_every;           /* seconds of work from then until ALIVE, and from one to the next */
    struct dm2_error alive_error; /* what came of the one that could not be sent */
    double heard;                 /* when the last message had come: work since then is `busy` */
    double ahead;                 /* seconds of work on this step before that */
    bool cpu_on;                  /* the processor's seconds, since `counted`; see count_cpu */
    double cpu_since;
    struct server_times times;
};

/* --- server_talk --- */

struct deadline server_deadline(const struct session *s);
enum dm2_status server_send(struct session *s, enum message_type type, struct dm2_error *err);
void server_beat(void *context);
enum dm2_status server_check_type(const struct frame *f, enum message_type type, struct bytes_reader *out,
                                  struct dm2_error *err);
enum dm2_status server_receive(struct session *s, uint32_t limit, struct deadline until, struct frame *f,
                               struct dm2_error *err);
enum dm2_status server_expect(struct session *s, enum message_type type, uint32_t limit,
                              struct deadline until, struct bytes_reader *out, struct dm2_error *err);
enum dm2_status server_not_decoded(const char *what, struct dm2_error *err);

/* --- server_deck --- */

enum dm2_status server_get_deck(struct session *s, struct dm2_error *err);

/* --- server_setup --- */

enum dm2_status server_get_assignment(struct session *s, struct dm2_error *err);
enum dm2_status server_send_ready(struct session *s, struct dm2_error *err);

/* --- server_steps --- */

enum dm2_status server_run_steps(struct session *s, struct dm2_error *err);
enum dm2_status server_send_done(struct session *s, struct dm2_error *err);

#endif
