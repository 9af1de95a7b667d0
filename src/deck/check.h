/* Does what a deck says make physical sense together? Findings only; the config stays as it is. */
#ifndef DM2_DECK_CHECK_H
#define DM2_DECK_CHECK_H

#include "bind.h"

/* Elements are numbered with 32 bits; an estimate above this is refused. */
#define DECK_MAX_ELEMENTS 4e9

/* The whole deck. Where something was bad before, what depends on it is not checked. False: no memory. */
bool deck_check(const struct deck_binding *b);

/* Its parts: bodies, probes and output; materials and their pairs. */
bool check_bodies(const struct deck_binding *b);
void check_materials(const struct deck_binding *b);
void check_chemistry(const struct deck_binding *b); /* phases and the reaction */

#endif
