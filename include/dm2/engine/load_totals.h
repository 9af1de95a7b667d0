/* What the sample did to a body under a force in one evaluation, as exact sums: the parts of any
 * decomposition merge to the same bits. They travel with the messages of each step (docs/protocol.md). */
#ifndef DM2_ENGINE_LOAD_TOTALS_H
#define DM2_ENGINE_LOAD_TOTALS_H

#include <stdint.h>

#include "dm2/base/exact.h"

/* The most bodies and walls of a deck that move by forces. */
enum { FORCED_MAX = 16 };

struct load_totals {
    struct exact_sum force[2]; /* of others on the body, in quanta of the pair sums */
    struct exact_sum
        speed[2]; /* velocities of the elements and walls that it touches; shift: measure_scales.velocity */
    uint32_t contacts; /* pairs that touch the body or link it with others, and contacts with walls */
};

/* Adds the part of another subdomain. */
static inline void load_totals_merge(struct load_totals *sum, const struct load_totals *part)
{
    for (int a = 0; a < 2; a++) {
        exact_merge(&sum->force[a], &part->force[a]);
        exact_merge(&sum->speed[a], &part->speed[a]);
    }
    sum->contacts += part->contacts;
}

#endif
