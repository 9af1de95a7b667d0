/* What a deck has to know of the state that its run begins from, as one text beside the deck's texts, so that
 * client and servers bind the deck alike without the state: the state's meaning, its step, its bodies.
 *
 * Lines of words, numbers with the digits that read back:
 *
 *     start DIGEST step time dt_before n_clock t_clock next_id next_grain bodies walls
 *     for each body of the meaning: the numbers of struct body_start, kinds, KIND ...
 *     for each wall of the meaning: dx dy angle
 *
 * then the meaning (dm2/deck/meaning.h). */
#ifndef DM2_DECK_START_H
#define DM2_DECK_START_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/deck/config.h"
#include "dm2/deck/deck.h"

/* How far a wall of the state has moved since its points were given. */
struct start_wall {
    double moved[2], angle; /* cm; radians */
};

struct start_source {
    char digest[START_DIGEST]; /* SHA-256 of the state's file */
    int64_t step;
    double time;      /* of the step, us */
    double dt_before; /* of the state's velocities; 0: these are of the step itself */
    int64_t n_clock;  /* the first step of the state's run, */
    double t_clock;   /* and its time, us */
    uint32_t next_id, next_grain;
    struct config before;      /* the deck of the state, by its meaning; owned */
    struct body_start *bodies; /* [before.n_bodies] */
    struct start_wall *walls;  /* [before.n_walls] */
    bool *kinds; /* [before.n_bodies][config_kinds(&before)] elements of the body are of the kind */
};

/* Appends the text. `meaning` is that of `before`. */
void start_put(struct bytes_writer *w, const struct start_source *s, const char *meaning, size_t length);

/* Reads text[0 .. length), of any bytes. *out is freed by start_free, and empty after a failure:
 * DM2_PROTOCOL, DM2_MEMORY. */
enum dm2_status start_get(const char *text, size_t length, struct start_source *out, struct dm2_error *err);
void start_free(struct start_source *s);

/* Makes a copy of text[0 .. length) the start of the run of a deck that has none.
 * DM2_MEMORY. */
enum dm2_status deck_source_begin(struct deck_source *source, const char *text, size_t length,
                                  struct dm2_error *err);

/* The text of deck_source_begin; NULL: the run begins with the elements of the deck. */
const struct deck_text *deck_source_start(const struct deck_source *source);

#endif
