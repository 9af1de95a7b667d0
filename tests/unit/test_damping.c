/* Local damping against closed forms: a body that falls, is thrown, spins; what the book says it took. */
#include "engine_help.h"

#include <math.h>

static const char fall[] =
    "let alpha = 0.2; let v = 0\n"
    "domain { size = 100 100; r_c = 1.1; delta_r = 0.1; gravity = 0 -0.001; damping = alpha }\n"
    "time { dt = 0.5; steps = 100 }\n"
    "material M { mass = 2 }\n"
    "interaction { potential = quadratic; k = 1 }\n"
    "body ball { shape = rectangle 50 50 50.5 50.5; spacing = 1; origin = 50.2 50.2; material = M\n"
    "    velocity = 0 v }\n"
    "body stone { shape = rectangle 20 50 20.5 50.5; spacing = 1; origin = 20.2 50.2; material = M\n"
    "    motion = driven; velocity = 0.01 0.02 }\n";

/* The velocity of the ball after `steps`, at the half step; *damped: what the book says of the state there.
 */
static double fall_for(const char *const *defines, int steps, double *damped, double *total)
{
    struct engine g;
    struct measures m, first;
    engine_start(&g, fall, defines, 1);
    engine_step(&g, &first);
    for (int k = 1; k < steps; k++)
        engine_step(&g, NULL);
    struct engine_state s = engine_collect(&g, false);
    double v = s.e[0].v[1];
    CHECK_SAME_BITS(s.e[1].v[0], 0.01); /* of prescribed motion */
    CHECK_SAME_BITS(s.e[1].v[1], 0.02);
    CHECK_SAME_BITS(s.e[1].damped, 0.0);
    engine_must(&g, engine_forces(&g, true));
    measures_clear(&m);
    engine_must(&g, subdomain_measure_last(g.sd[0], &m, &g.err));
    *damped = exact_value(&m.damped, model_scales(g.model).energy);
    *total = engine_total(&g, &m) - engine_total(&g, &first);
    engine_state_free(&s);
    engine_stop(&g);
    return v;
}

/* From rest the first half kick is whole, then (1 - alpha) g; a body that rises is slowed by (1 + alpha) g.
 */
TEST(a_body_that_falls_or_rises)
{
    const char *const falls[] = {"alpha=0.2", "v=0", NULL}, *const rises[] = {"alpha=0.5", "v=0.1", NULL},
                      *const free[] = {"alpha=0", "v=0.1", NULL};
    double damped, total, dt = 0.5, g = 0.001, mass = 2;
    CHECK_NEAR_REL(fall_for(falls, 1, &damped, &total), -g * 0.5 * dt, 1e-14);
    CHECK_NEAR_REL(fall_for(falls, 41, &damped, &total), -g * (0.5 + 0.8 * 40) * dt, 1e-14);
    /* alpha m g times the way, but for the first half kick */
    CHECK_NEAR_REL(damped, 0.2 * mass * g * (0.5 * 0.8 * g * (41 * dt) * (41 * dt)), 0.02);
    CHECK_NEAR(total, 0, 1e-3 * damped);
    CHECK_NEAR_REL(fall_for(rises, 41, &damped, &total), 0.1 - 1.5 * g * 40.5 * dt, 1e-14);
    double t = 41 * dt, way = 0.1 * t - 0.5 * 1.5 * g * t * t;
    CHECK_NEAR_REL(damped, 0.5 * mass * g * way, 1e-6);
    CHECK_NEAR(total, 0, 1e-3 * damped);
    CHECK_NEAR_REL(fall_for(free, 41, &damped, &total), 0.1 - g * 40.5 * dt, 1e-14);
    CHECK_SAME_BITS(damped, 0.0);
}

static const char spin[] =
    "let alpha = 0.3; let dt = 0.02\n"
    "domain { size = 8 8; r_c = 1.3; delta_r = 0.1; damping = alpha }\n"
    "time { dt = dt; steps = 100 }\n"
    "material M { mass = 1 }\n"
    "interaction { potential = quadratic; k = 1; kt_ratio = 0.4; linked = yes; link_break = 1.2 }\n"
    "body pair { shape = rectangle 2 2 3.5 2.5; spacing = 1; origin = 2.2 2.2; material = M }\n";

/* Two linked discs turn against their shear spring. Returns by how much the total drifts over what local
 * damping has taken, most of what there was. */
static double turn_for(const char *const *defines)
{
    struct engine g;
    struct measures m, first = {0};
    double worst = 0, damped = 0;
    engine_start(&g, spin, defines, 1);
    struct engine_state s = engine_collect(&g, false);
    s.e[0].w = s.e[1].w = 0.01;
    s.e[0].v[1] = 0.003;
    engine_restore(&g, 0, &s);
    engine_state_free(&s);
    for (int k = 0; k < (int)(30 / g.deck.config.dt); k++) {
        engine_step(&g, &m);
        if (k == 0)
            first = m;
        double off = fabs(engine_total(&g, &m) - engine_total(&g, &first));
        worst = off > worst ? off : worst;
        damped = exact_value(&m.damped, model_scales(g.model).energy);
    }
    CHECK(damped > 0.5 * exact_value(&first.kinetic, model_scales(g.model).energy));
    engine_stop(&g);
    return worst / damped;
}

TEST(the_book_of_spins_closes)
{
    const char *const coarse[] = {"dt=0.1", NULL}, *const fine[] = {"dt=0.025", NULL};
    double off = turn_for(coarse);
    CHECK(off < 0.01);
    CHECK_REPORT(turn_for(fine) < 0.3 * off, "%g and %g", turn_for(fine), off);
}

/* Any number of ranks, begun ahead or not, carries the bits. */
TEST(ranks_have_the_bits)
{
    static const char sheet[] =
        "domain { size = 20 20; r_c = 1.6; delta_r = 0.3; damping = 0.4 }\n"
        "time { dt = 0.1; steps = 100 }\n"
        "material M { mass = 1 }\n"
        "interaction { potential = morse; k = 1; shape = 4; kt_ratio = 0.3; mu = 0.3 }\n"
        "body sheet { shape = rectangle 2 2 18 18; spacing = 1; material = M\n"
        "    jitter = 0.05; seed = 5 }\n";
    struct engine one, many;
    engine_start(&one, sheet, NULL, 1);
    engine_start(&many, sheet, NULL, 6);
    many.ahead = true;
    engine_run(&one, 60);
    engine_run(&many, 60);
    struct engine_state a = engine_collect(&one, false), b = engine_collect(&many, false);
    double most = 0;
    for (size_t k = 0; k < a.n; k++)
        most = a.e[k].damped > most ? a.e[k].damped : most;
    CHECK(most > 0);
    engine_check_same(&b, &a, "6 ranks");
    engine_state_free(&a);
    engine_state_free(&b);
    engine_stop(&one);
    engine_stop(&many);
}

TEST_MAIN(CASE(a_body_that_falls_or_rises), CASE(the_book_of_spins_closes), CASE(ranks_have_the_bits))
