/* The client's side of one session: set-up (client_setup.c) and steps (client_steps.c), called by client.c.
 *
 * Each function with a status may fail with DM2_NET, DM2_TIMEOUT, DM2_PROTOCOL, DM2_INTERRUPTED, DM2_MEMORY
 * or the status of a server's ERROR message, the steps also with DM2_NUMERIC or DM2_IO. */
#ifndef DM2_CLUSTER_CLIENT_PARTS_H
#define DM2_CLUSTER_CLIENT_PARTS_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/cluster/auth.h"
#include "dm2/cluster/client.h"
#include "dm2/cluster/decomposition.h"
#include "dm2/cluster/messages.h"
#include "dm2/engine/loading.h"
#include "dm2/engine/rebuild.h"
#include "collection.h"
#include "conversation.h"
#include "course.h"
#include "relay.h"

/* The answers of one server in this session. */
struct server_answers {
    uint8_t loaded; /* of ANSWER; 0: the server wants the texts of the deck */
    struct auth_nonces nonces;
    bool challenged; /* CHALLENGE has come */
    struct place_message place;
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
    struct crack_list cracks; /* that came with the last STEP or DONE messages */
    bool copy_due;            /* the state comes with the next STEP messages */
    bool survey;              /* the spread comes with the next STEP messages */
    struct loading *loading;  /* the bodies under force; NULL: there are none */
};

/* --- client_setup.c, in the order of a session --- */

/* Connects to every server of the course. After a loss, attempts go on for options->reconnect seconds. */
enum dm2_status client_connect(struct client *c, struct dm2_error *err);

/* Shakes hands: with a key, client and server prove to each other that they have the key; then every server
 * says which one it is, and the client takes its turn at one after the other in the order of their ids. So
 * clients that want the same servers wait for each other without a cycle, whatever their hosts files call the
 * servers. Releases and fingerprints are compared. DM2_PROTOCOL: wrong proof, different releases or
 * fingerprints, one server under two names. */
enum dm2_status client_greet(struct client *c, struct dm2_error *err);

/* Answers a server's CHALLENGE with PROOF, while client_greet awaits GRANT. */
enum dm2_status client_answer_challenge(struct client *c, int rank, struct bytes_reader *r,
                                        struct dm2_error *err);

/* Measures round trips (struct client_echo). */
enum dm2_status client_echo(struct client *c, struct client_echo *e, struct dm2_error *err);

/* Names the deck to every server, then sends the texts to the servers that do not have the deck. DM2_DECK:
 * the texts are too long to be sent. */
enum dm2_status client_share_deck(struct client *c, struct dm2_error *err);

/* Assigns a rank to every server, sends each its share of the state unless the run starts at the beginning,
 * and awaits READY. */
enum dm2_status client_assign(struct client *c, struct dm2_error *err);

/* --- client_steps.c --- */

/* Runs the steps from the session's starting step to the last one and writes their results. */
enum dm2_status client_run_steps(struct client *c, struct dm2_error *err);

/* Receives the last state and the last measures, writes them, and fills course->report.servers. */
enum dm2_status client_finish(struct client *c, struct dm2_error *err);

#endif
