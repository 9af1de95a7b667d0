/* Walls under loads: a platen that is a wall reaches its stress; constant force; a gap between walls; what a
 * wall rests on, and a body on a wall; the same bits on any number of ranks, from a state; tables of
 * velocity, spin, temperature; refusals. */
#include <math.h>

#include "engine/loading_parts.h"
#include "engine/subdomain_parts.h"
#include "engine_help.h"

static const struct body_state *state_of(const struct engine *g, size_t i)
{
    return &subdomain_loading(g->sd[0])->body[i];
}

/* Force of others along y on mover i of those under force, in the last evaluation, Mbar cm2. */
static double force_on(const struct engine *g, size_t i)
{
    return exact_value(&state_of(g, i)->last.force[1], 0) * g->model->fixed.over_force;
}

/* --- a platen --- */

/* 240 grains between two lines settle under 0.5 kbar until 40 us; then the stress doubles within 15 us. */
#define PLATEN                                                                                               \
    "material al { rho0 = 2.7; c0 = 0.534; s = 1.34; cp = 9e-6 }\n"                                          \
    "interaction { zeta = 0.2; ct_ratio = 0.05; mu = 0.5; linked = no }\n"                                   \
    "let d = 0.02\n"                                                                                         \
    "let speed = 0\n"                                                                                        \
    "let width = 20 * d\n"                                                                                   \
    "let top = 14 * d\n"                                                                                     \
    "domain { size = width, top + 4*d; boundary = periodic free; r_c = 1.3*d; delta_r = 0.3*d }\n"           \
    "time { dt = 0.006 us; steps = 14000 }\n"                                                                \
    "body grains { shape = rectangle 0, 2*d, width, top; structure = discs; grain_size = 1.001*d\n"          \
    "              solid_fraction = 0.8; spacing = d; material = al; seed = 2; jitter = speed }\n"           \
    "wall floor { line = 0, 1.5*d, width/2, 1.2*d, width, 1.5*d; material = al }\n"                          \
    "wall lid { line = 0, top + 0.5*d, width/3, top + 0.5*d, width, top + 0.5*d; material = al }\n"          \
    "load press { body = lid; stress_yy = 0 us -0.0005 Mbar, 40 us -0.0005 Mbar, 55 us -0.001 Mbar }\n"

TEST(platen_reaches_its_stress)
{
    struct engine g;
    engine_start(&g, PLATEN, NULL, 1);
    const struct forced_axis *at = &g.model->forced[0].axis[1];
    const double asked = 0.001 * 0.4; /* times the width, 1 cm deep */
    double most = 0.0, worst = 0.0;
    CHECK_SAME_BITS(at->length, 0.4);
    CHECK_SAME_BITS(at->side, 1.0);
    CHECK_NEAR_REL(at->share, 0.2, 1e-12);
    CHECK_SAME_BITS(at->weight, 0.0);
    for (int n = 0; n < 14000; n++) {
        engine_step(&g, NULL);
        double f = force_on(&g, 0) / asked;
        most = fmax(most, f);
        if (n >= 10500)
            worst = fmax(worst, fabs(f - 1.0));
    }
    printf("overshoot %.3g, at rest off by %.3g\n", most - 1.0, worst);
    CHECK_REPORT(most <= 1.05, "the stress overshoots by %.3g", most - 1.0);
    CHECK_REPORT(worst <= 0.005, "the stress at rest is off by %.3g", worst);
    engine_stop(&g);
}

/* --- the same bits --- */

/* The platen, with a drum that a force drags through the grains. */
static const char drum[] = PLATEN "wall drum { circle = 10*d, 8*d, 2.2*d; rigid = yes }\n"
                                  "load drag { body = drum; force_x = 0 us 0, 2 us 2e-4; velocity_y = 0 us "
                                  "0, 4 us 0.002 }\n"
                                  "void hole { shape = disc 10*d, 8*d, 2.8*d }\n";

static void check_same_bodies(struct engine *g, const struct section_array *want)
{
    for (int r = 0; r < g->map.ranks; r++) {
        struct section_array got = {.n = 0};
        CHECK(loading_collect(subdomain_loading(g->sd[r]), &got));
        CHECK_EQ_INT(got.n, 2);
        CHECK(memcmp(got.records, want->records, 2 * sizeof(struct body_record)) == 0);
        free(got.records);
    }
}

static struct section_array collect_bodies(struct engine *g)
{
    struct section_array out = {.n = 0};
    CHECK(loading_collect(subdomain_loading(g->sd[0]), &out));
    return out;
}

TEST(same_bits_on_all_ranks)
{
    const char *const defines[] = {"speed=0.005", NULL};
    struct engine one, many;
    engine_start(&one, drum, defines, 1);
    engine_run(&one, 1200);
    struct engine_state want = engine_collect(&one, false);
    struct section_array bodies = collect_bodies(&one);
    const struct body_record *lid = section_record(SECTION_BODY, &bodies, 0),
                             *dragged = section_record(SECTION_BODY, &bodies, 1);
    CHECK_EQ_INT(lid->mover, 2);
    CHECK_EQ_INT(dragged->mover, 3);
    CHECK(lid->contacts[0] > 2 && dragged->contacts[0] > 0);
    CHECK(fabs(dragged->displacement[0]) > 1e-4 && dragged->displacement[1] == 0.0);
    for (int ranks = 2; ranks <= 5; ranks += ranks == 3 ? 2 : 1) {
        engine_start(&many, drum, defines, ranks);
        many.ahead = true;
        engine_run(&many, 1200);
        struct engine_state got = engine_collect(&many, false);
        engine_check_same(&got, &want, "ranks");
        check_same_bodies(&many, &bodies);
        CHECK(many.migrants > 0);
        engine_state_free(&got);
        engine_stop(&many);
    }
    free(bodies.records);
    engine_state_free(&want);
    engine_stop(&one);
}

/* --- walls without grains --- */

#define ALONE                                                                                                \
    "material al { rho0 = 2.7; c0 = 0.534; s = 1.34; cp = 9e-6; kappa = 2.37e-12 }\n"                        \
    "interaction { zeta = 0.2; ct_ratio = 0.05; mu = 0.5; linked = no }\n"                                   \
    "domain { size = 1 1; r_c = 0.05; delta_r = 0.01; gravity = 0, -1e-5 }\n"                                \
    "time { dt = 0.006 us; steps = 20000 }\n"                                                                \
    "let up = 0.5\n"                                                                                         \
    "body floor { shape = rectangle 0, 0.1, 1, 0.12; lattice = square; spacing = 0.02; material = al\n"      \
    "             origin = 0.01, 0.11; motion = fixed }\n"

/* A wall weighs nothing. Kicks 2 to n - 1 of F/M dt: the path F/M dt^2 k (k + 1)/2 with k = n - 2. */
TEST(constant_force)
{
    struct engine g;
    engine_start(&g,
                 ALONE "wall bar { circle = 0.5 up 0.05; material = al; velocity = 0.01 0 }\n"
                       "load push { body = bar; force_y = 0 us -1e-6, 1 us -1e-6; max_velocity = 1; mass = "
                       "0.01 }\n",
                 NULL, 1);
    engine_run(&g, 1000);
    const struct control_state *s = &state_of(&g, 0)->axis[1];
    double dt = 0.006, k = 998.0, M = 0.01;
    CHECK_NEAR_REL(s->shift, -1e-6 / M * dt * dt * k * (k + 1.0) / 2.0, 1e-12);
    struct wall_pose at;
    wall_pose_at(g.model, subdomain_loading(g.sd[0]), &g.model->walls[0], 1000, &at);
    CHECK_SAME_BITS(at.d[1], s->shift);
    CHECK_SAME_BITS(at.v[1], s->velocity);
    CHECK_NEAR(at.d[0], 0.01 * 1000.0 * dt, 1e-15);
    engine_stop(&g);
}

/* Fixed elements, which nothing moves, bear a wall that a force moves; K of many of them. */
TEST(a_wall_rests_on_fixed_elements)
{
    struct engine g;
    engine_start(&g,
                 ALONE "wall bar { line = 0.2 0.1205 0.8 0.1205; material = al }\n"
                       "load push { body = bar; force_y = 0 us -1e-4, 1 us -1e-4 }\n",
                 NULL, 1);
    engine_run(&g, 20000);
    CHECK_NEAR_REL(force_on(&g, 0), 1e-4, 1e-4);
    CHECK_NEAR(state_of(&g, 0)->axis[1].velocity, 0.0, 1e-8);
    CHECK_EQ_INT(state_of(&g, 0)->last.contacts, 30);
    engine_stop(&g);
}

/* The contacts with a wall damp a body under force, too; one at a joint of two parts counts once. */
TEST(a_body_rests_on_a_wall)
{
    struct engine g;
    engine_start(&g,
                 ALONE "body row { shape = rectangle 0.4, 0.5, 0.5, 0.52; lattice = square; spacing = 0.02\n"
                       "           origin = 0.41, 0.51; material = al; motion = driven }\n"
                       "wall table { line = 0.2 0.4995 0.43 0.4995 0.8 0.4995; material = al }\n"
                       "load push { body = row; force_y = 0 us -1e-4, 1 us -1e-4 }\n",
                 NULL, 1);
    engine_run(&g, 6000);
    double weight = g.model->forced[0].axis[1].weight;
    CHECK(weight < 0.0);
    CHECK_NEAR_REL(force_on(&g, 0), 1e-4 - weight, 1e-4);
    CHECK_NEAR(state_of(&g, 0)->axis[1].velocity, 0.0, 1e-8);
    CHECK_EQ_INT(state_of(&g, 0)->last.contacts, 5);
    engine_stop(&g);
}

/* The stress on a wall acts on the gap between two others, of which one moves away. */
TEST(stress_between_two_walls)
{
    struct engine g;
    engine_start(&g,
                 ALONE "wall left { line = 0.1 0.2 0.1 0.8; material = al }\n"
                       "wall right { circle = 0.6 0.5 0.1; material = al; velocity = 0.01 0 }\n"
                       "wall low { line = 0.2 0.2 0.4 0.2; material = al }\n"
                       "load push { body = low; stress_yy = 0 us 0.001 Mbar, 1 us 0.001 Mbar\n"
                       "            between = right left; max_velocity = 1 }\n",
                 NULL, 1);
    const struct forced_axis *at = &g.model->forced[0].axis[1];
    CHECK_NEAR(at->length, 0.4, 1e-15);
    CHECK_SAME_BITS(at->side, -1.0);
    engine_run(&g, 3);
    double dt = 0.006, gap = 0.4 + 0.01 * 2.0 * dt;
    CHECK_NEAR_REL(state_of(&g, 0)->axis[1].velocity, -0.001 * gap / at->control.mass * dt, 1e-12);
    engine_stop(&g);
}

/* --- tables --- */

/* A wall is where the integrals of its velocity and spin are. */
TEST(tables_move_a_wall)
{
    struct engine g;
    engine_start(&g,
                 ALONE "wall paddle { line = 0.4 0.5 0.6 0.5; material = al }\n"
                       "load move { body = paddle; velocity_x = 0 us 0, 3 us 0.02, 5 us 0.02\n"
                       "            spin = 0 us 0.1, 6 us -0.1 }\n",
                 NULL, 1);
    engine_run(&g, 1000);
    struct wall_pose at;
    wall_pose_at(g.model, NULL, &g.model->walls[0], 1000, &at);
    CHECK_NEAR(at.d[0], 0.03 + 0.02 * 3.0, 1e-14);
    CHECK_NEAR(at.angle, 0.0, 1e-14);
    wall_pose_at(g.model, NULL, &g.model->walls[0], 500, &at);
    CHECK_NEAR(at.d[0], 0.03, 1e-14);
    CHECK_NEAR(at.angle, 0.15, 1e-14);
    CHECK_NEAR(at.sine, sin(0.15), 1e-14);
    CHECK_NEAR(at.v[0], 0.02 - 0.5 * 0.006 * 0.02 / 3.0, 1e-14);
    engine_stop(&g);
}

/* The heat of a disc on a wall whose temperature is a table: kappa A/r of the contact times the integral of
 * the difference, of which the disc's own warming is a small part. */
TEST(a_table_holds_the_temperature_of_a_wall)
{
    struct engine g;
    struct measures m;
    engine_start(&g,
                 ALONE "body row { shape = rectangle 0.4, 0.5, 0.42, 0.52; lattice = square; spacing = 0.02\n"
                       "           origin = 0.41, 0.51; material = al; motion = fixed }\n"
                       "wall plate { line = 0.2 0.5 0.8 0.5; material = al }\n"
                       "load heat { body = plate; temperature = 0 us 300, 3 us 900, 6 us 500 }\n",
                 NULL, 1);
    engine_run(&g, 1000);
    engine_step(&g, &m);
    struct engine_state s = engine_collect(&g, false);
    double want = 2.37e-12 / sqrt(3.0) * (3.0 * 300.0 + 3.0 * 400.0);
    CHECK_NEAR_REL(s.e[s.n - 1].heat, want, 1e-3);
    CHECK_NEAR_REL(exact_value(&m.work, model_scales(g.model).energy), s.e[s.n - 1].heat, 2e-3);
    engine_state_free(&s);
    engine_stop(&g);
}

/* --- refusals --- */

/* The deck or the model refuses ALONE with these blocks, at the line of the load. */
static void refuse(const char *rest, const char *expected, const char *place)
{
    char text[4000];
    struct dm2_error err = {0};
    struct model *model;
    (void)snprintf(text, sizeof text, "%s%s\n", ALONE, rest);
    struct loaded deck = load_text(text, NULL, -1);
    if (deck.status == DM2_OK) {
        CHECK_EQ_INT(model_build(&deck.config, &model, &err), DM2_DECK);
        CHECK_CONTAINS(err.text, expected);
        CHECK_CONTAINS(err.text, place);
    } else {
        CHECK_CONTAINS(deck.report.text, expected);
        CHECK_CONTAINS(deck.report.text, place);
    }
    loaded_free(&deck);
}

TEST(loads_that_cannot_act)
{
    refuse("wall w { line = 0.2 0.5 0.8 0.5; material = al; velocity = 0 0.01 }\n"
           "load a { body = w; force_y = 0 us 1, 1 us 1 }",
           "the load 'a' moves the wall 'w' along the same axis", "deck:8:");
    refuse("wall w { line = 0.2 0.5 0.8 0.5; material = al }\n"
           "load a { body = w; stress_yy = 0 us 1, 1 us 1; velocity_y = 0 us 1, 1 us 1 }",
           "is prescribed twice", "deck:9:");
    refuse("wall w { line = 0.2 0.5 0.8 0.5; material = al; spin = 0.1 }\n"
           "load a { body = w; force_y = 0 us 1, 1 us 1 }",
           "the wall 'w' has a spin, and under a force a wall does not turn", "deck:9:");
    refuse("wall w { line = 0.2 0.5 0.8 0.5; material = al }\n"
           "load a { body = w; acceleration_y = 0 us 1, 1 us 1 }",
           "a wall has no acceleration", "deck:9:");
    refuse("wall w { line = 0.2 0.5 0.2 0.7; material = al }\n"
           "load a { body = w; stress_yy = 0 us 1, 1 us 1 }",
           "the wall 'w' has no extent along x on which a stress acts", "deck:9:");
    refuse("wall w { line = 0.2 0.5 0.4 0.5; material = al }\n"
           "load a { body = w; stress_yy = 0 us 1e-6, 1 us 1e-6; mass = 1e-9 g }",
           "give at least", "deck:9:");
    refuse("wall w { line = 0.2 0.5 0.4 0.5; material = al }\n"
           "load a { body = w; stress_yy = 0 us 1e-6, 1 us 1e-6; between = w floor }",
           "no gap along x between", "deck:9:");
}

TEST_MAIN(CASE(platen_reaches_its_stress), CASE(same_bits_on_all_ranks), CASE(constant_force),
          CASE(a_wall_rests_on_fixed_elements), CASE(a_body_rests_on_a_wall), CASE(stress_between_two_walls),
          CASE(tables_move_a_wall), CASE(a_table_holds_the_temperature_of_a_wall),
          CASE(loads_that_cannot_act))
