/* pulse_beat is not inlined, because each call comes between pieces of work of at least a microsecond, and
 * because a test replaces it to emulate a slow machine (tests/failing/slow.c). */
#include "dm2/engine/pulse.h"

#include <stddef.h>

void pulse_beat(const struct pulse *pulse)
{
    if (pulse != NULL && pulse->beat != NULL)
        pulse->beat(pulse->context);
}
