/* The boundaries of a body: prescribed motion (fixed, driven), periodic sides, the body force. */
#include "engine_help.h"

#define SOLID                                                                                                \
    "time { dt = 0.01; steps = 100 }\n"                                                                      \
    "material Cu { rho0 = 8.93; c0 = 0.394; s = 1.489; shear = 0.477; cp = 3.85e-6 }\n"                      \
    "interaction { zeta = 0.1; ct_ratio = 0.02 }\n"

/* A block between a fixed floor and a piston that comes down; the block is linked to both. */
static const char piston[] =
    "domain { size = 1.2 1.2; r_c = 0.06; delta_r = 0.01; boundary = periodic free }\n" SOLID
    "interface body { linked = yes }\n"
    "let row = 0.04*sqrt(3)/2\n"
    "body floor { shape = rectangle 0 0 1.2 2*row; spacing = 0.04; origin = 0.01 0.01; material = Cu; motion "
    "= fixed }\n"
    "body block { shape = rectangle 0 2*row 1.2 22*row; spacing = 0.04; origin = 0.01 0.01; material = Cu }\n"
    "body lid { shape = rectangle 0 22*row 1.2 24*row; spacing = 0.04; origin = 0.01 0.01; material = Cu\n"
    "           motion = driven; velocity = 0 -0.01 }\n";

TEST(the_work_of_a_piston_closes_the_book)
{
    struct engine g;
    struct measures m;
    double first = 0.0, largest = 0.0, work = 0.0;
    engine_start(&g, piston, NULL, 1);
    for (int step = 0; step < 300; step++) {
        engine_step(&g, &m);
        double total = engine_total(&g, &m);
        work = exact_value(&m.work, model_scales(g.model).energy);
        first = step == 0 ? total : first;
        largest = fmax(largest, fabs(total - first));
    }
    CHECK(work > 1e-4);
    CHECK_REPORT(largest < 2e-3 * work, "the total drifts by %g of a work of %g", largest, work);
    struct engine_state s = engine_collect(&g, false);
    for (size_t i = 0; i < s.n; i++) {
        if (s.e[i].body == 0) {
            CHECK_SAME_BITS(s.e[i].v[0], 0.0);
            CHECK_SAME_BITS(s.e[i].v[1], 0.0);
            CHECK_SAME_BITS(s.e[i].w, 0.0);
        }
        if (s.e[i].body == 2)
            CHECK_SAME_BITS(s.e[i].v[1], -0.01);
    }
    engine_state_free(&s);
    engine_stop(&g);
}

TEST(a_piston_is_the_same_on_any_number_of_ranks)
{
    struct engine one;
    engine_start(&one, piston, NULL, 1);
    engine_run(&one, 200);
    struct engine_state want = engine_collect(&one, false);
    for (int ranks = 2; ranks <= 7; ranks += 5) {
        struct engine g;
        engine_start(&g, piston, NULL, ranks);
        engine_run(&g, 200);
        struct engine_state got = engine_collect(&g, false);
        engine_check_same(&got, &want, "piston");
        engine_state_free(&got);
        engine_stop(&g);
    }
    engine_state_free(&want);
    engine_stop(&one);
}

/* The lattice fits the period in x and in y: 24 elements of 0.05 a row, 28 rows. */
static const char seamless[] =
    "let row = 0.05*sqrt(3)/2\n"
    "domain { size = 1.2 28*row; r_c = 0.08; delta_r = 0.01; rebuild_every = 10; boundary = periodic "
    "periodic }\n" SOLID
    "body all { shape = rectangle 0 0 1.2 28*row; spacing = 0.05; origin = 0.0125 row/2; material = Cu; "
    "velocity = 0.02 0.01 }\n";

TEST(a_periodic_crystal_is_bulk)
{
    struct engine g;
    struct measures m;
    engine_start(&g, seamless, NULL, 5);
    engine_step(&g, &m);
    CHECK_EQ_INT(m.elements, 24 * 28);
    CHECK_EQ_INT(m.links, 3 * 24 * 28); /* also across both seams and the corner */
    /* The lattice moves through the seams without a force: velocities stay and nothing heats. The deck asks
     * for rebuilds, because a common motion does not. */
    engine_run(&g, 3000);
    CHECK(g.migrants > 100);
    engine_step(&g, &m);
    CHECK_EQ_INT(m.links, 3 * 24 * 28);
    CHECK_NEAR(m.p_max, 0.0, 1e-11);
    struct engine_state s = engine_collect(&g, false);
    for (size_t i = 0; i < s.n; i++) {
        CHECK_NEAR(s.e[i].v[0], 0.02, 1e-12);
        CHECK_NEAR(s.e[i].v[1], 0.01, 1e-12);
    }
    engine_state_free(&s);
    engine_stop(&g);
}

/* A wave of one period across the seams: its phase must not matter. */
TEST(a_seam_is_nowhere)
{
    struct engine g[2];
    static const char *const shift[2][2] = {{"x=0", NULL}, {"x=0.35", NULL}};
    static const char text[] =
        "let row = 0.05*sqrt(3)/2\n"
        "let x = 0\n"
        "domain { origin = -x 0; size = 1.2 28*row; r_c = 0.08; delta_r = 0.01; boundary = periodic periodic "
        "}\n" SOLID "body left { shape = rectangle 0.4 0 0.8 28*row; spacing = 0.05; origin = 0.0125 row/2; "
        "material = Cu; velocity = 0.02 0 }\n"
        "body right1 { shape = rectangle 0.8 0 1.2 - x 28*row; spacing = 0.05; origin = 0.0125 row/2; "
        "material = Cu }\n"
        "body right2 { shape = rectangle -x 0 0.4 28*row; spacing = 0.05; origin = 0.0125 row/2; material = "
        "Cu }\n"
        "interface body { linked = yes }\n";
    struct measures m[2];
    for (int k = 0; k < 2; k++) {
        engine_start(&g[k], text, shift[k], 1 + 3 * k);
        engine_run(&g[k], 150);
        engine_step(&g[k], &m[k]);
    }
    int scale = model_scales(g[0].model).energy;
    CHECK_EQ_INT(m[0].links, m[1].links);
    CHECK_NEAR_REL(exact_value(&m[1].kinetic, scale), exact_value(&m[0].kinetic, scale), 1e-9);
    CHECK_NEAR_REL(exact_value(&m[1].potential, scale), exact_value(&m[0].potential, scale), 1e-9);
    for (int k = 0; k < 2; k++)
        engine_stop(&g[k]);
}

/* A thrown block: a parabola whose energy account the work of gravity closes; then the block comes to rest
 * on a fixed floor. */
TEST(gravity_does_work)
{
    static const char text[] =
        "domain { size = 1 1; r_c = 0.08; delta_r = 0.01; gravity = 0.001 -0.02 }\n" SOLID
        "body block { shape = rectangle 0.3 0.3 0.6 0.6; spacing = 0.05; material = Cu; velocity = 0 0.01 "
        "}\n";
    struct engine g;
    struct measures m;
    engine_start(&g, text, NULL, 2);
    engine_step(&g, &m);
    double first = engine_total(&g, &m), t = 100 * 0.01;
    struct engine_state a = engine_collect(&g, false);
    engine_run(&g, 99);
    engine_step(&g, &m);
    struct engine_state b = engine_collect(&g, false);
    CHECK_NEAR_REL(engine_total(&g, &m), first, 1e-9);
    /* v at the half step 100 - 1/2 after half a step's kick at the start: t = (100 + 1/2) dt from rest. */
    for (size_t i = 0; i < a.n; i++) {
        CHECK_NEAR(b.e[i].v[0] - a.e[i].v[0], 0.001 * t, 1e-12);
        CHECK_NEAR(b.e[i].v[1] - a.e[i].v[1], -0.02 * t, 1e-12);
    }
    engine_state_free(&a);
    engine_state_free(&b);
    engine_stop(&g);
}

static void check_refused(const char *body, const char *message)
{
    char text[1200];
    snprintf(text, sizeof text,
             "domain { size = 1 1; r_c = 0.08; delta_r = 0.01 }\n" SOLID
             "body b { shape = rectangle 0.3 0.3 0.6 0.6; spacing = 0.05; material = Cu; %s }\n",
             body);
    struct loaded l = load_text(text, NULL, -1);
    CHECK_EQ_INT(l.status, DM2_DECK);
    CHECK_CONTAINS(l.report.text, message);
    loaded_free(&l);
}

TEST(contradictions_are_refused)
{
    check_refused("motion = fixed; velocity = 0 1", "the body 'b' is fixed: it has no velocity");
    check_refused("motion = driven; jitter = 0.1", "the motion of the body 'b' is prescribed");
    check_refused("motion = driven2", "'driven2' is no value of 'motion'");
}

TEST_MAIN(CASE(the_work_of_a_piston_closes_the_book), CASE(a_piston_is_the_same_on_any_number_of_ranks),
          CASE(a_periodic_crystal_is_bulk), CASE(a_seam_is_nowhere), CASE(gravity_does_work),
          CASE(contradictions_are_refused))
