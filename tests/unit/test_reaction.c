/* The reaction against known results: Arrhenius' law, adiabatic temperature rise, proportions,
 * conservation, and the same bits on any number of ranks and after a restart. */
#include "thermo_help.h"

#include "engine/phase.h"
#include "engine/reaction.h"
#include "engine/tables.h"

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

/* The chemical energy that one step of a fixed mixture frees, started at `start`. */
static double freed(const char *start)
{
    const char *defines[] = {start, NULL};
    struct engine g;
    engine_start(
        &g,
        THERMO_METALS
        "let start = 600\n"
        "domain { size = 0.8, 0.8; r_c = 0.06; delta_r = 0.01 }\ntime { dt = 0.01; steps = 10 }\n"
        "reaction r { reactants = Ni Al; product = NiAl; kind = non-stoichiometric; k0 = 10; ea = 60 "
        "kJ/mol\n             heat = 1.54 kJ/g }\n"
        "body a { shape = rectangle 0, 0, 0.8, 0.8; spacing = 0.04; radius = 0.0201; mix = Ni 0.5, "
        "Al 0.5\n         motion = fixed; temperature = start }\n",
        defines, 2);
    return thermo_freed(&g);
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

/* Two touching elements with masses in the stoichiometric proportion become product wholly. */
TEST(complete_conversion_gives_the_adiabatic_temperature)
{
    struct engine g;
    engine_start(
        &g,
        THERMO_METALS
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
    struct measures m = thermo_step(&g);
    double total = engine_total(&g, &m), chemical = thermo_energy(&g, &m.chemical);
    struct engine_state s = engine_collect(&g, false);
    double mass = s.e[0].mass + s.e[1].mass, start = (s.e[0].mass * 4.4e-6 + s.e[1].mass * 8.97e-6) * 300.0;
    CHECK_EQ_INT(s.n, 2);
    CHECK_NEAR_REL(chemical, 1.54e-2 * mass, 1e-15);
    engine_state_free(&s);
    engine_run(&g, 400);
    m = thermo_step(&g);
    s = engine_collect(&g, true);
    CHECK_NEAR_REL(engine_total(&g, &m), total, 1e-13);
    CHECK_NEAR(thermo_energy(&g, &m.chemical), 0.0, 1e-13 * chemical);
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

/* --- three elements, each in contact with both others --- */

#define TRIO_DECK                                                                                            \
    THERMO_METALS                                                                                            \
    "domain { size = 0.4, 0.4; r_c = 0.06; delta_r = 0.01 }\ntime { dt = 0.01; steps = 1 }\n"                \
    "reaction r { reactants = Ni Al; product = NiAl; masses = 58.693, 26.982; k0 = 1e4; ea = 60 kJ/mol\n"    \
    "             heat = 1.54 kJ/g }\n"                                                                      \
    "body a { shape = disc 0.2, 0.2, 0.01; spacing = 0.04; origin = 0.2, 0.2; material = Ni }\n"

static const double trio_at[3][2] = {{0.18, 0.2}, {0.219, 0.2}, {0.199, 0.233}};

/* The pairs of the three, and the pair of the third with the first alone. */
static uint32_t trio_start[] = {0, 2, 3, 3}, trio_partner[] = {1, 2, 2}, last_start[] = {0, 0, 0, 1},
                last_partner[] = {0};
static uint8_t trio_linked[3];
static const struct lists trio_pairs = {.near = {.start = trio_start, .j = trio_partner},
                                        .linked = trio_linked},
                          last_pair = {.near = {.start = last_start, .j = last_partner},
                                       .linked = trio_linked};

/* Puts nickel, aluminium and nickel with these shares into *p at 900 K; out: their masses and heats. */
static void put_trio(struct particles *p, const struct model *m, const double share[3][2], double mass[3],
                     double heat[3])
{
    particles_start(p, m);
    CHECK_EQ_INT(particles_reserve(p, 3), 0);
    p->n = p->n_own = 3;
    for (size_t i = 0; i < 3; i++) {
        mass[i] = (double)(i + 1) * 0.004;
        struct element e = {.id = (uint32_t)i,
                            .kind = (uint16_t)(i < 2 ? i : 0),
                            .was = (uint16_t)(i < 2 ? i : 0),
                            .radius = 0.02,
                            .mass = mass[i],
                            .r = {trio_at[i][0], trio_at[i][1]},
                            .share = {share[i][0], share[i][1]}};
        particles_put(p, m, i, &e);
        p->heat[i] = mass[i] * particles_heat_capacity(p, m, i) * (900.0 - 300.0);
        heat[i] = p->heat[i];
        particles_warm(p, m, i, 1.0 / mass[i]);
    }
}

/* The masses of A and B that each of the three elements loses in 0.01 us by the rates of its pairs: A of i
 * with B of j. */
static void sum_trio_rates(const struct reaction_table *x, const double mass[3], const double share[3][2],
                           double want[3][2])
{
    memset(want, 0, 3 * sizeof *want);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double got[2];
            reaction_rate(x, (struct reaction_side){mass[i], share[i][0]},
                          (struct reaction_side){mass[j], share[j][1]}, 900.0, 0.04 / sqrt(3.0), 0.01, got);
            want[i][0] += i != j ? got[0] : 0.0;
            want[j][1] += i != j ? got[1] : 0.0;
        }
    }
}

/* The converted masses of an evaluation equal the rates of the pairs and, once applied, what the elements
 * lose. A mixture reacts both ways, traces react, too; below 1 % of reactants an element that reacts becomes
 * product, and one that does not react stays. */
TEST(converted_masses_are_lost_by_the_shares)
{
    static const double shares[4][3][2] = {{{1, 0}, {0, 1}, {0.5, 0.3}},
                                           {{0, 5e-4}, {5e-4, 0}, {6e-3, 5e-3}},
                                           {{0.0101, 0}, {0, 0.0099}, {0, 0}},
                                           {{5e-4, 0}, {0, 5e-4}, {0, 0}}};
    static const uint16_t kinds[4][3] = {{0, 1, 0}, {2, 2, 0}, {0, 2, 0}, {2, 2, 0}};
    struct engine g;
    engine_load(&g, TRIO_DECK, NULL, 1);
    const struct model *m = g.model;
    const struct reaction_table *x = &m->reaction;
    struct particles p;
    struct reaction_sums sums = {0}; /* each evaluation finds the sums of the one before */
    for (int k = 0; k < 4; k++) {
        const double(*share)[2] = shares[k];
        double mass[3], want[3][2], heat[3];
        put_trio(&p, m, share, mass, heat);
        sum_trio_rates(x, mass, share, want);
        CHECK_EQ_INT(reaction_evaluate(m, &p, &trio_pairs, 0.01, 1, &sums, &g.err), DM2_OK);
        CHECK_EQ_INT(reaction_apply(m, &p, &sums, 1, &g.err), DM2_OK);
        for (size_t i = 0; i < 3; i++) {
            double both = 0.0;
            for (size_t a = 0; a < 2; a++) {
                double said = (double)sums.item[REACTION_SUMS * i + a] / x->mass_scale;
                double lost = mass[i] * (share[i][a] - p.share[2 * i + a]);
                CHECK((said > 0.0) == (share[i][a] > 0.0));
                CHECK_NEAR(said, want[i][a], 1e-12 * want[i][a] + 1e-15 * mass[i]);
                CHECK_NEAR(lost, said, 1e-15 * mass[i]);
                both += said;
            }
            CHECK_NEAR(p.heat[i] - heat[i], 1.54e-2 * both,
                       1e-11 * 1.54e-2 * both + 1e-15 * heat[i] + 1.0 / m->fixed.heat);
            CHECK_EQ_INT(p.kind[i], kinds[k][i]);
            CHECK_NEAR_REL(p.temperature[i],
                           300.0 + p.heat[i] / (mass[i] * particles_heat_capacity(&p, m, i)), 1e-14);
        }
        particles_free(&p);
    }
    free(sums.item);
    engine_stop(&g);
}

/* What the third element reacts with the first is rounded to the nearest quantum. Their heat may come to
 * 2^57 quanta; an element may end at -1e-9 of a reactant, counted as none. */
TEST(sums_round_and_know_their_range)
{
    static const double share[3][2] = {{1, 0}, {0, 1}, {0.5, 0.3}};
    struct engine g;
    engine_load(&g, TRIO_DECK, NULL, 1);
    struct model m = *g.model;
    struct particles p;
    struct reaction_sums sums = {0};
    double mass[3], heat[3], got[2];
    put_trio(&p, &m, share, mass, heat);
    const struct reaction_side a = {mass[0], 1.0}, b = {mass[2], 0.3};
    reaction_rate(&m.reaction, a, b, 900.0, 0.04 / sqrt(3.0), 0.01, got);
    for (int more = 0; more < 2; more++) {
        double quanta = more ? 2.505 : 2.495;
        m.reaction.mass_scale = quanta / got[0];
        CHECK_EQ_INT(reaction_evaluate(&m, &p, &last_pair, 0.01, 7, &sums, &g.err), DM2_OK);
        CHECK_EQ_INT(sums.item[REACTION_A], 2 + more);
        m.reaction.mass_scale = quanta / got[1];
        CHECK_EQ_INT(reaction_evaluate(&m, &p, &last_pair, 0.01, 7, &sums, &g.err), DM2_OK);
        CHECK_EQ_INT(sums.item[2 * REACTION_SUMS + REACTION_B], 2 + more);
    }
    m.reaction.heat = 0.99 * 0x1p57 / (m.fixed.heat * (got[0] + got[1]));
    CHECK_EQ_INT(reaction_evaluate(&m, &p, &last_pair, 0.01, 7, &sums, &g.err), DM2_OK);
    m.reaction.heat *= 1.01 / 0.99;
    CHECK_EQ_INT(reaction_evaluate(&m, &p, &last_pair, 0.01, 7, &sums, &g.err), DM2_NUMERIC);
    CHECK_CONTAINS(g.err.text, "step 7: the heat of reaction of elements 2 and 0, near (0.199, 0.233) cm");
    for (int more = 0; more < 2; more++) {
        double over = more ? 1.01e-9 : 0.99e-9;
        m.reaction.mass_scale = 0x1p57;
        memset(sums.item, 0, 3 * REACTION_SUMS * sizeof *sums.item);
        p.share[4] = 0.5;
        sums.item[2 * REACTION_SUMS + REACTION_A] = (int64_t)((0.5 + over) * mass[2] * 0x1p57);
        CHECK_EQ_INT(reaction_apply(&m, &p, &sums, 8, &g.err), more ? DM2_NUMERIC : DM2_OK);
        CHECK(more || p.share[4] == 0.0);
    }
    CHECK_CONTAINS(g.err.text, "step 8: element 2 at (0.199, 0.233) cm");
    free(sums.item);
    particles_free(&p);
    engine_stop(&g);
}

#define MIXTURE                                                                                              \
    THERMO_METALS                                                                                            \
    "let dt = 0.004\nlet k0 = 1e4\nlet v = 0.08\nlet d = 0.04\nlet h = 24*d*sqrt(3)/2\n"                     \
    "domain { size = 1.4, h; boundary = free periodic; r_c = 0.06; delta_r = 0.01 }\ntime { dt = "           \
    "dt; steps = 600 }\n"                                                                                    \
    "phase Al liquid { transition = temperature; t_line = 933; dt_dp = 6000; latent = 0.4 kJ/g; "            \
    "rho0 = 2.6; shear = 0; yield = 0 }\n"                                                                   \
    "reaction r { reactants = Ni Al; product = NiAl; kind = non-stoichiometric; k0 = k0; ea = 60 "           \
    "kJ/mol; heat = 1.54 kJ/g }\n"                                                                           \
    "interaction { zeta = 0.1; ct_ratio = 0.05; mu = 0.2; a_p = 0.5; a_t = 1e-4 }\n"                         \
    "body a { shape = rectangle 0, 0, 0.6, h; spacing = d; mix = Ni 0.5, Al 0.5; velocity = v, 0; "          \
    "temperature = 700 }\n"                                                                                  \
    "body b { shape = rectangle 0.65, 0, 1.4, h; spacing = d; mix = Ni 0.5, Al 0.5; velocity = -v, "         \
    "0; temperature = 700; seed = 3 }\n"

/* Masses of elements stay; the part of a mass that is neither A nor B is product. */
TEST(a_mixture_conserves_and_stays_positive)
{
    const char *const defines[3][3] = {{"k0=1e4", NULL}, {"k0=1e30", "dt=0.0025", NULL}, {"k0=1e-6", NULL}};
    for (int k = 0; k < 3; k++) {
        struct engine g;
        engine_start(&g, MIXTURE, defines[k], 2);
        struct measures m = thermo_step(&g);
        double total = engine_total(&g, &m),
               scale = thermo_energy(&g, &m.kinetic) + thermo_energy(&g, &m.thermal), least = 1.0;
        struct engine_state begin = engine_collect(&g, false);
        engine_run(&g, 300);
        struct engine_state now = engine_collect(&g, false); /* the state that the next evaluation measures */
        double species = 0.0;
        for (size_t i = 0; i < now.n; i++) {
            species += now.e[i].mass * (now.e[i].share[0] + now.e[i].share[1]);
            CHECK_SAME_BITS(now.e[i].mass, begin.e[i].mass);
        }
        m = thermo_step(&g);
        CHECK_NEAR_REL(thermo_energy(&g, &m.chemical), 1.54e-2 * species, 1e-13);
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
        /* One move lies between the evaluation of the measures and the state. */
        CHECK(thermo_energy(&g, &m.chemical) >= 1.54e-2 * left * (1 - 1e-12));
        CHECK_NEAR(engine_total(&g, &m), total, 2e-4 * scale);
        CHECK(k == 2 || product > 10);
        engine_state_free(&s);
        engine_stop(&g);
    }
}

/* Nickel and aluminium react in the proportion of the deck, and their energy becomes heat. */
TEST(a_stoichiometric_mixture_takes_both_in_proportion)
{
    struct engine g;
    engine_start(
        &g,
        THERMO_METALS
        "domain { size = 0.8, 0.8; r_c = 0.06; delta_r = 0.01 }\ntime { dt = 0.01; steps = 1000 }\n"
        "reaction r { reactants = Ni Al; product = NiAl; masses = 58.693, 26.982; k0 = 1e3; ea = 60 kJ/mol\n"
        "             heat = 1.54 kJ/g }\n"
        "body a { shape = rectangle 0, 0, 0.8, 0.8; spacing = 0.04; radius = 0.0201; mix = Ni 0.5, Al 0.5\n"
        "         motion = fixed; temperature = 700 }\n",
        NULL, 3);
    struct measures m = thermo_step(&g);
    double total = engine_total(&g, &m), lost[2] = {0.0, 0.0};
    for (int n = 0; n < 20; n++)
        engine_run(&g, 20);
    m = thermo_step(&g);
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

/* An element that swells, reacts and swells again as the product. */
TEST(no_element_outgrows_the_bound)
{
    struct engine g;
    engine_load(
        &g,
        THERMO_METALS
        "domain { size = 0.8, 0.8; r_c = 0.12; delta_r = 0.01 }\ntime { dt = 0.01; steps = 10 }\n"
        "reaction r { reactants = Ni Al; product = NiAl; kind = non-stoichiometric; k0 = 10; ea = 60 kJ/mol\n"
        "             heat = 1.54 kJ/g }\n"
        "phase Al liquid { transition = temperature; t_line = 933; latent = 0.4 kJ/g; rho0 = 2.4 }\n"
        "phase Ni high { transition = pressure; p_line = 0.5; t_line = 300; rho0 = 9.1 }\n"
        "phase NiAl liquid { transition = temperature; t_line = 1911; latent = 0.9 kJ/g; rho0 = 5 }\n"
        "body a { shape = rectangle 0, 0, 0.8, 0.8; spacing = 0.04; mix = Ni 0.5, Al 0.5 }\n",
        NULL, 1);
    const struct model *m = g.model;
    double radius = phase_radius(m, 0.02, 1, 3); /* of the liquid */
    CHECK_NEAR_REL(radius, 0.02 * sqrt(2.703 / 2.4), 1e-15);
    radius = phase_radius(m, radius, 3, 2); /* of the product */
    radius = phase_radius(m, radius, 2, 5); /* of the product's liquid */
    CHECK_NEAR_REL(radius, 0.02 * sqrt(2.703 / 2.4 * 5.86 / 5), 1e-15);
    CHECK_NEAR_REL(m->radius_max, radius, 1e-15);
    CHECK_NEAR_REL(m->growth, sqrt(2.703 / 2.4 * 5.86 / 5), 1e-14);
    engine_stop(&g);
}

TEST(any_number_of_ranks_gives_the_same_bits)
{
    const int ranks[] = {1, 2, 4, 7};
    thermo_check_ranks(MIXTURE, "reacting mixture", ranks, 4);
}

/* A run stopped and restored in the middle from its records alone. */
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

#define VALID          "reactants = Ni Al; product = NiAl; masses = 1, 1; k0 = 1; ea = 1"
#define REACTION(what) THERMO_FRAME THERMO_SPECIMEN "reaction r { " what " }\n"
TEST(bad_reactions_are_refused)
{
    thermo_check_refused(
        REACTION("reactants = Ni Ti; product = NiAl; masses = 1, 1; k0 = 1; ea = 1; heat = 1"),
        "there is no material 'Ti'");
    thermo_check_refused(REACTION("reactants = Ni Al; product = NiAl; k0 = 1; ea = 1; heat = 1"),
                         "lacks 'masses'");
    thermo_check_refused(REACTION("reactants = Ni Al; product = Al; masses = 1, 1; k0 = 1; ea = 1; heat = 1"),
                         "must be three materials");
    thermo_check_refused(
        REACTION("reactants = Ni Al; product = NiAl; masses = 1, 1; k0 = -1; ea = 1; heat = 1"),
        "'k0' must be greater than 0");
    thermo_check_refused(REACTION("reactants = Ni Al; product = NiAl; masses = 1, 1; k0 = 1; heat = 1"),
                         "lacks 'ea'");
    thermo_check_refused(REACTION(VALID "; heat = 1") "reaction s { " VALID "; heat = 1 }\n",
                         "more than 1 blocks 'reaction'");
    thermo_check_refused(
        THERMO_FRAME THERMO_SPECIMEN
        "material X { rho0 = 1; c0 = 0.3; s = 1 }\n"
        "reaction r { reactants = Ni X; product = NiAl; masses = 1, 1; k0 = 1; ea = 1; heat = 1 }\n",
        "'X' lacks 'cp', which its reaction needs");
    thermo_check_refused(
        THERMO_FRAME THERMO_SPECIMEN
        "material X { rho0 = 1; c0 = 0.3; s = 1; cp = 1e-6; t0 = 290 }\n"
        "reaction r { reactants = Ni X; product = NiAl; masses = 1, 1; k0 = 1; ea = 1; heat = 1 }\n",
        "need the same");
}

TEST_MAIN(CASE(converted_masses_are_lost_by_the_shares), CASE(sums_round_and_know_their_range),
          CASE(rates_follow_arrhenius), CASE(a_mixture_reacts_as_arrhenius_says),
          CASE(no_step_takes_more_than_its_part), CASE(complete_conversion_gives_the_adiabatic_temperature),
          CASE(a_mixture_conserves_and_stays_positive),
          CASE(a_stoichiometric_mixture_takes_both_in_proportion), CASE(no_element_outgrows_the_bound),
          CASE(any_number_of_ranks_gives_the_same_bits), CASE(a_restart_goes_on_with_the_same_bits),
          CASE(bad_reactions_are_refused))
