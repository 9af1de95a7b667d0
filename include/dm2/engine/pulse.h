/* A sign of life from long work. A server whose client waits gives the engine a function that the engine
 * calls between the phases of a step and within the loops of a set-up. The function decides by itself whether
 * a message is due, so that the engine may call the function often. The function changes no data of the
 * engine. The set-up also asks whether anybody still wants its result; a step that has begun comes to its
 * end. */
#ifndef DM2_ENGINE_PULSE_H
#define DM2_ENGINE_PULSE_H

#include <stdbool.h>

#include "dm2/base/status.h"

struct pulse {
    void (*beat)(void *context); /* NULL: no client waits */
    void *context;
    bool (*stopped)(void *context); /* is the set-up to be given up? NULL: never */
};

/* Calls pulse->beat where it is not NULL; pulse may be NULL, too. */
void pulse_beat(const struct pulse *pulse);

/* pulse->stopped; false where that or pulse is NULL. */
bool pulse_stopped(const struct pulse *pulse);

/* Fails with DM2_INTERRUPTED, for work that ends because of pulse_stopped. */
enum dm2_status pulse_give_up(struct dm2_error *err);

#endif
