/* A sign of life from long work. Whoever has the engine work for somebody who waits hands in a function that
 * is called now and then: between the phases of a step, and within the loops of a set-up. It decides by
 * itself whether it is time to say something, so it may be called often, and it changes nothing that the
 * engine computes with. */
#ifndef DM2_ENGINE_PULSE_H
#define DM2_ENGINE_PULSE_H

struct pulse {
    void (*beat)(void *context); /* NULL: nobody waits */
    void *context;
};

/* Calls beat, if there is one; pulse may be NULL. */
void pulse_beat(const struct pulse *pulse);

#endif
