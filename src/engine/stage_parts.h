/* The parts of stage_begin that have a file of their own. */
#ifndef DM2_ENGINE_STAGE_PARTS_H
#define DM2_ENGINE_STAGE_PARTS_H

#include "dm2/engine/stage.h"

/* Appends the elements that the deck makes beside those of the state, with their links. As stage_begin. */
enum dm2_status stage_add_new(const struct model *model, struct stage_records *records,
                              struct dm2_error *err);

/* Links the elements of the state anew, as the deck would link them if it had made them; a link starts
 * without force. Pairs that stay unlinked keep their memory. Sets the elements' counts of links. DM2_MEMORY.
 */
enum dm2_status stage_form_links(const struct model *model, struct stage_records *records,
                                 struct dm2_error *err);

#endif
