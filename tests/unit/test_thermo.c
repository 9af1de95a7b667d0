/* Heat and phases against known results: series solution, mixing temperature, softening, transition lines,
 * latent heat, conservation, and the same bits on any number of ranks. */
#include "thermo_help.h"

#include "engine/phase.h"
#include "engine/tables.h"

static const double pi = 3.14159265358979323846;

/* --- heat --- */

#define COPPER                                                                                               \
    "material Cu { rho0 = 8.93; c0 = 0.394; s = 1.489; cp = 3.83e-6; kappa = kappa }\n"                      \
    "let kappa = 2.74e-7\n"                                                                                  \
    "interaction { linked = yes }\n"
#define ROD(size, boundary, hot, cold)                                                                       \
    "let d = 0.04\nlet h = d*sqrt(3)/2\n"                                                                    \
    "domain { size = " size "; boundary = " boundary "; r_c = 0.045; delta_r = 0.004 }\n"                    \
    "time { dt = 0.02; steps = 2500 }\n" COPPER "body hot { shape = rectangle " hot                          \
    "; spacing = d; origin = d/4, h/2; material = Cu; temperature = 600; motion = fixed }\n"                 \
    "body cold { shape = rectangle " cold                                                                    \
    "; spacing = d; origin = d/4, h/2; material = Cu; temperature = 300; motion = fixed }\n"                 \
    "output { history_every = 1000 }\n"

/* Temperature at `at` and time t of an insulated rod of length `length` whose first half was hot. */
static double rod_series(double length, double at, double diffusivity, double t)
{
    double sum = 450.0;
    for (int k = 1; k < 200; k += 2) {
        double wave = k * pi / length;
        sum += (k % 4 == 1 ? 1.0 : -1.0) * (2.0 * 300.0 / (k * pi)) * cos(wave * at) *
               exp(-diffusivity * wave * wave * t);
    }
    return sum;
}

static void check_rod(const char *deck, int axis, double length, const char *what)
{
    struct engine g;
    const double diffusivity = 2.74e-7 / (8.93 * 3.83e-6);
    engine_start(&g, deck, NULL, 2);
    struct measures m = thermo_step(&g);
    double heat = thermo_energy(&g, &m.thermal);
    engine_run(&g, g.deck.config.steps - 2);
    m = thermo_step(&g);
    CHECK_NEAR_REL(thermo_energy(&g, &m.thermal), heat, 1e-13);
    struct engine_state s = engine_collect(&g, true);
    double worst = 0.0;
    for (size_t k = 0; k < s.n; k++) {
        /* conduction acts over half a step at first, then over whole steps */
        double t = ((double)g.deck.config.steps - 0.5) * 0.02,
               want = rod_series(length, s.e[k].r[axis], diffusivity, t);
        worst = fmax(worst, fabs(s.m[k].temperature - want));
    }
    printf("rod %s: %zu elements, largest error %.4f K of 300 K\n", what, s.n, worst);
    CHECK(worst < 0.3); /* 0.1 % */
    engine_state_free(&s);
    engine_stop(&g);
}

TEST(a_rod_follows_the_series_solution)
{
    check_rod(ROD("50*d, 8*h", "free periodic", "0, 0, 25*d, 8*h", "25*d, 0, 50*d, 8*h"), 0, 2.0,
              "along the rows");
    check_rod(ROD("8*d, 60*h", "periodic free", "0, 0, 8*d, 30*h", "0, 30*h, 8*d, 60*h"), 1,
              60.0 * 0.04 * 0.5 * sqrt(3.0), "across the rows");
}

TEST(two_bodies_reach_the_mixing_temperature)
{
    struct engine g;
    engine_start(&g,
                 "let d = 0.04\nlet kappa = 2.74e-7\n"
                 "domain { size = 0.4, 0.2; r_c = 0.045; delta_r = 0.004 }\n"
                 "time { dt = 0.02; steps = 100000 }\n"
                 "material Cu { rho0 = 8.93; c0 = 0.394; s = 1.489; cp = 3.83e-6; kappa = kappa }\n"
                 "material Al { rho0 = 2.7; c0 = 0.535; s = 1.34; cp = 8.97e-6; kappa = kappa }\n"
                 "interaction { linked = yes }\ninterface body { conductance = 0.3 }\n"
                 "body a { shape = rectangle 0, 0, 0.2, 0.2; spacing = d; material = Cu; temperature = 800; "
                 "motion = fixed }\n"
                 "body b { shape = rectangle 0.2, 0, 0.4, 0.2; spacing = d; material = Al; temperature = "
                 "300; motion = fixed }\n",
                 NULL, 3);
    struct measures m = thermo_step(&g);
    double heat = thermo_energy(&g, &m.thermal);
    struct engine_state s = engine_collect(&g, false);
    double up = 0.0, down = 0.0;
    for (size_t k = 0; k < s.n; k++) {
        double c = s.e[k].mass * (s.e[k].kind == 0 ? 3.83e-6 : 8.97e-6);
        up += c * (s.e[k].kind == 0 ? 800.0 : 300.0);
        down += c;
    }
    engine_state_free(&s);
    engine_run(&g, 20000);
    m = thermo_step(&g);
    s = engine_collect(&g, true);
    CHECK_NEAR_REL(thermo_energy(&g, &m.thermal), heat, 1e-13);
    for (size_t k = 0; k < s.n; k++)
        CHECK_NEAR(s.m[k].temperature, up / down, 1e-6);
    engine_state_free(&s);
    engine_stop(&g);
}

/* 1 - ((T - T0)/(Tm - T0))^n with T0 = 300 K and Tm = 1300 K, worked out by hand; 1 at and below T0, 0 from
 * Tm on. */
TEST(softening_with_temperature)
{
    static const double t[] = {0.0, 299.0, 300.0, 340.0, 390.0, 550.0, 940.0, 1299.0, 1300.0, 1301.0, 1e5};
    static const double n[] = {0.5, 1.0, 2.0};
    static const double want[3][11] = {
        {1.0, 1.0, 1.0, 0.8, 0.7, 0.5, 0.2, 5.001250625390898e-4, 0.0, 0.0, 0.0},
        {1.0, 1.0, 1.0, 0.96, 0.91, 0.75, 0.36, 0.001, 0.0, 0.0, 0.0},
        {1.0, 1.0, 1.0, 0.9984, 0.9919, 0.9375, 0.5904, 0.001999, 0.0, 0.0, 0.0}};
    for (int k = 0; k < 3; k++) {
        struct kind kind = {.t0 = 300.0, .tm = 1300.0, .over_range = 1e-3, .softening = n[k]};
        for (int i = 0; i < 11; i++) {
            double soft = particles_softening(&kind, t[i]);
            CHECK_NEAR(soft, want[k][i], i <= 2 || i > 7 ? 0.0 : 1e-14);
        }
        kind.tm = INFINITY; /* without a melting point */
        kind.over_range = 0.0;
        CHECK_NEAR(particles_softening(&kind, 1e5), 1.0, 0.0);
    }
}

TEST(a_step_beyond_the_thermal_limit_is_refused)
{
    thermo_check_refused("domain { size = 1, 1; r_c = 0.05; delta_r = 0.01 }\ntime { dt = 0.02; steps = 1 }\n"
                         "material Cu { rho0 = 8.93; c0 = 0.394; s = 1.489; cp = 3.83e-6; kappa = 1e-4 }\n"
                         "body a { shape = rectangle 0, 0, 0.2, 0.2; spacing = 0.04; material = Cu }\n",
                         "limit: heat conduction");
}

/* --- phases --- */

#define TIN                                                                                                  \
    "let d = 0.04\n"                                                                                         \
    "domain { size = 0.8, 0.4; r_c = 0.06; delta_r = 0.01 }\n"                                               \
    "material Sn { rho0 = 7.3; c0 = 0.26; s = 1.5; shear = 0.18; yield = 0.001; tensile = 0.005; tm = 505; " \
    "cp = 2.3e-6 }\n"

#define LINES                                                                                                \
    TIN "time { dt = 0.02; steps = 10 }\n"                                                                   \
        "phase Sn high { transition = pressure; p_line = 0.09; t_line = 300; dp_dt = -1e-4; hysteresis_p = " \
        "0.02; rho0 = 7.4 }\n"                                                                               \
        "phase Sn liquid { transition = temperature; t_line = 505; dt_dp = 3000; latent = 6e-4; shear = 0; " \
        "yield = 0; cp = 2.5e-6 }\n"                                                                         \
        "phase Sn top { from = high; reversible = no; transition = pressure; p_line = 0.4; t_line = 300 }\n" \
        "body a { shape = rectangle 0, 0, 0.2, 0.2; spacing = d; material = Sn }\n"

TEST(transitions_are_exactly_at_their_lines)
{
    struct engine g;
    engine_load(&g, LINES, NULL, 1);
    const struct model *m = g.model;
    for (double t = 300.0; t < 500.0; t += 50.0) {
        double line = 0.09 + -1e-4 * (t - 300.0);
        CHECK_EQ_INT(phase_of(m, 0, line, t), 0);
        CHECK_EQ_INT(phase_of(m, 0, nextafter(line, 1.0) + 1e-17, t), 1);
        CHECK_EQ_INT(phase_of(m, 1, line, t), 1);
        CHECK_EQ_INT(phase_of(m, 1, line - 0.02 + 1e-15, t), 1);
        CHECK_EQ_INT(phase_of(m, 1, line - 0.02 - 1e-15, t), 0);
    }
    double drop = 1.1 * 6e-4 / 2.3e-6;
    for (double p = -0.01; p < 0.03; p += 0.01) {
        double line = 505.0 + 3000.0 * p;
        CHECK_EQ_INT(phase_of(m, 0, p, line), 0);
        CHECK_EQ_INT(phase_of(m, 0, p, line + 1e-10), 2);
        CHECK_EQ_INT(phase_of(m, 2, p, line - drop + 1e-9), 2);
        CHECK_EQ_INT(phase_of(m, 2, p, line - drop - 1e-9), 0);
    }
    CHECK_EQ_INT(phase_of(m, 1, 0.41, 300.0), 3);
    CHECK_EQ_INT(phase_of(m, 3, -1.0, 300.0), 3); /* not reversible */
    CHECK_NEAR_REL(phase_radius(m, 0.02, 0, 1), 0.02 * sqrt(7.3 / 7.4), 1e-15);
    CHECK_NEAR_REL(phase_radius(m, phase_radius(m, 0.02, 0, 1), 1, 0), 0.02, 1e-15);
    struct config *c = &g.deck.config;
    CHECK_NEAR(c->phases[2].state.rho0, 7.4, 0.0);      /* of the phase that it forms from */
    CHECK_NEAR(c->phases[1].state.tensile, 0.005, 0.0); /* of the material */
    engine_stop(&g);
}

/* Heat flows from a hot body into a melting one; every transition takes m L at any temperature. */
TEST(melting_takes_the_latent_heat)
{
    struct engine g;
    const char *deck =
        TIN "time { dt = 0.01; steps = 100000 }\n"
            "material Hot { rho0 = 7.3; c0 = 0.26; s = 1.5; cp = 2.3e-6; kappa = 3e-7 }\n"
            "material Tin { rho0 = 7.3; c0 = 0.26; s = 1.5; cp = 2.3e-6; kappa = 3e-7 }\n"
            "phase Tin liquid { transition = temperature; t_line = 505; latent = 2e-4; cp = 2.5e-6 }\n"
            "interaction { linked = yes; kt_ratio = 0 }\ninterface body { linked = yes }\n"
            "body a { shape = rectangle 0, 0, 0.4, 0.4; spacing = d; material = Hot; temperature = 1200; "
            "motion = fixed }\n"
            "body b { shape = rectangle 0.4, 0, 0.8, 0.4; spacing = d; material = Tin; temperature = 450; "
            "motion = fixed }\n";
    engine_start(&g, deck, NULL, 4);
    struct measures m = thermo_step(&g);
    double total = engine_total(&g, &m);
    CHECK_NEAR(thermo_energy(&g, &m.phase), 0.0, 0.0);
    engine_run(&g, 20000);
    m = thermo_step(&g);
    CHECK_NEAR_REL(engine_total(&g, &m), total, 1e-12);
    struct engine_state s = engine_collect(&g, true);
    size_t liquid = 0;
    double up = 0.0, down = 0.0, mass = 0.0;
    for (size_t k = 0; k < s.n; k++) {
        double cp = s.e[k].kind == 3 ? 2.5e-6 : 2.3e-6;
        liquid += s.e[k].kind == 3;
        mass += s.e[k].kind == 3 ? s.e[k].mass : 0.0;
        up += s.e[k].mass * 2.3e-6 * (s.e[k].kind == 1 ? 1200.0 : 450.0);
        down += s.e[k].mass * cp;
    }
    /* sum m cp (T - 505) + latent heat is constant. */
    double want = (up - mass * 2e-4 + mass * 0.2e-6 * 505.0) / down;
    printf("melting: %zu of %zu elements are liquid; %.3f K\n", liquid, s.n, s.m[0].temperature);
    CHECK(liquid > s.n / 3 && liquid < s.n);
    CHECK_NEAR_REL(thermo_energy(&g, &m.phase), mass * (2e-4 - 0.2e-6 * 205.0), 1e-12);
    for (size_t k = 0; k < s.n; k++)
        CHECK_NEAR(s.m[k].temperature, want, 1e-3);
    engine_state_free(&s);
    engine_stop(&g);
}

#define IMPACT                                                                                               \
    "let d = 0.04\n"                                                                                         \
    "domain { size = 1.4, 0.8; r_c = 0.06; delta_r = 0.01 }\ntime { dt = dt; steps = 300 }\n"                \
    "material Ni { rho0 = 8.874; c0 = 0.4602; s = 1.437; shear = 0.855; yield = 0.0014; tensile = 0.02; tm " \
    "= 1728; cp = 4.4e-6 "                                                                                   \
    "; kappa = 9e-12 }\n"                                                                                    \
    "phase Ni high { transition = pressure; p_line = 0.06; t_line = 300; dp_dt = -1e-6; hysteresis_p = "     \
    "0.04; rho0 = 8.98 "                                                                                     \
    "; latent = 1e-5; cp = 4.6e-6 }\n"                                                                       \
    "interaction { zeta = 0.1; ct_ratio = 0.05; mu = 0.2; a_p = 0.5 }\n"                                     \
    "body a { shape = disc 0.35, 0.4, 0.28; spacing = d; material = Ni; velocity = v, 0 }\n"                 \
    "body b { shape = disc 1.0, 0.42, 0.28; spacing = d; material = Ni; velocity = -v, 0 }\n"                \
    "let dt = 0.01\nlet v = 0.06\n"

/* Energy account of an impact that forms a denser phase and undoes it; the error falls with the square
 * of the step. */
TEST(the_energy_account_of_a_transition_closes)
{
    double drift[2];
    for (int k = 0; k < 2; k++) {
        struct engine g;
        const char *const defines[2][2] = {{"dt=0.01", NULL}, {"dt=0.005", NULL}};
        engine_start(&g, IMPACT, defines[k], 1);
        struct measures m = thermo_step(&g);
        double start = engine_total(&g, &m), kinetic = thermo_energy(&g, &m.kinetic), worst = 0.0,
               moved = 0.0;
        size_t most = 0;
        for (int n = 0; n < 350 * (k + 1); n++) {
            m = thermo_step(&g);
            worst = fmax(worst, fabs(engine_total(&g, &m) - start));
            moved = fmax(moved, fabs(thermo_energy(&g, &m.phase)));
            struct engine_state s = engine_collect(&g, false);
            size_t high = 0;
            for (size_t i = 0; i < s.n; i++)
                high += s.e[i].kind == 1;
            most = high > most ? high : most;
            engine_state_free(&s);
        }
        struct engine_state s = engine_collect(&g, false);
        size_t left = 0;
        for (size_t i = 0; i < s.n; i++)
            left += s.e[i].kind == 1;
        drift[k] = worst / kinetic;
        printf("impact: up to %zu of %zu elements in the dense phase, %zu at the end; account up to %.3g, "
               "drift %.3g of the "
               "kinetic energy\n",
               most, s.n, left, moved / kinetic, drift[k]);
        CHECK(most > 20 && left < most);
        CHECK(drift[k] < 0.002);
        engine_state_free(&s);
        engine_stop(&g);
    }
    CHECK(drift[1] < 0.35 * drift[0]);
}

TEST(any_number_of_ranks_gives_the_same_bits)
{
    const int ranks[] = {1, 2, 4, 7};
    thermo_check_ranks(IMPACT, "impact with phases", ranks, 4);
}

TEST(bad_phases_are_refused)
{
    thermo_check_refused(THERMO_FRAME THERMO_SPECIMEN
                         "phase Al liquid { transition = temperature; t_line = 250 }\n",
                         "is already the phase 'liquid'");
    thermo_check_refused(THERMO_FRAME THERMO_SPECIMEN
                         "phase Al high { transition = pressure; p_line = -0.1; t_line = 300 }\n",
                         "is already the phase 'high'");
    thermo_check_refused(
        THERMO_FRAME THERMO_SPECIMEN
        "phase Al liquid { transition = temperature; t_line = 933; latent = 0.4 kJ/g; hysteresis_t = 100 }\n",
        "it would go back at once");
    thermo_check_refused(THERMO_FRAME THERMO_SPECIMEN
                         "phase Al high { from = low; transition = pressure; p_line = 0.1; t_line = 300 }\n",
                         "the material 'Al' has no phase 'low' before this one");
    thermo_check_refused(THERMO_FRAME THERMO_SPECIMEN
                         "phase Ti high { transition = pressure; p_line = 0.1; t_line = 300 }\n",
                         "there is no material 'Ti'");
    thermo_check_refused(THERMO_FRAME THERMO_SPECIMEN
                         "phase Al high { transition = pressure; t_line = 300; rho0 = -1 }\n",
                         "'rho0' must be greater");
    thermo_check_refused(THERMO_FRAME THERMO_SPECIMEN "phase Al high { t_line = 300 }\n",
                         "lacks 'transition'");
    thermo_check_refused(THERMO_FRAME THERMO_SPECIMEN
                         "phase Al a { transition = pressure; p_line = 1; t_line = 300 }\n"
                         "phase Al a { transition = pressure; p_line = 1; t_line = 300 }\n",
                         "has a phase 'a' before");
    thermo_check_refused(THERMO_FRAME THERMO_SPECIMEN
                         "material X { rho0 = 1; c0 = 0.3; s = 1 }\n"
                         "phase X liquid { transition = temperature; t_line = 933 }\n",
                         "lacks 'cp'");
    thermo_check_refused(
        THERMO_FRAME THERMO_SPECIMEN
        "interaction { scope = all }\nphase Al a { transition = pressure; p_line = 1; t_line = 300 }\n",
        "need interactions of scope linked");
}

TEST_MAIN(CASE(softening_with_temperature), CASE(a_rod_follows_the_series_solution),
          CASE(two_bodies_reach_the_mixing_temperature), CASE(a_step_beyond_the_thermal_limit_is_refused),
          CASE(transitions_are_exactly_at_their_lines), CASE(melting_takes_the_latent_heat),
          CASE(the_energy_account_of_a_transition_closes), CASE(any_number_of_ranks_gives_the_same_bits),
          CASE(bad_phases_are_refused))
