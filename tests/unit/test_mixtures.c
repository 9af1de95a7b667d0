/* Elements that are mixtures or change their phase: heat capacity, spin, who becomes product; the range of
 * the reaction and the part of the reactants that a contact takes. */
#include "thermo_help.h"

#include "engine/kinds.h"
#include "engine/particles.h"
#include "engine/phase.h"
#include "engine/reaction.h"
#include "engine/tables.h"

#define REACTION                                                                                             \
    "reaction r { reactants = Ni Al; product = NiAl; masses = 8.874, 2.703; k0 = 1e4; ea = 60 kJ/mol\n"      \
    "             heat = 1.54 kJ/g }\n"

TEST(a_mixture_has_the_heat_capacity_of_its_parts)
{
    static const char deck[] = THERMO_FRAME REACTION
        "material W { rho0 = 19; c0 = 0.4; s = 1.2; cp = 1.3e-6 }\n"
        "phase Al liquid { transition = temperature; t_line = 933; cp = 1.18e-5 }\n" THERMO_SPECIMEN;
    enum { NI, AL, NIAL, W, AL_LIQUID };
    static const struct {
        int kind;
        double share[2], cp;
    } given[] = {{NI, {1, 0}, 4.4e-6},
                 {AL, {0, 1}, 8.97e-6},
                 {NIAL, {0, 0}, 5.4e-6},
                 {NI, {0.5, 0.2}, 0.5 * 4.4e-6 + 0.2 * 8.97e-6 + 0.3 * 5.4e-6},
                 {AL, {0.1, 0.8}, 0.1 * 4.4e-6 + 0.8 * 8.97e-6 + 0.1 * 5.4e-6},
                 {NIAL, {0.004, 0.005}, 0.004 * 4.4e-6 + 0.005 * 8.97e-6 + 0.991 * 5.4e-6},
                 {AL_LIQUID, {0.1, 0.6}, 0.1 * 4.4e-6 + 0.6 * 1.18e-5 + 0.3 * 5.4e-6},
                 {W, {0, 0}, 1.3e-6}};
    struct engine g;
    struct particles p;
    engine_load(&g, deck, NULL, 1);
    particles_start(&p, g.model);
    CHECK_EQ_INT(particles_reserve(&p, 1), 0);
    p.n = p.n_own = 1;
    for (size_t k = 0; k < sizeof given / sizeof given[0]; k++) {
        struct element e = {.kind = (uint16_t)given[k].kind,
                            .was = (uint16_t)given[k].kind,
                            .radius = 0.02,
                            .mass = 0.004,
                            .heat = 0.004 * given[k].cp * 250.0,
                            .share = {given[k].share[0], given[k].share[1]}};
        particles_put(&p, g.model, 0, &e);
        CHECK_NEAR_REL(particles_heat_capacity(&p, g.model, 0), given[k].cp, 1e-14);
        CHECK_NEAR_REL(p.temperature[0], 550.0, 1e-14);
    }
    particles_free(&p);
    engine_stop(&g);
}

/* A disc that may touch many loses a smaller part to each. */
TEST(parts_of_reactants_follow_from_the_radii)
{
    for (int large = 0; large < 2; large++) {
        char text[1600];
        struct engine g;
        (void)snprintf(
            text, sizeof text,
            THERMO_METALS
            "domain { size = 1, 1; r_c = 0.2; delta_r = 0.01 }\ntime { dt = 0.001; steps = 1 }\n" REACTION
                THERMO_SPECIMEN "body c { shape = rectangle 0.5 0 1 1; spacing = %s; material = Ni }\n",
            large ? "0.0601" : "0.0599");
        engine_load(&g, text, NULL, 1);
        CHECK_NEAR(g.model->reaction.limit, large ? 1.0 / 64.0 : 1.0 / 8.0, 0.0);
        engine_stop(&g);
    }
}

/* Puts one element of 0.004 g with these shares into *p, at 550 K and with the spin 3/us. */
static void put_one(struct particles *p, const struct model *m, int kind, double share_a, double share_b)
{
    struct element e = {.kind = (uint16_t)kind,
                        .was = (uint16_t)kind,
                        .radius = 0.02,
                        .mass = 0.004,
                        .w = 3.0,
                        .share = {share_a, share_b}};
    particles_start(p, m);
    CHECK_EQ_INT(particles_reserve(p, 1), 0);
    p->n = p->n_own = 1;
    particles_put(p, m, 0, &e);
    p->heat[0] = 0.004 * particles_heat_capacity(p, m, 0) * 250.0;
    particles_warm(p, m, 0, 1.0 / 0.004);
}

/* A change of phase keeps mass, angular momentum and the sum of heat and energy of the phase; what the spin
 * loses is the account's. */
TEST(a_change_of_phase_keeps_the_angular_momentum)
{
    struct engine g;
    struct particles p;
    engine_load(&g,
                THERMO_FRAME
                "phase Al dense { transition = pressure; p_line = 1; t_line = 300; rho0 = 4.2234375\n"
                "hysteresis_p = 1; latent = 1e-3; shear = 0; c0 = 0.6 }\n" THERMO_SPECIMEN,
                NULL, 1);
    put_one(&p, g.model, 1, 0.0, 0.0);
    double heat = p.heat[0];
    phase_become(g.model, &p, 0, 3); /* 0.8 of the radius */
    CHECK_NEAR_REL(p.radius[0], 0.016, 1e-14);
    CHECK_NEAR_REL(p.w[0], 3.0 / 0.64, 1e-14);
    CHECK_NEAR_REL(p.moved[0], 0.25 * 0.004 * (0.0004 * 9.0 - 0.000256 * 9.0 / 0.4096), 1e-13);
    CHECK_NEAR_REL(p.heat[0], heat - 0.004 * 1e-3, 1e-14);
    CHECK_NEAR_REL(p.temperature[0], 550.0 - 1e-3 / 8.97e-6, 1e-13);
    phase_become(g.model, &p, 0, 1);
    CHECK_NEAR_REL(p.radius[0], 0.02, 1e-14);
    CHECK_NEAR_REL(p.w[0], 3.0, 1e-14);
    CHECK_NEAR(p.moved[0], 0.0, 1e-20);
    CHECK_NEAR_REL(p.temperature[0], 550.0, 1e-13);
    particles_free(&p);
    engine_stop(&g);
}

/* An element becomes product where the sum of both shares is below the threshold, 0.01. */
TEST(what_is_left_decides_who_is_product)
{
    static const struct {
        double share[2];
        bool product;
    } given[] = {{{0.1, 0.6}, false}, {{0.6, 0.1}, false},      {{0.0051, 0.0051}, false},
                 {{0, 0.011}, false}, {{0.0049, 0.0049}, true}, {{0.0099, 0}, true}};
    struct engine g;
    engine_load(&g, THERMO_FRAME REACTION THERMO_SPECIMEN, NULL, 1);
    CHECK_NEAR(g.model->reaction.limit, 0.125, 0.0);
    CHECK_NEAR_REL(g.model->reaction.share[0], 8.874 / 11.577, 1e-14);
    CHECK_NEAR_REL(g.model->reaction.share[1], 2.703 / 11.577, 1e-14);
    for (int m = 0; m < 3; m++)
        for (size_t kind = 0; kind < 3; kind++)
            CHECK(kind_may_become(g.model, m, kind) == (kind == (size_t)m || kind == 2));
    for (size_t k = 0; k < sizeof given / sizeof given[0]; k++) {
        struct particles p;
        int64_t item[REACTION_SUMS] = {0};
        struct reaction_sums sums = {.item = item};
        put_one(&p, g.model, 0, given[k].share[0], given[k].share[1]);
        item[REACTION_HEAT] = 1; /* something has reacted */
        CHECK_EQ_INT(reaction_apply(g.model, &p, &sums, 1, &g.err), DM2_OK);
        CHECK_EQ_INT(p.kind[0], given[k].product ? 2 : 0);
        particles_free(&p);
    }
    engine_stop(&g);
}

/* What two elements that are not linked convert in two steps at this distance, in contact distances. */
static double converted(double distance)
{
    char place[48];
    const char *const defines[] = {place, NULL};
    struct engine g;
    (void)snprintf(place, sizeof place, "x=0.2 + 0.04*%.17g", distance);
    engine_start(&g,
                 THERMO_METALS
                 "let x = 0\ndomain { size = 0.4, 0.4; r_c = 0.06; delta_r = 0.01 }\n"
                 "time { dt = 0.01; steps = 2 }\n" REACTION
                 "body a { shape = disc 0.2, 0.2, 0.01; spacing = 0.04; origin = 0.2, 0.2; material = Ni\n"
                 "         motion = fixed; temperature = 900 }\n"
                 "body b { shape = disc x, 0.2, 0.01; spacing = 0.04; origin = x, 0.2; material = Al\n"
                 "         motion = fixed; temperature = 900 }\n",
                 defines, 1);
    return thermo_freed(&g);
}

TEST(elements_react_where_they_touch)
{
    CHECK(converted(0.9) > 0.0);
    CHECK(converted(0.9999) > 0.0);
    CHECK_NEAR(converted(1.0001), 0.0, 0.0);
    CHECK_NEAR(converted(1.01), 0.0, 0.0);
    CHECK_NEAR(converted(1.04), 0.0, 0.0);
}

TEST_MAIN(CASE(a_mixture_has_the_heat_capacity_of_its_parts), CASE(parts_of_reactants_follow_from_the_radii),
          CASE(a_change_of_phase_keeps_the_angular_momentum), CASE(what_is_left_decides_who_is_product),
          CASE(elements_react_where_they_touch))
