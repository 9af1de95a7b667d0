/* Heat, phases and the reaction against what is known of them: series solution, mixing temperature,
 * transition lines, adiabatic temperature rise, Arrhenius' law, conservation, and the same bits on any number
 * of ranks. */
#include "engine_help.h"

#include "dm2/base/real.h"
#include "engine/phase.h"
#include "engine/reaction.h"
#include "engine/tables.h"

static const double pi = 3.14159265358979323846;

/* kinetic etc. as doubles */
static double energy_of(const struct engine *g, const struct exact_sum *sum)
{
    return exact_value(sum, model_scales(g->model).energy);
}

/* One more step with its measures. */
static struct measures measured_step(struct engine *g)
{
    struct measures m;
    engine_step(g, &m);
    return m;
}

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

/* Insulated rod of length `length`, its first half hot: temperature at `at` and time t. */
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
    struct measures m = measured_step(&g);
    double heat = energy_of(&g, &m.thermal);
    engine_run(&g, g.deck.config.steps - 2);
    m = measured_step(&g);
    CHECK_NEAR_REL(energy_of(&g, &m.thermal), heat, 1e-13);
    struct engine_state s = engine_collect(&g, true);
    double worst = 0.0;
    for (size_t k = 0; k < s.n; k++) {
        /* conducted over half a step at first, and over whole ones since */
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
    struct measures m = measured_step(&g);
    double heat = energy_of(&g, &m.thermal);
    struct engine_state s = engine_collect(&g, false);
    double up = 0.0, down = 0.0;
    for (size_t k = 0; k < s.n; k++) {
        double c = s.e[k].mass * (s.e[k].kind == 0 ? 3.83e-6 : 8.97e-6);
        up += c * (s.e[k].kind == 0 ? 800.0 : 300.0);
        down += c;
    }
    engine_state_free(&s);
    engine_run(&g, 20000);
    m = measured_step(&g);
    s = engine_collect(&g, true);
    CHECK_NEAR_REL(energy_of(&g, &m.thermal), heat, 1e-13);
    for (size_t k = 0; k < s.n; k++)
        CHECK_NEAR(s.m[k].temperature, up / down, 1e-6);
    engine_state_free(&s);
    engine_stop(&g);
}

static void check_refused(const char *text, const char *part)
{
    struct loaded l = load_text(text, NULL, -1);
    struct model *m = NULL;
    struct dm2_error err = {0};
    enum dm2_status status = l.status == DM2_OK ? model_build(&l.config, &m, &err) : l.status;
    CHECK_EQ_INT(status, DM2_DECK);
    CHECK_CONTAINS(l.status == DM2_OK ? err.text : l.report.text, part);
    model_free(m);
    loaded_free(&l);
}

TEST(a_step_beyond_the_thermal_limit_is_refused)
{
    check_refused("domain { size = 1, 1; r_c = 0.05; delta_r = 0.01 }\ntime { dt = 0.02; steps = 1 }\n"
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
    CHECK_NEAR(c->phases[2].state.rho0, 7.4, 0.0);      /* from the phase it forms from */
    CHECK_NEAR(c->phases[1].state.tensile, 0.005, 0.0); /* from the material */
    engine_stop(&g);
}

/* Heat flows from a hot body into one that melts; every transition takes m L, at whatever temperature it
 * happens. */
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
    struct measures m = measured_step(&g);
    double total = engine_total(&g, &m);
    CHECK_NEAR(energy_of(&g, &m.phase), 0.0, 0.0);
    engine_run(&g, 20000);
    m = measured_step(&g);
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
    /* sum m cp (T - 505) + latent heat stays. */
    double want = (up - mass * 2e-4 + mass * 0.2e-6 * 505.0) / down;
    printf("melting: %zu of %zu elements are liquid; %.3f K\n", liquid, s.n, s.m[0].temperature);
    CHECK(liquid > s.n / 3 && liquid < s.n);
    CHECK_NEAR_REL(energy_of(&g, &m.phase), mass * (2e-4 - 0.2e-6 * 205.0), 1e-12);
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

/* Energy book of an impact that makes and undoes a denser phase; the error halves with the step. */
TEST(the_energy_account_of_a_transition_closes)
{
    double drift[2];
    for (int k = 0; k < 2; k++) {
        struct engine g;
        const char *const defines[2][2] = {{"dt=0.01", NULL}, {"dt=0.005", NULL}};
        engine_start(&g, IMPACT, defines[k], 1);
        struct measures m = measured_step(&g);
        double start = engine_total(&g, &m), kinetic = energy_of(&g, &m.kinetic), worst = 0.0, moved = 0.0;
        size_t most = 0;
        for (int n = 0; n < 350 * (k + 1); n++) {
            m = measured_step(&g);
            worst = fmax(worst, fabs(engine_total(&g, &m) - start));
            moved = fmax(moved, fabs(energy_of(&g, &m.phase)));
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
        CHECK(drift[k] < 0.01);
        engine_state_free(&s);
        engine_stop(&g);
    }
    CHECK(drift[1] < 0.6 * drift[0]);
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

/* --- reaction --- */

#define METALS                                                                                               \
    "material Ni { rho0 = 8.874; c0 = 0.4602; s = 1.437; shear = 0.855; yield = 0.0014; tensile = 0.02; cp " \
    "= 4.4e-6; kappa = 9e-12 }\n"                                                                            \
    "material Al { rho0 = 2.703; c0 = 0.535; s = 1.34; shear = 0.276; yield = 0.0029; tensile = 0.012; cp "  \
    "= 8.97e-6; kappa = 2e-11 }\n"                                                                           \
    "material NiAl { rho0 = 5.86; c0 = 0.519; s = 1.5; shear = 0.75; yield = 0.003; tensile = 0.01; cp = "   \
    "5.4e-6; kappa = 8e-12 }\n"
static const struct reaction_table some_table = {.any = true,
                                                 .reactant = {0, 1},
                                                 .product = 2,
                                                 .stoichiometric = true,
                                                 .share = {0.685, 0.315},
                                                 .k0 = 7.0,
                                                 .theta = 15000.0,
                                                 .limit = 0.125};

TEST(rates_follow_arrhenius)
{
    double cold[2], hot[2];
    struct reaction_side a = {0.012, 0.7}, b = {0.004, 0.4};
    reaction_rate(&some_table, a, b, 600.0, 0.023, 1e-9, cold);
    reaction_rate(&some_table, a, b, 900.0, 0.023, 1e-9, hot);
    CHECK_NEAR_REL(cold[0] + cold[1], 7.0 * exp(-15000.0 / 600.0) * 0.7 * 0.4 * 0.023 * 1e-9, 1e-13);
    CHECK_NEAR_REL(hot[0] / cold[0], exp(15000.0 / 600.0 - 15000.0 / 900.0), 1e-13);
    CHECK_NEAR_REL(cold[0] / cold[1], 0.685 / 0.315, 1e-13);
    struct reaction_table free_table = some_table;
    free_table.stoichiometric = false;
    reaction_rate(&free_table, a, b, 600.0, 0.023, 1e-9, cold);
    CHECK_NEAR_REL(cold[0] / cold[1], (0.012 * 0.7) / (0.004 * 0.4), 1e-13);
    reaction_rate(&some_table, a, b, 0.0, 0.023, 1.0, cold);
    CHECK_NEAR(cold[0] + cold[1], 0.0, 0.0);
}

/* The same through the engine: what one step of a fixed mixture frees at two temperatures. */
static double freed(const char *start)
{
    const char *defines[] = {start, NULL};
    struct engine g;
    engine_start(
        &g,
        METALS "let start = 600\n"
               "domain { size = 0.8, 0.8; r_c = 0.06; delta_r = 0.01 }\ntime { dt = 0.01; steps = 10 }\n"
               "reaction r { reactants = Ni Al; product = NiAl; kind = non-stoichiometric; k0 = 10; ea = 60 "
               "kJ/mol\n             heat = 1.54 kJ/g }\n"
               "body a { shape = rectangle 0, 0, 0.8, 0.8; spacing = 0.04; radius = 0.0201; mix = Ni 0.5, "
               "Al 0.5\n         motion = fixed; temperature = start }\n",
        defines, 2);
    struct measures m = measured_step(&g);
    double before = energy_of(&g, &m.chemical);
    m = measured_step(&g);
    double after = energy_of(&g, &m.chemical);
    engine_stop(&g);
    return before - after;
}

TEST(a_mixture_reacts_as_arrhenius_says)
{
    double cold = freed("start=600"), hot = freed("start=900"), r = 8.31446261815324;
    printf("freed in a step: %.6g at 600 K, %.6g at 900 K, ratio %.6g, Arrhenius %.6g\n", cold, hot,
           hot / cold, exp(60e3 / r * (1.0 / 600.0 - 1.0 / 900.0)));
    CHECK(cold > 0.0);
    CHECK_NEAR_REL(hot / cold, exp(60e3 / r * (1.0 / 600.0 - 1.0 / 900.0)), 1e-6);
}

TEST(no_step_takes_more_than_its_part)
{
    for (int k = -60; k <= 60; k++) {
        double got[2], dt = pow(10.0, k);
        struct reaction_side a = {0.012, 0.7}, b = {0.004, 0.4};
        for (int kind = 0; kind < 2; kind++) {
            struct reaction_table x = some_table;
            x.stoichiometric = kind == 0;
            reaction_rate(&x, a, b, 900.0, 0.023, dt, got);
            CHECK(got[0] >= 0.0 && got[0] <= 0.125 * 0.012 * 0.7 * (1 + 1e-15));
            CHECK(got[1] >= 0.0 && got[1] <= 0.125 * 0.004 * 0.4 * (1 + 1e-15));
        }
    }
}

/* Two touching elements whose masses are in the proportion that reacts: all becomes product. */
TEST(complete_conversion_gives_the_adiabatic_temperature)
{
    struct engine g;
    engine_start(
        &g,
        METALS
        "domain { size = 0.4, 0.4; r_c = 0.06; delta_r = 0.01 }\ntime { dt = 0.01; steps = 1000 }\n"
        "reaction r { reactants = Ni Al; product = NiAl; masses = 8.874, 2.703; k0 = 1e30; ea = 130 kJ/mol\n"
        "; heat = 1.54 kJ/g }\n"
        "body a { shape = disc 0.2, 0.2, 0.01; spacing = 0.04; origin = 0.2, 0.2; material = Ni; motion = "
        "fixed "
        "; temperature = 600 }\n"
        "body b { shape = disc 0.239, 0.2, 0.01; spacing = 0.04; origin = 0.239, 0.2; material = Al; motion "
        "= fixed "
        "; temperature = 600 }\n",
        NULL, 1);
    struct measures m = measured_step(&g);
    double total = engine_total(&g, &m), chemical = energy_of(&g, &m.chemical);
    struct engine_state s = engine_collect(&g, false);
    double mass = s.e[0].mass + s.e[1].mass, start = (s.e[0].mass * 4.4e-6 + s.e[1].mass * 8.97e-6) * 300.0;
    CHECK_EQ_INT(s.n, 2);
    CHECK_NEAR_REL(chemical, 1.54e-2 * mass, 1e-15);
    engine_state_free(&s);
    engine_run(&g, 400);
    m = measured_step(&g);
    s = engine_collect(&g, true);
    CHECK_NEAR_REL(engine_total(&g, &m), total, 1e-13);
    CHECK_NEAR(energy_of(&g, &m.chemical), 0.0, 1e-13 * chemical);
    double mean = 0.0;
    for (int k = 0; k < 2; k++) {
        CHECK_EQ_INT(s.e[k].kind, 2);
        CHECK(s.e[k].share[0] >= 0.0 && s.e[k].share[1] >= 0.0);
        CHECK(s.e[k].share[0] + s.e[k].share[1] < 1e-12);
        mean += s.e[k].mass * s.m[k].temperature / mass;
    }
    printf("reaction: adiabatic rise to %.3f K\n", mean);
    CHECK_NEAR(mean, 300.0 + (start + 1.54e-2 * mass) / (mass * 5.4e-6), 1e-6);
    engine_state_free(&s);
    engine_stop(&g);
}

/* What an evaluation says that it converted against what the elements lose when it is applied, and both
 * against the rates of the pairs: nickel, aluminium and a mixture, each touching both others. The mixture
 * reacts both ways. */
TEST(converted_masses_are_lost_by_the_shares)
{
    static const double at[3][2] = {{0.18, 0.2}, {0.219, 0.2}, {0.199, 0.233}},
                        begin[3][2] = {{1, 0}, {0, 1}, {0.5, 0.3}};
    static const char deck[] = METALS
        "domain { size = 0.4, 0.4; r_c = 0.06; delta_r = 0.01 }\ntime { dt = 0.01; steps = 1 }\n"
        "reaction r { reactants = Ni Al; product = NiAl; masses = 58.693, 26.982; k0 = 1e4; ea = 60 kJ/mol\n"
        "             heat = 1.54 kJ/g }\n"
        "body a { shape = disc 0.2, 0.2, 0.01; spacing = 0.04; origin = 0.2, 0.2; material = Ni }\n";
    struct engine g;
    engine_load(&g, deck, NULL, 1);
    const struct model *m = g.model;
    const struct reaction_table *x = &m->reaction;
    struct particles p;
    struct reaction_sums sums = {0};
    uint32_t start[] = {0, 2, 3, 3}, partner[] = {1, 2, 2};
    struct lists lists = {.near = {.start = start, .j = partner}};
    double mass[3], want[3][2] = {{0.0}}, heat[3], temperature = 900.0;
    particles_start(&p, m);
    CHECK_EQ_INT(particles_reserve(&p, 3), 0);
    p.n = p.n_own = 3;
    for (size_t i = 0; i < 3; i++) {
        mass[i] = (double)(i + 1) * 0.004;
        struct element e = {.id = (uint32_t)i,
                            .kind = (uint16_t)(i < 2 ? i : 0),
                            .was = (uint16_t)(i < 2 ? i : 0),
                            .radius = 0.02,
                            .mass = mass[i],
                            .r = {at[i][0], at[i][1]},
                            .share = {begin[i][0], begin[i][1]}};
        particles_put(&p, m, i, &e);
        p.heat[i] = mass[i] * particles_heat_capacity(&p, m, i) * (temperature - 300.0);
        heat[i] = p.heat[i];
        particles_warm(&p, m, i, 1.0 / mass[i]);
    }
    for (int i = 0; i < 3; i++) { /* A of i with B of j */
        for (int j = 0; j < 3; j++) {
            double got[2];
            reaction_rate(x, (struct reaction_side){mass[i], begin[i][0]},
                          (struct reaction_side){mass[j], begin[j][1]}, temperature, 0.04 / sqrt(3.0), 0.01,
                          got);
            want[i][0] += i != j ? got[0] : 0.0;
            want[j][1] += i != j ? got[1] : 0.0;
        }
    }
    CHECK_EQ_INT(reaction_evaluate(m, &p, &lists, 0.01, 1, &sums, &g.err), DM2_OK);
    CHECK_EQ_INT(reaction_apply(m, &p, &sums, 1, &g.err), DM2_OK);
    for (size_t i = 0; i < 3; i++) {
        double both = 0.0;
        for (size_t a = 0; a < 2; a++) {
            double said = (double)sums.item[REACTION_SUMS * i + a] / x->mass_scale;
            double lost = mass[i] * (begin[i][a] - p.share[2 * i + a]);
            CHECK((said > 0.0) == (begin[i][a] > 0.0));
            CHECK_NEAR(said, want[i][a], 1e-12 * mass[i]);
            CHECK_NEAR(lost, said, 1e-15 * mass[i]);
            both += said;
        }
        CHECK_NEAR_REL(p.heat[i] - heat[i], 1.54e-2 * both, 1e-11);
    }
    free(sums.item);
    particles_free(&p);
    engine_stop(&g);
}

#define MIXTURE                                                                                              \
    METALS "let dt = 0.004\nlet k0 = 1e4\nlet v = 0.08\nlet d = 0.04\nlet h = 24*d*sqrt(3)/2\n"              \
           "domain { size = 1.4, h; boundary = free periodic; r_c = 0.06; delta_r = 0.01 }\ntime { dt = "    \
           "dt; steps = 600 }\n"                                                                             \
           "phase Al liquid { transition = temperature; t_line = 933; dt_dp = 6000; latent = 0.4 kJ/g; "     \
           "rho0 = 2.6; shear = 0; yield = 0 }\n"                                                            \
           "reaction r { reactants = Ni Al; product = NiAl; kind = non-stoichiometric; k0 = k0; ea = 60 "    \
           "kJ/mol; heat = 1.54 kJ/g }\n"                                                                    \
           "interaction { zeta = 0.1; ct_ratio = 0.05; mu = 0.2; a_p = 0.5; a_t = 1e-4 }\n"                  \
           "body a { shape = rectangle 0, 0, 0.6, h; spacing = d; mix = Ni 0.5, Al 0.5; velocity = v, 0; "   \
           "temperature = 700 }\n"                                                                           \
           "body b { shape = rectangle 0.65, 0, 1.4, h; spacing = d; mix = Ni 0.5, Al 0.5; velocity = -v, "  \
           "0; temperature = 700; seed = 3 }\n"

/* Species masses: of each element its own stays; what is not A or B is product. */
TEST(a_mixture_conserves_and_stays_positive)
{
    const char *const defines[3][3] = {{"k0=1e4", NULL}, {"k0=1e30", "dt=0.0025", NULL}, {"k0=1e-6", NULL}};
    for (int k = 0; k < 3; k++) {
        struct engine g;
        engine_start(&g, MIXTURE, defines[k], 2);
        struct measures m = measured_step(&g);
        double total = engine_total(&g, &m), scale = energy_of(&g, &m.kinetic) + energy_of(&g, &m.thermal),
               least = 1.0;
        struct engine_state begin = engine_collect(&g, false);
        engine_run(&g, 300);
        struct engine_state now = engine_collect(&g, false); /* that the next evaluation measures */
        double species = 0.0;
        for (size_t i = 0; i < now.n; i++) {
            species += now.e[i].mass * (now.e[i].share[0] + now.e[i].share[1]);
            CHECK_SAME_BITS(now.e[i].mass, begin.e[i].mass);
        }
        m = measured_step(&g);
        CHECK_NEAR_REL(energy_of(&g, &m.chemical), 1.54e-2 * species, 1e-13);
        engine_state_free(&begin);
        engine_state_free(&now);
        struct engine_state s = engine_collect(&g, true);
        size_t product = 0, liquid = 0;
        double left = 0.0;
        for (size_t i = 0; i < s.n; i++) {
            least = fmin(least, fmin(s.e[i].share[0], s.e[i].share[1]));
            CHECK(s.e[i].share[0] + s.e[i].share[1] <= 1.0);
            product += s.e[i].kind == 2;
            liquid += s.e[i].kind == 3;
            left += s.e[i].mass * (s.e[i].share[0] + s.e[i].share[1]);
        }
        printf("mixture: %zu of %zu elements are product, %zu liquid; total off by %.2g of kinetic and "
               "thermal\n",
               product, s.n, liquid, (engine_total(&g, &m) - total) / scale);
        CHECK(least >= 0.0);
        /* One move lies between the evaluation that the measures are of and the state. */
        CHECK(energy_of(&g, &m.chemical) >= 1.54e-2 * left * (1 - 1e-12));
        CHECK_NEAR(engine_total(&g, &m), total, 0.001 * scale);
        CHECK(k == 2 || product > 10);
        engine_state_free(&s);
        engine_stop(&g);
    }
}

/* Nickel and aluminium go in the proportion of the deck, and the energy they give is in the heat. */
TEST(a_stoichiometric_mixture_takes_both_in_proportion)
{
    struct engine g;
    engine_start(
        &g,
        METALS
        "domain { size = 0.8, 0.8; r_c = 0.06; delta_r = 0.01 }\ntime { dt = 0.01; steps = 1000 }\n"
        "reaction r { reactants = Ni Al; product = NiAl; masses = 58.693, 26.982; k0 = 1e3; ea = 60 kJ/mol\n"
        "             heat = 1.54 kJ/g }\n"
        "body a { shape = rectangle 0, 0, 0.8, 0.8; spacing = 0.04; radius = 0.0201; mix = Ni 0.5, Al 0.5\n"
        "         motion = fixed; temperature = 700 }\n",
        NULL, 3);
    struct measures m = measured_step(&g);
    double total = engine_total(&g, &m), lost[2] = {0.0, 0.0};
    for (int n = 0; n < 20; n++)
        engine_run(&g, 20);
    m = measured_step(&g);
    struct engine_state s = engine_collect(&g, false);
    for (size_t i = 0; i < s.n; i++) {
        double pure = s.e[i].mass > 0.01 ? 0 : 1; /* 0.0123 g of nickel, 0.0037 g of aluminium */
        lost[(int)pure] += s.e[i].mass * (1.0 - s.e[i].share[(int)pure]);
        CHECK_NEAR(s.e[i].share[1 - (int)pure], 0.0, 0.0);
    }
    printf("stoichiometry: %.6g g of nickel and %.6g g of aluminium reacted\n", lost[0], lost[1]);
    CHECK(lost[0] > 0.1);
    CHECK_NEAR_REL(lost[0] / 58.693, lost[1] / 26.982, 1e-13);
    CHECK_NEAR_REL(engine_total(&g, &m), total, 1e-13);
    engine_state_free(&s);
    engine_stop(&g);
}

static void check_ranks(const char *deck, const char *what, const int *ranks, size_t n_ranks)
{
    struct engine_state want = {0};
    for (size_t k = 0; k < n_ranks; k++) {
        struct engine g;
        struct measures m;
        engine_start(&g, deck, NULL, ranks[k]);
        engine_run(&g, 250);
        engine_step(&g, &m);
        CHECK(8 * subdomain_update_width(g.model) <= 88); /* the paper's g */
        struct engine_state s = engine_collect(&g, false);
        if (k == 0) {
            size_t changed = 0;
            for (size_t i = 0; i < s.n; i++)
                changed += s.e[i].moved < 0.0 || s.e[i].moved > 0.0;
            CHECK(changed > 10);
            want = s;
        } else {
            engine_check_same(&s, &want, what);
            engine_state_free(&s);
        }
        engine_stop(&g);
    }
    engine_state_free(&want);
}

/* One that swells, reacts and swells again as the product. */
TEST(no_element_outgrows_the_bound)
{
    struct engine g;
    engine_load(
        &g,
        METALS
        "domain { size = 0.8, 0.8; r_c = 0.12; delta_r = 0.01 }\ntime { dt = 0.01; steps = 10 }\n"
        "reaction r { reactants = Ni Al; product = NiAl; kind = non-stoichiometric; k0 = 10; ea = 60 kJ/mol\n"
        "             heat = 1.54 kJ/g }\n"
        "phase Al liquid { transition = temperature; t_line = 933; latent = 0.4 kJ/g; rho0 = 2.4 }\n"
        "phase Ni high { transition = pressure; p_line = 0.5; t_line = 300; rho0 = 9.1 }\n"
        "phase NiAl liquid { transition = temperature; t_line = 1911; latent = 0.9 kJ/g; rho0 = 5 }\n"
        "body a { shape = rectangle 0, 0, 0.8, 0.8; spacing = 0.04; mix = Ni 0.5, Al 0.5 }\n",
        NULL, 1);
    const struct model *m = g.model;
    double radius = phase_radius(m, 0.02, 1, 3); /* the liquid's */
    CHECK_NEAR_REL(radius, 0.02 * sqrt(2.703 / 2.4), 1e-15);
    radius = phase_radius(m, radius, 3, 2); /* the product's */
    radius = phase_radius(m, radius, 2, 5); /* and that of its liquid */
    CHECK_NEAR_REL(radius, 0.02 * sqrt(2.703 / 2.4 * 5.86 / 5), 1e-15);
    CHECK_NEAR_REL(m->radius_max, radius, 1e-15);
    CHECK_NEAR_REL(m->growth, sqrt(2.703 / 2.4 * 5.86 / 5), 1e-14);
    engine_stop(&g);
}

TEST(any_number_of_ranks_gives_the_same_bits)
{
    const int ranks[] = {1, 2, 4, 7};
    check_ranks(IMPACT, "impact with phases", ranks, 4);
    check_ranks(MIXTURE, "reacting mixture", ranks, 4);
}

/* Stopped and restored in the middle, from the records alone. */
TEST(a_restart_goes_on_with_the_same_bits)
{
    struct engine g, h;
    engine_start(&g, MIXTURE, NULL, 2);
    engine_run(&g, 200);
    struct engine_state middle = engine_collect(&g, false);
    engine_run(&g, 40);
    struct engine_state want = engine_collect(&g, false);
    engine_load(&h, MIXTURE, NULL, 4);
    engine_restore(&h, 200, &middle);
    engine_run(&h, 40);
    struct engine_state got = engine_collect(&h, false);
    engine_check_same(&got, &want, "restarted");
    engine_state_free(&middle);
    engine_state_free(&want);
    engine_state_free(&got);
    engine_stop(&g);
    engine_stop(&h);
}

/* --- decks that make no sense --- */

#define FRAME    METALS "domain { size = 1, 1; r_c = 0.06; delta_r = 0.01 }\ntime { dt = 0.01; steps = 1 }\n"
#define SPECIMEN "body a { shape = rectangle 0, 0, 0.2, 0.2; spacing = 0.04; material = Al }\n"

TEST(bad_chemistry_is_refused)
{
    check_refused(FRAME SPECIMEN "phase Al liquid { transition = temperature; t_line = 250 }\n",
                  "is already the phase 'liquid'");
    check_refused(FRAME SPECIMEN "phase Al high { transition = pressure; p_line = -0.1; t_line = 300 }\n",
                  "is already the phase 'high'");
    check_refused(
        FRAME SPECIMEN
        "phase Al liquid { transition = temperature; t_line = 933; latent = 0.4 kJ/g; hysteresis_t = 100 }\n",
        "it would go back at once");
    check_refused(FRAME SPECIMEN
                  "phase Al high { from = low; transition = pressure; p_line = 0.1; t_line = 300 }\n",
                  "the material 'Al' has no phase 'low' before this one");
    check_refused(FRAME SPECIMEN "phase Ti high { transition = pressure; p_line = 0.1; t_line = 300 }\n",
                  "there is no material 'Ti'");
    check_refused(FRAME SPECIMEN "phase Al high { transition = pressure; t_line = 300; rho0 = -1 }\n",
                  "'rho0' must be greater");
    check_refused(FRAME SPECIMEN "phase Al high { t_line = 300 }\n", "lacks 'transition'");
    check_refused(FRAME SPECIMEN "phase Al a { transition = pressure; p_line = 1; t_line = 300 }\n"
                                 "phase Al a { transition = pressure; p_line = 1; t_line = 300 }\n",
                  "has a phase 'a' before");
    check_refused(FRAME SPECIMEN "material X { rho0 = 1; c0 = 0.3; s = 1 }\n"
                                 "phase X liquid { transition = temperature; t_line = 933 }\n",
                  "lacks 'cp'");
    check_refused(
        FRAME SPECIMEN
        "interaction { scope = all }\nphase Al a { transition = pressure; p_line = 1; t_line = 300 }\n",
        "need interactions of scope linked");
#define REACTION(what) FRAME SPECIMEN "reaction r { " what " }\n"
    check_refused(REACTION("reactants = Ni Ti; product = NiAl; masses = 1, 1; k0 = 1; ea = 1; heat = 1"),
                  "there is no material 'Ti'");
    check_refused(REACTION("reactants = Ni Al; product = NiAl; k0 = 1; ea = 1; heat = 1"), "lacks 'masses'");
    check_refused(REACTION("reactants = Ni Al; product = Al; masses = 1, 1; k0 = 1; ea = 1; heat = 1"),
                  "must be three materials");
    check_refused(REACTION("reactants = Ni Al; product = NiAl; masses = 1, 1; k0 = -1; ea = 1; heat = 1"),
                  "'k0' must be greater than 0");
    check_refused(REACTION("reactants = Ni Al; product = NiAl; masses = 1, 1; k0 = 1; heat = 1"),
                  "lacks 'ea'");
    check_refused(
        REACTION(
            "reactants = Ni Al; product = NiAl; masses = 1, 1; k0 = 1; ea = 1; heat = 1") "reaction s { "
                                                                                          "reactants = Ni "
                                                                                          "Al; product = "
                                                                                          "NiAl; masses = 1, "
                                                                                          "1; k0 = 1; ea = "
                                                                                          "1; heat = 1 }\n",
        "more than 1 blocks 'reaction'");
    check_refused(
        FRAME SPECIMEN
        "material X { rho0 = 1; c0 = 0.3; s = 1 }\n"
        "reaction r { reactants = Ni X; product = NiAl; masses = 1, 1; k0 = 1; ea = 1; heat = 1 }\n",
        "'X' lacks 'cp', which its reaction needs");
    check_refused(
        FRAME SPECIMEN
        "material X { rho0 = 1; c0 = 0.3; s = 1; cp = 1e-6; t0 = 290 }\n"
        "reaction r { reactants = Ni X; product = NiAl; masses = 1, 1; k0 = 1; ea = 1; heat = 1 }\n",
        "need the same");
}

TEST_MAIN(CASE(softening_with_temperature), CASE(converted_masses_are_lost_by_the_shares),
          CASE(a_rod_follows_the_series_solution), CASE(two_bodies_reach_the_mixing_temperature),
          CASE(a_step_beyond_the_thermal_limit_is_refused), CASE(transitions_are_exactly_at_their_lines),
          CASE(melting_takes_the_latent_heat), CASE(the_energy_account_of_a_transition_closes),
          CASE(rates_follow_arrhenius), CASE(a_mixture_reacts_as_arrhenius_says),
          CASE(no_step_takes_more_than_its_part), CASE(complete_conversion_gives_the_adiabatic_temperature),
          CASE(a_mixture_conserves_and_stays_positive),
          CASE(a_stoichiometric_mixture_takes_both_in_proportion), CASE(no_element_outgrows_the_bound),
          CASE(any_number_of_ranks_gives_the_same_bits), CASE(a_restart_goes_on_with_the_same_bits),
          CASE(bad_chemistry_is_refused))
