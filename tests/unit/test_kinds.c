/* Kinds of elements: sizes, phases that form from phases, hysteresis, the product of a reaction, and the
 * energy that a change of kind moves in a pair that only stood near. */
#include "thermo_help.h"

#include "engine/kinds.h"
#include "engine/phase.h"
#include "engine/reaction.h"
#include "engine/tables.h"

#define FRAME "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 1e-6; steps = 9 }\n"

/* A reactant grows in a phase of its own, and then shrinks in a phase of the product. */
TEST(growth_goes_on_in_the_product)
{
    struct engine g;
    engine_load(&g,
                FRAME
                "material A { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"
                "material B { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"
                "material C { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"
                "phase A dense { transition = pressure; p_line = 1; t_line = 300; rho0 = 4/0.81 }\n"
                "phase C wide { transition = pressure; p_line = 1; t_line = 300; rho0 = 4/1.21 }\n"
                "reaction r { reactants = A B; product = C; masses = 1 3; k0 = 1; ea = 2 kJ/mol; heat = 1e-3 "
                "}\nbody b { shape = rectangle 0 0 0.5 1; spacing = 0.04; mix = A 0.5 B 0.5 }\n",
                NULL, 1);
    CHECK_NEAR_REL(g.model->growth, 1.1 / 0.9, 1e-14);
    CHECK_NEAR_REL(g.model->radius_max, 0.022, 1e-14);
    const struct reaction_table *x = &g.model->reaction;
    CHECK(g.model->has_kinds && x->stoichiometric);
    CHECK_SAME_BITS(x->share[0], 0.25);
    CHECK_SAME_BITS(x->share[1], 0.75);
    CHECK_NEAR_REL(x->theta, 2000.0 / 8.31446261815324, 1e-12);
    for (size_t kind = 0; kind < 5; kind++) /* A, B, C, dense A, wide C */
        for (int of = 0; of < 3; of++)
            CHECK_EQ_INT(kind_may_become(g.model, of, kind),
                         kind == 2 || kind == 4 || (int)kind == of || (kind == 3 && of == 0));
    engine_stop(&g);
    engine_load(&g,
                FRAME "material A { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"
                      "material B { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"
                      "material C { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"
                      "phase A wide { transition = pressure; p_line = 1; t_line = 300; rho0 = 4/1.21 }\n"
                      "phase C dense { transition = pressure; p_line = 1; t_line = 300; rho0 = 4/0.81 }\n"
                      "reaction r { reactants = A B; product = C; kind = non-stoichiometric; k0 = 1; ea = 0; "
                      "heat = 1e-3 }\n"
                      "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; mix = A 0.5 B 0.5 }\n",
                NULL, 1);
    CHECK_NEAR_REL(g.model->growth, 1.1 / 0.9, 1e-14);
    CHECK_NEAR_REL(g.model->radius_max, 0.022, 1e-14);
    engine_stop(&g);
}

/* A large disc may touch many small ones; with radii up to 1.5 of the least eight at most. */
TEST(a_pair_s_part_of_the_reactants)
{
    static const double radius[] = {1.49, 1.51};
    for (int k = 0; k < 2; k++) {
        char text[1200];
        struct engine g;
        (void)snprintf(text, sizeof text,
                       FRAME "material A { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"
                             "material B { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"
                             "material C { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"
                             "reaction r { reactants = A B; product = C; kind = non-stoichiometric; k0 = 1; "
                             "ea = 0; heat = 1e-3 "
                             "}\n"
                             "body a { shape = rectangle 0 0 0.3 1; spacing = 0.04; material = A }\n"
                             "body b { shape = rectangle 0.3 0 0.6 1; spacing = 0.0404; material = B }\n"
                             "body c { shape = rectangle 0.6 0 1 1; spacing = %g*0.04; material = B }\n",
                       radius[k]);
        engine_load(&g, text, NULL, 1);
        CHECK(g.model->has_kinds && !g.model->has_phases);
        CHECK_SAME_BITS(g.model->reaction.limit, k == 0 ? 1.0 / 8.0 : 1.0 / 64.0);
        engine_stop(&g);
    }
}

/* The rate by its equation, at any temperature, and its bound: the least part of either reactant. */
TEST(rates_and_their_bound)
{
    struct reaction_table x = {.any = true, .share = {0.25, 0.75}, .k0 = 3.0, .theta = 500.0, .limit = 0.125};
    const struct reaction_side a = {0.02, 0.5}, b = {0.03, 0.8};
    double got[2];
    for (int kind = 0; kind < 2; kind++) {
        double part = kind == 0 ? 0.01 / 0.034 : 0.25, rate = 3.0 * exp(-1.25) * 0.4 * 0.05;
        x.stoichiometric = kind == 1;
        reaction_rate(&x, a, b, 400.0, 0.05, 1e-3, got);
        CHECK_NEAR_REL(got[0], rate * 1e-3 * part, 1e-13);
        CHECK_NEAR_REL(got[1], rate * 1e-3 * (1.0 - part), 1e-13);
        /* The part of A, or of B, is a hundredth beyond what a pair may take. */
        for (int which = 0; which < 2; which++) {
            double most = 0.125 * (which == 0 ? 0.01 : 0.024), share = which == 0 ? part : 1.0 - part;
            reaction_rate(&x, a, b, 400.0, 0.05, 1.01 * most / (rate * share), got);
            double shorter = kind == 0 ? 1.0 : which == 0 ? 0.125 * 0.024 / (1.01 * most * 3.0) : 1.0;
            double less = fmin(1.0 / 1.01, shorter);
            CHECK_NEAR_REL(got[which], 1.01 * most * less, 1e-12);
            CHECK_NEAR_REL(got[1 - which], 1.01 * most * less * (1.0 - share) / share, 1e-12);
        }
    }
    x.theta = 0.0;
    reaction_rate(&x, a, b, 5e-4, 0.05, 1e-3, got);
    CHECK_NEAR_REL(got[0] + got[1], 3.0 * 0.4 * 0.05 * 1e-3, 1e-13);
    for (int none = 0; none < 3; none++) {
        const struct reaction_side empty = {0.02, 0.0};
        reaction_rate(&x, none == 0 ? empty : a, none == 1 ? empty : b, none == 2 ? 0.0 : 300.0, 0.05, 1e-3,
                      got);
        CHECK(got[0] == 0.0 && got[1] == 0.0);
    }
    const struct reaction_side little = {1e-3, 1e-4};
    reaction_rate(&x, little, little, 300.0, 0.05, 1e-12, got);
    CHECK_NEAR_REL(got[0], 0.25 * 3.0 * 1e-8 * 0.05 * 1e-12, 1e-13);
}

#define PHASES                                                                                               \
    FRAME                                                                                                    \
    "material A { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"                                                  \
    "phase A one { transition = temperature; t_line = 500; latent = 1e-3; cp = 1.01e-5; p_line = 0.2; "      \
    "dt_dp = "                                                                                               \
    "100 }\n"                                                                                                \
    "phase A two { from = one; transition = temperature; t_line = 700; latent = -2e-3; cp = 1.01e-5 }\n"     \
    "phase A three { from = two; transition = pressure; p_line = 0.5; t_line = 800; dp_dt = 1e-3\n"          \
    "                hysteresis_p = 0.1; latent = 4e-3; cp = 2e-5; reversible = no }\n"                      \
    "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n"

TEST(phases_form_from_phases)
{
    struct engine g;
    engine_load(&g, PHASES, NULL, 1);
    const struct kind *k = g.model->kinds;
    for (size_t i = 1; i < 4; i++)
        CHECK_EQ_INT(k[i].from, i - 1);
    CHECK_NEAR_REL(k[1].energy, 1e-3 - 1e-7 * 200.0, 1e-13);
    CHECK_NEAR_REL(k[2].energy, k[1].energy - 2e-3, 1e-13);
    CHECK_NEAR_REL(k[3].energy, k[2].energy + 4e-3 - 0.99e-5 * 500.0, 1e-13);
    CHECK_NEAR_REL(k[1].hysteresis, 1.1 * 1e-3 / 1e-5, 1e-13); /* the lesser of the two heat capacities */
    CHECK_NEAR(k[2].hysteresis, 0.0, 0.0);                     /* forming it sets heat free */
    CHECK_SAME_BITS(k[3].hysteresis, 0.1);
    engine_stop(&g);
}

/* Lines with their slopes, and the way back at the hysteresis below them, in pressure and in temperature. */
TEST(lines_and_ways_back)
{
    struct engine g;
    engine_load(&g, PHASES, NULL, 1);
    const struct model *m = g.model;
    /* T > 500 + 100 (p - 0.2), and back below the line less 110 K. */
    CHECK_EQ_INT(phase_of(m, 0, 0.2, 500.5), 1);
    CHECK_EQ_INT(phase_of(m, 0, 0.2, 499.5), 0);
    CHECK_EQ_INT(phase_of(m, 0, 0.5, 530.5), 1);
    CHECK_EQ_INT(phase_of(m, 0, 0.5, 529.5), 0);
    CHECK_EQ_INT(phase_of(m, 1, 0.5, 420.5), 1);
    CHECK_EQ_INT(phase_of(m, 1, 0.5, 419.5), 0);
    /* T > 700, and back below. */
    CHECK_EQ_INT(phase_of(m, 1, 0.0, 700.5), 2);
    CHECK_EQ_INT(phase_of(m, 2, 0.0, 699.5), 1);
    CHECK_EQ_INT(phase_of(m, 2, 0.0, 700.5), 2);
    /* p > 0.5 + 1e-3 (T - 800), and no way back. */
    CHECK_EQ_INT(phase_of(m, 2, 0.605, 900.0), 3);
    CHECK_EQ_INT(phase_of(m, 2, 0.595, 900.0), 2);
    CHECK_EQ_INT(phase_of(m, 3, -5.0, 900.0), 3);
    engine_stop(&g);
}

/* The energy that the book of a bond of quadratic potential holds: u + f v_n dt/2, and the same of its
 * spring. */
static double book(const struct pair_law *law, bool linked, const struct pair_record *pair, double r,
                   double vn, double vt, const double radius[2], const double w[2], double dt)
{
    double r0 = radius[0] + radius[1], x = r - r0 - (linked ? pair->stretch : 0.0);
    double kt = linked ? law->kt_link : law->kt_contact,
           sliding = vt - r / r0 * (w[0] * radius[0] + w[1] * radius[1]);
    double held = linked || r < r0 ? 0.5 * law->k * x * x - law->k * x * vn * dt / 2.0 : 0.0;
    return held + 0.5 * kt * pair->spring * (pair->spring + sliding * dt);
}

/* Two elements, smaller than 0.01 mm, askew and in motion, of which the second has become denser: linked, 1 %
 * apart without a link, and pressed by 1 %. What the book of their bond loses goes to the two accounts, half
 * each. */
TEST(a_change_of_phase_beside_an_element)
{
    static const double apart[] = {1.004, 1.01, 0.99};
    static const char deck[] =
        "let d = 4e-4\nlet apart = 1\n"
        "domain { size = 0.01 0.01; r_c = 1e-3; delta_r = 1e-4 }\ntime { dt = 1e-6; steps = 9 }\n"
        "material A { rho0 = 4; c0 = 0.4; s = 2; cp = 1e-5 }\n"
        "phase A dense { transition = pressure; p_line = 9; t_line = 300; rho0 = 4/0.81; c0 = 0.6; "
        "hysteresis_p = 3 }\n"
        "interaction { potential = quadratic; kt_ratio = 0.3; mu = 0.5; zeta = 0.1 }\n"
        "body a { shape = disc 50*d/4 50*d/4 d/40; spacing = d; origin = 50*d/4 50*d/4; material = A }\n"
        "body b { shape = disc (50/4 + 0.6*apart)*d (50/4 + 0.8*apart)*d d/40; spacing = d\n"
        "         origin = (50/4 + 0.6*apart)*d (50/4 + 0.8*apart)*d; material = A }\n";
    for (int k = 0; k < 3; k++) {
        char define[40];
        const char *const defines[] = {define, NULL};
        struct engine g;
        struct pair_record pair = {0, 1, k == 0, k == 0 ? 2e-6 : 0.0, k == 1 ? 0.0 : 3e-6};
        (void)snprintf(define, sizeof define, "apart=%g", apart[k]);
        engine_start(&g, deck, defines, 1);
        struct engine_state s = engine_collect(&g, false);
        CHECK_EQ_INT(s.n, 2);
        for (int i = 0; i < 2; i++) {
            s.e[i].v[0] = 0.02 - 0.05 * i;
            s.e[i].v[1] = -0.01 + 0.01 * i;
            s.e[i].w = 40.0 + 30.0 * i;
        }
        s.e[1].kind = 1;
        s.e[1].radius *= 0.9;
        const struct element *e = s.e;
        double n[2] = {-0.6, -0.8}, v[2] = {e[0].v[0] - e[1].v[0], e[0].v[1] - e[1].v[1]};
        double r = apart[k] * 4e-4, vn = v[0] * n[0] + v[1] * n[1], vt = v[1] * n[0] - v[0] * n[1];
        const double now[2] = {e[0].radius, e[1].radius}, was[2] = {2e-4, 2e-4}, w[2] = {e[0].w, e[1].w},
                     spun[2] = {e[0].w, e[1].w * 0.81};
        double lost =
            book(model_law(g.model, 0, 0, RELATION_OTHER_BODY), k == 0, &pair, r, vn, vt, was, spun, 1e-6) -
            book(model_law(g.model, 0, 1, RELATION_OTHER_BODY), k == 0, &pair, r, vn, vt, now, w, 1e-6);
        free(s.pair);
        s.pair = malloc(sizeof pair);
        s.pair[0] = pair;
        s.n_pairs = k == 1 ? 0 : 1;
        engine_restore(&g, 3, &s);
        engine_state_free(&s);
        engine_must(&g, engine_forces(&g, false));
        s = engine_collect(&g, false);
        CHECK((k == 1) == (fabs(lost) < 1e-25));
        for (int i = 0; i < 2; i++)
            CHECK_NEAR(s.e[i].moved, 0.5 * lost, 1e-8 * fabs(lost));
        engine_state_free(&s);
        engine_stop(&g);
    }
}

/* Where all elements change at once, the book counts as well. */
TEST(all_elements_change)
{
    struct engine g;
    engine_start(
        &g,
        FRAME "material A { rho0 = 4; c0 = 0.4; s = 2 }\n"
              "phase A dense { transition = pressure; p_line = 9; t_line = 300; rho0 = 4/0.81 }\n"
              "interaction { k = 3; potential = quadratic }\n"
              "body a { shape = disc 0.5 0.5 0.001; spacing = 0.04; origin = 0.5 0.5; material = A }\n"
              "body b { shape = disc 0.5396 0.5 0.001; spacing = 0.04; origin = 0.5396 0.5; material = A }\n",
        NULL, 1);
    struct engine_state s = engine_collect(&g, false);
    for (int i = 0; i < 2; i++) {
        s.e[i].kind = 1;
        s.e[i].radius *= 0.9;
    }
    engine_restore(&g, 3, &s);
    engine_state_free(&s);
    engine_must(&g, engine_forces(&g, false));
    s = engine_collect(&g, false);
    for (int i = 0; i < 2; i++)
        CHECK_NEAR_REL(s.e[i].moved, 0.25 * 3.0 * 0.0004 * 0.0004, 1e-9);
    engine_state_free(&s);
    engine_stop(&g);
}

/* --- sums of the changes --- */

/* Books the change of phase of the third of four elements beside the last, which is mirrored and gets nothing
 * here. The energy is rounded to the nearest quantum and may come to 2^57 quanta. */
TEST(changes_round_and_know_their_range)
{
    static const double at[4][2] = {{0.1, 0.9}, {0.9, 0.1}, {0.538, 0.505}, {0.5, 0.5}};
    uint32_t start[] = {0, 0, 0, 1}, partner[] = {3};
    uint8_t linked[] = {1};
    double stretch[] = {1e-4}, spring[] = {2e-4};
    const struct lists lists = {
        .near = {.start = start, .j = partner}, .linked = linked, .stretch = stretch, .spring = spring};
    struct engine g;
    engine_load(&g,
                FRAME "material A { rho0 = 4; c0 = 0.4; s = 2 }\n"
                      "phase A dense { transition = pressure; p_line = 9; t_line = 300; rho0 = 4/0.81 }\n"
                      "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; material = A }\n",
                NULL, 1);
    struct model m = *g.model;
    const double natural = m.fixed.energy;
    struct particles p;
    particles_start(&p, &m);
    CHECK_EQ_INT(particles_reserve(&p, 4), 0);
    p.n = 4;
    p.n_own = 3;
    double lost = 0.0;
    for (int k = 0; k < 5; k++) { /* the quanta of the second to the last booking */
        const double quanta[] = {0.0, 2.495, 2.505, 0.99 * 0x1p57, 1.01 * 0x1p57};
        for (size_t i = 0; i < 4; i++) {
            const struct element e = {.id = (uint32_t)i,
                                      .kind = i == 2,
                                      .radius = 0.02,
                                      .mass = 0.004,
                                      .r = {at[i][0], at[i][1]},
                                      .v = {0.01 * (double)i, 0.0}};
            particles_put(&p, &m, i, &e);
        }
        m.fixed.energy = k == 0 ? natural : quanta[k] / fabs(lost);
        CHECK_EQ_INT(phase_account(&m, &p, &lists, 7, &g.err), k < 4 ? DM2_OK : DM2_NUMERIC);
        CHECK(p.moved[0] == 0.0 && p.moved[1] == 0.0 && p.moved[3] == 0.0);
        if (k == 0)
            lost = p.moved[2];
        else if (k < 3)
            CHECK_NEAR_REL(p.moved[2] * m.fixed.energy, copysign(k + 1.0, lost), 1e-14);
    }
    CHECK(lost < 0.0 || lost > 0.0);
    CHECK_CONTAINS(g.err.text, "step 7: the change of phase of element 2 or 3, near (0.538, 0.505) cm");
    particles_free(&p);
    engine_stop(&g);
}

/* --- slots --- */

TEST(strength_softens_towards_melting)
{
    struct kind k = {.t0 = 300.0, .tm = 1300.0, .softening = 1.0, .over_range = 1e-3};
    CHECK_SAME_BITS(particles_softening(&k, 299.0), 1.0);
    CHECK_NEAR(particles_softening(&k, 303.0), 0.997, 1e-15);
    CHECK_NEAR(particles_softening(&k, 1290.0), 0.01, 1e-15);
    CHECK_SAME_BITS(particles_softening(&k, 1300.0), 0.0);
    CHECK_SAME_BITS(particles_softening(&k, 1310.0), 0.0);
    k.softening = 1.02;
    CHECK_NEAR(particles_softening(&k, 800.0), 1.0 - pow(0.5, 1.02), 1e-15);
    k.softening = 2.0;
    CHECK_NEAR(particles_softening(&k, 800.0), 0.75, 1e-15);
    k.tm = INFINITY;
    CHECK_SAME_BITS(particles_softening(&k, 1e6), 1.0);
    /* Where rounding makes the share of the range 1 just below Tm, or less than 1 at Tm. */
    k = (struct kind){.t0 = 300.0, .tm = 1918.95, .softening = 1.0, .over_range = 1.0 / (1918.95 - 300.0)};
    CHECK_SAME_BITS(particles_softening(&k, nextafter(1918.95, 0.0)), 0.0);
    k.tm = 349.0;
    k.over_range = 1.0 / 49.0;
    CHECK_SAME_BITS(particles_softening(&k, 349.0), 0.0);
}

TEST(slots_hold_their_values)
{
    double r[] = {0.25, 0.5, 0.75, 1.0}, temperature[] = {0.0, 0.0}, soft[2], heat[] = {4e-6, -2e-6},
           share[4] = {0};
    int32_t image[] = {0, 0, -3, 5};
    uint16_t kind[] = {0, 1}, body[] = {0, 1};
    int64_t virial[2 * VIRIAL_COUNT] = {0};
    struct kind kinds[2] = {{.t0 = 200.0, .tm = 1200.0, .softening = 1.0, .over_range = 1e-3, .over_cp = 1e5},
                            {.t0 = 300.0, .tm = INFINITY, .softening = 1.0, .over_cp = 2e5}};
    const struct model m = {.kinds = kinds, .n_kinds = 2, .grid = {.size = {2.0, 4.0}}};
    struct particles p = {.n = 2,
                          .r = r,
                          .heat = heat,
                          .soft = soft,
                          .share = share,
                          .kind = kind,
                          .body = body,
                          .virial = virial};
    CHECK_SAME_BITS(particles_temperature(&p, &m, 1), 300.0); /* no array of temperatures */
    particles_warm(&p, &m, 0, 500.0);
    p.temperature = temperature;
    particles_warm(&p, &m, 0, 500.0);
    particles_warm(&p, &m, 1, 250.0);
    CHECK_NEAR_REL(particles_temperature(&p, &m, 0), 200.0 + 200.0, 1e-14);
    CHECK_NEAR_REL(particles_temperature(&p, &m, 1), 300.0 - 100.0, 1e-14);
    CHECK_NEAR_REL(soft[0], 0.8, 1e-14);
    CHECK_SAME_BITS(soft[1], 1.0);
    virial[VIRIAL_COUNT + VIRIAL_TALLY] = 7 * TALLY_PAIR + 5 * TALLY_LINK + 3 * TALLY_CONTACT;
    CHECK_EQ_INT(particles_links(&p, 1), 5);
    CHECK_EQ_INT(particles_contacts(&p, 1), 3);
    CHECK_EQ_INT(particles_links(&p, 0), 0);
    CHECK_EQ_INT(particles_contacts(&p, 0), 0);
    CHECK_SAME_BITS(particles_unwrapped(&p, &m, 1, 0), 0.75);
    p.image = image;
    CHECK_SAME_BITS(particles_unwrapped(&p, &m, 0, 1), 0.5);
    CHECK_SAME_BITS(particles_unwrapped(&p, &m, 1, 0), 0.75 - 6.0);
    CHECK_SAME_BITS(particles_unwrapped(&p, &m, 1, 1), 1.0 + 20.0);
}

/* Free, held and forced elements in one body or two: whether no force acts, and whether a side is held. */
TEST(walls_and_what_is_held)
{
    static const uint8_t all[] = {0, ELEMENT_FIXED_MOTION, ELEMENT_FIXED_MOTION | ELEMENT_FORCED};
    for (int k = 0; k < 18; k++) {
        uint8_t flags[2] = {all[k % 3], all[k / 3 % 3]};
        uint16_t body[2] = {4, k < 9 ? 4 : 5};
        const struct particles p = {.n = 2, .flags = flags, .body = body};
        bool fixed[2] = {k % 3 == 1, k / 3 % 3 == 1}, forced[2] = {k % 3 == 2, k / 3 % 3 == 2};
        CHECK_EQ_INT(particles_walls(&p, 0, 1), k >= 9 && fixed[0] && fixed[1]);
        for (int i = 0; i < 2; i++) /* a body under force meets what no force moves with its own mass */
            CHECK_EQ_INT(particles_held(&p, (size_t)i, (size_t)(1 - i)),
                         fixed[i] || (forced[i] && !fixed[1 - i]));
    }
}

TEST_MAIN(CASE(growth_goes_on_in_the_product), CASE(a_pair_s_part_of_the_reactants),
          CASE(rates_and_their_bound), CASE(phases_form_from_phases), CASE(lines_and_ways_back),
          CASE(a_change_of_phase_beside_an_element), CASE(all_elements_change),
          CASE(changes_round_and_know_their_range), CASE(strength_softens_towards_melting),
          CASE(slots_hold_their_values), CASE(walls_and_what_is_held))
