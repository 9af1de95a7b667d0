/* The force of each near pair in one evaluation, kept for the snapshots of decks: most evaluations keep
 * none. */
#ifndef DM2_ENGINE_PAIR_FORCES_H
#define DM2_ENGINE_PAIR_FORCES_H

#include <stdint.h>

#include "lists.h"

/* Makes lists->forces hold the forces of the next evaluation: no pair acts. 0, or -1 without memory. */
int pair_forces_hold(struct lists *lists, size_t n_own);

/* Frees lists->forces: the next evaluations keep none. */
void pair_forces_drop(struct lists *lists);

/* Notes the force on the element of the row, of components fn along n and ft along t = (-n_y, n_x), Mbar cm2.
 * `scale`: fixed_scales.force. */
void pair_forces_note(struct lists *lists, size_t entry, double scale, double nx, double ny, double fn,
                      double ft);

#endif
