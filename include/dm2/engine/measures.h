/* The measures of the whole system at one time step: a row of history.csv. The sums are exact, so that the
 * parts of any decomposition merge to the same bits. */
#ifndef DM2_ENGINE_MEASURES_H
#define DM2_ENGINE_MEASURES_H

#include <stdint.h>

#include "dm2/base/exact.h"
#include "dm2/deck/config.h"

/* The shift (dm2/base/exact.h) of each kind of sum. All follow from the deck, so that all servers have the
 * same. */
struct measure_scales {
    int energy, momentum, length, velocity, mass, volume, temperature;
};

struct probe_sums {
    uint64_t count;
    struct exact_sum r[2], v[2]; /* positions, cm; means of the velocities of the two half steps, cm/us */
};

struct measures {
    struct exact_sum kinetic, potential, elastic, thermal; /* energies, g cm2/us2 */
    struct exact_sum chemical; /* energy that the remaining reactants can still release */
    struct exact_sum phase;    /* latent heats, and energy that changes of kind took out of bonds and spin */
    struct exact_sum work;     /* energy that body force and driven elements put in */
    struct exact_sum momentum[2]; /* g cm/us */
    struct exact_sum angular;     /* angular momentum about the origin, orbital and spin */
    uint64_t elements, links, contacts;
    double t_max;        /* K; -inf without elements */
    double p_min, p_max; /* Mbar; +inf and -inf without elements */
    double dt_share;    /* largest share of the present limit that dt is (engine/stiffness.h); 0: not known */
    double compression; /* largest 1 - x/r0 of bonds and contacts, at least 0 */
    struct probe_sums probe[PROBE_MAX];
};

/* Sets the measures of no element: zero sums, infinite extremes. */
void measures_clear(struct measures *m);

/* Adds to *m the measures of another part of the system at the same step. */
void measures_merge(struct measures *m, const struct measures *part);

#endif
