/* Bodies that move by forces: a platen on grains, free motion, a body on the floor, the gap between two
 * bodies, the same bits on any number of ranks, and what the model refuses. */
#include <math.h>

#include "dm2/cluster/messages.h"
#include "engine/loading_parts.h"
#include "check.h"
#include "engine_help.h"

static const char material[] = "material al { rho0 = 2.7; c0 = 0.534; s = 1.34; cp = 9e-6 }\n"
                               "interaction { zeta = 0.2; ct_ratio = 0.05; mu = 0.5; linked = no }\n";

static void start(struct engine *g, const char *rest, const char *const *defines, int ranks)
{
    char text[4000];
    (void)snprintf(text, sizeof text, "%s%s", material, rest);
    engine_start(g, text, defines, ranks);
}

static const struct body_state *state_of(const struct engine *g, size_t i)
{
    return &subdomain_loading(g->sd[0])->body[i];
}

/* Force of others on body i along an axis in the last evaluation, Mbar cm2. */
static double force_on(const struct engine *g, size_t i, size_t axis)
{
    return exact_value(&state_of(g, i)->last.force[axis], 0) * g->model->fixed.over_force;
}

/* --- a platen --- */

/* 260 grains settle under 0.5 kbar until 40 us; then the stress doubles within 15 us. */
static const char platen[] =
    "let d = 0.02\n"
    "let speed = 0\n"
    "let width = 20 * d\n"
    "let top = 14 * d\n"
    "domain { size = width, top + 4*d; boundary = periodic free; r_c = 1.3*d; delta_r = 0.3*d }\n"
    "time { dt = 0.006 us; steps = 14000 }\n"
    "body floor { shape = rectangle 0, d, width, 2*d; lattice = square; spacing = width/13; radius = d/2\n"
    "             origin = d/2, 1.5*d; material = al; motion = fixed }\n"
    "body lid { shape = rectangle 0, top, width, top + d; lattice = square; spacing = width/13; radius = "
    "d/2\n"
    "           origin = d/2, top + 0.5*d; material = al; motion = driven }\n"
    "body grains { shape = rectangle 0, 2*d, width, top; structure = discs; grain_size = 1.001*d\n"
    "              solid_fraction = 0.8; spacing = d; material = al; seed = 2; jitter = speed }\n"
    "load press { body = lid; stress_yy = 0 us -0.0005 Mbar, 40 us -0.0005 Mbar, 55 us -0.001 Mbar }\n";

TEST(platen_reaches_its_stress)
{
    struct engine g;
    start(&g, platen, NULL, 1);
    const struct forced_axis *at = &g.model->forced[0].axis[1];
    const double asked = 0.001 * 0.4; /* times the width, 1 cm deep */
    double most = 0.0, worst = 0.0;
    CHECK_SAME_BITS(at->length, 0.4);
    CHECK_SAME_BITS(at->side, 1.0);
    for (int n = 0; n < 14000; n++) {
        engine_step(&g, NULL);
        double f = force_on(&g, 0, 1) / asked;
        most = fmax(most, f);
        if (n >= 10500)
            worst = fmax(worst, fabs(f - 1.0));
    }
    CHECK_REPORT(most <= 1.05, "the stress overshoots by %.3g", most - 1.0);
    CHECK_REPORT(worst <= 0.005, "the stress at rest is off by %.3g", worst);
    engine_stop(&g);
}

/* The parts of all ranks sum to the same totals, with forces ahead and migrating grains. */
TEST(same_bits_on_all_ranks)
{
    struct engine one, many;
    const char *const defines[] = {"speed=0.005", NULL};
    start(&one, platen, defines, 1);
    engine_run(&one, 1500);
    struct engine_state want = engine_collect(&one, false);
    for (int ranks = 2; ranks <= 5; ranks += ranks == 3 ? 2 : 1) {
        start(&many, platen, defines, ranks);
        many.ahead = true;
        engine_run(&many, 1500);
        struct engine_state got = engine_collect(&many, false);
        engine_check_same(&got, &want, "ranks");
        for (int r = 0; r < ranks; r++) {
            struct section_array a = {.n = 0}, b = {.n = 0};
            CHECK(loading_collect(subdomain_loading(one.sd[0]), &a));
            CHECK(loading_collect(subdomain_loading(many.sd[r]), &b));
            CHECK(a.n == 1 && b.n == 1 && memcmp(a.records, b.records, sizeof(struct body_record)) == 0);
            free(a.records);
            free(b.records);
        }
        CHECK(many.migrants > 0);
        engine_state_free(&got);
        engine_stop(&many);
    }
    engine_state_free(&want);
    engine_stop(&one);
}

/* --- bodies without grains --- */

static const char alone[] =
    "let a = 0\n"
    "let load = 1e-6\n"
    "let up = 0.6\n"
    "let slide = 0.01\n"
    "domain { size = 1 1; r_c = 0.05; delta_r = 0.01; gravity = 0, -a }\n"
    "time { dt = 0.006 us; steps = 1000; }\n"
    "body floor { shape = rectangle 0, 0.1, 1, 0.12; lattice = square; spacing = 0.02; material = al\n"
    "             origin = 0.01, 0.11; motion = fixed }\n"
    "body lid { shape = rectangle 0.4, up, 0.5, up + 0.02; lattice = square; spacing = 0.02; material = al\n"
    "           origin = 0.41, up + 0.01; motion = driven; velocity = slide, 0 }\n"
    "load push { body = lid; force_y = 0 us, -load, 1 us, -load; max_velocity = 1 }\n";

/* Kicks 2 to n - 1 of F/M dt: the path F/M dt^2 k (k + 1)/2 with k = n - 2, F t^2/2M but for one step. */
TEST(constant_force_and_weight)
{
    for (int weighs = 0; weighs < 2; weighs++) {
        struct engine g;
        const char *const defines[] = {weighs ? "a=1e-5" : "a=0", weighs ? "load=0" : "load=1e-6", NULL};
        start(&g, alone, defines, 1);
        const struct forced_axis *at = &g.model->forced[0].axis[1];
        double own = 5.0 * 2.7 * 0.02 * 0.02 * sqrt(0.75), force = weighs ? -own * 1e-5 : -1e-6;
        CHECK_NEAR_REL(at->weight, weighs ? force : 0.0, 1e-12);
        engine_run(&g, 1000);
        const struct control_state *s = &state_of(&g, 0)->axis[1];
        double dt = 0.006, k = 998.0, t = k * dt, M = at->control.mass;
        CHECK_NEAR_REL(s->shift, force / M * dt * dt * k * (k + 1.0) / 2.0, 1e-12);
        CHECK_NEAR_REL(s->shift, force * t * t / (2.0 * M), 1.1 / k);
        struct engine_state e = engine_collect(&g, false);
        const struct element *last = &e.e[e.n - 1];
        CHECK_NEAR(last->r[1], 0.61 + s->shift, 1e-15);
        CHECK_NEAR(last->r[0], 0.49 + 0.01 * 1000.0 * dt, 1e-14);
        CHECK_SAME_BITS(last->v[1], s->velocity);
        engine_state_free(&e);
        engine_stop(&g);
    }
}

/* Elements of a body under force feel those of a fixed body, with their own mass; the body comes to rest on
 * the floor, which bears the load. */
TEST(body_rests_on_the_floor)
{
    struct engine g;
    const char *const defines[] = {"load=1e-4", "up=0.1205", "slide=0", NULL};
    start(&g, alone, defines, 1);
    engine_run(&g, 10000);
    CHECK_NEAR_REL(force_on(&g, 0, 1), 1e-4, 1e-4);
    CHECK(state_of(&g, 0)->last.contacts >= 5);
    CHECK_NEAR(state_of(&g, 0)->axis[1].velocity, 0.0, 1e-8);
    engine_stop(&g);
}

/* The stress acts on the gap between two plates, one of which moves away at a constant speed. */
TEST(stress_between_two_bodies)
{
    struct engine g;
    start(
        &g,
        "domain { size = 1 1; r_c = 0.05; delta_r = 0.01 }\n"
        "time { dt = 0.006 us; steps = 1000 }\n"
        "body left { shape = rectangle 0.1, 0.1, 0.12, 0.3; lattice = square; spacing = 0.02; material = al\n"
        "            origin = 0.11, 0.11; motion = fixed }\n"
        "body right { shape = rectangle 0.5, 0.1, 0.52, 0.3; lattice = square; spacing = 0.02\n"
        "             material = al; origin = 0.51, 0.11; motion = driven; velocity = 0.01 0 }\n"
        "body low { shape = rectangle 0.2, 0.1, 0.4, 0.12; lattice = square; spacing = 0.02; material = al\n"
        "           origin = 0.21, 0.11; motion = driven }\n"
        "load push { body = low; stress_yy = 0 us 0.001 Mbar, 1 us 0.001 Mbar; between = right left\n"
        "            max_velocity = 1 }\n",
        NULL, 1);
    const struct forced_axis *at = &g.model->forced[0].axis[1];
    CHECK_NEAR(at->length, 0.38, 1e-15);
    CHECK_SAME_BITS(at->side, -1.0); /* a pull takes the lower body down */
    engine_run(&g, 3);
    double v = state_of(&g, 0)->axis[1].velocity, dt = 0.006, gap = 0.38 + 0.01 * 2.0 * dt;
    CHECK_NEAR_REL(v, -0.001 * gap / at->control.mass * dt, 1e-12);
    engine_stop(&g);
}

/* --- what a body that meets nothing does --- */

TEST(body_that_meets_nothing)
{
    struct engine g;
    char line[LOADING_LINE];
    start(&g, alone, NULL, 1);
    struct loading *l = subdomain_loading(g.sd[0]);
    l->body[0].axis[1].velocity = 0.9;
    enum dm2_status status = DM2_OK;
    int n = 0, warned = -1, warnings = 0;
    for (; n < 1000 && status == DM2_OK; n++) {
        status = loading_kick(l, &g.err);
        if (status == DM2_OK)
            loading_take(l, (const struct load_totals[FORCED_MAX]){{.contacts = 0}});
        if (loading_warns(l, line)) {
            warned = n;
            warnings++;
        }
    }
    CHECK_EQ_INT(status, DM2_NUMERIC);
    CHECK_EQ_INT(warnings, 1);
    CHECK_NEAR(warned * 0.9 * 0.006, 10 * 0.02, 0.01);
    CHECK_CONTAINS(line, "load 'push' has moved 'lid' by 0.2");
    CHECK_NEAR(l->body[0].axis[1].shift, 1.4, 0.01); /* its lower face two domains up */
    CHECK_CONTAINS(g.err.text, "load 'push' has moved 'lid' by 1.40");
    engine_stop(&g);
}

/* --- messages --- */

/* STEP and NEXT carry 1 + 68 n bytes more, and refuse no totals, too many, and totals that are cut. */
TEST(totals_in_messages)
{
    struct bytes_writer w = {0}, bare = {0};
    struct step_message step = {.step = 3, .n_loads = 2}, step_in = {.step = 0};
    struct next_message next = {.step = 3, .n_loads = 2}, next_in = {.step = 0};
    for (int i = 0; i < 2; i++) {
        step.loads[i] =
            (struct load_totals){.force = {{-1, 2}, {3, 4}}, .speed = {{5, 6}, {-7, 8}}, .contacts = 9};
        step.loads[i].force[0].hi -= i;
        next.loads[i] = step.loads[i];
    }
    message_put_step(&bare, &(struct step_message){.step = 3});
    message_put_step(&w, &step);
    CHECK_EQ_INT(w.length, bare.length + 1 + 2 * 68);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    message_get_step(&r, &step_in);
    CHECK(bytes_done(&r) && step_in.n_loads == 2);
    CHECK(memcmp(step_in.loads, step.loads, 2 * sizeof *step.loads) == 0);
    for (size_t cut = 0; cut < w.length; cut++) {
        r = bytes_reader_of(w.data, cut);
        message_get_step(&r, &step_in);
        CHECK(r.failed);
    }
    size_t at = w.length - 4 - 2 * 68 - 1;
    for (int n = 0; n <= FORCED_MAX + 1; n += FORCED_MAX + 1) {
        w.data[at] = (unsigned char)n;
        r = bytes_reader_of(w.data, w.length);
        message_get_step(&r, &step_in);
        CHECK(r.failed);
    }
    bytes_clear(&w);
    message_put_next(&w, &next);
    r = bytes_reader_of(w.data, w.length);
    message_get_next(&r, &next_in);
    CHECK(bytes_done(&r) && next_in.n_loads == 2);
    CHECK(memcmp(next_in.loads, next.loads, 2 * sizeof *next.loads) == 0);
    next.redo = true;
    bytes_clear(&w);
    message_put_next(&w, &next);
    r = bytes_reader_of(w.data, w.length);
    message_get_next(&r, &next_in);
    CHECK(r.failed);
    bytes_free(&w);
    bytes_free(&bare);
}

/* --- refusals --- */

/* The model refuses the bodies of `alone` with these interactions and this load, which is at line 14. */
static void refuse(const char *interactions, const char *load, const char *expected)
{
    char text[4000];
    struct dm2_error err = {0};
    struct model *model;
    int bodies = (int)(strstr(alone, "load push") - alone);
    (void)snprintf(text, sizeof text, "%s%s%.*s%s", material, interactions, bodies, alone, load);
    struct loaded deck = load_text(text, NULL, -1);
    CHECK_REPORT(deck.status == DM2_OK, "%s", deck.report.text);
    if (deck.status == DM2_OK) {
        CHECK_EQ_INT(model_build(&deck.config, &model, &err), DM2_DECK);
        CHECK_CONTAINS(err.text, expected);
        CHECK_CONTAINS(err.text, "deck:14:");
    }
    loaded_free(&deck);
}

TEST(loads_that_cannot_act)
{
    refuse("\n", "load a { body = lid; force_y = 0 us 1e-6, 1 us 1e-6; mass = 1e-9 g }", "give at least");
    refuse("\n", "load a { body = lid; force_y = 0 us 0, 1 us 0 }", "give `max_velocity`");
    refuse("\n", "load a { body = lid; stress_yy = 0 us 1e-6 Mbar, 1 us 1e-6 Mbar; between = lid floor }",
           "no gap along x between 'lid' and 'floor'");
    refuse("interaction al al { scope = all }\n", "load a { body = lid; force_y = 0 us 1e-6, 1 us 1e-6 }",
           "all interactions have scope linked");
}

TEST_MAIN(CASE(platen_reaches_its_stress), CASE(same_bits_on_all_ranks), CASE(constant_force_and_weight),
          CASE(body_rests_on_the_floor), CASE(stress_between_two_bodies), CASE(body_that_meets_nothing),
          CASE(totals_in_messages), CASE(loads_that_cannot_act))
