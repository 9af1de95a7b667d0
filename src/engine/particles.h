/* The elements of a subdomain as arrays: owned ones first, in cell order, then the mirrored ones. What the
 * pair loops read is apart from what only the integration or a rebuild reads. */
#ifndef DM2_ENGINE_PARTICLES_H
#define DM2_ENGINE_PARTICLES_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/real.h"
#include "dm2/engine/element.h"
#include "tables.h"

/* Slots of the pair sums of one element: one cache line. */
enum pair_sum {
    SUM_FX, /* force */
    SUM_FY,
    SUM_DX, /* its damping part */
    SUM_DY,
    SUM_TORQUE,
    SUM_DTORQUE, /* its damping part */
    SUM_HEAT,    /* freed at once: slip, yield, breaking */
    SUM_DHEAT,   /* lagged damping heat and conduction */
    SUM_COUNT
};

/* What a measuring evaluation adds up of the pairs of an element: the fixed-point sum of r (x) f, and, of
 * those that touch or are linked, how many pairs, links and contacts, 16 bits each of one number: */
enum virial_sum { VIRIAL_XX, VIRIAL_YY, VIRIAL_XY, VIRIAL_TALLY, VIRIAL_COUNT };
#define TALLY_PAIR    INT64_C(1)
#define TALLY_LINK    (INT64_C(1) << 16)
#define TALLY_CONTACT (INT64_C(1) << 32)

/* and the fixed-point sum of their r (x) r, which tells the area that an element has among its neighbours. */
enum around_sum { AROUND_XX, AROUND_YY, AROUND_XY, AROUND_COUNT };

/* Not every deck needs every array: particles_start decides by the model; the others stay NULL, and the
 * values that they would hold are 0 (temperature: that at which the material has no heat; soft: 1). */
struct particles {
    unsigned groups; /* which arrays there are; private to particles.c */
    size_t n_own;    /* owned: [0, n_own) */
    size_t n;        /* all: mirrored are [n_own, n) */
    size_t cap;
    double *r; /* [n][2] position, cm */
    double *v; /* [n][2] velocity at the half step, cm/us */
    double *w; /* [n] angular velocity there, 1/us */
    double *radius, *mass;
    double *heat;        /* [n] g cm2/us2 */
    double *temperature; /* [n] K, follows from heat; near pairs, or a material with a heat capacity */
    double *soft;        /* [n] softening factor, follows from temperature; likewise */
    double *p;           /* [n] pressure of the last evaluation, Mbar; damping or phases that depend on it */
    double *work;        /* [n] g cm2/us2; a body force or prescribed motion */
    double *share;       /* [n][2] mass fractions of the reactants; a reaction */
    double *moved;       /* [n] energy that changes of kind took out of bonds and spin, g cm2/us2; phases or a
                            reaction */
    uint16_t *was;       /* [n] kind before the last move; likewise */
    double *strain;      /* [n][3] xx, yy, xy, of owned elements; where the deck asks for it */
    uint16_t *bonds;     /* [n] links at the start, of owned elements; near pairs */
    uint32_t *id, *grain;
    uint16_t *kind, *body;
    uint8_t *flags, *probes;
    int64_t *far_sum;  /* [n][2] fixed-point force of the potentials of scope all; where there are some, or no
                          pairs */
    int64_t *pair_sum; /* [n][SUM_COUNT] fixed-point sums of everything else; near pairs */
    int64_t *virial;   /* [n][VIRIAL_COUNT] of the last measuring step */
    int64_t *around;   /* [n][AROUND_COUNT] likewise; near pairs */
};

/* An empty set for elements of this model. */
void particles_start(struct particles *p, const struct model *m);

/* Room for n elements and the slot after them, keeping the owned and mirrored ones. 0, or -1 without memory
 * (then as before). */
int particles_reserve(struct particles *p, size_t n);
void particles_free(struct particles *p);
size_t particles_bytes(const struct particles *p);

/* Bytes of pair_sum, which a rebuild may use as it likes once the state has been rearranged. */
size_t particles_sum_bytes(const struct particles *p);

/* Element i as a record, and a record into slot i. The second sets temperature and softening from the heat.
 */
void particles_get(const struct particles *p, size_t i, struct element *out);
void particles_put(struct particles *p, const struct model *m, size_t i, const struct element *in);

/* Rearranges the state; the pair sums are lost: new slot k gets what slot from[k] held, for k < n; a slot
 * with from[k] = PARTICLES_NONE is left to be put. 0, or -1 without memory. The caller sets n and n_own. */
#define PARTICLES_NONE UINT32_MAX
int particles_permute(struct particles *p, const uint32_t *from, size_t n);

/* Heat capacity of slot i, cm2/us2/K: that of its kind, or the mean of what its reactants and product have.
 */
double particles_heat_capacity(const struct particles *p, const struct model *m, size_t i);

/* What slot i has of an array that may not be there. */
static inline double particles_temperature(const struct particles *p, const struct model *m, size_t i)
{
    return p->temperature != NULL ? p->temperature[i] : m->kinds[p->kind[i]].t0;
}

/* How many links and contacts slot i had at the last measuring step. */
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

/* Temperature and softening factor of slot i from its heat, where there are such; over_mass: 1/m of the slot,
 * 1/g. */
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

#endif
