/* Checks of a config for physical sense. The checks add findings and leave the config as it is. */
#ifndef DM2_DECK_CHECK_H
#define DM2_DECK_CHECK_H

#include "bind.h"

/* Elements are numbered with 32 bits. A deck whose estimated number of elements is above this is refused. */
#define DECK_MAX_ELEMENTS 4e9

/* Checks the whole deck. A check that needs a value that did not read is skipped. False: no memory. */
bool deck_check(const struct deck_binding *b);

/* The parts of deck_check. check_bodies: bodies, voids and flaws, and check_probes; false: no memory.
 * check_materials: materials and the interactions of their pairs. */
bool check_bodies(const struct deck_binding *b);
void check_probes(const struct deck_binding *b, bool shapes_known); /* shapes_known: of all bodies */
void check_materials(const struct deck_binding *b);
void check_chemistry(const struct deck_binding *b); /* phases and the reaction */
void check_loads(const struct deck_binding *b);     /* loads, and the spins of bodies */
void check_walls(const struct deck_binding *b);     /* the sizes of the elements of fixed, driven bodies */
void check_lines(const struct deck_binding *b);     /* the blocks `wall` */

#endif
