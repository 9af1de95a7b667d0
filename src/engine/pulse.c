/* A function of its own, not inlined: next to it stands work of at least a microsecond, and a test puts a
 * slow machine in its place (tests/failing/slow.c). */
#include "dm2/engine/pulse.h"

#include <stddef.h>

void pulse_beat(const struct pulse *pulse)
{
    if (pulse != NULL && pulse->beat != NULL)
        pulse->beat(pulse->context);
}
