/* The stable time step that holds now: in a lattice it is the limit of the deck; a light disc among many
 * heavy elements, compressed bonds and viscosity without stiffness lower it; driven elements do not count;
 * any number of ranks gives the same bits. */
#include "engine_help.h"

#include "engine/tables.h"

static const char sheet[] =
    "let zeta = 0; let ct = 0; let kt = 0; let dt = 0.1\n"
    "domain { size = 30 30; r_c = 1.6; delta_r = 0.3 }\n"
    "time { dt = dt; steps = 20 }\n"
    "material A { mass = 1 }\n"
    "interaction { potential = morse; k = 1; shape = 6; zeta = zeta; ct_ratio = ct; kt_ratio = kt; "
    "link_break = 1.3 }\n"
    "body sheet { shape = rectangle 5 5 20 20; spacing = 1; material = A }\n";

static const char light[] =
    "let dt = 0.02; let v = 0\n"
    "domain { size = 2 cm, 2 cm; r_c = 0.65 cm; delta_r = 0.01 cm }\n"
    "time { dt = dt; steps = 150 }\n"
    "material L { rho0 = 0.002 g/cm3 }\n"
    "material H { rho0 = 20 g/cm3 }\n"
    "interaction { potential = quadratic; k = 0.1; linked = yes }\n"
    "interface body { linked = yes }\n"
    "body light { shape = disc 1 cm, 1 cm, 0.1 cm; spacing = 0.6 cm; origin = 1 cm, 1 cm; material = L }\n"
    "body crystal { shape = rectangle 0.5 cm, 0.5 cm, 1.5 cm, 1.5 cm; spacing = 0.03; origin = 1 cm, 1 cm; "
    "material = H }\n"
    "void hole { shape = disc 1 cm, 1 cm, 0.313 cm; body = crystal }\n";

static const char rod[] =
    "domain { size = 0.2 0.2; r_c = 0.011; delta_r = 0.001 }\n"
    "time { dt = 5e-2; steps = 20 }\n"
    "material Cu { rho0 = 8.93 g/cm3; c0 = 3.94 km/s; s = 1.489; cp = 385 J/kg/K; kappa = 401 W/m/K }\n"
    "body rod { shape = rectangle 0.05 0.05 0.15 0.15; spacing = 0.01; material = Cu; motion = fixed }\n";

/* The measures of step 0. */
static struct measures start(struct engine *g)
{
    struct measures m;
    engine_must(g, engine_forces(g, true));
    engine_must(g, engine_move(g, &m));
    return m;
}

static void check_sheet(const char *zeta, const char *ct, const char *kt)
{
    struct engine g;
    const char *const defines[] = {zeta, ct, kt, NULL};
    const char *which;
    engine_start(&g, sheet, defines, 1);
    struct measures m = start(&g);
    double want = g.deck.config.dt / model_stable_dt(g.model, &which), stable;
    CHECK_REPORT(fabs(m.dt_share / want - 1) < 1e-9, "%s %s %s: dt is %.12g of the limit, expected %.12g",
                 zeta, ct, kt, m.dt_share, want);
    stable = model_stable_start(g.model, &m, &which);
    CHECK_SAME_BITS(stable, g.model->dt_stable); /* to the last digit */
    CHECK_NEAR(m.compression, 0, 1e-12);
    engine_stop(&g);
}

TEST(lattice_has_the_limit_of_the_deck)
{
    check_sheet("zeta=0", "ct=0", "kt=0");
    check_sheet("zeta=0.3", "ct=0", "kt=0");
    check_sheet("zeta=0.1", "ct=0.1", "kt=0.3");
    check_sheet("zeta=0", "ct=0.2", "kt=0"); /* damping alone limits the rotation */
}

/* Driven elements conduct. */
TEST(conduction_in_a_lattice)
{
    struct engine g;
    const char *which;
    engine_start(&g, rod, NULL, 1);
    struct measures m = start(&g);
    CHECK_NEAR_REL(m.dt_share, g.deck.config.dt / model_stable_dt(g.model, &which), 1e-6);
    CHECK_STR(which, "heat conduction");
    CHECK_NEAR(m.compression, 0, 0);
    engine_stop(&g);
}

/* A Morse bond stiffens as 2 E^2 - E. */
TEST(compression_lowers_the_limit)
{
    struct engine g, pressed;
    engine_start(&g, sheet, NULL, 1);
    struct engine_state s = engine_collect(&g, false);
    double one = start(&g).dt_share, e = exp(6 * 0.1);
    for (size_t i = 0; i < s.n; i++)
        for (int a = 0; a < 2; a++)
            s.e[i].r[a] = 10 + 0.9 * (s.e[i].r[a] - 10);
    engine_load(&pressed, sheet, NULL, 1);
    engine_restore(&pressed, 0, &s);
    struct measures m = start(&pressed);
    CHECK_NEAR_REL(m.dt_share, one * sqrt(2 * e * e - e), 1e-9);
    CHECK_NEAR(m.compression, 0.1, 1e-12);
    engine_state_free(&s);
    engine_stop(&g);
    engine_stop(&pressed);
}

/* 36 links around the disc: Q = 36/2 k (1 + sqrt(m/m_heavy)); the six of the deck's formula gave 0.0645 us.
 */
TEST(light_disc_among_heavy_elements)
{
    double share[3];
    for (int ranks = 1; ranks <= 3; ranks++) {
        struct engine g;
        const char *which;
        engine_start(&g, light, NULL, ranks);
        struct measures m = start(&g);
        double mass = 0.002 * sqrt(0.75) * 0.36, heavy = 20 * sqrt(0.75) * 0.0009;
        CHECK_NEAR_REL(model_stable_start(g.model, &m, &which),
                       2 / sqrt(0.5 * 36 * 0.1 * (1 + sqrt(mass / heavy)) / mass), 2e-3);
        CHECK_STR(which, "neighbours at the start");
        CHECK_EQ_INT(model_check_start(g.model, &m, &g.err), DM2_OK);
        share[ranks - 1] = m.dt_share;
        struct model_room room = model_room(g.model);
        CHECK_EQ_INT(room.count, 65);
        CHECK_EQ_INT(room.body, 0);
        CHECK_NEAR_REL(room.dt, 2 / sqrt(0.5 * 65 * 0.1 / mass), 1e-12);
        engine_stop(&g);
    }
    CHECK_SAME_BITS(share[0], share[1]);
    CHECK_SAME_BITS(share[0], share[2]);
}

TEST(unstable_start_is_refused)
{
    struct engine g;
    const char *const defines[] = {"dt=0.0355", NULL};
    engine_start(&g, light, defines, 1);
    struct measures m = start(&g);
    CHECK_EQ_INT(model_check_start(g.model, &m, &g.err), DM2_DECK);
    CHECK_CONTAINS(g.err.text, "the time step dt = 0.0355 us is not below the stable one, 0.0339809 us");
    engine_stop(&g);
}

TEST_MAIN(CASE(lattice_has_the_limit_of_the_deck), CASE(conduction_in_a_lattice),
          CASE(compression_lowers_the_limit), CASE(light_disc_among_heavy_elements),
          CASE(unstable_start_is_refused))
