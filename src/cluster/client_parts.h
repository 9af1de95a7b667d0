/* The client's side of one session, from the first connection to DONE: its set-up (client_setup.c) and its
 * steps (client_steps.c). Every function that returns a status fails with the texts of conversation.h:
 * DM2_NET, DM2_TIMEOUT, DM2_PROTOCOL, DM2_INTERRUPTED, DM2_MEMORY, the status of a server's ERROR; those that
 * write results also with DM2_IO. */
#ifndef DM2_CLUSTER_CLIENT_PARTS_H
#define DM2_CLUSTER_CLIENT_PARTS_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/client.h"
#include "dm2/cluster/decomposition.h"
#include "dm2/cluster/messages.h"
#include "dm2/engine/rebuild.h"
#include "collection.h"
#include "conversation.h"
#include "course.h"
#include "relay.h"

/* What one server has answered in this session. */
struct server_answers {
    uint8_t loaded; /* ANSWER: 0: the deck's texts are wanted */
    struct auth_nonces nonces;
    bool challenged;
    struct ready_message ready;
    struct step_message step;
    struct relay_source segments; /* of the last STEP message, in the channel's buffer */
    struct done_message done;
};

/* One session. */
struct client {
    const struct client_job *job; /* NULL: only the network is measured */
    const struct client_options *options;
    struct course *course;
    const struct decomposition *decomposition;
    int ranks;
    struct conversation talk;
    struct collection collection;
    struct server_answers *answers; /* [ranks] */
    struct relay relay;
    struct relay_source *sources; /* [ranks] */
    struct rebuild_plan plan;
    bool copy_due; /* the state comes with this step */
    bool survey;   /* the spread comes with this step */
};

/* --- before the steps (client_setup.c), in this order --- */

/* Connects to every server of the course. In a session after a loss, servers have options->reconnect seconds
 * to be there. */
enum dm2_status client_connect(struct client *c, struct dm2_error *err);

/* Shakes hands: where a key is given, each side proves to the other that it has the key; then versions and
 * fingerprints of the arithmetic are compared. */
enum dm2_status client_greet(struct client *c, struct dm2_error *err);

/* Takes a CHALLENGE, during client_greet: sends the code that proves the key. */
enum dm2_status client_answer_challenge(struct client *c, int rank, struct bytes_reader *r,
                                        struct dm2_error *err);

/* Measures round trips (struct client_echo). */
enum dm2_status client_echo(struct client *c, struct client_echo *e, struct dm2_error *err);

/* Names the deck to every server, and sends its texts to those that do not have it. DM2_DECK: the texts are
 * too long to be sent. */
enum dm2_status client_share_deck(struct client *c, struct dm2_error *err);

/* Assigns every server its rank and, where the run does not start from the beginning, its share of the state;
 * awaits READY. */
enum dm2_status client_assign(struct client *c, struct dm2_error *err);

/* --- the steps (client_steps.c) --- */

/* All steps from the state of the session's start on, with their results. */
enum dm2_status client_run_steps(struct client *c, struct dm2_error *err);

/* Takes the last state and the last measures, writes them, and fills the reports of servers. */
enum dm2_status client_finish(struct client *c, struct dm2_error *err);

#endif
