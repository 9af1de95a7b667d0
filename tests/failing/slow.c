/* Linked into dm2-server in front of the engine (-Wl,--wrap): a slow machine. Each pulse_beat of the engine
 * for a client takes DM2_SLOW milliseconds more; with DM2_MUTE the server then sends no ALIVE. */
#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <time.h>

#include "dm2/engine/pulse.h"

void __real_pulse_beat(const struct pulse *pulse);
void __wrap_pulse_beat(const struct pulse *pulse);

void __wrap_pulse_beat(const struct pulse *pulse)
{
    const char *slow = getenv("DM2_SLOW");
    bool waits = pulse != NULL && pulse->beat != NULL;
    long ms = slow != NULL && waits ? strtol(slow, NULL, 10) : 0;
    struct timespec rest = {.tv_sec = ms / 1000, .tv_nsec = ms % 1000 * 1000000};
    while (nanosleep(&rest, &rest) != 0 && errno == EINTR)
        continue;
    if (getenv("DM2_MUTE") == NULL)
        __real_pulse_beat(pulse);
}
