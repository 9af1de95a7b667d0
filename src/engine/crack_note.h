/* The note that a loop of forces takes of a link that breaks. */
#ifndef DM2_ENGINE_CRACK_NOTE_H
#define DM2_ENGINE_CRACK_NOTE_H

#include <stddef.h>

#include "dm2/engine/crack.h"
#include "pair_pass.h"

struct pair_law;
struct pair_state;

/* Adds the crack of slots i and j to `list`, unless another rank owns the lower id: their link broke at the
 * distance r, cm, with the memory `before`, and freed `heat`, g cm2/us2. Sets pass->no_memory without
 * memory. */
void crack_note(struct pass *pass, struct crack_list *list, size_t i, size_t j, const struct pair_law *law,
                double r, const struct pair_state *before, double heat);

#endif
