/* The part of stage_begin that has a file of its own. */
#ifndef DM2_ENGINE_STAGE_PARTS_H
#define DM2_ENGINE_STAGE_PARTS_H

#include "dm2/engine/stage.h"

/* Appends the elements that the deck makes beside those of the state, with their links. As stage_begin. */
enum dm2_status stage_add_new(const struct model *model, struct stage_records *records,
                              struct dm2_error *err);

#endif
