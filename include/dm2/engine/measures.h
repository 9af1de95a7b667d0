/* The measures of the whole system at one time step: a row of history.csv. The sums are exact, so that the
 * parts of any decomposition merge to the same bits. */
#ifndef DM2_ENGINE_MEASURES_H
#define DM2_ENGINE_MEASURES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/exact.h"
#include "dm2/deck/config.h"
#include "dm2/engine/probe.h"

/* The shift (dm2/base/exact.h) of each kind of sum. All follow from the deck, so that all servers have the
 * same. */
struct measure_scales {
    int energy, momentum, length, velocity, mass, volume, temperature, force, moment, inertia, spin;
};

/* The shift of the sums of `fabric`. */
enum { FABRIC_SHIFT = 40 };

struct measures {
    struct exact_sum kinetic, potential, elastic, thermal; /* energies, g cm2/us2 */
    struct exact_sum chemical; /* energy that the remaining reactants can still release */
    struct exact_sum phase;    /* latent heats, and energy that changes of kind took out of bonds and spin */
    struct exact_sum work;     /* energy that body force and driven elements put in */
    struct exact_sum damped;   /* energy that local damping took */
    struct exact_sum momentum[2]; /* g cm/us */
    struct exact_sum angular;     /* angular momentum about the origin, orbital and spin */
    uint64_t elements, links, contacts;
    uint64_t pairs;                          /* of elements that touch or are linked */
    uint64_t wall_contacts;                  /* of elements with walls; `contacts` counts them too */
    struct exact_sum fabric[2];              /* n n of the pairs that touch, xx and xy */
    uint64_t free_elements, loaded_pairs;    /* pairs and contacts with walls: with an element that is free; 0
                                                elements where a    potential of scope `all` acts */
    struct exact_sum resultants, magnitudes; /* |force| of these elements, and in these pairs, Mbar cm2 */
    double t_max;                            /* K; -inf without elements */
    double p_min, p_max;                     /* Mbar; +inf and -inf without elements */
    double dt_share;    /* largest share of the present limit that dt is (engine/stiffness.h); 0: not known */
    double compression; /* largest 1 - x/r0 of bonds and contacts, at least 0 */
    size_t n_probes;
    struct probe_sums probe[PROBE_MAX]; /* [n_probes]; the others are not set */
};

/* Sets the measures of no element: zero sums, infinite extremes, no probes. */
void measures_clear(struct measures *m);

/* The mean resultant force of the free elements, with gravity, over the mean force in the pairs that touch or
 * are linked and have a free element, and in the contacts of free elements with walls. NaN without a free
 * element or such a force, and where a potential of
 * scope `all` acts. Near 0: the elements are in equilibrium. */
double measures_unbalanced(const struct measures *m, const struct measure_scales *scales);

/* Pairs that touch or are linked per element, each counted for both elements, and contacts with walls per
 * element; NaN without elements. */
double measures_coordination(const struct measures *m);

/* The mean of n n over the pairs of elements that touch, n the direction from one centre to the other: xx,
 * yy, xy. The trace is 1. NaN without such a pair. Source: Satake (1982). */
void measures_fabric(const struct measures *m, double fabric[3]);

/* Are the probes of *m those of the config, with the sums that they need? */
bool measures_match(const struct measures *m, const struct config *c);

/* Adds to *m, which is clear or has the same probes, the measures of another part of the system at the same
 * step. */
void measures_merge(struct measures *m, const struct measures *part);

#endif
