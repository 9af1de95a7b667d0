/* A stage that begins from a state: its steps, its times, and its first kick. */
#include "check.h"
#include "deck_help.h"
#include "engine_help.h"

#include "dm2/deck/schedule.h"

static const char deck[] =
    "domain { size = 2 1.6; boundary = periodic free; r_c = 0.125; delta_r = 0.0125; gravity = 0 -0.0005 }\n"
    "time { dt = 0.02; steps = 40 }\n"
    "material Cu { rho0 = 8.93; c0 = 0.394; s = 1.489; shear = 0.477; yield = 0.0012; cp = 3.8e-6; t0 = 300 "
    "}\n"
    "interaction { zeta = 0.1; mu = 0.2 }\n"
    "body left { shape = disc 0.6 0.8 0.35; spacing = 0.05; material = Cu; velocity = 0.02 0 }\n"
    "body right { shape = disc 1.34 0.8 0.35; spacing = 0.05; material = Cu; motion = driven; velocity = "
    "-0.02 0 }\n"
    "output { strain = yes }\n";

static const char fall[] = "domain { size = 2 1.6; r_c = 0.125; delta_r = 0.0125; gravity = 0 -0.25 }\n"
                           "time { dt = 0.001; steps = 40 }\n"
                           "material Cu { rho0 = 8.93; c0 = 0.394; s = 1.489 }\n"
                           "body one { shape = disc 0.6 0.8 0.01; origin = 0.6 0.8; spacing = 0.05; material "
                           "= Cu; velocity = 0.5 0 }\n";

static void begin_stage(struct engine *g, int64_t n_start, double t_start, double dt_before)
{
    g->deck.config.n_start = n_start;
    g->deck.config.t_start = t_start;
    g->deck.config.dt_before = dt_before;
}

/* A stage that changes nothing goes on to the same bits, whether its steps go on or begin at 0. */
TEST(a_stage_that_changes_nothing)
{
    static const int64_t starts[] = {0, 15, 1000};
    struct engine straight, stage;
    engine_start(&straight, deck, NULL, 1);
    engine_run(&straight, 15);
    struct engine_state from = engine_collect(&straight, false);
    engine_run(&straight, 15);
    struct engine_state want = engine_collect(&straight, false);
    for (size_t k = 0; k < 3; k++)
        for (int ranks = 1; ranks <= 3; ranks += 2) {
            engine_load(&stage, deck, NULL, ranks);
            begin_stage(&stage, starts[k], 3.25, 0.02);
            engine_restore(&stage, starts[k], &from);
            engine_run(&stage, 15);
            struct engine_state got = engine_collect(&stage, false);
            engine_check_same(&got, &want, "the stage");
            engine_state_free(&got);
            engine_stop(&stage);
        }
    engine_state_free(&from);
    engine_state_free(&want);
    engine_stop(&straight);
}

/* Under gravity alone the leapfrog is exact at whole steps, also where a stage changes dt, or begins with
 * velocities of the whole step. */
TEST(a_stage_with_another_step)
{
    static const double before[] = {0.001, 0.001, 0.0};
    static const char *const steps[] = {"dt = 0.001", "dt = 0.0025", "dt = 0.0005"};
    for (size_t k = 0; k < 3; k++) {
        struct engine g;
        char text[sizeof fall + 20];
        engine_start(&g, fall, NULL, 1);
        engine_run(&g, 40);
        struct engine_state from = engine_collect(&g, false), end;
        engine_stop(&g);
        double v[2] = {0.5, -0.25 * 0.04}, r[2] = {from.e[0].r[0], from.e[0].r[1]};
        CHECK_NEAR(r[1], 0.8 - 0.125 * 0.04 * 0.04, 1e-14);
        if (before[k] == 0.0) {
            from.e[0].v[0] = v[0] = 0.125;
            from.e[0].v[1] = v[1] = 0.0625;
        }
        const char *at = strstr(fall, "dt = 0.001");
        (void)snprintf(text, sizeof text, "%.*s%s%s", (int)(at - fall), fall, steps[k],
                       at + strlen("dt = 0.001"));
        engine_load(&g, text, NULL, 1);
        begin_stage(&g, 7, 0.5, before[k]);
        engine_restore(&g, 7, &from);
        engine_run(&g, 24);
        end = engine_collect(&g, false);
        double t = 24 * g.deck.config.dt;
        CHECK_NEAR(config_time(&g.deck.config, 7 + 24), 0.5 + t, 1e-15);
        CHECK_NEAR(end.e[0].r[0], r[0] + v[0] * t, 1e-13);
        CHECK_NEAR(end.e[0].r[1], r[1] + v[1] * t - 0.125 * t * t, 1e-13);
        engine_state_free(&from);
        engine_state_free(&end);
        engine_stop(&g);
    }
}

TEST(the_first_step_of_a_stage_is_measured)
{
    struct config c = {
        .n_start = 7, .t_start = 0.5, .dt = 0.25, .steps = 100, .output = {.history_every = 10}};
    CHECK(schedule_measure(&c, 7) && schedule_limit(&c, 7) && !schedule_measure(&c, 8) &&
          schedule_measure(&c, 10));
    CHECK(!schedule_checkpoint(&c, 7, 7) && schedule_checkpoint(&c, 7, 14));
    CHECK_SAME_BITS(config_time(&c, 7), 0.5);
    CHECK_SAME_BITS(config_time(&c, 9), 1.0);
}

TEST_MAIN(CASE(a_stage_that_changes_nothing), CASE(a_stage_with_another_step),
          CASE(the_first_step_of_a_stage_is_measured))
