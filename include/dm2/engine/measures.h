/* What is measured of the whole system at one time step: a row of history.csv. The sums are exact, so
 * that the parts of any decomposition merge to the same bits. */
#ifndef DM2_ENGINE_MEASURES_H
#define DM2_ENGINE_MEASURES_H

#include <stdint.h>

#include "dm2/base/exact.h"
#include "dm2/deck/config.h"

/* The shifts (dm2/base/exact.h) of each kind of sum, from the deck: the same on every server. */
struct measure_scales {
    int energy, momentum, length, velocity, mass, volume, temperature;
};

struct probe_sums {
    uint64_t count;
    struct exact_sum r[2], v[2]; /* positions, mean velocities of the two half steps */
};

struct measures {
    struct exact_sum kinetic, potential, elastic, thermal; /* energies */
    struct exact_sum chemical;                             /* energy that the reactants have left */
    struct exact_sum phase; /* latent heats, and what changes of kind took out of bonds and spin */
    struct exact_sum work;  /* the energy put in by body force and driven elements */
    struct exact_sum momentum[2];
    struct exact_sum angular; /* angular momentum about the origin, orbital and spin */
    uint64_t elements, links, contacts;
    double t_max;        /* K; -inf where there is no element */
    double p_min, p_max; /* Mbar; +inf and -inf where there is none */
    struct probe_sums probe[PROBE_MAX];
};

/* No element yet: zero sums, infinite extremes. */
void measures_clear(struct measures *m);

/* Adds the measures of another part of the same step. */
void measures_merge(struct measures *m, const struct measures *part);

#endif
