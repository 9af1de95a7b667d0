/* pulse_beat is not inlined, because each call comes between pieces of work of at least a microsecond, and
 * because a test replaces it to emulate a slow machine (tests/failing/slow.c). */
#include "dm2/engine/pulse.h"

#include <stddef.h>

void pulse_beat(const struct pulse *pulse)
{
    if (pulse != NULL && pulse->beat != NULL)
        pulse->beat(pulse->context);
}

bool pulse_stopped(const struct pulse *pulse)
{
    return pulse != NULL && pulse->stopped != NULL && pulse->stopped(pulse->context);
}

enum dm2_status pulse_give_up(struct dm2_error *err)
{
    return dm2_fail(err, DM2_INTERRUPTED, "interrupted before the first step");
}
