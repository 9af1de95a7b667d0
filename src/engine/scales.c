/* The scales follow from the deck's laws, masses and sizes alone, so that all servers of a run agree. */
#include "scales.h"

#include <math.h>

#include "kinds.h"
#include "wall_shape.h"

/* The largest power of two that keeps |value| <= `largest` below 2^bits. */
static double fixed_scale(double largest, int bits)
{
    int e;
    (void)frexp(largest, &e);
    return ldexp(1.0, bits - e);
}

/* True if the body has elements that are, or may become, of the kind. */
static bool holds_kind(const struct model *m, const struct body_config *body, size_t kind)
{
    for (size_t i = 0; i < body->n_mix; i++)
        if (kind_may_become(m, body->mix_material[i], kind))
            return true;
    return false;
}

/* True if some pair of the deck may follow the law of these kinds and this relation with a force of its own.
 */
static bool law_has_pairs(const struct model *m, size_t a, size_t b, enum relation relation)
{
    const struct config *c = m->config;
    for (size_t x = 0; x < c->n_bodies; x++) {
        if (!holds_kind(m, &c->bodies[x], a))
            continue;
        for (size_t y = 0; y < c->n_bodies; y++) {
            bool walls = c->bodies[x].motion != MOTION_FREE && c->bodies[y].motion != MOTION_FREE &&
                         (m->forced_of == NULL || (m->forced_of[x] == 0 && m->forced_of[y] == 0));
            if ((x == y) != (relation == RELATION_OTHER_BODY) && (x == y || !walls) &&
                holds_kind(m, &c->bodies[y], b))
                return true;
        }
    }
    return false;
}

/* What the sums of the deck have to hold: the largest force, heat and mass of reactants. */
struct ranges {
    double force; /* Mbar cm2: k r0, the force of a bond strained by 100 % */
    double heat;  /* g cm2/us2, of a pair in one step */
    double mass;  /* g, of the heaviest element, and of the heaviest that reacts */
    double reacting;
};

/* The heat of a pair in one step: F_ref r0, what two elements conduct whose temperatures differ by 1e5 K, or
 * the heat of all reactant of an element. The heat that an element holds is a double and sets no range. */
static struct ranges find_ranges(const struct model *m)
{
    const struct config *c = m->config;
    const struct reaction_table *x = &m->reaction;
    double r0 = 2.0 * m->radius_max;
    struct ranges range = {.force = 0.0};
    for (size_t i = 0; i < m->n_kinds * m->n_kinds * RELATION_COUNT; i++) {
        const struct pair_law *law = &m->laws[i];
        size_t a = i / RELATION_COUNT / m->n_kinds, b = i / RELATION_COUNT % m->n_kinds;
        range.heat = fmax(range.heat, 1e5 * law->conduction * c->dt);
        if (law_has_pairs(m, a, b, (enum relation)(i % RELATION_COUNT)))
            range.force = fmax(range.force, law->k * (law->eps12 > 0.0 ? sqrt(law->rm2) : r0));
    }
    for (size_t i = 0; i < m->n_walls * m->n_kinds; i++) {
        const struct pair_law *law = &m->walls[i / m->n_kinds].laws[i % m->n_kinds];
        range.force = fmax(range.force, law->k * r0);
        range.heat = fmax(range.heat, 1e5 * law->conduction * c->dt);
    }
    for (size_t b = 0; b < c->n_bodies; b++) {
        for (size_t i = 0; i < c->bodies[b].n_mix; i++) {
            int material = c->bodies[b].mix_material[i];
            double one = kind_mass(&c->materials[material], c->bodies[b].radius);
            range.mass = fmax(range.mass, one);
            if (x->any && (material == x->reactant[0] || material == x->reactant[1]))
                range.reacting = fmax(range.reacting, one);
        }
    }
    range.heat = fmax(range.heat, fmax(range.force * r0, fabs(x->heat) * range.reacting));
    return range;
}

/* The reference force F_ref = k r0 is the force of a bond strained by 100 %. Sums of up to 64 pairs of 2^57
 * fit in 64 bits; the far sums use the 51 bits that are left when 1.5 * 2^52 is added, see far.c. */
void scales_choose(struct model *m)
{
    const struct config *c = m->config;
    const struct ranges range = find_ranges(m);
    double r0 = 2.0 * m->radius_max, force = range.force;
    double mass_total = range.mass * (double)(m->n_elements > 0 ? m->n_elements : 1);
    m->fixed = (struct fixed_scales){.far_force = fixed_scale(force, 39),
                                     .force = fixed_scale(force, 45),
                                     .torque = fixed_scale(force * r0, 45),
                                     .heat = fixed_scale(range.heat, 56),
                                     .virial = fixed_scale(force * r0, 45),
                                     .around = fixed_scale(r0 * r0, 44),
                                     .energy = fixed_scale(force * r0, 50),
                                     .stiffness = fixed_scale(force / r0, 40),
                                     .energy_left = 30};
    if (m->reaction.any)
        m->reaction.mass_scale = fixed_scale(range.reacting, 56);
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
    (void)frexp(force, &e);
    m->scales.force = 75 - e; /* log2(fixed.force) + energy_left */
    (void)frexp(mass_total * speed, &e);
    m->scales.momentum = 110 - e;
    (void)frexp(extent * 1e6 * (double)m->n_elements, &e);
    m->scales.length = 118 - e;
    (void)frexp(speed * (double)m->n_elements, &e);
    m->scales.velocity = 118 - e;
    (void)frexp(mass_total, &e);
    m->scales.mass = 118 - e;
    (void)frexp(mass_total * extent * 1e6, &e); /* an element may go round the domain often */
    m->scales.moment = 118 - e;
    (void)frexp(mass_total * (extent * extent) * 1e12, &e);
    m->scales.inertia = 118 - e;
    (void)frexp(r0 * r0 * (double)m->n_elements, &e);
    m->scales.volume = 118 - e;
    (void)frexp(1e6 / c->dt, &e); /* a bound: no wall turns more often than its steps */
    m->scales.spin = 110 - e;
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
