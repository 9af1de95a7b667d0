/* The scales follow from the deck's laws, masses and sizes alone, so that all servers of a run agree. */
#include "scales.h"

#include <math.h>

#include "kinds.h"

/* The largest power of two that keeps |value| <= `largest` below 2^bits. */
static double fixed_scale(double largest, int bits)
{
    int e;
    (void)frexp(largest, &e);
    return ldexp(1.0, bits - e);
}

/* The reference force F_ref = k r0 is the force of a bond strained by 100 %. Sums of up to 64 pairs of 2^57
 * fit in 64 bits; the far sums use the 51 bits that are left when 1.5 * 2^52 is added, see far.c. */
void scales_choose(struct model *m)
{
    const struct config *c = m->config;
    double r0 = 2.0 * m->radius_max, force = 0.0, heat = 0.0, mass = 0.0, mass_total = 0.0;
    for (size_t i = 0; i < m->n_kinds * m->n_kinds * RELATION_COUNT; i++) {
        const struct pair_law *law = &m->laws[i];
        double r = law->eps12 > 0.0 ? sqrt(law->rm2) : r0;
        force = law->k * r > force ? law->k * r : force;
    }
    for (size_t b = 0; b < c->n_bodies; b++) {
        for (size_t i = 0; i < c->bodies[b].n_mix; i++) {
            double one = kind_mass(&c->materials[c->bodies[b].mix_material[i]], c->bodies[b].radius);
            double cp = m->kinds[c->bodies[b].mix_material[i]].cp;
            mass = one > mass ? one : mass;
            if (isfinite(cp) && 1e5 * one * cp > heat)
                heat = 1e5 * one * cp;
        }
    }
    mass_total = mass * (double)(m->n_elements > 0 ? m->n_elements : 1);
    heat = heat > force * r0 ? heat : force * r0;
    m->fixed = (struct fixed_scales){.far_force = fixed_scale(force, 39),
                                     .force = fixed_scale(force, 45),
                                     .torque = fixed_scale(force * r0, 45),
                                     .heat = fixed_scale(heat, 56),
                                     .virial = fixed_scale(force * r0, 45),
                                     .around = fixed_scale(r0 * r0, 44),
                                     .energy = fixed_scale(force * r0, 50),
                                     .energy_left = 30};
    if (m->reaction.any)
        m->reaction.mass_scale = fixed_scale(mass, 56);
    m->fixed.over_far_force = 1.0 / m->fixed.far_force;
    m->fixed.over_force = 1.0 / m->fixed.force;
    m->fixed.over_torque = 1.0 / m->fixed.torque;
    m->fixed.over_heat = 1.0 / m->fixed.heat;
    double extent = c->size[0] + c->size[1] + fabs(c->origin[0]) + fabs(c->origin[1]);
    m->far_place = 0x1p30 * (extent + m->far_cutoff);
    double speed = extent / c->dt; /* a bound: no element crosses the domain in one step */
    int e;
    (void)frexp(force * r0, &e);
    m->scales.energy = 80 - e;
    (void)frexp(mass_total * speed, &e);
    m->scales.momentum = 110 - e;
    (void)frexp(extent * 1e6 * (double)m->n_elements, &e);
    m->scales.length = 118 - e;
    (void)frexp(speed * (double)m->n_elements, &e);
    m->scales.velocity = 118 - e;
    (void)frexp(mass_total, &e);
    m->scales.mass = 118 - e;
    (void)frexp(r0 * r0 * (double)m->n_elements, &e);
    m->scales.volume = 118 - e;
    (void)frexp(1e12 * (double)m->n_elements, &e); /* a bound: no element is hotter than 1e12 K */
    m->scales.temperature = 118 - e;
}

/* r2_least is the r^2 below which a scaled Lennard-Jones force reaches 2^50, so that far.c can check
 * distances instead of forces. */
void scales_find_far_ranges(struct model *m)
{
    for (size_t i = 0; i < m->n_kinds * m->n_kinds * RELATION_COUNT; i++) {
        struct pair_law *law = &m->laws[i];
        double r2 = law->rm2, force = 0.0;
        while (law->eps12 > 0.0 && force < 0x1p50) {
            law->r2_least = r2;
            r2 *= 0.99;
            double q = law->rm2 / r2, q3 = q * q * q;
            force = law->eps12 * (q3 * q3 - q3) / sqrt(r2) * m->fixed.far_force;
        }
    }
}
