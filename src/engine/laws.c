/* The laws of all pairs of kinds, from the constants of materials and interactions (docs/physics.md, section
 * 3); two materials have the weaker of their Y and of their Yt.
 *
 * Every table entry is computed with the pair's kinds in ascending order, so that law(a, b) and law(b, a)
 * have the same bits. */
#include "laws.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "dm2/deck/lattice.h"
#include "kinds.h"

/* Sets k and shape of the pair, from an explicit k, from plain epsilon and sigma, or from Hugoniot data. */
static enum dm2_status calibrate_centre(const struct material_config *a, const struct material_config *b,
                                        const struct interaction_config *in, struct pair_law *law,
                                        struct dm2_error *err)
{
    if (!isnan(in->epsilon)) {
        double cube_root2 = 0x1.428a2f98d728bp0; /* 2^(1/3) */
        law->eps12 = 12.0 * in->epsilon;
        law->rm2 = cube_root2 * (in->sigma * in->sigma);
        law->strength = law->eps12 / law->rm2;
        law->k = lattice_atomic_stiffness(in->epsilon, in->sigma);
    } else if (!isnan(in->k)) {
        law->k = in->k;
    } else {
        law->k = lattice_stiffness(a, b, in->calibration);
        if (!(law->k > 0.0))
            return dm2_fail(
                err, DM2_DECK,
                "materials '%s' and '%s' have no stiffness: give them rho0 and c0, or the interaction k, "
                "or epsilon and sigma",
                a->name, b->name);
    }
    law->shape = kind_given(in->shape, lattice_shape(a, b, in->calibration));
    if (law->potential != POTENTIAL_MORSE)
        law->shape = 0.0;
    else if (!(law->shape > 0.0))
        return dm2_fail(
            err, DM2_DECK,
            "the Morse potential of '%s' and '%s' has no shape: give the materials s (above %s), or the "
            "interaction a shape",
            a->name, b->name, in->calibration == CALIBRATION_BULK ? "3/8 for bulk calibration" : "0");
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
        double cutoff = kind_given(in.cutoff, c->r_c);
        law->cutoff2 = cutoff * cutoff;
        if (law->eps12 > 0.0) {
            double q = law->rm2 / law->cutoff2, q3 = q * q * q;
            law->u_cut = law->eps12 / 12.0 * (q3 * q3 - 2.0 * q3);
        }
    }
    law->cn = in.zeta * 2.0 * sqrt(law->k);
    law->ct = in.ct_ratio * 2.0 * sqrt(law->k);
    law->kt_link = isnan(in.kt_ratio) ? lattice_shear_stiffness(a, b, law->k) : in.kt_ratio * law->k;
    /* Dry friction needs a tangential spring even where the lattice has none: 2/7 kn, the ratio that
     * Schaefer, Dippel, Wolf, J. Phys. I 6 (1996) 5, use for discs. */
    law->kt_contact = in.mu > 0.0 && law->kt_link < 2.0 / 7.0 * law->k && isnan(in.kt_ratio)
                          ? 2.0 / 7.0 * law->k
                          : law->kt_link;
    law->tangential = law->kt_contact > 0.0 || law->ct > 0.0; /* kt_link is not larger */
    law->yield_i = kind_given(in.yield, kind_given(a->yield, INFINITY));
    law->yield_j = kind_given(in.yield, kind_given(b->yield, INFINITY));
    law->tensile_i = kind_given(in.tensile, kind_given(a->tensile, INFINITY));
    law->tensile_j = kind_given(in.tensile, kind_given(b->tensile, INFINITY));
    law->conduction = in.conductance * lattice_mean(a->kappa, b->kappa);
    law->near = law->scope == SCOPE_LINKED || law->cn > 0.0 || law->tangential || law->conduction > 0.0;
    law->cn_mass = law->ct_mass = -1.0;
    return DM2_OK;
}

/* Fills the constants cn_mass to bond of the laws between kinds whose elements all have one radius, hence one
 * mass. DM2_MEMORY. */
static enum dm2_status find_uniform_kinds(struct model *m, struct dm2_error *err)
{
    const struct config *c = m->config;
    double *radius = mem_zalloc(c->n_materials, sizeof *radius); /* 0: no element yet, -1: several masses */
    if (radius == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the laws of %zu kinds", m->n_kinds);
    for (size_t b = 0; b < c->n_bodies; b++) {
        for (size_t i = 0; i < c->bodies[b].n_mix; i++) {
            double *r = &radius[c->bodies[b].mix_material[i]];
            *r = *r == 0.0 || *r == c->bodies[b].radius ? c->bodies[b].radius : -1.0;
        }
    }
    if (m->reaction.any)
        radius[m->reaction.product] = -1.0; /* the product forms from elements of two materials */
    for (size_t a = 0; a < m->n_kinds; a++) {
        for (size_t b = 0; b < m->n_kinds; b++) {
            size_t ia = (size_t)m->kinds[a].material, ib = (size_t)m->kinds[b].material;
            if (radius[ia] <= 0.0 || radius[ib] <= 0.0)
                continue;
            double ma = kind_mass(&c->materials[ia], radius[ia]);
            double mb = kind_mass(&c->materials[ib], radius[ib]);
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
    return DM2_OK;
}

enum dm2_status laws_build(struct model *m, struct dm2_error *err)
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
    return find_uniform_kinds(m, err);
}
