/* From the deck's numbers to the engine's tables.
 *
 * Calibration (docs/physics.md, section 3): a hexagonal nearest-neighbour lattice of stiffness kn, kt has
 * C11 = sqrt(3)/4 (3 kn + kt)/h and C66 = sqrt(3)/4 (kn + kt)/h. With K0 = rho0 c0^2:
 *   uniaxial: kn = 4 K0 h/(3 sqrt 3), Morse shape a = (16 S + 3)/9  (right for plane shocks)
 *   bulk:     kn = 2 K0 h/sqrt 3,     Morse shape a = (8 S - 3)/3   (right for isotropic loading)
 *   kt = 4 G h/sqrt 3 - kn, kept within [0, kn/2].
 * A pair of two materials: harmonic mean of K0 and G, mean of S, the weaker of Y and Yt.
 *
 * Every table entry is computed with the pair's kinds in ascending order, so that law(a, b) and law(b, a)
 * have the same bits. */
#include "dm2/engine/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/real.h"
#include "dm2/deck/shape.h"
#include "generate.h"
#include "tables.h"

static const double second_shell = 0.6; /* of a contact distance: sqrt(3) less a tenth, less one */
static const double root3 = 0x1.bb67ae8584caap0, pi = 0x1.921fb54442d18p1;

double model_element_mass(const struct material_config *m, double radius)
{
    if (!isnan(m->mass))
        return m->mass;
    double d = 2.0 * radius;
    return m->rho0 * (0.5 * root3 * (d * d));
}

static double harmonic_mean(double a, double b)
{
    return a + b > 0.0 ? 2.0 * (a * b) / (a + b) : 0.0;
}

static double or_else(double value, double otherwise)
{
    return isnan(value) ? otherwise : value;
}

/* k and shape of the pair at contact distance r0, from an explicit k, plain epsilon and sigma, or Hugoniot
 * data. */
static enum dm2_status calibrate_centre(const struct material_config *a, const struct material_config *b,
                                        const struct interaction_config *in, struct pair_law *law,
                                        struct dm2_error *err)
{
    double s = 0.5 * (a->s + b->s);
    bool bulk = in->calibration == CALIBRATION_BULK;
    if (!isnan(in->epsilon)) {
        double cube_root2 = 0x1.428a2f98d728bp0; /* 2^(1/3) */
        law->eps12 = 12.0 * in->epsilon;
        law->rm2 = cube_root2 * (in->sigma * in->sigma);
        law->strength = law->eps12 / law->rm2;
        law->k = 72.0 * in->epsilon / law->rm2;
    } else if (!isnan(in->k)) {
        law->k = in->k;
    } else {
        double k0 = harmonic_mean(a->rho0 * (a->c0 * a->c0), b->rho0 * (b->c0 * b->c0));
        if (!(k0 > 0.0))
            return dm2_fail(
                err, DM2_DECK,
                "materials '%s' and '%s' have no stiffness: give them rho0 and c0, or the interaction k, "
                "or epsilon and sigma",
                a->name, b->name);
        law->k = bulk ? 2.0 * k0 / root3 : 4.0 * k0 / (3.0 * root3);
    }
    law->shape = or_else(in->shape, bulk ? (8.0 * s - 3.0) / 3.0 : (16.0 * s + 3.0) / 9.0);
    if (law->potential != POTENTIAL_MORSE)
        law->shape = 0.0;
    else if (!(law->shape > 0.0))
        return dm2_fail(
            err, DM2_DECK,
            "the Morse potential of '%s' and '%s' has no shape: give the materials s (above %s), or the "
            "interaction a shape",
            a->name, b->name, bulk ? "3/8 for bulk calibration" : "0");
    return DM2_OK;
}

static enum dm2_status build_law(const struct model *m, size_t ia, size_t ib, enum relation relation,
                                 struct pair_law *law, struct dm2_error *err)
{
    const struct config *c = m->config;
    const struct material_config *a = m->kinds[ia].state, *b = m->kinds[ib].state;
    struct interaction_config in =
        config_interaction(c, m->kinds[ia].material, m->kinds[ib].material, relation);
    *law = (struct pair_law){.potential = in.potential,
                             .scope = in.scope,
                             .initial_link = in.linked,
                             .a_p = in.a_p,
                             .a_t = in.a_t,
                             .t0_mean = 0.5 * (a->t0 + b->t0),
                             .mu = in.mu,
                             .link_form = in.link_form,
                             .link_break = in.link_break};
    enum dm2_status status = calibrate_centre(a, b, &in, law, err);
    if (status != DM2_OK)
        return status;
    if (in.scope == SCOPE_ALL) {
        double cutoff = or_else(in.cutoff, c->r_c);
        law->cutoff2 = cutoff * cutoff;
        if (law->eps12 > 0.0) {
            double q = law->rm2 / law->cutoff2, q3 = q * q * q;
            law->u_cut = law->eps12 / 12.0 * (q3 * q3 - 2.0 * q3);
        }
    }
    law->cn = in.zeta * 2.0 * sqrt(law->k);
    law->ct = in.ct_ratio * 2.0 * sqrt(law->k);
    law->kt_link = in.kt_ratio * law->k;
    if (isnan(in.kt_ratio)) {
        double g = isnan(a->shear) || isnan(b->shear) ? 0.0 : harmonic_mean(a->shear, b->shear);
        double kt = 4.0 * g / root3 - law->k;
        law->kt_link = kt < 0.0 ? 0.0 : kt > 0.5 * law->k ? 0.5 * law->k : kt;
    }
    /* Dry friction needs a spring to load also where the lattice has none: 2/7 kn (Schaefer, Dippel, Wolf,
     * J. Phys. I 6 (1996) 5, use that ratio for discs). */
    law->kt_contact = in.mu > 0.0 && law->kt_link < 2.0 / 7.0 * law->k && isnan(in.kt_ratio)
                          ? 2.0 / 7.0 * law->k
                          : law->kt_link;
    law->tangential = law->kt_link > 0.0 || law->kt_contact > 0.0 || law->ct > 0.0;
    law->yield_i = or_else(in.yield, or_else(a->yield, INFINITY));
    law->yield_j = or_else(in.yield, or_else(b->yield, INFINITY));
    law->tensile_i = or_else(in.tensile, or_else(a->tensile, INFINITY));
    law->tensile_j = or_else(in.tensile, or_else(b->tensile, INFINITY));
    law->conduction = in.conductance * harmonic_mean(a->kappa, b->kappa);
    law->near = law->scope == SCOPE_LINKED || law->cn > 0.0 || law->tangential || law->conduction > 0.0;
    law->cn_mass = law->ct_mass = -1.0;
    return DM2_OK;
}

/* Where all elements of each kind have one radius, and so one mass, the pair loop finds its constants worked
 * out. */
static void uniform_kinds(struct model *m)
{
    const struct config *c = m->config;
    double *radius = mem_zalloc(c->n_materials, sizeof *radius); /* 0: no element yet, -1: several masses */
    if (radius == NULL)
        return;
    for (size_t b = 0; b < c->n_bodies; b++) {
        for (size_t i = 0; i < c->bodies[b].n_mix; i++) {
            double *r = &radius[c->bodies[b].mix_material[i]];
            *r = *r == 0.0 || *r == c->bodies[b].radius ? c->bodies[b].radius : -1.0;
        }
    }
    if (m->reaction.any)
        radius[m->reaction.product] = -1.0; /* made of elements of two materials */
    for (size_t a = 0; a < m->n_kinds; a++) {
        for (size_t b = 0; b < m->n_kinds; b++) {
            size_t ia = (size_t)m->kinds[a].material, ib = (size_t)m->kinds[b].material;
            if (radius[ia] <= 0.0 || radius[ib] <= 0.0)
                continue;
            double ma = model_element_mass(&c->materials[ia], radius[ia]);
            double mb = model_element_mass(&c->materials[ib], radius[ib]);
            double root = sqrt((ma * mb) / (ma + mb));
            for (size_t rel = 0; rel < RELATION_COUNT; rel++) {
                struct pair_law *law = &m->laws[(a * m->n_kinds + b) * RELATION_COUNT + rel];
                law->cn_mass = law->cn * root;
                law->ct_mass = law->ct * root;
                law->radius_i = radius[ia] * m->kinds[a].size;
                law->radius_j = radius[ib] * m->kinds[b].size;
                law->bond = law_bond(law, law->radius_i + law->radius_j);
                law->wide = law->scope == SCOPE_LINKED && law->potential == POTENTIAL_MORSE;
                m->wide_near |= law->wide;
            }
        }
    }
    free(radius);
}

static enum dm2_status build_laws(struct model *m, struct dm2_error *err)
{
    size_t n = m->n_kinds;
    for (size_t a = 0; a < n; a++) {
        for (size_t b = a; b < n; b++) {
            for (size_t rel = 0; rel < RELATION_COUNT; rel++) {
                struct pair_law *law = &m->laws[(a * n + b) * RELATION_COUNT + rel];
                enum dm2_status status = build_law(m, a, b, (enum relation)rel, law, err);
                if (status != DM2_OK)
                    return status;
                struct pair_law *mirror = &m->laws[(b * n + a) * RELATION_COUNT + rel];
                *mirror = *law;
                mirror->yield_i = law->yield_j;
                mirror->yield_j = law->yield_i;
                mirror->tensile_i = law->tensile_j;
                mirror->tensile_j = law->tensile_i;
                m->has_far |= law->scope == SCOPE_ALL;
                m->has_near |= law->near;
                m->has_spin |= law->tangential;
                m->has_damping |= law->cn > 0.0 || law->ct > 0.0 || law->tangential;
                m->has_heat |= law->conduction > 0.0 || (law->cn > 0.0 && law->a_t != 0.0);
                m->has_pressure |= law->cn > 0.0 && law->a_p != 0.0;
                double cutoff = sqrt(law->cutoff2);
                m->far_cutoff = cutoff > m->far_cutoff ? cutoff : m->far_cutoff;
            }
        }
    }
    const struct pair_law *only = &m->laws[0];
    m->uniform_far =
        n == 1 && only[0].scope == SCOPE_ALL && only[1].scope == SCOPE_ALL && only[2].scope == SCOPE_ALL;
    for (int rel = 1; rel < RELATION_COUNT && m->uniform_far; rel++)
        m->uniform_far = only[rel].potential == only[0].potential && only[rel].k == only[0].k &&
                         only[rel].shape == only[0].shape && only[rel].eps12 == only[0].eps12 &&
                         only[rel].cutoff2 == only[0].cutoff2;
    m->wide_far = m->uniform_far && only->eps12 > 0.0;
    uniform_kinds(m);
    return DM2_OK;
}

/* The largest power of two that keeps |value| <= `largest` below 2^bits. */
static double fixed_scale(double largest, int bits)
{
    int e;
    (void)frexp(largest, &e);
    return ldexp(1.0, bits - e);
}

/* Scales from the deck alone. F_ref = k r0 is the force of a bond strained by 100 %. Sums of up to 64 pairs
 * of 2^57 fit in 64 bits; the far sums use the 51 bits that adding 1.5 * 2^52 leaves, see force.c. */
static void choose_scales(struct model *m)
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
            double one = model_element_mass(&c->materials[c->bodies[b].mix_material[i]], c->bodies[b].radius);
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
    m->fixed.over_far_force = 1.0 / m->fixed.far_force;
    m->fixed.over_force = 1.0 / m->fixed.force;
    m->fixed.over_torque = 1.0 / m->fixed.torque;
    m->fixed.over_heat = 1.0 / m->fixed.heat;
    double extent = c->size[0] + c->size[1] + fabs(c->origin[0]) + fabs(c->origin[1]);
    m->far_place = 0x1p30 * (extent + m->far_cutoff);
    double speed = extent / c->dt; /* nothing moves faster than a cell per step */
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
    (void)frexp(1e12 * (double)m->n_elements, &e); /* no element is hotter than 1e12 K */
    m->scales.temperature = 118 - e;
}

/* Can an element that starts as this material be of this kind? */
static bool may_become(const struct model *m, int material, size_t kind)
{
    const struct reaction_table *x = &m->reaction;
    bool reacts = x->any && (material == x->reactant[0] || material == x->reactant[1]);
    return m->kinds[kind].material == material || (reacts && m->kinds[kind].material == x->product);
}

/* Where a Lennard-Jones force, scaled, reaches 2^50: far.c checks distances instead of forces. */
static void far_ranges(struct model *m)
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

static double larger(double a, double b)
{
    return a > b ? a : b;
}

/* Takes a limit that is smaller than the one so far. */
static void limit_time_step(struct model *m, double dt, const char *mode, size_t a, size_t b)
{
    if (!(dt < m->dt_stable))
        return;
    m->dt_stable = dt;
    m->dt_mode = mode;
    m->dt_kinds[0] = a;
    m->dt_kinds[1] = b;
}

/* The largest stable step of an element of this mass among neighbours of this law: omega^2 dt^2 + 2 gamma dt
 * < 4 for its stiffest mode. Translation omega^2 = (6 kn + 2 kt)/m, gamma = (6 c_n + 2 c_t)/m; rotation
 * omega^2 = 24 kt/m, gamma = 24 c_t/m. The factors of damping with P and T are not known before the run and
 * not in it. */
static void limit_by_law(struct model *m, double mass, double m_eff, size_t a, size_t b,
                         const struct pair_law *law)
{
    static const char *const modes[2][2] = {{"translation", "damping of the translation"},
                                            {"rotation", "damping of the rotation"}};
    double kt = law->kt_link > law->kt_contact ? law->kt_link : law->kt_contact, root = sqrt(m_eff);
    double omega2[2] = {(6.0 * law->k + 2.0 * kt) / mass, 24.0 * kt / mass};
    double gamma[2] = {(6.0 * law->cn + 2.0 * law->ct) * root / mass, 24.0 * law->ct * root / mass};
    for (int mode = 0; mode < 2; mode++) {
        double g = gamma[mode], o = omega2[mode];
        if (!(o > 0.0))
            continue;
        double dt = (sqrt(g * g + 4.0 * o) - g) / o;
        limit_time_step(m, dt, modes[mode][2.0 * g > o * dt], a, b); /* which term is the larger */
    }
}

/* Over all elements and the laws that they can come under. m_eff is that of the two masses where their kinds
 * have one each, and else with the heaviest element of the deck for a partner: never too small. Heat: the
 * shortest wave of the hexagonal lattice, 9 kappa/sqrt(3) / (m cp) dt < 2. */
static void stable_time_step(struct model *m)
{
    const struct config *c = m->config;
    double heaviest = 0.0;
    m->dt_stable = INFINITY;
    m->dt_mode = "nothing";
    for (size_t body = 0; body < c->n_bodies; body++)
        for (size_t i = 0; i < c->bodies[body].n_mix; i++)
            heaviest = larger(heaviest, model_element_mass(&c->materials[c->bodies[body].mix_material[i]],
                                                           c->bodies[body].radius));
    for (size_t body = 0; body < c->n_bodies; body++) {
        for (size_t i = 0; i < c->bodies[body].n_mix; i++) {
            int material = c->bodies[body].mix_material[i];
            double mass = model_element_mass(&c->materials[material], c->bodies[body].radius);
            for (size_t k = 0; k < m->n_kinds * m->n_kinds * RELATION_COUNT; k++) {
                size_t a = k / RELATION_COUNT / m->n_kinds, b = k / RELATION_COUNT % m->n_kinds;
                const struct pair_law *law = &m->laws[k];
                double m_eff = mass * heaviest / (mass + heaviest), cp = m->kinds[a].cp;
                if (!may_become(m, material, a))
                    continue;
                if (law->cn_mass >= 0.0 && law->cn > 0.0)
                    m_eff = (law->cn_mass / law->cn) * (law->cn_mass / law->cn);
                if (c->bodies[body].motion == MOTION_FREE) /* what is driven does not vibrate */
                    limit_by_law(m, mass, m_eff, a, b, law);
                if (law->conduction > 0.0 && isfinite(cp))
                    limit_time_step(m, 2.0 * mass * cp / (9.0 / root3 * law->conduction), "heat conduction",
                                    a, b);
            }
        }
    }
}

static enum dm2_status check_time_step(const struct model *m, struct dm2_error *err)
{
    const struct config *c = m->config;
    struct kind_name a, b;
    if (c->dt < m->dt_stable)
        return DM2_OK;
    return config_fail(
        c->dt_place, err, DM2_DECK,
        "the time step dt = %g us is not below the stable one, %g us (limit: %s, '%s' with '%s'): choose dt "
        "below %.2g us%s",
        c->dt, m->dt_stable, m->dt_mode, config_kind_name(c, m->dt_kinds[0], &a),
        config_kind_name(c, m->dt_kinds[1], &b), 0.8 * m->dt_stable,
        strncmp(m->dt_mode, "damping", 7) == 0 ? ", or zeta and ct_ratio smaller" : "");
}

static enum dm2_status count_element(void *context, const struct element *element, struct dm2_error *err)
{
    (void)element;
    (void)err;
    ++*(size_t *)context;
    return DM2_OK;
}

static enum dm2_status check_reach(const struct model *m, struct dm2_error *err)
{
    const struct config *c = m->config;
    for (size_t i = 0; i < m->n_kinds * m->n_kinds * RELATION_COUNT; i++) {
        const struct pair_law *law = &m->laws[i];
        double reach = 2.0 * m->radius_max * (law->near && law->link_break > 1.0 ? law->link_break : 1.0);
        if (law->near && c->r_c < reach)
            return dm2_fail(
                err, DM2_DECK,
                "r_c = %g cm is below %g cm, the distance up to which elements touch or stay linked "
                "(link_break (R_i + R_j)): make r_c at least that",
                c->r_c, reach);
        if (law->cutoff2 > c->r_c * c->r_c)
            return dm2_fail(err, DM2_DECK,
                            "a cutoff of %g cm is beyond r_c = %g cm: make r_c at least the cutoff",
                            sqrt(law->cutoff2), c->r_c);
    }
    return DM2_OK;
}

/* How much smaller and larger than the material itself its elements become in its phases. */
static void sizes_of(const struct model *m, int material, double *least, double *most)
{
    *least = *most = 1.0;
    for (size_t i = 0; i < m->n_kinds; i++) {
        double size = m->kinds[i].material == material ? m->kinds[i].size : 1.0;
        *least = size < *least ? size : *least;
        *most = size > *most ? size : *most;
    }
}

/* The largest radius of any element at any time, and by what factor one may grow. Who becomes the product of
 * a reaction brings the size it had along, and the phases of the product change that. */
static void bound_sizes(struct model *m)
{
    const struct reaction_config *r = m->config->n_reactions > 0 ? &m->config->reactions[0] : NULL;
    double largest = 1.0, least, most, product_least = 1.0, product_most = 1.0;
    m->growth = 1.0;
    if (r != NULL)
        sizes_of(m, r->product, &product_least, &product_most);
    for (int i = 0; i < (int)m->config->n_materials; i++) {
        sizes_of(m, i, &least, &most);
        if (r != NULL && (i == r->reactant[0] || i == r->reactant[1])) {
            least *= product_least;
            most *= product_most;
        }
        m->growth = most / least > m->growth ? most / least : m->growth;
        largest = most > largest ? most : largest;
    }
    m->radius_max *= largest;
}

/* The energy of a phase is that of the one it forms from, plus the latent heat, less what the difference of
 * heat capacities makes up to the temperature at which the latent heat is meant. */
static void build_kinds(struct model *m)
{
    const struct config *c = m->config;
    for (size_t i = 0; i < m->n_kinds; i++) {
        const struct phase_config *phase = i < c->n_materials ? NULL : &c->phases[i - c->n_materials];
        const struct material_config *state = phase == NULL ? &c->materials[i] : &phase->state;
        struct kind *kind = &m->kinds[i];
        *kind = (struct kind){.material = phase == NULL ? (int)i : phase->material,
                              .state = state,
                              .phase = phase,
                              .size = 1.0,
                              .t0 = state->t0,
                              .tm = or_else(state->tm, INFINITY),
                              .softening = state->softening,
                              .cp = or_else(state->cp, INFINITY)};
        kind->over_cp = 1.0 / kind->cp;
        kind->over_range = 1.0 / (kind->tm - kind->t0);
        if (phase == NULL)
            continue;
        kind->from = phase->from < 0 ? (size_t)phase->material : c->n_materials + (size_t)phase->from;
        const struct kind *from = &m->kinds[kind->from];
        kind->energy = from->energy + phase->latent;
        if (isfinite(kind->cp))
            kind->energy -= (kind->cp - from->cp) * (phase->t_line - kind->t0);
        double least_cp = kind->cp < from->cp ? kind->cp : from->cp;
        double latent = phase->latent > 0.0 ? phase->latent : 0.0;
        kind->hysteresis = phase->transition == TRANSITION_PRESSURE
                               ? phase->hysteresis_p
                               : or_else(phase->hysteresis_t, 1.1 * latent / least_cp);
        if (isnan(c->materials[phase->material].mass))
            kind->size = sqrt(c->materials[phase->material].rho0 / state->rho0);
    }
    bound_sizes(m);
    m->has_phases = c->n_phases > 0;
    m->has_kinds = m->has_phases || c->n_reactions > 0;
}

/* Where elements interact by links and contact alone, lists reach so far beyond contact that the second
 * neighbours of a lattice stay out of them though it be compressed by a tenth: pairs that cost little, and
 * fewer rebuilds. They cannot reach beyond R_c + dR, which cells exceed. */
static struct margins margins_of(const struct model *m)
{
    double contact = 2.0 * m->radius_max, dr = m->config->delta_r, reach = m->config->r_c + dr;
    struct margins of = {.close = dr,
                         .wide = reach - (m->has_far && m->far_cutoff > contact ? m->far_cutoff : contact)};
    double more = second_shell * contact < of.wide ? second_shell * contact : of.wide;
    if (!m->has_far && more > dr)
        of.close = more;
    return of;
}

static void build_reaction(struct model *m)
{
    const struct config *c = m->config;
    if (c->n_reactions == 0)
        return;
    const double gas_constant =
        8.31446261815324e-5; /* g cm2/us2/mol/K; CODATA 2018, 8.31446261815324 J/mol/K */
    const struct reaction_config *r = &c->reactions[0];
    double least = INFINITY, mass = 0.0;
    for (size_t b = 0; b < c->n_bodies; b++) {
        least = c->bodies[b].radius < least ? c->bodies[b].radius : least;
        for (size_t i = 0; i < c->bodies[b].n_mix; i++) {
            double one = model_element_mass(&c->materials[c->bodies[b].mix_material[i]], c->bodies[b].radius);
            mass = one > mass ? one : mass;
        }
    }
    m->reaction = (struct reaction_table){.any = true,
                                          .reactant = {r->reactant[0], r->reactant[1]},
                                          .product = r->product,
                                          .stoichiometric = r->kind == REACTION_STOICHIOMETRIC,
                                          .share = {0.5, 0.5},
                                          .k0 = r->k0,
                                          .theta = r->ea / gas_constant,
                                          .heat = r->heat,
                                          .threshold = r->threshold,
                                          .mass_scale = fixed_scale(mass, 56)};
    for (int a = 0; a < 2 && m->reaction.stoichiometric; a++)
        m->reaction.share[a] = r->masses[a] / (r->masses[0] + r->masses[1]);
    /* Equal discs have six neighbours, eight when crushed; a large one may touch up to the 64 that sums
     * allow. */
    m->reaction.limit = m->radius_max <= 1.5 * least ? 1.0 / 8.0 : 1.0 / 64.0;
    m->has_heat = true;
}

/* Sites of a crystal are looked for in a box along its rows, those of a grain in one that is hardly more than
 * four times the grain. */
static double places_of(const struct body_config *b)
{
    double box[4];
    shape_box(&b->shape, box);
    double width = box[2] - box[0], height = box[3] - box[1], site = b->spacing * b->row_spacing;
    if (b->structure != STRUCTURE_CRYSTAL)
        return width * height * (4.0 / site + 4.0 / (pi * (b->grain_size * b->grain_size)));
    double cosine = fabs(real_cos(b->angle)), sine = fabs(real_sin(b->angle));
    return (width * cosine + height * sine) * (width * sine + height * cosine) / site;
}

struct model_estimate model_estimate(const struct config *config)
{
    double reach = config->r_c + config->delta_r;
    struct model_estimate e = {.cells = (config->size[0] / reach + 1.0) * (config->size[1] / reach + 1.0)};
    for (size_t i = 0; i < config->n_bodies; i++) {
        const struct body_config *b = &config->bodies[i];
        e.elements += shape_area(&b->shape) / (b->spacing * b->row_spacing);
        e.places += places_of(b);
    }
    return e;
}

enum dm2_status model_build(const struct config *config, struct model **out, struct dm2_error *err)
{
    return model_build_watched(config, (struct pulse){0}, out, err);
}

enum dm2_status model_build_watched(const struct config *config, struct pulse pulse, struct model **out,
                                    struct dm2_error *err)
{
    enum dm2_status status = DM2_MEMORY;
    struct model *m = mem_zalloc(1, sizeof *m);
    *out = NULL;
    if (m == NULL)
        goto no_memory;
    m->config = config;
    m->pulse = pulse;
    m->n_kinds = config_kinds(config);
    m->kinds = mem_zalloc(m->n_kinds, sizeof *m->kinds);
    m->laws = mem_zalloc(m->n_kinds * m->n_kinds * RELATION_COUNT, sizeof *m->laws);
    if (m->kinds == NULL || m->laws == NULL)
        goto no_memory;
    for (size_t b = 0; b < config->n_bodies; b++)
        m->radius_max = config->bodies[b].radius > m->radius_max ? config->bodies[b].radius : m->radius_max;
    build_kinds(m);
    build_reaction(m);
    status = build_laws(m, err);
    if (status == DM2_OK && m->has_kinds && m->has_far)
        status =
            dm2_fail(err, DM2_DECK,
                     "phases and reactions need interactions of scope linked: their energies are those of "
                     "linked and contacting pairs");
    if (status == DM2_OK)
        status = check_reach(m, err);
    for (size_t i = 0; i < m->n_kinds; i++)
        m->has_heat |= isfinite(m->kinds[i].tm) && isfinite(m->kinds[i].cp) && m->has_near;
    m->has_strain = config->output.strain;
    if (status == DM2_OK && m->has_strain && !m->has_near)
        status = dm2_fail(
            err, DM2_DECK,
            "strain = yes measures the motion of linked or touching neighbours, and no interaction of "
            "this deck links or meets (scope = all): leave it out");
    if (status == DM2_OK)
        status = grid_build(config->origin, config->size, config->periodic, config->r_c + config->delta_r,
                            &m->grid, err);
    if (status == DM2_OK)
        status = generate_elements(m, count_element, &m->n_elements, err);
    if (status != DM2_OK) {
        model_free(m);
        return status;
    }
    m->margins = margins_of(m);
    choose_scales(m);
    far_ranges(m);
    stable_time_step(m);
    status = check_time_step(m, err);
    if (status != DM2_OK) {
        model_free(m);
        return status;
    }
    *out = m;
    return DM2_OK;
no_memory:
    model_free(m);
    return dm2_fail(err, DM2_MEMORY, "no memory for the tables of %zu materials", config->n_materials);
}

void model_free(struct model *m)
{
    if (m == NULL)
        return;
    free(m->kinds);
    free(m->laws);
    free(m);
}

const struct config *model_config(const struct model *m)
{
    return m->config;
}

const struct grid *model_grid(const struct model *m)
{
    return &m->grid;
}

struct margins model_margins(const struct model *m)
{
    return m->margins;
}

struct measure_scales model_scales(const struct model *m)
{
    return m->scales;
}

size_t model_elements(const struct model *m)
{
    return m->n_elements;
}

double model_stable_dt(const struct model *m, const char **which)
{
    *which = m->dt_mode;
    return m->dt_stable;
}

struct cell_counter {
    const struct grid *grid;
    uint32_t *counts;
};

static enum dm2_status count_in_cell(void *context, const struct element *e, struct dm2_error *err)
{
    struct cell_counter *counter = context;
    (void)err;
    counter->counts[grid_cell(counter->grid, e->r[0], e->r[1])]++;
    return DM2_OK;
}

enum dm2_status model_cell_counts(const struct model *m, uint32_t *counts, struct dm2_error *err)
{
    struct cell_counter counter = {&m->grid, counts};
    for (size_t cell = 0; cell < (size_t)m->grid.cx * (size_t)m->grid.cy; cell++)
        counts[cell] = 0;
    return generate_elements(m, count_in_cell, &counter, err);
}
