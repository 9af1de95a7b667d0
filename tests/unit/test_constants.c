/* The constants that the engine works out from a deck: the lattice of a material, the laws of pairs, the
 * stable time step. */
#include "thermo_help.h"

#include "dm2/deck/lattice.h"
#include "engine/law.h"
#include "engine/particles.h"
#include "engine/tables.h"

static const double root3 = 1.7320508075688772;

/* --- the lattice --- */

static struct material_config metal(double rho0, double c0, double s, double shear)
{
    return (struct material_config){.rho0 = rho0, .c0 = c0, .s = s, .shear = shear};
}

TEST(lattice_constants_follow_from_hugoniot_data)
{
    struct material_config a = metal(8.93, 0.394, 1.489, 0.477), b = metal(2.703, 0.535, 1.34, 0.276);
    double k0 = 8.93 * 0.394 * 0.394, kb = 2.703 * 0.535 * 0.535, both = 2.0 / (1.0 / k0 + 1.0 / kb);
    CHECK_NEAR_REL(lattice_stiffness(&a, &a, CALIBRATION_UNIAXIAL), 4.0 * k0 / (3.0 * root3), 1e-14);
    CHECK_NEAR_REL(lattice_stiffness(&a, &a, CALIBRATION_BULK), 2.0 * k0 / root3, 1e-14);
    CHECK_NEAR_REL(lattice_stiffness(&a, &b, CALIBRATION_BULK), 2.0 * both / root3, 1e-14);
    CHECK_NEAR_REL(lattice_shape(&a, &a, CALIBRATION_UNIAXIAL), (16.0 * 1.489 + 3.0) / 9.0, 1e-14);
    CHECK_NEAR_REL(lattice_shape(&a, &b, CALIBRATION_BULK), (8.0 * 1.4145 - 3.0) / 3.0, 1e-14);
    /* Lennard-Jones with its own depth and length: the second derivative at the minimum, 2^(1/6) sigma. */
    CHECK_NEAR_REL(lattice_atomic_stiffness(0.3, 0.9), 72.0 * 0.3 / (cbrt(2.0) * 0.9 * 0.9), 1e-14);
    CHECK_NEAR_REL(lattice_mean(2.0, 3.0), 2.4, 1e-15);
    CHECK_NEAR(lattice_mean(0.0, 0.0), 0.0, 0.0);
    for (int c = 0; c < 2; c++) {
        enum calibration_kind kind = (enum calibration_kind)c;
        CHECK_NEAR_REL(lattice_sound_speed(lattice_stiffness(&a, &a, kind), a.rho0, kind), a.c0, 1e-14);
        CHECK_NEAR_REL(lattice_slope(lattice_shape(&a, &a, kind), kind), a.s, 1e-14);
    }
}

TEST(shear_stiffness_stays_within_its_bounds)
{
    static const double of_central[] = {0.75, 0.995, 1.0, 1.005, 1.25, 1.495, 1.5, 1.505, 1.75},
                        want[] = {0.0, 0.0, 0.0, 0.005, 0.25, 0.495, 0.5, 0.5, 0.5};
    for (int k = 0; k < 9; k++) {
        double g = 0.25 * root3 * of_central[k];
        struct material_config a = metal(1.0, 1.0, 1.0, g), none = metal(1.0, 1.0, 1.0, (double)NAN);
        CHECK_NEAR(lattice_shear_stiffness(&a, &a, 1.0), want[k], 1e-15);
        CHECK_NEAR(lattice_shear_stiffness(&a, &none, 1.0), 0.0, 0.0);
        CHECK_NEAR_REL(lattice_shear_modulus(1.0, want[k]), 0.25 * root3 * (1.0 + want[k]), 1e-15);
        a.shear *= 3.0;
        CHECK_NEAR(lattice_shear_stiffness(&a, &a, 3.0), 3.0 * want[k], 5e-15);
    }
}

/* The strongest pull, searched in steps of 1e-5 r0, over the facet r0/sqrt 3. */
TEST(strength_is_the_strongest_pull)
{
    const double r0 = 0.04;
    for (int p = POTENTIAL_QUADRATIC; p <= POTENTIAL_LENNARD_JONES; p++) {
        struct pair_law law = {.potential = (enum potential_kind)p, .k = 1.4, .shape = 2.9};
        double most = 0.0, u, claimed = lattice_strength(law.potential, law.k, law.shape);
        for (double x = r0; x < 2.0 * r0 && p != POTENTIAL_QUADRATIC; x += 1e-5 * r0)
            most = fmax(most, -potential_force(&law, x, r0, &u));
        if (p == POTENTIAL_QUADRATIC)
            CHECK(isinf(claimed) &&
                  fabs(lattice_strength_to(law.potential, 1.4, 2.9, 1.25) - 0.35 * root3) < 1e-15);
        else
            CHECK_NEAR_REL(claimed, most / (r0 / root3), 1e-8);
    }
}

TEST(no_other_potential_has_a_force)
{
    struct pair_law law = {.potential = (enum potential_kind)(POTENTIAL_LENNARD_JONES + 1), .k = 1.4};
    double u = 0.0;
    CHECK(isnan(potential_force(&law, 0.9, 1.0, &u)) && isnan(u));
}

/* The facet, and the length of the strongest pull: shorter and longer bonds pull less, and a bond that may
 * yield has yielded beyond. */
TEST(bonds_know_their_peak)
{
    const double r0 = 0.04;
    for (int p = POTENTIAL_MORSE; p <= POTENTIAL_LENNARD_JONES; p++) {
        struct pair_law law = {
            .potential = (enum potential_kind)p, .k = 1.4, .shape = 2.9, .link_form = 0.9, .link_break = 1.3};
        struct bond bond = law_bond(&law, r0);
        double u, pull = -potential_force(&law, bond.peak, r0, &u);
        CHECK_NEAR_REL(bond.area, r0 / root3, 1e-15);
        CHECK_NEAR_REL(bond.forms, 0.036, 1e-15);
        CHECK_NEAR_REL(bond.breaks, 1.3 * law_touch_length(r0), 1e-15);
        CHECK(bond.peak > r0);
        for (double stretch = 1.01; stretch < 1.6; stretch += 0.07) { /* before the peak and behind it */
            double at = stretch * r0 < bond.peak ? stretch * r0 : bond.peak;
            CHECK_NEAR_REL(lattice_strength_to(law.potential, law.k, law.shape, stretch) * bond.area,
                           -potential_force(&law, at, r0, &u), 1e-12);
        }
        CHECK_NEAR_REL(pull, lattice_strength(law.potential, law.k, law.shape) * bond.area, 1e-14);
        double near_peak = bond.peak / r0 - 0.001, beyond = bond.peak / r0 + 0.001;
        CHECK_NEAR_REL(lattice_strength_to(law.potential, law.k, law.shape, beyond) * bond.area, pull, 1e-14);
        CHECK_NEAR_REL(lattice_strength_to(law.potential, law.k, law.shape, near_peak) * bond.area,
                       -potential_force(&law, near_peak * r0, r0, &u), 1e-12);
        for (int side = -1; side <= 1; side += 2)
            CHECK(-potential_force(&law, bond.peak * (1.0 + 1e-4 * side), r0, &u) < pull);
        if (p == POTENTIAL_LENNARD_JONES)
            CHECK_NEAR(law_yield_length(&law, r0, 1e12, false), 0.0, 0.0); /* no repulsion is so strong */
        double x = 1.001 * bond.peak, f = potential_force(&law, x, r0, &u);
        CHECK(law_pulls_too_hard(&law, &bond, x, f, 0.999999 * pull));
        CHECK(!law_pulls_too_hard(&law, &bond, x, f, 1.000001 * pull));
        x = 0.9 * bond.peak + 0.1 * r0;
        f = potential_force(&law, x, r0, &u);
        CHECK(!law_pulls_too_hard(&law, &bond, x, f, -1.000001 * f));
        CHECK(law_pulls_too_hard(&law, &bond, x, f, -0.999999 * f));
    }
}

/* --- the laws of pairs --- */

/* The law of a material A (kn = 4 rho0 c0^2/(3 sqrt 3) = 1 for uniaxial calibration) in one grain, with G in
 * units of what the central forces have. */
static struct pair_law law_of(double shear, const char *rules)
{
    char text[1000];
    struct engine g;
    (void)snprintf(text, sizeof text,
                   "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 0.001; steps = 1 }\n"
                   "material A { rho0 = 0.75*sqrt(3); c0 = 1; s = 1.5; shear = %.17g }\n"
                   "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n"
                   "interaction { %s }\n",
                   0.25 * root3 * shear, rules);
    engine_load(&g, text, NULL, 1);
    struct pair_law law = *model_law(g.model, 0, 0, RELATION_SAME_GRAIN);
    engine_stop(&g);
    return law;
}

TEST(laws_follow_their_calibration)
{
    struct pair_law uniaxial = law_of(1.2, ""), bulk = law_of(2.0, "calibration = bulk");
    CHECK_NEAR_REL(uniaxial.k, 1.0, 1e-14);
    CHECK_NEAR_REL(uniaxial.shape, 3.0, 1e-14);
    CHECK_NEAR_REL(uniaxial.kt_link, 0.2, 1e-13);
    CHECK_NEAR_REL(bulk.k, 1.5, 1e-14);
    CHECK_NEAR_REL(bulk.shape, 3.0, 1e-14);
    CHECK_NEAR_REL(bulk.kt_link, 0.5, 1e-13);
    CHECK(law_of(1.2, "kt_ratio = 0").near && !law_of(1.2, "kt_ratio = 0").tangential);
    CHECK(!law_of(1.2, "scope = all; kt_ratio = 0").near && law_of(1.2, "scope = all").near);
    CHECK(law_of(1.2, "scope = all; kt_ratio = 0; zeta = 0.1").near);
    struct pair_law other = law_of(1.2, "calibration = bulk; k = 1");
    CHECK_NEAR_REL(other.k, 1.0, 0.0);
    CHECK_NEAR_REL(other.kt_link, 0.2, 1e-13);
}

/* 1.5 is the slope for which both calibrations give a = 3. */
TEST(shapes_of_the_calibrations_differ)
{
    struct engine g;
    for (int bulk = 0; bulk < 2; bulk++) {
        char text[500];
        (void)snprintf(text, sizeof text,
                       "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 0.001; steps = 1 }\n"
                       "material A { rho0 = 1; c0 = 1; s = 2 }\nmaterial B { rho0 = 1; c0 = 1; s = 0.9 }\n"
                       "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; mix = A 0.5, B 0.5 }\n"
                       "interaction { calibration = %s }\n",
                       bulk ? "bulk" : "uniaxial");
        engine_load(&g, text, NULL, 1);
        for (int r = 0; r < RELATION_COUNT; r++) {
            CHECK_NEAR_REL(model_law(g.model, 0, 0, (enum relation)r)->shape, bulk ? 13.0 / 3.0 : 35.0 / 9.0,
                           1e-14);
            CHECK_NEAR_REL(model_law(g.model, 1, 0, (enum relation)r)->shape,
                           bulk ? (8.0 * 1.45 - 3.0) / 3.0 : (16.0 * 1.45 + 3.0) / 9.0, 1e-14);
        }
        engine_stop(&g);
    }
}

/* Friction has a spring of 2/7 kn where the lattice gives less; links keep the lattice's. */
TEST(friction_has_a_spring)
{
    struct pair_law frictionless = law_of(1.2, ""), soft = law_of(1.2, "mu = 0.3"),
                    none = law_of(0.9, "mu = 0.3"), stiff = law_of(1.4, "mu = 0.3"),
                    told = law_of(1.2, "mu = 0.3; kt_ratio = 0.1");
    CHECK_NEAR_REL(frictionless.kt_contact, 0.2, 1e-13);
    CHECK_NEAR_REL(soft.kt_contact, 2.0 / 7.0, 1e-14);
    CHECK_NEAR_REL(soft.kt_link, 0.2, 1e-13);
    CHECK_NEAR_REL(none.kt_contact, 2.0 / 7.0, 1e-14);
    CHECK_NEAR(none.kt_link, 0.0, 0.0);
    CHECK_NEAR_REL(stiff.kt_contact, 0.4, 1e-13);
    CHECK_NEAR_REL(told.kt_contact, 0.1, 1e-14);
    CHECK_NEAR_REL(law_of(1.284, "mu = 0.3").kt_contact, 2.0 / 7.0, 1e-14); /* 0.6 % beside the bound */
    CHECK_NEAR_REL(law_of(1.288, "mu = 0.3").kt_contact, 0.288, 1e-12);
    CHECK(none.tangential && soft.tangential);
}

/* Everything else of a law: damping, conduction, strengths, lengths; the mirrored law has the strengths
 * exchanged. */
TEST(laws_have_the_constants_of_the_deck)
{
    struct engine g;
    engine_load(
        &g,
        "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 1e-6; steps = 1 }\n"
        "material A { rho0 = 1; c0 = 1; s = 2; shear = 0.5; yield = 1e-3; tensile = 2e-3; kappa = 3e-9\n"
        "             cp = 1e-5; t0 = 200; tm = 1200 }\n"
        "material B { rho0 = 2; c0 = 1; s = 2; shear = 1; tensile = 3e-3; kappa = 6e-9; cp = 1e-5 }\n"
        "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n"
        "body c { shape = rectangle 0.5 0 1 1; spacing = 0.04; material = B }\n"
        "interaction { k = 4; zeta = 0.1; ct_ratio = 0.05; conductance = 0.5; mu = 0.2; link_form = 0.9\n"
        "              link_break = 1.2; a_p = 3; a_t = 0.001 }\n"
        "interaction B B { potential = lennard-jones; scope = all; epsilon = 0.5; sigma = 0.03\n"
        "                  cutoff = 0.08; yield = 4e-3; tensile = 5e-3 }\n",
        NULL, 1);
    const struct pair_law *ab = model_law(g.model, 0, 1, RELATION_OTHER_BODY),
                          *ba = model_law(g.model, 1, 0, RELATION_OTHER_BODY),
                          *bb = model_law(g.model, 1, 1, RELATION_SAME_GRAIN);
    const double ma = 0.5 * root3 * 0.0016, mb = 2.0 * ma, root = sqrt(ma * mb / (ma + mb));
    CHECK_NEAR_REL(ab->cn, 0.4, 1e-14);
    CHECK_NEAR_REL(ab->ct, 0.2, 1e-14);
    CHECK_NEAR_REL(ab->cn_mass, 0.4 * root, 1e-14);
    CHECK_NEAR_REL(ab->ct_mass, 0.2 * root, 1e-14);
    CHECK_NEAR_REL(ab->conduction, 0.5 * 4e-9, 1e-14);
    CHECK(ab->a_p == 3.0 && ab->a_t == 0.001 && ab->mu == 0.2);
    CHECK_NEAR_REL(ab->t0_mean, 250.0, 1e-15);
    CHECK(ab->yield_i == 1e-3 && isinf(ab->yield_j) && ab->tensile_i == 2e-3 && ab->tensile_j == 3e-3);
    CHECK(isinf(ba->yield_i) && ba->yield_j == 1e-3 && ba->tensile_i == 3e-3 && ba->tensile_j == 2e-3);
    CHECK(!ab->initial_link && model_law(g.model, 0, 0, RELATION_SAME_GRAIN)->initial_link);
    CHECK_NEAR_REL(ab->bond.r0, 0.04, 1e-15);
    CHECK_NEAR_REL(ab->bond.breaks, 1.2 * law_touch_length(0.04), 1e-15);
    CHECK(bb->yield_i == 4e-3 && bb->yield_j == 4e-3 && bb->tensile_i == 5e-3 && bb->tensile_j == 5e-3);
    CHECK_NEAR_REL(bb->cutoff2, 0.0064, 1e-15);
    CHECK_NEAR_REL(bb->k, 72.0 * 0.5 / (cbrt(2.0) * 0.0009), 1e-14);
    CHECK_NEAR_REL(bb->rm2, cbrt(2.0) * 0.0009, 1e-14);
    CHECK_NEAR_REL(bb->u_cut, 4.0 * 0.5 * (pow(0.375, 12.0) - pow(0.375, 6.0)), 1e-13);
    CHECK(g.model->has_far && g.model->has_near && g.model->has_heat && g.model->has_pressure);
    CHECK_NEAR_REL(g.model->far_cutoff, 0.08, 1e-15);
    CHECK_NEAR_REL(particles_softening(&g.model->kinds[0], 450.0), 0.75, 1e-14);
    CHECK_NEAR(particles_softening(&g.model->kinds[0], 1200.0), 0.0, 0.0);
    CHECK_NEAR(particles_softening(&g.model->kinds[1], 1e6), 1.0, 0.0);
    engine_stop(&g);
}

/* A denser phase is smaller, by the root of the densities; its bonds with the first phase are between. */
TEST(phases_have_their_size)
{
    struct engine g;
    engine_load(
        &g,
        "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 1e-4; steps = 1 }\n"
        "material A { rho0 = 4; c0 = 0.4; s = 2 }\n"
        "phase A dense { transition = pressure; p_line = 1; t_line = 300; rho0 = 6.25; hysteresis_p = 1 }\n"
        "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n",
        NULL, 1);
    const struct pair_law *mixed = model_law(g.model, 0, 1, RELATION_SAME_GRAIN),
                          *dense = model_law(g.model, 1, 1, RELATION_SAME_GRAIN);
    CHECK_NEAR_REL(g.model->kinds[1].size, 0.8, 1e-15);
    CHECK_NEAR_REL(mixed->radius_i, 0.02, 1e-15);
    CHECK_NEAR_REL(mixed->radius_j, 0.016, 1e-15);
    CHECK_NEAR_REL(mixed->bond.r0, 0.036, 1e-15);
    CHECK_NEAR_REL(dense->bond.r0, 0.032, 1e-15);
    CHECK_NEAR_REL(dense->k, 4.0 * 6.25 * 0.16 / (3.0 * root3), 1e-14);
    CHECK_NEAR_REL(mixed->k, 4.0 * 0.16 * (2.0 * 25.0 / 10.25) / (3.0 * root3), 1e-14);
    CHECK_NEAR_REL(g.model->radius_max, 0.02, 1e-15);
    CHECK_NEAR_REL(g.model->growth, 1.25, 1e-15);
    engine_stop(&g);
}

/* The largest factor of growth, from a phase 1 % smaller or larger. */
TEST(growth_is_that_of_the_sizes)
{
    for (int larger = 0; larger < 2; larger++) {
        char text[600];
        struct engine g;
        (void)snprintf(text, sizeof text,
                       "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 1e-4; steps = 1 }\n"
                       "material A { rho0 = 4; c0 = 0.4; s = 2 }\n"
                       "phase A p { transition = pressure; p_line = 1; t_line = 300; rho0 = 4%s1.01^2 }\n"
                       "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n",
                       larger ? "/" : "*");
        engine_load(&g, text, NULL, 1);
        CHECK_NEAR_REL(g.model->growth, 1.01, 1e-14);
        CHECK_NEAR_REL(g.model->radius_max, larger ? 0.0202 : 0.02, 1e-14);
        engine_stop(&g);
    }
}

/* A guard against 0 holds for the smallest constants, too: a foam of 1e-6 g/cm3, atoms of 1e-9 g cm2/us2. */
TEST(small_constants_are_not_none)
{
    static const char *const rules[] = {
        "zeta = 1e-6; conductance = 1e-3; a_p = 1e-5; a_t = 1e-6", "ct_ratio = 1e-6", "mu = 1e-4",
        "potential = lennard-jones; scope = all; epsilon = 1e-9; sigma = 0.03; cutoff = 0.08"};
    for (int k = 0; k < 4; k++) {
        char text[1000];
        struct engine g;
        (void)snprintf(text, sizeof text,
                       "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 1e-4; steps = 1 }\n"
                       "material A { rho0 = 1e-6; c0 = 0.01; s = 2; kappa = 1e-15; cp = 1e-5; %s }\n"
                       "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n"
                       "interaction { %s }\n",
                       k == 0 ? "shear = 0.4e-10" : "", rules[k]);
        engine_load(&g, text, NULL, 1);
        const struct pair_law *law = model_law(g.model, 0, 0, RELATION_SAME_GRAIN);
        CHECK(law->near && g.model->has_near == (k < 4));
        CHECK(law->tangential == (k < 3) && g.model->has_spin == (k < 3));
        CHECK(g.model->has_heat && g.model->has_pressure == (k == 0));
        if (k == 3) {
            CHECK_NEAR_REL(law->u_cut, 4e-9 * (pow(0.375, 12.0) - pow(0.375, 6.0)), 1e-13);
            CHECK(g.model->has_far);
        } else {
            CHECK_NEAR_REL(law->k, 4e-10 / (3.0 * root3), 1e-14);
        }
        if (k == 0)
            CHECK_NEAR_REL(law->kt_link, 1.6e-10 / root3 - law->k, 1e-13);
        if (k == 2)
            CHECK_NEAR_REL(law->kt_contact, 2.0 / 7.0 * law->k, 1e-14);
        CHECK(g.model->dt_stable < INFINITY);
        engine_stop(&g);
    }
}

/* Damping that changes with temperature alone: at 1300 K and a_t = 0.001/K twice as much. */
TEST(damping_by_temperature_needs_no_pressure)
{
    static const char deck[] =
        "domain { size = 1 1; r_c = 0.06; delta_r = 0.01 }\ntime { dt = 0.001; steps = 20 }\n"
        "material A { rho0 = 8; c0 = 0.4; s = 1.5; shear = 0.5; cp = 1e6 }\n"
        "let zeta = 0.1\nlet a_t = 0\ninteraction { zeta = zeta; a_t = a_t }\n"
        "body b { shape = disc 0.5 0.5 0.2; spacing = 0.04; material = A; jitter = 0.001; temperature = 1300 "
        "}\n";
    const char *const plain[] = {"zeta=0.2", NULL}, *const heated[] = {"a_t=0.001", NULL};
    struct engine_state s[2];
    for (int k = 0; k < 2; k++) {
        struct engine g;
        engine_start(&g, deck, k == 0 ? plain : heated, 1);
        engine_run(&g, 19);
        (void)thermo_step(&g);
        s[k] = engine_collect(&g, false);
        engine_stop(&g);
    }
    CHECK_EQ_INT(s[0].n, s[1].n);
    for (size_t i = 0; i < s[0].n; i++)
        for (int c = 0; c < 2; c++)
            CHECK_NEAR(s[0].e[i].v[c], s[1].e[i].v[c], 1e-15);
    engine_state_free(&s[0]);
    engine_state_free(&s[1]);
}

/* The stable time step of a deck with the material of law_of and a heavier one that it may meet. */
static double stable_step(const char *constants, const char *rules, const char *heavy)
{
    char text[1200];
    struct engine g;
    (void)snprintf(text, sizeof text,
                   "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 1e-9; steps = 1 }\n"
                   "material A { rho0 = 0.75*sqrt(3); c0 = 1; s = 1.5; %s }\n"
                   "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n"
                   "interaction { %s }\n%s",
                   constants, rules, heavy);
    engine_load(&g, text, NULL, 1);
    double dt = g.model->dt_stable;
    engine_stop(&g);
    return dt;
}

/* The step at which omega^2 dt^2 + 2 gamma dt = 4. */
static double mode_step(double omega2, double gamma)
{
    return 4.0 / (sqrt(gamma * gamma + 4.0 * omega2) + gamma);
}

TEST(stable_steps_are_those_of_the_stiffest_mode)
{
    const double m = 0.0018, root = sqrt(m / 2.0), none = stable_step("", "", "");
    CHECK_NEAR_REL(none, mode_step(6.0 / m, 0.0), 1e-13);
    CHECK_NEAR_REL(stable_step("", "zeta = 0.3", ""), mode_step(6.0 / m, 6.0 * 0.6 * root / m), 1e-13);
    CHECK_NEAR_REL(stable_step("", "kt_ratio = 0.2; zeta = 0.1", ""),
                   mode_step(6.4 / m, 6.0 * 0.2 * root / m), 1e-13);
    CHECK_NEAR_REL(stable_step("", "kt_ratio = 0.4", ""), mode_step(9.6 / m, 0.0), 1e-13);
    CHECK_NEAR_REL(stable_step("", "kt_ratio = 0.2; ct_ratio = 0.1", ""),
                   mode_step(4.8 / m, 24.0 * 0.2 * root / m), 1e-13);
    CHECK_NEAR_REL(stable_step("", "mu = 0.2", ""), mode_step(24.0 * 2.0 / 7.0 / m, 0.0), 1e-13);
    CHECK_NEAR_REL(stable_step("cp = 1e-5; kappa = 1e-4", "", ""), 2.0 * m * 1e-5 * root3 / (9.0 * 1e-4),
                   1e-13);
}

/* A law between equal elements damps by their own mass, although a heavier element is in the deck. */
TEST(stable_steps_take_the_pair_s_own_mass)
{
    const double m = 0.0018, root = sqrt(m / 2.0);
    double got = stable_step("", "k = 1; zeta = 0.01",
                             "interaction A H { zeta = 0 }\n"
                             "material H { rho0 = 100; c0 = 1; s = 1.5 }\n"
                             "body c { shape = rectangle 0.5 0 1 1; spacing = 0.04; material = H }\n");
    CHECK_NEAR_REL(got, mode_step(6.0 / m, 6.0 * 0.02 * root / m), 1e-13);
}

TEST(steps_above_the_stable_one_are_refused)
{
    for (int above = 0; above < 2; above++) {
        char text[600];
        struct model *model = NULL;
        struct dm2_error err = {0};
        (void)snprintf(text, sizeof text,
                       "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = %.17g; steps = 1 }\n"
                       "material A { rho0 = 0.75*sqrt(3); c0 = 1; s = 1.5 }\n"
                       "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n",
                       mode_step(6.0 / 0.0018, 0.0) * (above ? 1.001 : 0.999));
        struct loaded l = load_text(text, NULL, -1);
        CHECK_EQ_INT(model_build(&l.config, &model, &err), above ? DM2_DECK : DM2_OK);
        model_free(model);
        loaded_free(&l);
    }
}

/* One loop takes all far pairs where one kind has one law in every relation, and only there. */
TEST(far_laws_are_uniform_where_nothing_differs)
{
    static const struct {
        const char *rules;
        bool uniform;
    } given[] = {
        {"", true},
        {"interface body { epsilon = 2e-9; sigma = 0.03 }", false},
        {"interface grain { epsilon = 1e-9; sigma = 0.02 }", false},
        {"interface grain { cutoff = 0.07 }", false},
        {"interface body { potential = quadratic; k = 1e-6 }", false},
        {"interface body { potential = morse; k = 1e-6; shape = 3 }", false},
        {"material B { mass = 2 }\nbody c { shape = rectangle 0.5 0 1 1; spacing = 0.04; material = B }",
         false}};
    for (size_t k = 0; k < sizeof given / sizeof given[0]; k++) {
        char text[800];
        struct engine g;
        (void)snprintf(text, sizeof text,
                       "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 1e-6; steps = 1 }\n"
                       "material A { mass = 1 }\n"
                       "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n"
                       "interaction { potential = lennard-jones; scope = all; epsilon = 1e-9; sigma = 0.03\n"
                       "              cutoff = 0.08 }\n%s\n",
                       given[k].rules);
        engine_load(&g, text, NULL, 1);
        CHECK(g.model->has_far && g.model->uniform_far == given[k].uniform);
        CHECK(g.model->wide_far == given[k].uniform);
        engine_stop(&g);
    }
}

TEST_MAIN(CASE(lattice_constants_follow_from_hugoniot_data), CASE(shear_stiffness_stays_within_its_bounds),
          CASE(strength_is_the_strongest_pull), CASE(no_other_potential_has_a_force),
          CASE(bonds_know_their_peak), CASE(laws_follow_their_calibration),
          CASE(shapes_of_the_calibrations_differ), CASE(friction_has_a_spring),
          CASE(laws_have_the_constants_of_the_deck), CASE(phases_have_their_size),
          CASE(growth_is_that_of_the_sizes), CASE(small_constants_are_not_none),
          CASE(damping_by_temperature_needs_no_pressure), CASE(stable_steps_are_those_of_the_stiffest_mode),
          CASE(stable_steps_take_the_pair_s_own_mass), CASE(steps_above_the_stable_one_are_refused),
          CASE(far_laws_are_uniform_where_nothing_differs))
