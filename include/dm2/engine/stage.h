/* A run that begins from the state of another deck: what the deck has to know of the state, and the first
 * state of the run. */
#ifndef DM2_ENGINE_STAGE_H
#define DM2_ENGINE_STAGE_H

#include <stddef.h>

#include "dm2/base/bytes.h"
#include "dm2/base/status.h"
#include "dm2/deck/start.h"
#include "dm2/engine/element.h"
#include "dm2/engine/model.h"
#include "dm2/engine/section.h"

/* Appends the text of dm2/deck/start.h about a whole state. `path` begins messages, `digest` is that of its
 * file. DM2_PROTOCOL: the state's meaning does not load, or its records do not fit the meaning;
 * DM2_DECK: the state is the first one of a stage, whose own state is the one to begin from; DM2_MEMORY. */
enum dm2_status stage_describe(const char *path, const struct state_view *state,
                               const char digest[START_DIGEST], struct bytes_writer *out,
                               struct dm2_error *err);

/* The records of a whole state; all arrays are owned. */
struct stage_records {
    struct element *elements;
    size_t n_elements;
    struct pair_record *pairs;
    size_t n_pairs;
    struct section_array sections[SECTION_COUNT];
};

/* Turns the records of the state into those of the first state of the run, of step n_start: the elements that
 * the deck takes, then those that the deck makes. `from` is what the model's deck was bound with. DM2_DECK:
 * an element that the deck makes is pressed into one of the state, or into another; a link of the state is
 * longer than its law allows; DM2_NUMERIC, DM2_MEMORY. */
enum dm2_status stage_begin(const struct model *model, const struct start_source *from,
                            struct stage_records *records, struct dm2_error *err);

#endif
