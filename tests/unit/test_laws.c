/* What the laws of a deck decide: which loops and arrays a run needs, and which constants all pairs of two
 * kinds share. Constants here lie on either side of 1, and within a hundredth of their limits. */
#include "thermo_help.h"

#include "engine/tables.h"

#define FRAME "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 1e-9; steps = 1 }\n"
#define BODY                                                                                                 \
    "material A { rho0 = 1; c0 = 1; s = 2; cp = 1e-5 }\n"                                                    \
    "body b { shape = rectangle 0 0 0.4 1; spacing = 0.04; material = A }\n"

static const struct pair_law *load(struct engine *g, const char *text)
{
    engine_load(g, text, NULL, 1);
    return model_law(g->model, 0, 0, RELATION_SAME_GRAIN);
}

TEST(potentials_of_their_own)
{
    struct engine g;
    const struct pair_law *law = load(&g, FRAME BODY "interaction { potential = lennard-jones; scope = all\n"
                                                     "    epsilon = 0.5; sigma = 0.03; cutoff = 0.08 }\n");
    CHECK_NEAR_REL(law->strength, 12.0 * 0.5 / (cbrt(2.0) * 0.0009), 1e-14);
    CHECK_SAME_BITS(law->shape, 0.0);
    CHECK(!law->wide && !law->near);
    engine_stop(&g);
    law = load(&g, FRAME BODY "interaction { potential = quadratic; k = 4 }\n");
    CHECK_SAME_BITS(law->shape, 0.0);
    CHECK(!law->wide && !g.model->wide_near);
    engine_stop(&g);
    law = load(&g, FRAME BODY "interaction { k = 1e-9; shape = 1e-4 }\n"); /* however soft */
    CHECK_SAME_BITS(law->shape, 1e-4);
    CHECK(law->wide && g.model->wide_near);
    engine_stop(&g);
    law = load(&g, FRAME BODY "interaction { scope = all; k = 1; shape = 3 }\n");
    CHECK(!law->wide && !law->near);
    engine_stop(&g);
}

/* 2/7 kn in contacts with friction whose lattice gives less, at a stiffness of 4 Mbar cm. */
TEST(springs_of_friction)
{
    static const char *const rules[] = {"mu = 0.1", "mu = 0.1; kt_ratio = 0.1", "mu = 0"};
    const double shear = 0.25 * sqrt(3.0) * (4.0 + 0.5), want[] = {8.0 / 7.0, 0.4, 0.5};
    for (int k = 0; k < 3; k++) {
        char text[600];
        struct engine g;
        (void)snprintf(text, sizeof text,
                       FRAME "material A { rho0 = 1; c0 = 1; s = 2; shear = %.17g }\n"
                             "body b { shape = rectangle 0 0 0.4 1; spacing = 0.04; material = A }\n"
                             "interaction { k = 4; %s }\n",
                       shear, rules[k]);
        const struct pair_law *law = load(&g, text);
        CHECK_NEAR_REL(law->kt_link, k == 1 ? 0.4 : 0.5, 1e-12);
        CHECK_NEAR_REL(law->kt_contact, want[k], 1e-12);
        CHECK(law->tangential && g.model->has_spin);
        engine_stop(&g);
    }
}

/* Heat matters where damping depends on temperature, pressure where damping depends on pressure. */
TEST(what_damping_needs)
{
    static const struct {
        const char *rules;
        bool heat, pressure;
    } cases[] = {{"zeta = 1e-4; a_t = 0.001", true, false},
                 {"zeta = 1e-4; a_p = 0.001", false, true},
                 {"zeta = 0.1", false, false},
                 {"zeta = 0; a_t = 0.1; a_p = 1", false, false},
                 {"zeta = 0.1; a_t = 0.1; a_p = 1", true, true}};
    for (int k = 0; k < 5; k++) {
        char text[600];
        struct engine g;
        (void)snprintf(text, sizeof text, FRAME BODY "interaction { k = 1; scope = all; %s }\n",
                       cases[k].rules);
        const struct pair_law *law = load(&g, text);
        CHECK_EQ_INT(law->near, k != 3);
        CHECK_EQ_INT(g.model->has_heat, cases[k].heat);
        CHECK_EQ_INT(g.model->has_pressure, cases[k].pressure);
        CHECK(!law->tangential && !g.model->has_spin);
        engine_stop(&g);
    }
}

/* The cutoff of the lists is the largest, be it by a hundredth. */
TEST(the_largest_cutoff)
{
    struct engine g;
    (void)load(&g, FRAME BODY
               "material B { rho0 = 1; c0 = 1; s = 2 }\n"
               "body c { shape = rectangle 0.4 0 1 1; spacing = 0.04; material = B }\n"
               "interaction { scope = all; cutoff = 0.08 }\ninteraction A B { cutoff = 0.0808 }\n");
    CHECK_NEAR_REL(g.model->far_cutoff, 0.0808, 1e-14);
    engine_stop(&g);
}

/* Constants by mass where all elements of a kind are equal, however small and in however many bodies. */
TEST(kinds_of_equal_elements)
{
    static const char *const second[] = {"4e-4", "4.04e-4"};
    for (int k = 0; k < 2; k++) {
        char text[900];
        struct engine g;
        (void)snprintf(
            text, sizeof text,
            "domain { size = 0.01 0.01; r_c = 1e-3; delta_r = 1e-4 }\ntime { dt = 1e-9; steps = 1 }\n"
            "material A { rho0 = 1; c0 = 1; s = 2 }\nmaterial B { rho0 = 2; c0 = 1; s = 2 }\n"
            "body a { shape = rectangle 0 0 0.003 0.01; spacing = 4e-4; material = A }\n"
            "body b { shape = rectangle 0.003 0 0.006 0.01; spacing = %s; material = A }\n"
            "body c { shape = rectangle 0.006 0 0.01 0.01; spacing = 4e-4; material = B }\n"
            "interaction { k = 4; zeta = 0.1; ct_ratio = 0.2 }\n",
            second[k]);
        const struct pair_law *aa = load(&g, text), *bb = model_law(g.model, 1, 1, RELATION_OTHER_BODY);
        const double m = 0.5 * sqrt(3.0) * 16e-8;
        CHECK_NEAR_REL(bb->cn_mass, 0.4 * sqrt(m), 1e-14);
        CHECK_NEAR_REL(bb->ct_mass, 0.8 * sqrt(m), 1e-14);
        if (k == 0)
            CHECK_NEAR_REL(aa->cn_mass, 0.4 * sqrt(0.5 * m), 1e-14);
        else
            CHECK(aa->cn_mass < 0.0 && aa->ct_mass < 0.0);
        CHECK(aa->wide == (k == 0) && bb->wide && (aa->bond.r0 > 0.0) == (k == 0));
        engine_stop(&g);
    }
}

TEST_MAIN(CASE(potentials_of_their_own), CASE(springs_of_friction), CASE(what_damping_needs),
          CASE(the_largest_cutoff), CASE(kinds_of_equal_elements))
