/* The stable time step: its mode and pair, the limit of the neighbours at the start, and the limit where
 * elements have room for more than six others. The values are those of docs/physics.md, section 10, written
 * out here anew. */
#include "thermo_help.h"

#include "engine/tables.h"

#define FRAME "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\n"

/* The step at which omega^2 dt^2 + 2 gamma dt = 4. */
static double mode_step(double omega2, double gamma)
{
    return 4.0 / (sqrt(gamma * gamma + 4.0 * omega2) + gamma);
}

static void load(struct engine *g, const char *format, double x, double y)
{
    char text[1600];
    (void)snprintf(text, sizeof text, format, x, y);
    engine_load(g, text, NULL, 1);
}

/* A in one lattice: mass 0.0018 g, k = 1. */
#define LATTICE                                                                                              \
    FRAME "time { dt = 1e-9; steps = 1 }\nmaterial A { rho0 = 0.75*sqrt(3); c0 = 1; s = 1.5 }\n"             \
          "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n"                           \
          "interaction { k = 1; zeta = %.17g; ct_ratio = %.17g; kt_ratio = 0.05 }\n"

TEST(translation_is_damped_along_and_across)
{
    const double m = 0.0018, root = sqrt(m / 2.0), zeta = 0.05, ct = 0.01;
    struct engine g;
    load(&g, LATTICE, zeta, ct);
    CHECK_NEAR_REL(g.model->dt_stable, mode_step(6.1 / m, (6.0 * 2.0 * zeta + 2.0 * 2.0 * ct) * root / m),
                   1e-13);
    CHECK_STR(g.model->dt_mode, "translation");
    engine_stop(&g);
}

/* The larger of omega^2 dt^2 and 2 gamma dt names the mode; both are 2 where gamma^2 = omega^2/2. */
TEST(modes_are_named_by_their_larger_term)
{
    const double m = 0.0018, root = sqrt(m / 2.0), equal = sqrt(0.5 * 6.1 / m) * m / (12.0 * root),
                 turning = sqrt(0.5 * 1.2 / m) * m / (48.0 * root);
    for (int more = 0; more < 2; more++) {
        double by = more ? 1.004 : 0.996;
        struct engine g;
        load(&g, LATTICE, equal * by, 0.0);
        CHECK_STR(g.model->dt_mode, more ? "damping of the translation" : "translation");
        engine_stop(&g);
        load(&g, LATTICE "interaction A A { k = 1e-9; kt_ratio = 5e7 }", 0.0, 0.0);
        CHECK_STR(g.model->dt_mode, "rotation");
        engine_stop(&g);
        load(&g, LATTICE, 0.0, 20.0 * turning);
        CHECK_STR(g.model->dt_mode, "damping of the rotation");
        engine_stop(&g);
    }
}

/* Elements of two sizes: the heaviest of the deck, far below a milligram, is the partner. The law of the
 * stiffer pair limits. */
TEST(the_heaviest_partner_and_the_limiting_pair)
{
    struct engine g;
    load(&g,
         "domain { size = 0.1 0.1; r_c = 0.01; delta_r = 0.001 }\ntime { dt = 1e-9; steps = 1 }\n"
         "material A { rho0 = 1; c0 = 1; s = 1.5 }\nmaterial B { rho0 = 2; c0 = 1; s = 1.5 }\n"
         "material C { rho0 = 1; c0 = 1; s = 1.5 }\n"
         "body a { shape = rectangle 0 0 0.04 0.1; spacing = 0.004; mix = A 0.5 B 0.5 }\n"
         "body b { shape = rectangle 0.04 0 0.06 0.1; spacing = 0.005; material = B }\n"
         "body c { shape = rectangle 0.06 0 0.1 0.1; spacing = 0.004; material = C }\n"
         "interaction { k = 0.5; zeta = 0.02 }\ninteraction A B { k = 1; zeta = %g }\n"
         "interaction B B { k = %g }\n",
         0.1, 0.25);
    const double cell = 0.5 * sqrt(3.0) * 1.6e-5, m = cell, heavy = 2.0 * cell * 25.0 / 16.0,
                 root = sqrt(m * heavy / (m + heavy));
    CHECK_NEAR_REL(g.model->dt_stable, mode_step(6.0 / m, 6.0 * 0.2 * root / m), 1e-13);
    CHECK_EQ_INT(g.model->dt_kinds[0], 0);
    CHECK_EQ_INT(g.model->dt_kinds[1], 1);
    engine_stop(&g);
}

/* However small zeta is, a pair of equal elements damps by their own mass. */
TEST(small_damping_takes_the_pair_s_own_mass)
{
    const double m = 0.0018, root = sqrt(m / 2.0), zeta = 1e-5;
    struct engine g;
    load(&g,
         LATTICE "interaction A H { k = 0.1 }\ninteraction H H { k = 0.1 }\n"
                 "material H { rho0 = 100; c0 = 1; s = 1.5 }\n"
                 "body c { shape = rectangle 0.5 0 1 1; spacing = 0.04; material = H }\n",
         zeta, 0.0);
    CHECK_NEAR_REL(g.model->dt_stable, mode_step(6.1 / m, 6.0 * 2.0 * zeta * root / m), 1e-13);
    engine_stop(&g);
}

TEST(the_limit_at_the_start)
{
    struct engine g;
    load(&g, LATTICE, 0.0, 0.0);
    const char *which;
    struct measures m;
    measures_clear(&m);
    CHECK_SAME_BITS(model_stable_start(g.model, &m, &which), g.model->dt_stable); /* nothing is known */
    m.dt_share = 1e-6; /* dt = 1e-9 us, a thousandth of a microsecond */
    CHECK_NEAR_REL(model_stable_start(g.model, &m, &which), 1e-3, 1e-15);
    CHECK_STR(which, "neighbours at the start");
    for (int k = -2; k <= 2; k++) {
        m.dt_share = 1e-9 / (g.model->dt_stable * (1.0 + k * 0.6e-6));
        bool closer = k == -2;
        CHECK_NEAR_REL(model_stable_start(g.model, &m, &which),
                       g.model->dt_stable * (closer ? 1.0 - 1.2e-6 : 1.0), 1e-12);
        CHECK_STR(which, closer ? "neighbours at the start" : "translation");
    }
    m.dt_share = 1.0 - 1e-9;
    CHECK_EQ_INT(model_check_start(g.model, &m, &g.err), DM2_OK);
    static const double shares[] = {1.0, 1.01, 0.5 / 0.0124};
    for (int k = 0; k < 3; k++) {
        m.dt_share = shares[k];
        m.compression = 0.033;
        CHECK_EQ_INT(model_check_start(g.model, &m, &g.err), DM2_DECK);
    }
    CHECK_CONTAINS(g.err.text, "1e-09 us is not below the stable one, 2.48e-11 us (limit");
    CHECK_CONTAINS(g.err.text, "compressed by up to 3.3 %): choose dt below 1.2e-11 us");
    engine_stop(&g);
}

/* A disc of radius R among n discs of radius r, sin(pi/n) >= r/(R + r): the limit with neighbours at rest. */
TEST(room_for_more_than_six)
{
    static const double kt_ratio[] = {0.1, 2.0}, ct_ratio[] = {0.02, 0.2};
    for (int turns = 0; turns < 2; turns++) {
        struct engine g;
        load(&g,
             "domain { size = 4 4; r_c = 1; delta_r = 0.1 }\ntime { dt = 1e-9; steps = 1 }\n"
             "material A { rho0 = 1; c0 = 1; s = 1.5 }\nmaterial B { rho0 = 2; c0 = 1; s = 1.5 }\n"
             "material C { rho0 = 5; c0 = 1; s = 1.5 }\n"
             "body a { shape = rectangle 1 1 2 2; spacing = 0.5; mix = C 0.5 A 0.5 }\n"
             "body b { shape = rectangle 2 1 3 2; spacing = 0.3; mix = B 0.5 C 0.5; motion = fixed }\n"
             "interaction { k = 0.5; zeta = 0.3; kt_ratio = %g; ct_ratio = %g; linked = no }\n",
             kt_ratio[turns], ct_ratio[turns]);
        double k = 0.5, kt = k * kt_ratio[turns], cn = 0.6 * sqrt(k), ct = 2.0 * ct_ratio[turns] * sqrt(k),
               n = 8;
        double m = 0.5 * sqrt(3.0) * 0.25, other = sqrt(3.0) * 0.09, root = sqrt(m * other / (m + other));
        double along = mode_step(n * (0.5 * k + kt / 6.0) / m, 0.5 * n * (cn + ct / 3.0) * root / m),
               about = mode_step(4.0 * n * kt / m, 4.0 * n * ct * root / m);
        struct model_room room = model_room(g.model);
        CHECK_EQ_INT(room.count, 8); /* sin(pi/8) = 0.383 >= 0.375 */
        CHECK(room.body == 0 && room.other == 1);
        CHECK(turns == (about < along));
        CHECK_NEAR_REL(room.dt, about < along ? about : along, 1e-13);
        engine_stop(&g);
    }
}

/* The heaviest of three, be it first, and heavier by a hundredth only. */
TEST(the_heaviest_comes_first)
{
    struct engine g;
    load(&g,
         "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 1e-9; steps = 1 }\n"
         "material A { rho0 = 1.01; c0 = 1; s = 1.5 }\nmaterial B { rho0 = 1; c0 = 1; s = 1.5 }\n"
         "body a { shape = rectangle 0 0 0.3 1; spacing = 0.04; material = A }\n"
         "body b { shape = rectangle 0.3 0 0.6 1; spacing = 0.04; material = B }\n"
         "body c { shape = rectangle 0.6 0 1 1; spacing = 0.0399; material = B }\n"
         "interaction { k = 1; zeta = %g; kt_ratio = %g }\n",
         0.3, 0.0);
    const double cell = 0.5 * sqrt(3.0), m = cell * 0.0399 * 0.0399, heavy = 1.01 * cell * 0.0016,
                 root = sqrt(m * heavy / (m + heavy));
    CHECK_NEAR_REL(g.model->dt_stable, mode_step(6.0 / m, 6.0 * 0.6 * root / m), 1e-13);
    engine_stop(&g);
}

/* One disc of radius R = 0.25 between discs of radius r, in a deck with other pairs. */
static struct model_room room_of(double ratio, double kt_ratio, double *mass)
{
    struct engine g;
    load(&g,
         "let r = 0.25*%.17g\ndomain { size = 4 4; r_c = 1; delta_r = 0.1 }\ntime { dt = 1e-9; steps = 1 }\n"
         "material A { rho0 = 1; c0 = 1; s = 1.5 }\nmaterial B { rho0 = 2; c0 = 1; s = 1.5 }\n"
         "material C { rho0 = 1.01; c0 = 1; s = 1.5 }\nmaterial D { rho0 = 2.02; c0 = 1; s = 1.5 }\n"
         "body a { shape = rectangle 1 1 2 2; spacing = 0.5; mix = A 0.5 C 0.5 }\n"
         "body b { shape = disc 3 3 1.5*r; spacing = 2*r; origin = 3 3; mix = B 0.5 D 0.5; motion = fixed }\n"
         "interaction { k = 1; kt_ratio = %.17g; linked = no }\ninteraction A B { k = 1.99 }\n"
         "interaction A D { k = 1.97 }\ninteraction C B { k = 2 }\ninteraction C D { k = 1.98 }\n",
         ratio, kt_ratio);
    struct model_room room = model_room(g.model);
    *mass = 0.5 * sqrt(3.0) * 0.25;
    engine_stop(&g);
    return room;
}

TEST(room_by_the_sine)
{
    /* R/r, the count: sin(pi/8) = 0.3827, sin(pi/9) = 0.3420; as pi/q would count, 9 and 9; tiny ones. */
    static const double q[] = {0.3822, 0.3832, 0.3455, 9e-4, 1.1e-3};
    static const int count[] = {8, 7, 8, 3490, 2855};
    for (int k = 0; k < 5; k++) {
        double m, n = count[k], kt = 0.1 * 2.0;
        struct model_room room = room_of(q[k] / (1.0 - q[k]), 0.1, &m);
        CHECK_EQ_INT(room.count, count[k]);
        CHECK_NEAR_REL(room.dt, mode_step(n * (0.5 * 2.0 + kt / 6.0) / m, 0.0), 1e-12);
    }
    /* Translation and rotation within a hundredth of each other: equal where k/2 + kt/6 = 4 kt. */
    for (int k = 0; k < 2; k++) {
        double m, equal = 0.5 / (4.0 - 1.0 / 6.0), ratio = equal * (k == 0 ? 0.98 : 1.02), kt = 2.0 * ratio;
        struct model_room room = room_of(0.3822 / (1.0 - 0.3822), ratio, &m);
        CHECK_NEAR_REL(room.dt, mode_step(8.0 * (k == 0 ? 1.0 + kt / 6.0 : 4.0 * kt) / m, 0.0), 1e-12);
    }
}

/* Against a wall, half of the stiffness and damping of six neighbours, with the whole mass: this limits only
 * damping, and only where the elements of the wall's material are light. */
TEST(walls_do_not_give_way)
{
    const double m = 0.0018, root = sqrt(m);
    static const double zeta[] = {0.8, 0.05}, ct[] = {0.02, 0.6}, kt[] = {0.3, 0.2};
    for (int k = 0; k < 2; k++) {
        char text[1200];
        struct engine g;
        (void)snprintf(text, sizeof text,
                       FRAME
                       "time { dt = 1e-9; steps = 1 }\n"
                       "material A { rho0 = 0.75*sqrt(3); c0 = 1; s = 1.5 }\n"
                       "material W { mass = 1e-7 g; c0 = 1; s = 1.5 }\n"
                       "body b { shape = rectangle 0 0.1 0.5 1; spacing = 0.04; material = A }\n"
                       "body f { shape = disc 0.8 0.8 0.01; spacing = 0.04; origin = 0.8 0.8; material = W\n"
                       "         motion = fixed }\nwall w { line = 0 0.05, 1 0.05; material = W }\n"
                       "interaction { k = 1e-3; shape = 3 }\ninteraction A W { k = 1.21; zeta = %g\n"
                       "    ct_ratio = %%g; kt_ratio = %%g }\n",
                       zeta[k]);
        load(&g, text, ct[k], kt[k]);
        double along = mode_step(1.21 * (3.0 + kt[k]) / m, 2.2 * (3.0 * zeta[k] + ct[k]) * root / m),
               about = mode_step(1.21 * 12.0 * kt[k] / m, 12.0 * 2.2 * ct[k] * root / m);
        CHECK_STR(g.model->dt_mode,
                  k == 0 ? "damping against a wall" : "damping of the rotation against a wall");
        CHECK_NEAR_REL(g.model->dt_stable, k == 0 ? along : about, 1e-13);
        CHECK(g.model->dt_kinds[0] == 0 && g.model->dt_kinds[1] == 1);
        engine_stop(&g);
    }
}

TEST(the_error_names_what_to_do)
{
    static const char *const rules[] = {"k = 1", "k = 1; zeta = 0.9"};
    for (int k = 0; k < 2; k++) {
        char text[600];
        struct model *model = NULL;
        struct dm2_error err = {0};
        (void)snprintf(text, sizeof text,
                       FRAME
                       "time { dt = 1; steps = 1 }\nmaterial A { mass = 9.2256e-4 g; c0 = 1; s = 1.5 }\n"
                       "interaction { %s; shape = 3 }\n"
                       "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n",
                       rules[k]);
        struct loaded l = load_text(text, NULL, -1);
        CHECK_EQ_INT(model_build(&l.config, &model, &err), DM2_DECK);
        if (k == 0) /* dt = 2 sqrt(m/(6 k)) = 0.0248 us */
            CHECK_CONTAINS(err.text,
                           "not below the stable one, 0.0248 us (limit: translation, 'A' with 'A'): "
                           "choose dt below 0.012 us");
        else
            CHECK_CONTAINS(err.text, "(limit: damping of the translation, 'A' with 'A')");
        CHECK((strstr(err.text, ", or zeta and ct_ratio smaller") != NULL) == (k == 1));
        model_free(model);
        loaded_free(&l);
    }
}

TEST_MAIN(CASE(translation_is_damped_along_and_across), CASE(modes_are_named_by_their_larger_term),
          CASE(the_heaviest_partner_and_the_limiting_pair), CASE(small_damping_takes_the_pair_s_own_mass),
          CASE(the_limit_at_the_start), CASE(room_for_more_than_six), CASE(the_heaviest_comes_first),
          CASE(room_by_the_sine), CASE(walls_do_not_give_way), CASE(the_error_names_what_to_do))
