/* A sign of life from long work. A server whose client waits gives the engine a function that the engine
 * calls between the phases of a step and within the loops of a set-up. The function decides by itself whether
 * a message is due, so that the engine may call the function often. The function changes no data of the
 * engine. */
#ifndef DM2_ENGINE_PULSE_H
#define DM2_ENGINE_PULSE_H

struct pulse {
    void (*beat)(void *context); /* NULL: no client waits */
    void *context;
};

/* Calls pulse->beat where it is not NULL; pulse may be NULL, too. */
void pulse_beat(const struct pulse *pulse);

#endif
