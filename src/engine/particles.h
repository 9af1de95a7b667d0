/* The elements of a subdomain as arrays: owned elements first, in cell order, then mirrored elements. Each
 * value has an array of its own, so that the pair loops do not read the values that only the integration or a
 * rebuild needs. */
#ifndef DM2_ENGINE_PARTICLES_H
#define DM2_ENGINE_PARTICLES_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/real.h"
#include "dm2/engine/element.h"
#include "tables.h"

/* Slots of the pair sums of one element: one cache line. */
enum pair_sum {
    SUM_FX, /* force */
    SUM_FY,
    SUM_DX, /* damping part of the force */
    SUM_DY,
    SUM_TORQUE,
    SUM_DTORQUE, /* damping part of the torque */
    SUM_HEAT,    /* freed at once: slip, yield, breaking */
    SUM_DHEAT,   /* lagged damping heat and conduction */
    SUM_COUNT
};

/* Sums of a measuring evaluation over the pairs of an element: r (x) f in fixed point; VIRIAL_TALLY holds the
 * numbers of pairs that touch or are linked, of links and of contacts, 16 bits each. */
enum virial_sum { VIRIAL_XX, VIRIAL_YY, VIRIAL_XY, VIRIAL_TALLY, VIRIAL_COUNT };
#define TALLY_PAIR    INT64_C(1)
#define TALLY_LINK    (INT64_C(1) << 16)
#define TALLY_CONTACT (INT64_C(1) << 32)

/* The fixed-point sum of r (x) r of the pairs that touch or are linked, which gives the area of an element
 * among its neighbours. */
enum around_sum { AROUND_XX, AROUND_YY, AROUND_XY, AROUND_COUNT };

/* particles_start decides by the model which arrays a deck needs. An array that is not needed stays NULL, and
 * stands for values of 0 (temperature: T0 of the material; soft: 1). The comments name the physics that needs
 * an array. */
struct particles {
    unsigned groups; /* the needs that the model has: enum need of particles.c */
    size_t n_own;    /* owned: [0, n_own) */
    size_t n;        /* all: mirrored are [n_own, n) */
    size_t cap;
    double *r;             /* [n][2] position, cm */
    double *v;             /* [n][2] velocity at the half step, cm/us */
    double *w;             /* [n] angular velocity at the half step, 1/us */
    double *radius, *mass; /* [n] cm, g */
    double *heat;          /* [n] g cm2/us2 */
    double *temperature;   /* [n] K, from heat; near pairs, a heat capacity, phases or a reaction */
    double *soft;          /* [n] softening factor, from temperature; likewise */
    double *p;       /* [n] pressure of the last evaluation, Mbar; damping that depends on p, or phases */
    double *work;    /* [n] g cm2/us2; a body force or prescribed motion */
    double *share;   /* [n][2] mass fractions of the reactants; a reaction */
    double *moved;   /* [n] energy that changes of kind took out of bonds and spin, g cm2/us2; phases or a
                        reaction */
    uint16_t *was;   /* [n] kind before the last move; likewise */
    double *strain;  /* [n][3] xx, yy, xy, of owned elements; a deck that asks for strain */
    double *damped;  /* [n] energy that local damping took, of owned elements; a deck with damping */
    uint16_t *bonds; /* [n] links at the start, of owned elements; near pairs */
    int32_t *image; /* [n][2] sizes of the domain that wrapping took off, of owned elements; periodic sides */
    double *home;   /* [n][2] place against the centroid when its load began, of owned elements, cm; bodies
                       that follow a table or turn */
    uint32_t *id, *grain;
    uint16_t *kind, *body;
    uint8_t *flags, *probes;
    int64_t *far_sum; /* [n][2] fixed-point force of the potentials of scope all; such potentials, or no pairs
                         at all */
    int64_t *pair_sum;               /* [n][SUM_COUNT] fixed-point sums of all other effects; near pairs */
    int64_t *virial;                 /* [n][VIRIAL_COUNT] of the last measuring step */
    int64_t *around;                 /* [n][AROUND_COUNT] likewise; near pairs */
    const struct body_drive *drives; /* [n_bodies] of the step whose forces were evaluated last (drive.h);
                                        NULL: the deck has none */
    const struct drive_runs *runs;   /* of the owned slots of driven bodies; NULL likewise */
};

/* An empty set for elements of this model. */
void particles_start(struct particles *p, const struct model *m);

/* Makes room for n elements and one slot behind them, and keeps the p->n present elements. 0, or -1 without
 * memory; then p is unchanged. */
int particles_reserve(struct particles *p, size_t n);
void particles_free(struct particles *p);
size_t particles_bytes(const struct particles *p); /* memory held */

/* Bytes of pair_sum. A rebuild may use pair_sum as scratch memory after particles_permute. */
size_t particles_sum_bytes(const struct particles *p);

/* Copies slot i to a record, and a record to slot i. particles_put also sets temperature and softening from
 * the heat. */
void particles_get(const struct particles *p, size_t i, struct element *out);
void particles_put(struct particles *p, const struct model *m, size_t i, const struct element *in);

/* Rearranges the state: new slot k < n gets the element of old slot from[k]; a slot with from[k] =
 * PARTICLES_NONE is to be filled by particles_put. The pair sums are lost. The caller sets p->n and p->n_own.
 * 0, or -1 without memory. */
#define PARTICLES_NONE UINT32_MAX
int particles_permute(struct particles *p, const uint32_t *from, size_t n);

/* Heat capacity of slot i, cm2/us2/K: the capacity of its kind, or in a reacting element the mean of the
 * capacities of reactants and product by mass. */
double particles_heat_capacity(const struct particles *p, const struct model *m, size_t i);

/* Temperature of slot i, K, also where there is no array of temperatures. */
static inline double particles_temperature(const struct particles *p, const struct model *m, size_t i)
{
    return p->temperature != NULL ? p->temperature[i] : m->kinds[p->kind[i]].t0;
}

/* Numbers of links and of contacts of slot i at the last measuring step. */
static inline uint16_t particles_links(const struct particles *p, size_t i)
{
    return (uint16_t)(p->virial[VIRIAL_COUNT * i + VIRIAL_TALLY] / TALLY_LINK);
}

static inline uint16_t particles_contacts(const struct particles *p, size_t i)
{
    return (uint16_t)(p->virial[VIRIAL_COUNT * i + VIRIAL_TALLY] / TALLY_CONTACT);
}

/* Softening factor 1 - ((T - T0)/(Tm - T0))^n within [0, 1] (docs/physics.md, section 4). */
static inline double particles_softening(const struct kind *kind, double temperature)
{
    if (!(temperature > kind->t0) || !isfinite(kind->tm))
        return 1.0;
    if (!(temperature < kind->tm))
        return 0.0;
    double x = (temperature - kind->t0) * kind->over_range;
    return x < 1.0 ? 1.0 - (kind->softening == 1.0 ? x : real_pow(x, kind->softening)) : 0.0;
}

/* Sets temperature and softening factor of slot i from its heat, where these arrays exist; over_mass: 1/m of
 * the slot, 1/g. */
static inline void particles_warm(struct particles *p, const struct model *m, size_t i, double over_mass)
{
    const struct kind *kind = &m->kinds[p->kind[i]];
    if (p->temperature == NULL)
        return;
    double over_cp = m->reaction.any ? 1.0 / particles_heat_capacity(p, m, i) : kind->over_cp;
    double temperature = kind->t0 + p->heat[i] * over_mass * over_cp;
    p->temperature[i] = temperature;
    p->soft[i] = particles_softening(kind, temperature);
}

/* A flag that only the arrays have: the element's body moves by forces (forced.h). */
enum { ELEMENT_FORCED = 2 };

/* True for two elements of prescribed motion in different bodies of which neither moves by forces. No force
 * can move either, so none acts between them, nor does their pair hold energy; the pair conducts, reacts,
 * counts, and links by distance. */
static inline bool particles_walls(const struct particles *p, size_t i, size_t j)
{
    return (p->flags[i] & p->flags[j] & ELEMENT_FIXED_MOTION) != 0 && p->body[i] != p->body[j] &&
           ((p->flags[i] | p->flags[j]) & ELEMENT_FORCED) == 0;
}

/* Is slot i of prescribed motion that moves by no force in its pair with slot j? An element of a body under
 * force counts with its own mass where the partner moves by no force. */
static inline bool particles_held(const struct particles *p, size_t i, size_t j)
{
    return (p->flags[i] & ELEMENT_FIXED_MOTION) != 0 &&
           !(p->flags[i] > ELEMENT_FIXED_MOTION && p->flags[j] == ELEMENT_FIXED_MOTION);
}

/* Coordinate a of slot i, owned, as if the element had never gone round a periodic domain, cm: r + image
 * size. */
static inline double particles_unwrapped(const struct particles *p, const struct model *m, size_t i, size_t a)
{
    double r = p->r[2 * i + a];
    return p->image != NULL ? r + (double)p->image[2 * i + a] * m->grid.size[a] : r;
}

/* The law of slot i with slot j, as i sees the pair. */
static inline const struct pair_law *particles_law(const struct model *m, const struct particles *p, size_t i,
                                                   size_t j)
{
    return model_law(m, p->kind[i], p->kind[j],
                     relation_of(p->body[i], p->grain[i], p->body[j], p->grain[j]));
}

#endif
