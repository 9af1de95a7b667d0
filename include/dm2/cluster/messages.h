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
#include "dm2/engine/measures.h"
#include "dm2/engine/rebuild.h"
#include "dm2/net/frame.h"

enum { PROTOCOL_VERSION = 10 };

enum { DEFAULT_PORT = 4702 }; /* of a server; the one place where it is written */

/* Seconds of work until ALIVE is sent: a quarter of the client's patience, and a second at most. Before
 * ASSIGN a server does not know that and takes ALIVE_SECONDS. */
#define ALIVE_SECONDS 0.25
static inline double alive_every(double patience)
{
    return patience < 4.0 ? 0.25 * patience : 1.0;
}

/* c: from the client, s: from the server. */
enum message_type {
    MESSAGE_HELLO = 1,    /* c: fingerprint, version of the program */
    MESSAGE_WELCOME = 2,  /* s: the same of the server */
    MESSAGE_DECK = 3,     /* c: the deck by name and digest, or its texts */
    MESSAGE_ANSWER = 4,   /* s: the deck is loaded, or its texts are wanted */
    MESSAGE_ASSIGN = 5,   /* c: rank, decomposition */
    MESSAGE_READY = 6,    /* s: the subdomain stands */
    MESSAGE_STEP = 7,     /* s: one step is done: dmax, measures, segments for others */
    MESSAGE_NEXT = 8,     /* c: the segments of others, and what to do next */
    MESSAGE_STATE = 9,    /* either: a part of a state */
    MESSAGE_DONE = 10,    /* s: last measures, timing; the session is over */
    MESSAGE_ECHO = 13,    /* c: bytes, after WELCOME; s: the same bytes. An empty one ends the session */
    MESSAGE_ERROR = 11,   /* either: why the session ends now */
    MESSAGE_PROFILE = 12, /* s: the sums of a profile, before STEP or DONE as STATE is */
    MESSAGE_ALIVE = 14,   /* either, after WELCOME, before what is due: nothing but that it is at work */
    /* Before HELLO where a key is in use (dm2/cluster/auth.h); the payloads are nonces and codes as they are.
     */
    MESSAGE_KNOCK = 20,     /* c: nonce */
    MESSAGE_CHALLENGE = 21, /* s: nonce */
    MESSAGE_PROOF = 22,     /* c: code */
    MESSAGE_GRANT = 23,     /* s: code */
    /* In place of KNOCK and HELLO, also while the server is busy. */
    MESSAGE_STATUS = 24, /* c: nonce */
    MESSAGE_REPORT = 25  /* s: what it does */
};

/* Largest payloads, bytes. */
enum {
    LIMIT_AUTH = 128,
    LIMIT_HELLO = 1024,
    LIMIT_DECK = 64 * 1024 * 1024,
    LIMIT_SMALL = 64 * 1024, /* ANSWER, READY, DONE, ERROR */
    LIMIT_ASSIGN = 4 * 1024 * 1024,
    LIMIT_STATE = 4 * 1024 * 1024,
    LIMIT_STEP = FRAME_LENGTH_MAX
};

enum { VERSION_TEXT_MAX = 64, DECK_NAME_MAX = 1024, DECK_TEXTS_MAX = 1000 };

struct hello_message {
    uint64_t fingerprint;
    char version[VERSION_TEXT_MAX + 1]; /* of the program */
};

/* With texts: `source` is whole. Without: it has only defines and steps. */
struct deck_message {
    bool with_texts;
    unsigned char digest[SHA256_BYTES]; /* deck_digest of the client's source */
    char *name;                         /* to look for below the server's deck directory */
    struct deck_source source;
};

struct assign_message {
    int rank, ranks;
    int cx, cy;                 /* the grid, to be compared */
    uint64_t elements;          /* of the whole run, to be compared */
    struct cell_rect *rects;    /* ranks of them */
    int interfaces[SIDE_COUNT]; /* the eight-element array, to be compared */
    double timeout;             /* the client's, seconds */
    int64_t hash_every;         /* 0: never */
    bool rebuild_first;         /* the first step ends with a rebuild */
    bool copy_first;            /* the state comes with the first step */
    int64_t start; /* the step to start from; its state follows in STATE messages; -1: generate */
};

struct ready_message {
    uint64_t owned, mirrored, bytes;
    uint64_t hash; /* of the state at step 0, where hashes are wanted */
};

struct step_message {
    int64_t step;      /* the state that the segments belong to */
    bool rebuild;      /* segments are parcels, not updates */
    uint64_t owned;    /* elements owned after the step, before the exchange; */
    uint64_t migrants; /* those of them that leave in the segments */
    double dmax;       /* cm */
    double busy;       /* seconds of work since the last message */
    bool measured;     /* measures (of state step - 1) are there */
    bool hashed;
    bool surveyed; /* the spread is there */
    struct spread spread;
    struct measures measures;
    uint64_t hash; /* of the server's part of the state `step` */
    uint32_t n_segments;
};

struct next_message {
    int64_t step;
    bool redo;         /* no segments: send the same step again as a rebuild */
    bool rebuild_next; /* the next step ends with a rebuild */
    bool copy_next;    /* the state comes with the next step */
    bool survey_next;  /* the spread comes with the next step */
    uint32_t n_segments;
};

/* A copy: from a server, of the step of the STEP message that follows; from the client, to start from. */
enum state_purpose { STATE_SNAPSHOT = 1, STATE_FINAL = 2, STATE_COPY = 3 };

struct state_message {
    int64_t step;
    enum state_purpose purpose; /* a snapshot has measures beside its elements */
    bool last;                  /* this server's part is complete */
    size_t n_elements, n_pairs; /* n_elements elements, their measures, n_pairs pairs follow */
};

/* What a server counted in a session; seconds. */
struct server_times {
    double forces, integrate, rebuild, pack, wait, unpack, output;
    double ahead; /* of forces: while the others' states were on the way */
    double cpu;   /* of the processor: computing, packing and unpacking in all steps */
    uint64_t steps, rebuilds, migrants, mirrored; /* migrants sent away; mirrored: sum over steps */
    uint64_t messages_in, messages_out, bytes_in, bytes_out;
};

/* Behind it stand n_bins bins (wire_get_bin). */
struct profile_message {
    int64_t step;
    size_t which; /* of the deck's profiles */
    size_t n_bins;
};

struct done_message {
    struct measures measures; /* of the last state */
    struct server_times times;
};

/* What a server says about itself. */
struct report_message {
    char version[VERSION_TEXT_MAX + 1]; /* of the program */
    bool busy;
    char peer[SOCKET_NAME]; /* with whom, */
    double seconds;         /* for how long */
    char deck[200];         /* empty: not known yet */
    int rank, ranks;        /* 0 of 0: not known yet */
    int64_t step;
    uint32_t waiting; /* clients whose turn has not come */
    double load;      /* machine_load(): -1 where it is not known */
    int cores;
};

struct error_message {
    enum dm2_status status;
    char text[600];
};

/* All that somebody is told who has not shown that he has the key. */
#define REFUSAL_TEXT "not admitted"

/* Each put appends to w; each get reads a whole payload, or the head of one that continues (STEP, NEXT,
 * STATE), and leaves r->failed where it cannot be. What a get allocated is freed by the function beside it,
 * also after a failure. */
void message_put_hello(struct bytes_writer *w, const struct hello_message *m);
void message_get_hello(struct bytes_reader *r, struct hello_message *m);
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
void message_put_profile(struct bytes_writer *w, const struct profile_message *m);
void message_get_profile(struct bytes_reader *r, struct profile_message *m);
void message_put_done(struct bytes_writer *w, const struct done_message *m);
void message_get_done(struct bytes_reader *r, struct done_message *m);
void message_put_report(struct bytes_writer *w, const struct report_message *m);
void message_get_report(struct bytes_reader *r, struct report_message *m);
void message_put_error(struct bytes_writer *w, const struct error_message *m);
void message_get_error(struct bytes_reader *r, struct error_message *m);

/* "HELLO", or "type 77". For error texts; the buffer is the caller's. */
const char *message_name(uint8_t type, char buffer[16]);

#endif
