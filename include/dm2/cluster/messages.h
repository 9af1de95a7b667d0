/* The messages between client and server: one list, one protocol version. docs/protocol.md is the normative
 * text.
 *
 * BUMP PROTOCOL_VERSION with every change of a message, of a field's meaning or of their order. A program
 * talks only to its own version. */
#ifndef DM2_CLUSTER_MESSAGES_H
#define DM2_CLUSTER_MESSAGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/bytes.h"
#include "dm2/base/sha256.h"
#include "dm2/base/status.h"
#include "dm2/cluster/decomposition.h"
#include "dm2/deck/deck.h"
#include "dm2/engine/load_totals.h"
#include "dm2/engine/measures.h"
#include "dm2/engine/overlap.h"
#include "dm2/engine/rebuild.h"
#include "dm2/engine/section.h"
#include "dm2/net/frame.h"

enum { PROTOCOL_VERSION = 12 };

enum { DEFAULT_PORT = 4702 }; /* of a server; written nowhere else */

/* Seconds of work until ALIVE is sent: a quarter of the client's timeout, at most 1. Before ASSIGN a server
 * does not know the client's timeout and takes ALIVE_SECONDS. */
#define ALIVE_SECONDS 0.25
static inline double alive_every(double timeout)
{
    return timeout < 4.0 ? 0.25 * timeout : 1.0;
}

/* c: from the client, s: from the server. */
enum message_type {
    MESSAGE_HELLO = 1,    /* c: fingerprint, version of the program; asks for its place, or takes its turn */
    MESSAGE_WELCOME = 2,  /* s: fingerprint, version, of the server; the client's turn has come */
    MESSAGE_DECK = 3,     /* c: the deck by name and digest, with or without its texts */
    MESSAGE_ANSWER = 4,   /* s: the deck is loaded, or its texts are wanted */
    MESSAGE_ASSIGN = 5,   /* c: rank, decomposition */
    MESSAGE_READY = 6,    /* s: the subdomain is ready */
    MESSAGE_STEP = 7,     /* s: one step is done: dmax, measures, segments for other ranks */
    MESSAGE_NEXT = 8,     /* c: the segments of other ranks, and orders for the next step */
    MESSAGE_STATE = 9,    /* either: a part of a state */
    MESSAGE_DONE = 10,    /* s: last measures, timing; the session is over */
    MESSAGE_ECHO = 13,    /* c: bytes, after WELCOME; s: the same bytes. An empty ECHO ends the session */
    MESSAGE_ERROR = 11,   /* either: why the sender ends the session */
    MESSAGE_PROFILE = 12, /* s: the sums of a profile; like STATE, before STEP or DONE */
    MESSAGE_ALIVE = 14,   /* either, after WELCOME: the sender works on the message that is due */
    /* Before HELLO where a key is in use (dm2/cluster/auth.h); each payload is a nonce or a code. */
    MESSAGE_KNOCK = 20,     /* c: nonce */
    MESSAGE_CHALLENGE = 21, /* s: nonce */
    MESSAGE_PROOF = 22,     /* c: code */
    MESSAGE_GRANT = 23,     /* s: code */
    /* In place of KNOCK and HELLO, also while the server is busy. */
    MESSAGE_STATUS = 24, /* c: nonce */
    MESSAGE_REPORT = 25, /* s: the state of the server */
    /* To a HELLO that asks, also while the server is busy. */
    MESSAGE_PLACE = 29 /* s: which server this is, and who comes before the client */
};

/* Largest payloads, bytes. */
enum {
    LIMIT_AUTH = 128,
    LIMIT_HELLO = 1024,
    LIMIT_DECK = 64 * 1024 * 1024,
    LIMIT_SMALL = 64 * 1024, /* ANSWER, READY, ERROR */
    LIMIT_ASSIGN = 4 * 1024 * 1024,
    LIMIT_STATE = 4 * 1024 * 1024,
    LIMIT_STEP = FRAME_LENGTH_MAX
};

enum { VERSION_TEXT_MAX = 64, DECK_NAME_MAX = 1024, DECK_TEXTS_MAX = 1000 };

/* HELLO and WELCOME. */
struct hello_message {
    bool turn; /* the client waits for its session; false: for PLACE, and its turn is asked for by another
                  HELLO */
    uint64_t fingerprint;
    char version[VERSION_TEXT_MAX + 1]; /* of the program */
};

enum { SERVER_ID = 16, PLACE_DECK_MAX = 199 };

struct place_message {
    unsigned char id[SERVER_ID]; /* drawn at random when the server starts */
    uint32_t before;             /* clients that come before: in session or waiting for it */
    char peer[SOCKET_NAME];      /* the client in session; empty: none */
    char deck[PLACE_DECK_MAX + 1];
    int64_t step;
};

/* `source` is complete with texts; without texts it holds only defines and steps. */
struct deck_message {
    bool with_texts;
    unsigned char digest[SHA256_BYTES]; /* of the deck's meaning, all parts */
    char *name;                         /* of a file below the server's deck directory */
    struct deck_source source;
};

struct assign_message {
    int rank, ranks;
    int cx, cy;                 /* cells of the grid; the server compares them with its own */
    uint64_t elements;          /* of the whole run; compared, too */
    struct cell_rect *rects;    /* by rank */
    int interfaces[SIDE_COUNT]; /* the eight-element array; compared, too */
    double timeout;             /* of the client, seconds */
    int64_t hash_every;         /* 0: never */
    bool rebuild_first;         /* the first step ends with a rebuild */
    bool copy_first;            /* the server sends the state with the first step */
    int64_t end;   /* the last step: the deck's, or an earlier one, where a block `stop` has ended the run */
    int64_t start; /* the step to start from, whose state follows in STATE messages; -1: generate */
};

struct ready_message {
    uint64_t owned, mirrored, bytes;
    uint64_t hash; /* of the state before the first step, where hash_every > 0 */
    struct overlap overlap;
};

/* The links that broke, of a STEP or a DONE message. */
struct crack_part {
    size_t n;
    const struct crack *items;  /* [n] to be sent; borrowed */
    const unsigned char *bytes; /* [n][WIRE_CRACK] of a message that came, in its payload */
};

struct step_message {
    int64_t step;             /* of the state after this step, to which the segments belong */
    bool rebuild;             /* segments are parcels, not updates */
    uint64_t owned;           /* elements owned after the step, before the exchange */
    uint64_t migrants;        /* of `owned`: elements that leave in the segments */
    double dmax;              /* greatest displacement in this step, cm */
    double busy;              /* seconds of work since the last NEXT */
    bool measured;            /* `measures` is there, of the state step - 1 */
    bool hashed;              /* `hash` is there */
    bool surveyed;            /* `spread` is there */
    struct crack_part cracks; /* of the evaluation of the state step - 1 */
    struct spread spread;
    struct measures measures;
    uint64_t hash;                        /* of the server's part of the state `step` */
    size_t n_loads;                       /* 0 also in a STEP that a redo asked for */
    struct load_totals loads[FORCED_MAX]; /* of the server's elements, in evaluation step - 1 */
    uint32_t n_segments;
};

struct next_message {
    int64_t step;
    bool redo;                            /* send the same step again as a rebuild; no segments */
    bool rebuild_next;                    /* the next step ends with a rebuild */
    bool copy_next;                       /* the server sends the state with the next step */
    bool survey_next;                     /* the server sends its spread with the next step */
    bool ends;                            /* the run ends two steps later */
    size_t n_loads;                       /* 0 also where `redo` is set */
    struct load_totals loads[FORCED_MAX]; /* of all servers, of the STEP that this NEXT answers */
    uint32_t n_segments;
};

/* STATE_COPY is, from a server, the state of the STEP message that follows; from the client, the state to
 * start from. */
enum state_purpose { STATE_SNAPSHOT = 1, STATE_FINAL = 2, STATE_COPY = 3 };

struct state_message {
    int64_t step;
    enum state_purpose purpose;     /* a STATE_SNAPSHOT has measures after its elements */
    bool last;                      /* no more STATE messages follow for this state */
    size_t n_elements, n_pairs;     /* n_elements elements, their measures, n_pairs pairs, */
    size_t sections[SECTION_COUNT]; /* and so many records of each further section follow */
};

/* Sums over a session, in seconds where nothing else is said. */
struct server_times {
    double forces, integrate, rebuild, pack, wait, unpack, output;
    double ahead; /* of forces, while NEXT was on the way */
    double cpu;   /* processor seconds of computing, packing and unpacking in all steps */
    uint64_t steps, rebuilds;
    uint64_t migrants, mirrored; /* elements sent away; elements mirrored, summed over steps */
    uint64_t messages_in, messages_out, bytes_in, bytes_out;
};

/* n_bins bins follow (wire_get_bin). */
struct profile_message {
    int64_t step;
    size_t which; /* index of a profile of the deck */
    size_t n_bins;
};

struct done_message {
    struct measures measures; /* of the last state */
    struct crack_part cracks; /* of its evaluation */
    struct server_times times;
};

/* The state of a server. */
struct report_message {
    char version[VERSION_TEXT_MAX + 1]; /* of the program */
    bool busy;
    char peer[SOCKET_NAME]; /* the client that is served */
    double seconds;         /* since its session began */
    char deck[200];         /* empty: not known yet */
    int rank, ranks;        /* 0 of 0: not known yet */
    int64_t step;
    uint32_t waiting; /* clients that wait for their turn */
    double load;      /* machine_load(); -1: not known */
    int cores;
};

struct error_message {
    enum dm2_status status;
    char text[600];
};

/* The text of each ERROR to a peer that has not proved the key. */
#define REFUSAL_TEXT "not admitted"

/* message_put_X appends to w. message_get_X reads a whole payload, or the head of a payload that continues
 * (STEP, NEXT, STATE, PROFILE), and sets r->failed where the bytes are no such message. message_free_X frees
 * the memory that message_get_X allocated, also after a failure. */
void message_put_hello(struct bytes_writer *w, const struct hello_message *m);
void message_get_hello(struct bytes_reader *r, struct hello_message *m);
void message_put_place(struct bytes_writer *w, const struct place_message *m);
void message_get_place(struct bytes_reader *r, struct place_message *m);
void message_put_deck(struct bytes_writer *w, const struct deck_message *m);
void message_get_deck(struct bytes_reader *r, struct deck_message *m);
void message_free_deck(struct deck_message *m);
void message_put_assign(struct bytes_writer *w, const struct assign_message *m);
void message_get_assign(struct bytes_reader *r, struct assign_message *m);
void message_free_assign(struct assign_message *m);
void message_put_ready(struct bytes_writer *w, const struct ready_message *m);
void message_get_ready(struct bytes_reader *r, struct ready_message *m);
void message_put_step(struct bytes_writer *w, const struct step_message *m);
void message_get_step(struct bytes_reader *r, struct step_message *m);
void message_put_next(struct bytes_writer *w, const struct next_message *m);
void message_get_next(struct bytes_reader *r, struct next_message *m);
void message_put_state(struct bytes_writer *w, const struct state_message *m);
void message_get_state(struct bytes_reader *r, struct state_message *m);
bool state_message_empty(const struct state_message *m); /* no records follow */
void message_put_profile(struct bytes_writer *w, const struct profile_message *m);
void message_get_profile(struct bytes_reader *r, struct profile_message *m);
void message_put_done(struct bytes_writer *w, const struct done_message *m);
void message_get_done(struct bytes_reader *r, struct done_message *m);
void message_put_report(struct bytes_writer *w, const struct report_message *m);
void message_get_report(struct bytes_reader *r, struct report_message *m);
void message_put_error(struct bytes_writer *w, const struct error_message *m);
void message_get_error(struct bytes_reader *r, struct error_message *m);

/* The name of a type, for error texts: "HELLO", or, written to the caller's buffer, "type 77". */
const char *message_name(uint8_t type, char buffer[16]);

#endif
