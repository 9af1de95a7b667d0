/* The stable time step: the largest step at which no mode of the elements grows. */
#ifndef DM2_ENGINE_STABILITY_H
#define DM2_ENGINE_STABILITY_H

#include "dm2/base/status.h"
#include "tables.h"

/* Fills m->dt_stable (us), dt_mode (the limiting mode's name) and dt_kinds (the pair). Needs kinds, laws and
 * reaction. */
void stability_find_time_step(struct model *m);

/* DM2_DECK, with the place of dt in the deck, where the deck's dt is not below m->dt_stable. */
enum dm2_status stability_check(const struct model *m, struct dm2_error *err);

#endif
