/* The table of pair laws (struct pair_law of law.h): their constants from the deck's materials and
 * interactions. */
#ifndef DM2_ENGINE_LAWS_H
#define DM2_ENGINE_LAWS_H

#include "dm2/base/status.h"
#include "tables.h"

/* Fills m->laws[n_kinds * n_kinds * RELATION_COUNT], which the caller allocated, and the flags of the model
 * that follow from the laws (has_far to has_pressure, uniform_far, wide_far, wide_near, far_cutoff). Needs
 * kinds and reaction. DM2_DECK where a pair has no stiffness or a Morse potential no shape; DM2_MEMORY. */
enum dm2_status laws_build(struct model *m, struct dm2_error *err);

#endif
