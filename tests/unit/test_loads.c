/* Loads in time: integrals of tables, places and velocities of the elements that follow them, the energy
 * book, held temperatures, accelerations, spins, and the same bits on any number of ranks and from a state.
 */
#include <math.h>

#include "dm2/engine/section.h"
#include "engine/motion.h"
#include "engine/subdomain_parts.h"
#include "engine/tables.h"
#include "check.h"
#include "engine_help.h"
#include "scratch.h"

static const char head[] =
    "let n = 1\n"
    "domain { size = 4 4; origin = -1 -1; r_c = 0.16; delta_r = 0.02; boundary = periodic free }\n"
    "time { dt = 0.02 us / n; steps = 100 * n }\n"
    "material cu { rho0 = 8.93; c0 = 0.394; s = 1.489; cp = 3.8e-6; kappa = 4e-12 }\n"
    "material ni { rho0 = 4.5; c0 = 0.394; s = 1.489; cp = 3.8e-6 }\n";

static void start(struct engine *g, const char *rest, const char *const *defines, int ranks)
{
    char text[4000];
    (void)snprintf(text, sizeof text, "%s%s", head, rest);
    engine_start(g, text, defines, ranks);
}

/* --- tables --- */

/* The integral of a table from its first point to t, with 64 bits of mantissa and no prefix sums. */
static long double integral(const struct load_config *load, double t)
{
    long double sum = 0, from = load->time[0], to = t;
    size_t n = load->n;
    if (load->repeat) {
        long double period = (long double)load->time[n - 1] - from, whole = 0;
        for (size_t k = 1; k < n; k++)
            whole += ((long double)load->time[k] - load->time[k - 1]) *
                     ((long double)load->value[k] + load->value[k - 1]) / 2;
        long double turns = floorl((to - from) / period);
        sum = turns * whole;
        to -= turns * period;
    }
    if (to < from)
        return (to - from) * load->value[0];
    for (size_t k = 1; k < n; k++) {
        long double a = load->time[k - 1], b = load->time[k], v = load->value[k - 1];
        long double slope = ((long double)load->value[k] - v) / (b - a), u = (to < b ? to : b) - a;
        if (u > 0)
            sum += u * (v + slope * u / 2);
    }
    if (to > load->time[n - 1])
        sum += (to - load->time[n - 1]) * load->value[n - 1];
    return sum;
}

static const double *table_at(size_t n, double (*points)[2], double *to, int part)
{
    for (size_t k = 0; k < n; k++)
        to[k] = points[k][part];
    return to;
}

/* Some numbers between -1 and 1 that are no short fractions. */
static double odd(size_t k)
{
    double x = sin(12.9898 * (double)k + 78.233) * 43758.5453;
    return 2 * (x - floor(x)) - 1;
}

TEST(integrals_are_exact_to_rounding)
{
    static double points[1000][2], time[1000], value[1000];
    static const size_t sizes[] = {2, 3, 7, 100, 1000};
    for (size_t s = 0; s < 5; s++) {
        for (int repeat = 0; repeat < 2; repeat++) {
            size_t n = sizes[s];
            double t = -0.7, most = 0, scale = 0;
            for (size_t k = 0; k < n; k++) {
                points[k][0] = t += 0.001 + 0.5 * (1 + odd(k));
                points[k][1] = odd(k + 5000);
            }
            points[n - 1][1] = repeat ? points[0][1] : points[n - 1][1];
            struct load_config load = {.n = n, .repeat = repeat};
            load.time = (double *)table_at(n, points, time, 0);
            load.value = (double *)table_at(n, points, value, 1);
            struct config config = {.n_loads = 1, .loads = &load, .dt = 0.01};
            struct model m = {.config = &config};
            struct dm2_error err;
            CHECK_EQ_INT(motion_build(&m, &err), DM2_OK);
            for (size_t k = 0; k < 2000; k++) {
                double at = time[0] - 1 + (time[n - 1] - time[0] + 2) * (1 + odd(k)) * (repeat ? 2 : 0.5);
                long double want = integral(&load, at);
                scale = fmax(scale, (double)fabsl(want));
                most = fmax(most, fabs(motion_table_integral(&m.load_tables[0], at) - (double)want));
            }
            CHECK_REPORT(most <= 1e-14 * (1 + scale), "%zu points, repeat %d: off by %g of %g", n, repeat,
                         most, scale);
            for (size_t k = 0; k + 1 < n; k++)
                CHECK_SAME_BITS(motion_table_value(&m.load_tables[0], time[k]), value[k]);
            motion_free(&m);
        }
    }
}

/* 400,000 steps of r += v dt end 1e-10 cm off. */
TEST(steps_do_not_add_errors_up)
{
    struct engine g;
    struct rigid_motion at;
    start(&g,
          "body lid { shape = rectangle 0 0 1 0.5; spacing = 0.1; material = cu; motion = driven }\n"
          "load a { body = lid; velocity_y = 0 0, 0.3 0.7, 1.1 -0.2, 1.7 0; repeat = yes }\n",
          NULL, 1);
    motion_at(g.model, 0, 400000, &at);
    long double want = integral(&g.deck.config.loads[0], 400000 * 0.02);
    CHECK_REPORT(fabs(at.dy - (double)want) <= 1e-12, "off by %g", at.dy - (double)want);
    CHECK_SAME_BITS(at.dx, 0.0);
    engine_stop(&g);
}

/* --- places --- */

static const char moving[] = "body lid { shape = rectangle 2.2 0.5 3.4 0.9; spacing = 0.1; material = cu; "
                             "motion = driven; velocity = 0.9 0 }\n"
                             "body post { shape = rectangle 0 2.5 0.5 2.9; spacing = 0.1; material = cu; "
                             "motion = driven; velocity = 0.1 0.2 }\n"
                             "load a { body = lid; velocity_y = 0 us 0 cm/us, 0.5 us -0.1 cm/us, 3 us 0.3; "
                             "spin = 0 0.5, 1 1, 1.5 -2 }\n";

/* The place that the tables give an element of `lid`, on the x of its last turn. */
static void place(const struct engine *g, const struct element *e, int64_t step, long double r[2])
{
    const struct config *c = &g->deck.config;
    double t = (double)step * c->dt;
    long double angle = integral(config_load(c, 0, LOAD_SPIN), t);
    const double *centre = g->model->centroids;
    r[0] = centre[0] + 0.9L * t + (cosl(angle) * e->home[0] - sinl(angle) * e->home[1]);
    r[1] = centre[1] + integral(config_load(c, 0, LOAD_VELOCITY_Y), t) +
           (sinl(angle) * e->home[0] + cosl(angle) * e->home[1]);
}

/* The body goes across the periodic side and round the domain, and turns over. */
TEST(elements_are_where_the_integrals_put_them)
{
    static const char *const defines[] = {"n=5", NULL};
    struct engine g;
    double off = 0, late = 0;
    start(&g, moving, defines, 1);
    double dt = g.deck.config.dt;
    for (int64_t step = 0; step < 500; step++) {
        engine_run(&g, 1);
        struct engine_state s = engine_collect(&g, false);
        for (size_t k = 0; k < s.n && step % 50 == 49 && s.e[k].body == 0; k++) {
            const struct element *e = &s.e[k];
            long double want[2], before[2];
            place(&g, e, step + 1, want);
            place(&g, e, step, before);
            for (int a = 0; a < 2; a++) {
                double turned = (double)(e->r[a] + (a == 0 ? 4.0L * e->image[0] : 0) - want[a]);
                if (a == 0 && e->home[0] + g.model->centroids[0] >= 3) /* began beyond the side */
                    turned += 4;
                off = fmax(off, fabs(turned));
                late = fmax(late, fabs(e->v[a] - (double)((want[a] - before[a]) / dt)));
            }
            long double spin = (integral(config_load(&g.deck.config, 0, LOAD_SPIN), (double)(step + 1) * dt) -
                                integral(config_load(&g.deck.config, 0, LOAD_SPIN), (double)step * dt)) /
                               dt;
            late = fmax(late, fabs(e->w - (double)spin));
        }
        engine_state_free(&s);
    }
    CHECK_REPORT(off <= 1e-12, "places off by %g cm", off);
    CHECK_REPORT(late <= 1e-11, "velocities off by %g cm/us", late);
    engine_stop(&g);
}

/* `post` has a constant velocity and no load, in a deck with loads and in one without. */
TEST(bodies_without_loads_keep_their_bits)
{
    struct engine with, without;
    char text[2000];
    (void)snprintf(text, sizeof text, "%.*s", (int)(strstr(moving, "load a") - moving), moving);
    start(&with, moving, NULL, 1);
    start(&without, text, NULL, 1);
    engine_run(&with, 80);
    engine_run(&without, 80);
    struct engine_state a = engine_collect(&with, false), b = engine_collect(&without, false);
    CHECK_EQ_INT(a.n, b.n);
    for (size_t k = 0; k < a.n && k < b.n; k++)
        if (a.e[k].body == 1)
            CHECK(memcmp(a.e[k].r, b.e[k].r, sizeof a.e[k].r) == 0 &&
                  memcmp(a.e[k].v, b.e[k].v, sizeof a.e[k].v) == 0);
    engine_state_free(&a);
    engine_state_free(&b);
    engine_stop(&with);
    engine_stop(&without);
}

/* --- energy --- */

/* total at the end less total at the start, with dt over n. */
static double drift(const char *rest, const char *n)
{
    const char *defines[] = {n, NULL};
    struct engine g;
    struct measures first, last;
    start(&g, rest, defines, 1);
    int64_t steps = g.deck.config.steps;
    engine_step(&g, &first);
    engine_run(&g, steps - 1);
    engine_must(&g, engine_forces(&g, true));
    engine_must(&g, subdomain_measure_last(g.sd[0], &last, &g.err));
    double off = engine_total(&g, &last) - engine_total(&g, &first);
    engine_stop(&g);
    return off;
}

/* A block linked to a body that is moved, turned, accelerated and heated: the book closes as dt^2. */
static const char driven[] =
    "interaction { mu = 0; zeta = 0.1; kt_ratio = 0; linked = yes; link_break = 1.5 }\n"
    "body base { shape = rectangle 0 0 1 0.5; spacing = 0.1; material = cu; spin = 0.02 }\n"
    "body lid { shape = rectangle -0.6 0.5 1.4 0.9; spacing = 0.1; material = cu; motion = driven }\n"
    "load a { body = lid; velocity_y = 0 0, 1 -0.01, 3 0; velocity_x = 0 0, 0.6 0.01, 2 0; spin = 0 0.01, 1 "
    "0, 2 "
    "-0.01 }\n"
    "load h { body = base; acceleration_x = 0 0, 2 0.02, 4 -0.01; temperature = 0 300, 2 400 }\n";

TEST(the_book_closes_with_the_square_of_the_step)
{
    double one = drift(driven, "n=1"), two = drift(driven, "n=2"), four = drift(driven, "n=4");
    CHECK_REPORT(one / two > 3.8 && one / two < 4.2 && two / four > 3.8 && two / four < 4.2,
                 "drift %g, %g, %g with dt, dt/2, dt/4", one, two, four);
}

/* The heat of a held body is that of its temperature at each evaluation, and what flows off is work. */
TEST(a_held_temperature_is_the_table)
{
    static const char held[] =
        "interaction { linked = yes; conductance = 1e6 }\n"
        "body hot { shape = rectangle 0 0 0.5 0.5; spacing = 0.1; material = cu; temperature = 100 }\n"
        "body cold { shape = rectangle 0.5 0 1 0.5; spacing = 0.1; material = cu; temperature = 300 }\n"
        "load h { body = hot; temperature = 0 400, 1 600, 2 500 }\n";
    struct engine g;
    start(&g, held, NULL, 1);
    for (int64_t step = 0; step <= 100; step += 25) {
        double t = (double)step * 0.02, want = t <= 1 ? 400 + 200 * t : 600 - 100 * (t - 1), cold = 0;
        struct engine_state s = engine_collect(&g, false);
        for (size_t k = 0; k < s.n; k++) {
            double temperature = 300 + s.e[k].heat / (s.e[k].mass * 3.8e-6);
            if (s.e[k].body == 0)
                CHECK_REPORT(fabs(temperature - want) < 1e-9, "step %lld: %.12g K, expected %g",
                             (long long)step, temperature, want);
            else
                cold = fmax(cold, temperature);
        }
        CHECK(step == 0 ? cold == 300 : cold > 301);
        engine_state_free(&s);
        engine_run(&g, 25);
    }
    engine_stop(&g);
    CHECK(fabs(drift(held, "n=1")) < 1e-12);
}

/* --- accelerations and spins --- */

/* x(n) of the leapfrog from rest under a(t) = 0.02 t, in closed form. */
TEST(an_acceleration_moves_a_free_body)
{
    struct engine g;
    struct measures last;
    start(&g,
          "body free { shape = rectangle 0 0 0.5 0.5; spacing = 0.1; material = cu }\n"
          "body other { shape = rectangle 0 1 0.5 1.5; spacing = 0.1; material = cu }\n"
          "load a { body = free; acceleration_y = 0 0, 10 0.2 }\n",
          NULL, 1);
    struct engine_state s0 = engine_collect(&g, false);
    engine_run(&g, 100);
    struct engine_state s = engine_collect(&g, false);
    for (size_t k = 0; k < s.n; k++) {
        double moved = s.e[k].r[1] - s0.e[k].r[1], t = 2.0, dt = 0.02;
        double want = s.e[k].body == 0 ? 0.02 * (t * t * t - t * dt * dt) / 6 : 0;
        CHECK_REPORT(fabs(moved - want) < 1e-13, "body %u moved by %.17g, expected %.17g", s.e[k].body, moved,
                     want);
    }
    engine_must(&g, engine_forces(&g, true));
    engine_must(&g, subdomain_measure_last(g.sd[0], &last, &g.err));
    int shift = model_scales(g.model).energy;
    double kinetic = exact_value(&last.kinetic, shift), work = exact_value(&last.work, shift);
    CHECK_REPORT(kinetic > 0 && fabs(work / kinetic - 1) < 1e-3, "kinetic %g, work %g", kinetic, work);
    engine_state_free(&s0);
    engine_state_free(&s);
    engine_stop(&g);
}

/* A spin gives a body of two materials angular momentum, and no momentum: its centroid is its centre of mass.
 */
TEST(a_spin_is_about_the_centre_of_mass)
{
    struct engine g;
    start(
        &g,
        "body top { shape = disc 0.3 0.2 0.4; spacing = 0.1; mix = cu 0.5, ni 0.5; seed = 3; spin = 0.25 }\n",
        NULL, 1);
    struct engine_state s = engine_collect(&g, false);
    double p[2] = {0, 0}, mass = 0, centre[2] = {0, 0};
    for (size_t k = 0; k < s.n; k++) {
        mass += s.e[k].mass;
        for (int a = 0; a < 2; a++) {
            p[a] += s.e[k].mass * s.e[k].v[a];
            centre[a] += s.e[k].mass * s.e[k].r[a];
        }
    }
    for (int a = 0; a < 2; a++)
        CHECK(fabs(p[a]) < 1e-15 * mass && fabs(centre[a] / mass - g.model->centroids[a]) < 1e-15);
    for (size_t k = 0; k < s.n; k++) {
        const struct element *e = &s.e[k];
        CHECK_SAME_BITS(e->w, 0.25);
        CHECK(fabs(e->v[0] + 0.25 * (e->r[1] - centre[1] / mass)) < 1e-15);
        CHECK(fabs(e->v[1] - 0.25 * (e->r[0] - centre[0] / mass)) < 1e-15);
        CHECK(e->home[0] == 0 && e->home[1] == 0);
    }
    engine_state_free(&s);
    engine_stop(&g);
}

/* --- the same bits --- */

static const char crowd[] =
    "interaction { mu = 0.3; zeta = 0.1; kt_ratio = 0.5 }\n"
    "body base { shape = rectangle -1 -0.9 3 0; spacing = 0.1; material = cu; jitter = 0.01 }\n"
    "body lid { shape = rectangle 2.2 0.05 3.4 0.5; spacing = 0.1; material = cu; motion = driven; velocity "
    "= 0.9 0 }\n"
    "body rotor { shape = disc 0.5 0.4 0.4; spacing = 0.1; material = cu; motion = driven; spin = 1.5 }\n"
    "load a { body = lid; velocity_y = 0 us 0 cm/us, 0.5 us -0.1 cm/us, 3 us 0.3; spin = 0 0.5, 1 1, 1.5 -2 "
    "}\n"
    "load h { body = base; temperature = 0 300, 2 400; acceleration_x = 0 0, 2 0.02 }\n";

/* 40 steps on 2 ranks, then from the records on 3; a record that is elsewhere, and one that is missing. */
static void from_a_state(const struct engine_state *want)
{
    struct engine g, h;
    struct section_array sections[SECTION_COUNT] = {{.n = 0}};
    start(&g, crowd, NULL, 2);
    engine_run(&g, 40);
    struct engine_state half = engine_collect(&g, false);
    for (int r = 0; r < 2; r++)
        engine_must(&g, subdomain_collect_sections(g.sd[r], sections, &g.err));
    CHECK(sections[SECTION_HOME].n > 50 && sections[SECTION_HOME].n < half.n);
    start(&h, crowd, NULL, 3);
    for (size_t k = 0; k < half.n; k++) /* homes come from the section alone */
        half.e[k].home[0] = half.e[k].home[1] = 0;
    struct state_view view = {.step = 40,
                              .elements = half.e,
                              .n_elements = half.n,
                              .pairs = half.pair,
                              .n_pairs = half.n_pairs,
                              .sections = {sections[0], sections[1], sections[2]}};
    for (int r = 0; r < 3; r++) {
        subdomain_free(h.sd[r]);
        engine_must(&h, subdomain_restore(h.model, &h.map, r, &view, &h.sd[r], &h.err));
    }
    rebuild_plan_done(&h.plan);
    engine_run(&h, 60);
    struct engine_state got = engine_collect(&h, false);
    engine_check_same(&got, want, "from a state");
    engine_state_free(&got);
    struct subdomain *sd = NULL;
    struct home_record *records = sections[SECTION_HOME].records;
    records[3].home[0] += 1e-3;
    CHECK_EQ_INT(subdomain_restore(g.model, &g.map, 0, &view, &sd, &g.err) == DM2_OK &&
                     subdomain_restore(g.model, &g.map, 1, &view, &sd, &g.err) == DM2_OK,
                 0);
    CHECK_CONTAINS(g.err.text, "its home in section HOME puts it at");
    view.sections[SECTION_HOME].n = 3;
    CHECK_EQ_INT(subdomain_restore(g.model, &g.map, 0, &view, &sd, &g.err) == DM2_OK &&
                     subdomain_restore(g.model, &g.map, 1, &view, &sd, &g.err) == DM2_OK,
                 0);
    CHECK_CONTAINS(g.err.text, "has no record in section HOME");
    section_free(sections);
    engine_state_free(&half);
    engine_stop(&g);
    engine_stop(&h);
}

TEST(ranks_and_states_change_no_bit)
{
    static const int ranks[] = {1, 2, 3, 5};
    struct engine_state want = {0};
    for (int k = 0; k < 4; k++) {
        struct engine g;
        char what[20];
        (void)snprintf(what, sizeof what, "%d ranks", ranks[k]);
        start(&g, crowd, NULL, ranks[k]);
        g.ahead = true;
        engine_run(&g, 100);
        struct engine_state got = engine_collect(&g, false);
        CHECK(k == 0 || g.migrants > 20);
        if (k == 0)
            want = got;
        else
            engine_check_same(&got, &want, what);
        if (k > 0)
            engine_state_free(&got);
        engine_stop(&g);
    }
    from_a_state(&want);
    engine_state_free(&want);
}

/* After rebuilds the runs of slots are, in turn, those of bodies without and with drives. */
TEST(runs_are_the_slots_of_driven_bodies)
{
    for (int k = 0; k < 2; k++) {
        struct engine g;
        char text[1500];
        (void)snprintf(text, sizeof text, "%.*s", (int)(strstr(crowd, "load h") - crowd), crowd);
        start(&g, k == 0 ? text : crowd, NULL, 2);
        engine_run(&g, 60);
        CHECK(g.rebuilds > 0);
        size_t runs = 0;
        for (int r = 0; r < 2; r++) {
            const struct particles *p = &g.sd[r]->p;
            size_t run = 0, with = 0;
            for (size_t i = 0; i < p->n_own; i++) {
                const char *body = g.deck.config.bodies[p->body[i]].name;
                bool drives = k == 1 || strcmp(body, "base") != 0;
                while (run < p->runs->n && p->runs->edge[run] <= i)
                    run++;
                CHECK_EQ_INT(run % 2, drives);
                with += drives;
            }
            CHECK_EQ_INT(run, p->runs->n);
            CHECK(k == 1 ? run == 1 && with == p->n_own : with < p->n_own);
            runs += run;
        }
        CHECK(k == 1 || runs > 4);
        engine_stop(&g);
    }
}

/* --- files --- */

static const char filed[] =
    "domain { size = 4 4; r_c = 0.16; delta_r = 0.02 }\n"
    "time { dt = 0.02; steps = 100 }\n"
    "material cu { rho0 = 8.93; c0 = 0.394; s = 1.489 }\n"
    "body lid { shape = rectangle 0 0 1 1; spacing = 0.1; material = cu; motion = driven }\n";

/* A file gives the numbers of the same points in the deck, to the bit, in any unit. */
TEST(files_and_decks_give_the_same_numbers)
{
    char text[1000];
    scratch_begin();
    scratch_write("t.csv", "time [ns],velocity_y [km/s],\"spin [1/ms]\",velocity_x\r\n"
                           "0,0,0,-0.25\r\n100,-0.1,3.3,1e-3\r\n3e3,+7,-0.7,.5\r\n");
    (void)snprintf(text, sizeof text, "%sload a { repeat = no; file = \"t.csv\"; body = lid }\n", filed);
    scratch_write("file", text);
    (void)snprintf(text, sizeof text,
                   "%sload a { body = lid; velocity_y = 0 ns 0 km/s, 100 ns -0.1 km/s, 3e3 ns 7 km/s\n"
                   "spin = 0 ns 0, 100 ns 3.3e-3, 3e3 ns -0.7e-3;"
                   "velocity_x = 0 ns -0.25, 100 ns 1e-3, 3e3 ns .5 }\n",
                   filed);
    scratch_write("deck", text);
    struct loaded file = load_path(scratch_path("file"), NULL, -1),
                  deck = load_path(scratch_path("deck"), NULL, -1);
    CHECK_REPORT(file.status == DM2_OK && deck.status == DM2_OK, "%s%s", file.report.text, deck.report.text);
    CHECK_EQ_INT(file.config.n_loads, 3);
    CHECK_EQ_INT(deck.config.n_loads, 3);
    for (size_t i = 0; i < 3 && file.config.n_loads == 3 && deck.config.n_loads == 3; i++) {
        const struct load_config *a = &file.config.loads[i], *b = &deck.config.loads[i];
        CHECK_EQ_INT(a->quantity, b->quantity);
        CHECK_EQ_INT(a->n, 3);
        for (size_t k = 0; k < 3; k++)
            CHECK_REPORT(a->time[k] == b->time[k] && a->value[k] == b->value[k],
                         "load %zu, point %zu: %.17g %.17g and %.17g %.17g", i, k, a->time[k], a->value[k],
                         b->time[k], b->value[k]);
    }
    loaded_free(&file);
    loaded_free(&deck);
    scratch_end();
}

/* The most points are read and found; one more is refused. */
TEST(tables_have_up_to_100000_points)
{
    char *text = malloc(4000000);
    for (size_t n = LOAD_POINTS_MAX; n <= LOAD_POINTS_MAX + 1; n++) {
        size_t at = (size_t)sprintf(text, "time [us],velocity_y\n");
        for (size_t k = 0; k < n; k++)
            at += (size_t)sprintf(text + at, "%zu,%g\n", k, 1e-3 * (double)(k % 7));
        scratch_begin();
        scratch_write("t.csv", text);
        char deck[1000];
        (void)snprintf(deck, sizeof deck, "%sload a { body = lid; file = \"t.csv\" }\n", filed);
        scratch_write("deck", deck);
        struct loaded l = load_path(scratch_path("deck"), NULL, -1);
        CHECK_EQ_INT(l.status, n == LOAD_POINTS_MAX ? DM2_OK : DM2_DECK);
        if (l.status == DM2_OK)
            CHECK_EQ_INT(l.config.loads[0].n, n);
        else
            CHECK_CONTAINS(l.report.text, "'file' is 2 to 100000 points, found 100001");
        loaded_free(&l);
        scratch_end();
    }
    free(text);
}

TEST_MAIN(CASE(integrals_are_exact_to_rounding), CASE(steps_do_not_add_errors_up),
          CASE(elements_are_where_the_integrals_put_them), CASE(bodies_without_loads_keep_their_bits),
          CASE(the_book_closes_with_the_square_of_the_step), CASE(a_held_temperature_is_the_table),
          CASE(an_acceleration_moves_a_free_body), CASE(a_spin_is_about_the_centre_of_mass),
          CASE(ranks_and_states_change_no_bit), CASE(runs_are_the_slots_of_driven_bodies),
          CASE(files_and_decks_give_the_same_numbers), CASE(tables_have_up_to_100000_points))
