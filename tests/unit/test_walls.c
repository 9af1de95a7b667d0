/* Walls: an impact, sliding and rolling are those of a plane, whatever its orientation and its parts; corners
 * keep energy; heat; sums; the same bits on any number of ranks; what is refused. */
#include "engine_help.h"

#include "dm2/base/real.h"

enum { TEXT = 60000 };
static const double pi = 3.14159265358979324;

/* A line from a to b of so many equal parts, as a deck's values. */
static void write_line(char *out, const double a[2], const double b[2], int parts)
{
    size_t at = 0;
    for (int k = 0; k <= parts; k++) {
        double s = (double)k / parts;
        at += (size_t)snprintf(out + at, TEXT - at, "%s%.17g %.17g", k == 0 ? "" : ", ",
                               a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]));
    }
}

#define DISC                                                                                                 \
    "body disc { shape = rectangle %.17g %.17g %.17g %.17g; lattice = square; spacing = 1; origin = %.17g "  \
    "%.17g; radius = 0.5; material = a; velocity = %.17g %.17g }\n"
#define BOX(x, y) (x) - 0.1, (y)-0.1, (x) + 0.1, (y) + 0.1, (x), (y)

static const char *domain_text = "domain { size = 20 20; origin = -10 -10; r_c = 1.1; delta_r = 0.2 %s}\n"
                                 "time { dt = %.17g; steps = 100000 }\n"
                                 "material a { mass = 1; cp = 1; kappa = 1e-3 }\n"
                                 "interaction { potential = quadratic; k = 1; linked = no; %s }\n";

/* Element 0. */
static struct element first_element(struct engine *g)
{
    struct engine_state s = engine_collect(g, false);
    struct element e = s.e[0];
    engine_state_free(&s);
    return e;
}

/* --- impact --- */

struct impact {
    double depth, time, speed; /* over v sqrt(m/k), pi sqrt(m/k), v */
};

static struct impact hit(double angle, int parts, double zeta, const char *of)
{
    static char text[3 * TEXT], line[TEXT], law[80];
    const double dt = 0.01, v = 1e-3, n[2] = {-sin(angle), cos(angle)}, t[2] = {cos(angle), sin(angle)};
    const double a[2] = {0.3 - 4.0 * t[0], 0.2 - 4.0 * t[1]}, b[2] = {0.3 + 4.0 * t[0], 0.2 + 4.0 * t[1]};
    const double x = 0.3 + (0.5 + 0.5 * v * dt) * n[0], y = 0.2 + (0.5 + 0.5 * v * dt) * n[1];
    write_line(line, a, b, parts);
    snprintf(law, sizeof law, "zeta = %g", zeta);
    int at = snprintf(text, sizeof text, domain_text, "", dt, law);
    at += snprintf(text + at, sizeof text - (size_t)at, DISC, BOX(x, y), -v * n[0], -v * n[1]);
    snprintf(text + at, sizeof text - (size_t)at, "wall w { line = %s; %s }\n", line, of);
    struct engine g;
    struct impact out = {0};
    double k = strstr(of, "rigid") != NULL ? 2.0 : 1.0, contact = 0.0;
    engine_start(&g, text, NULL, 1);
    for (int step = 0; step < 500; step++) {
        engine_step(&g, NULL);
        struct element e = first_element(&g);
        double height = (e.r[0] - 0.3) * n[0] + (e.r[1] - 0.2) * n[1], up = e.v[0] * n[0] + e.v[1] * n[1];
        out.depth = fmax(out.depth, 0.5 - height);
        contact += height < 0.5 ? dt : 0.0;
        out.speed = up / v;
        CHECK_NEAR(e.v[0] * t[0] + e.v[1] * t[1], 0.0, 1e-13);
    }
    engine_stop(&g);
    out.depth /= v * sqrt(1.0 / k);
    out.time = contact / (pi * sqrt(1.0 / k));
    return out;
}

TEST(an_impact_is_that_of_a_plane)
{
    const double damped = exp(-0.3 / sqrt(0.91) * (pi - atan(0.6 * sqrt(0.91) / (1.0 - 0.18))));
    static const int parts[] = {1, 4, 97};
    for (int k = 0; k < 3; k++) {
        for (double angle = 0.0; angle < 6.0; angle += 0.7) {
            struct impact of = hit(angle, parts[k], 0.0, "material = a");
            CHECK_NEAR(of.depth, 1.0, 1e-4);
            CHECK_NEAR(of.time, 1.0, 5e-3);
            CHECK_NEAR(of.speed, 1.0, 1e-4);
        }
        CHECK_NEAR(hit(0.4, parts[k], 0.3, "material = a").speed, damped, 1e-3);
    }
    CHECK_NEAR(hit(1.1, 1, 0.0, "rigid = yes").depth, 1.0, 1e-4);
    CHECK_NEAR(hit(1.1, 4, 0.3, "rigid = yes").speed, damped, 1e-3);
}

/* --- slopes --- */

/* Acceleration along a slope over g, of one disc, or of a block: a triangular lattice of 4 and 3 linked
 * discs, which cannot roll as the discs of a row or a square lattice can. */
static double slide(double slope, double mu, bool block, int parts)
{
    static char text[3 * TEXT], line[TEXT], law[160], more[80];
    const double g = 1e-4, s = slope / sqrt(1.0 + slope * slope), c = 1.0 / sqrt(1.0 + slope * slope);
    const double a[2] = {-9.0 * c, 9.0 * s}, b[2] = {9.0 * c, -9.0 * s}, dt = 0.2;
    const double x = -6.0 * c + 0.5 * s, y = 6.0 * s + 0.5 * c, long_x = block ? 3.2 : 0.2,
                 long_y = block ? 1.0 : 0.2;
    const int more_steps = block ? 6 : 1;
    const double corner[4][2] = {{-0.2, -0.2}, {long_x, -0.2}, {long_x, long_y}, {-0.2, long_y}};
    snprintf(more, sizeof more, "; gravity = 0 %.17g", -g);
    snprintf(law, sizeof law, "zeta = 0.5; kt_ratio = 0.5; ct_ratio = 0.2; mu = %.17g", mu);
    write_line(line, a, b, parts);
    int at = snprintf(text, sizeof text, domain_text, more, dt, law);
    at +=
        snprintf(text + at, sizeof text - (size_t)at,
                 "interaction a a { linked = yes }\nbody block { spacing = 1; origin = %.17g %.17g; angle = "
                 "%.17g; radius = 0.5; material = a; shape = polygon",
                 x, y, -atan(slope));
    for (int k = 0; k < 4; k++)
        at += snprintf(text + at, sizeof text - (size_t)at, " %.17g %.17g",
                       x + corner[k][0] * c + corner[k][1] * s, y - corner[k][0] * s + corner[k][1] * c);
    snprintf(text + at, sizeof text - (size_t)at, " }\nwall w { line = %s; material = a }\n", line);
    struct engine e;
    double v[2];
    engine_start(&e, text, NULL, 1);
    for (int k = 0; k < 2; k++) {
        engine_run(&e, (k == 0 ? 400 : 600) * more_steps);
        struct engine_state state = engine_collect(&e, false);
        CHECK_EQ_INT(state.n, block ? 7 : 1);
        v[k] = 0.0;
        for (size_t i = 0; i < state.n; i++)
            v[k] += (state.e[i].v[0] * c - state.e[i].v[1] * s) / (double)state.n;
        engine_state_free(&state);
    }
    engine_stop(&e);
    return (v[1] - v[0]) / (600.0 * more_steps * dt) / g;
}

TEST(a_block_slides_by_coulomb_and_a_disc_rolls)
{
    static const int parts[] = {1, 97};
    for (int k = 0; k < 2; k++) {
        CHECK_NEAR(slide(0.29, 0.3, true, parts[k]), 0.0, 1e-6);
        double s = 0.35 / sqrt(1.0 + 0.35 * 0.35), c = 1.0 / sqrt(1.0 + 0.35 * 0.35);
        double got = slide(0.35, 0.3, true, parts[k]);
        CHECK_NEAR_REL(got, s - 0.3 * c, 0.01);
        CHECK_NEAR_REL(slide(0.35, 0.3, false, parts[k]), 2.0 / 3.0 * s, 0.002);
        s = 1.5 / sqrt(3.25);
        c = 1.0 / sqrt(3.25);
        CHECK_NEAR_REL(slide(1.5, 0.3, false, parts[k]), s - 0.3 * c, 0.002); /* 3 mu is 0.9: it slips */
    }
}

/* --- corners --- */

/* Largest change of the energy of an elastic disc in a polygon, over the energy. */
static double polygon_error(int sides, double dt, int steps)
{
    static char text[3 * TEXT], line[TEXT];
    size_t at = 0;
    for (int k = 0; k <= sides; k++) {
        double angle = 2.0 * pi * (k % sides) / sides;
        at += (size_t)snprintf(line + at, TEXT - at, "%s%.17g %.17g", k == 0 ? "" : ", ", 2.5 * cos(angle),
                               2.5 * sin(angle));
    }
    int n = snprintf(text, sizeof text, domain_text, "", dt, "zeta = 0");
    n += snprintf(text + n, sizeof text - (size_t)n, DISC, BOX(0.2, 0.1), 0.04, 0.017);
    snprintf(text + n, sizeof text - (size_t)n, "wall w { line = %s; material = a }\n", line);
    struct engine g;
    double most = 0.0, start = 0.5 * (0.04 * 0.04 + 0.017 * 0.017);
    engine_start(&g, text, NULL, 1);
    for (int step = 0; step < steps; step++) {
        struct measures m;
        engine_step(&g, &m);
        struct measure_scales s = model_scales(g.model);
        double total = exact_value(&m.kinetic, s.energy) + exact_value(&m.potential, s.energy);
        most = fmax(most, fabs(total / start - 1.0));
    }
    engine_stop(&g);
    return most;
}

TEST(corners_keep_energy)
{
    static const int sides[] = {3, 4, 20};
    for (int k = 0; k < 3; k++) {
        double one = polygon_error(sides[k], 0.1, 10000), quarter = polygon_error(sides[k], 0.025, 40000);
        printf("%d sides: %.3g, %.3g\n", sides[k], one, quarter);
        CHECK(one < 0.01);
        CHECK(quarter < one / 8.0);
    }
}

/* --- heat --- */

/* Heat of a disc that rests on a hot wall of so many parts, and the change of the total less the work. */
static double warm(int parts, double *drift)
{
    static char text[3 * TEXT], line[TEXT];
    const double a[2] = {-3.0, 0.0}, b[2] = {3.0, 0.0};
    write_line(line, a, b, parts);
    int n = snprintf(text, sizeof text, domain_text, "; gravity = 0 -1e-3", 0.1, "zeta = 0.5");
    n += snprintf(text + n, sizeof text - (size_t)n, DISC, BOX(0.0, 0.499), 0.0, 0.0);
    snprintf(text + n, sizeof text - (size_t)n, "wall w { line = %s; material = a; temperature = 400 }\n",
             line);
    struct engine g;
    struct measures m;
    engine_start(&g, text, NULL, 1);
    engine_step(&g, &m);
    double start = engine_total(&g, &m);
    engine_run(&g, 500);
    engine_step(&g, &m);
    *drift = engine_total(&g, &m) - start;
    struct element e = first_element(&g);
    engine_stop(&g);
    return e.heat;
}

TEST(heat_does_not_depend_on_the_parts)
{
    double drift[3], one = warm(1, &drift[0]);
    CHECK_NEAR_REL(warm(50, &drift[1]), one, 1e-12);
    CHECK_NEAR_REL(warm(51, &drift[2]), one, 1e-12);
    /* kappa A/r of the first touch: 1e-3/sqrt(3), little less than 100 K, 50 us */
    CHECK_NEAR_REL(one, 1e-3 / sqrt(3.0) * 100.0 * 50.1, 0.03);
    for (int k = 0; k < 3; k++)
        CHECK_NEAR(drift[k], 0.0, 1e-8);
}

/* --- moving walls, sums --- */

/* A powder between a line that closes across the periodic side, a turning square and a circle. */
static const char *const many =
    "domain { size = 12 12; origin = -6 -6; r_c = 0.45; delta_r = 0.05; boundary = periodic free; gravity = "
    "0 "
    "-4e-3 }\n"
    "time { dt = 0.02; steps = 100000 }\n"
    "material a { mass = 1e-2; cp = 1; kappa = 1e-4 }\n"
    "interaction { potential = quadratic; k = 1; linked = no; zeta = 0.1; mu = 0.5; kt_ratio = 0.3 }\n"
    "body b { shape = rectangle -6 -3.7 6 -2.5; spacing = 0.3; origin = 0.1 -3.7; radius = 0.145; material = "
    "a; "
    "jitter = 0.02; velocity = 0.1 0; seed = 3 }\n"
    "body c { shape = rectangle 1.25 2.85 2.75 4.1; spacing = 0.31; origin = 0 0; radius = 0.15; material = "
    "a; jitter = "
    "0.02; seed = 5 }\n"
    "wall floor { line = -6 -4 -5 -3.95 0 -4.2 3 -4 6 -4; material = a; temperature = 350; velocity = 0.03 0 "
    "}\n"
    "wall stirrer { line = -1 -2.4 0 -2.4 0 -1.4 -1 -1.4 -1 -2.4; rigid = yes; spin = 0.1; velocity = 0 "
    "-0.02 }\n"
    "wall ring { circle = 2 3.5 1.2; material = a; spin = -0.2 }\n";

/* The whole memory of wall contacts, as in a state. */
static struct section_array collect_contacts(struct engine *g)
{
    struct section_array all[SECTION_COUNT] = {{.n = 0}};
    for (int r = 0; r < g->map.ranks; r++)
        engine_must(g, subdomain_collect_sections(g->sd[r], all, &g->err));
    engine_must(g, section_sort(SECTION_WCON, &all[SECTION_WCON], &g->err));
    return all[SECTION_WCON];
}

static void check_same_contacts(const struct section_array *got, const struct section_array *want)
{
    CHECK_EQ_INT(got->n, want->n);
    for (size_t k = 0; k < got->n && k < want->n; k++) {
        const struct wall_contact *x = section_record(SECTION_WCON, got, k),
                                  *y = section_record(SECTION_WCON, want, k);
        CHECK(x->id == y->id && x->feature == y->feature && x->sign == y->sign);
        CHECK_SAME_BITS(x->spring, y->spring);
    }
}

TEST(same_bits_on_any_number_of_ranks)
{
    struct engine_state want = {0};
    struct section_array contacts = {0};
    struct wall_sums sums[3];
    static const char *const rebuilds[] = {"", "; rebuild_every = 1", "; rebuild_every = 7"};
    for (int ranks = 1; ranks <= 8; ranks++) {
        char text[3000];
        struct engine g;
        size_t at = (size_t)(strchr(many, '}') - many);
        snprintf(text, sizeof text, "%.*s%s%s", (int)at, many, rebuilds[ranks % 3], many + at);
        engine_start(&g, text, NULL, ranks);
        g.ahead = ranks % 2 == 0;
        engine_run(&g, 1500);
        struct engine_state state = engine_collect(&g, false);
        struct section_array here = collect_contacts(&g);
        engine_must(&g, engine_forces(&g, true));
        struct wall_sums part[3] = {{.contacts = 0}};
        for (int r = 0; r < ranks; r++)
            for (int w = 0; w < 3; w++)
                wall_sums_merge(&part[w], &subdomain_wall_sums(g.sd[r])[w]);
        if (ranks == 1) {
            want = state;
            contacts = here;
            memcpy(sums, part, sizeof sums);
            printf("%zu elements, %zu wall contacts\n", want.n, contacts.n);
            CHECK(contacts.n > 10);
            for (int w = 0; w < 3; w++)
                CHECK(sums[w].contacts > 0);
        } else {
            CHECK(g.migrants > 0);
            engine_check_same(&state, &want, "ranks");
            check_same_contacts(&here, &contacts);
            CHECK(memcmp(part, sums, sizeof sums) == 0);
            engine_state_free(&state);
            free(here.records);
        }
        engine_stop(&g);
    }
    engine_state_free(&want);
    free(contacts.records);
}

/* From the records of a state the run goes on as without a break. */
TEST(a_state_holds_the_memory_of_contacts)
{
    struct engine g, h;
    engine_start(&g, many, NULL, 3);
    engine_run(&g, 1200);
    struct engine_state middle = engine_collect(&g, false);
    struct section_array contacts = collect_contacts(&g);
    engine_run(&g, 300);
    engine_load(&h, many, NULL, 2);
    for (int r = 0; r < 2; r++) {
        struct state_view view = {.step = 1200,
                                  .elements = middle.e,
                                  .n_elements = middle.n,
                                  .pairs = middle.pair,
                                  .n_pairs = middle.n_pairs};
        view.sections[SECTION_WCON] = contacts;
        engine_must(&h, subdomain_restore(h.model, &h.map, r, &view, &h.sd[r], &h.err));
    }
    engine_run(&h, 300);
    struct engine_state one = engine_collect(&g, false), other = engine_collect(&h, false);
    engine_check_same(&other, &one, "restart");
    engine_state_free(&one);
    engine_state_free(&other);
    engine_state_free(&middle);
    free(contacts.records);
    engine_stop(&g);
    engine_stop(&h);
}

/* Over all elements and walls forces sum to zero in integers: what the walls feel is what the elements lack.
 */
TEST(the_sums_of_walls_are_those_of_the_elements)
{
    struct engine g;
    struct measures before, after;
    engine_start(&g, many, NULL, 1);
    engine_run(&g, 1500);
    engine_step(&g, &before);
    struct wall_load load = {{0}, 0, 0};
    double mass = 0.0;
    engine_must(&g, engine_forces(&g, true));
    for (int w = 0; w < 3; w++) {
        struct wall_load one = subdomain_wall_load(g.model, &subdomain_wall_sums(g.sd[0])[w]);
        load.force[0] += one.force[0];
        load.force[1] += one.force[1];
    }
    struct engine_state was = engine_collect(&g, false);
    engine_must(&g, engine_move(&g, &after));
    struct engine_state is = engine_collect(&g, false);
    double gained[2] = {0.0, 0.0}, dt = 0.02;
    for (size_t k = 0; k < is.n; k++) {
        mass += is.e[k].mass;
        for (int a = 0; a < 2; a++)
            gained[a] += is.e[k].mass * (is.e[k].v[a] - was.e[k].v[a]) / dt;
    }
    CHECK_NEAR(gained[0], -load.force[0], 1e-11);
    CHECK_NEAR(gained[1], -load.force[1] - 4e-3 * mass, 1e-11);
    engine_state_free(&was);
    engine_state_free(&is);
    engine_stop(&g);
}

/* The energy that moving walls put in is in the book: the error of an elastic, frictional run falls with the
 * time step. */
TEST(the_work_of_moving_walls_is_booked)
{
    double error[2], put_in[2];
    for (int k = 0; k < 2; k++) {
        char text[3000];
        struct engine g;
        struct measures m;
        const char *dt = strstr(many, "dt = 0.02;");
        snprintf(text, sizeof text, "%.*sdt = %s;%s", (int)(dt - many), many, k == 0 ? "0.02" : "0.01",
                 dt + 10);
        engine_start(&g, text, NULL, 1);
        engine_step(&g, &m);
        double start = engine_total(&g, &m);
        error[k] = 0.0;
        for (int step = 0; step < (k == 0 ? 30 : 60); step++) {
            engine_run(&g, 50);
            engine_step(&g, &m);
            error[k] = fmax(error[k], fabs(engine_total(&g, &m) - start));
        }
        put_in[k] = exact_value(&m.work, model_scales(g.model).energy);
        printf("book off by %.3g of %.3g that the walls put in\n", error[k], put_in[k]);
        CHECK(fabs(put_in[k]) > 0.01);
        CHECK(error[k] < 1e-3 * fabs(put_in[k]));
        engine_stop(&g);
    }
    CHECK(error[1] < 0.7 * error[0]);
}

/* --- what is refused --- */

static void check_refused(const char *domain, const char *rest, const char *message)
{
    char text[3000];
    struct model *model = NULL;
    struct dm2_error err;
    int at = snprintf(text, sizeof text, domain_text, domain, 0.01, "zeta = 0");
    at += snprintf(text + at, sizeof text - (size_t)at, DISC, BOX(0.0, 0.0), 0.0, 0.0);
    snprintf(text + at, sizeof text - (size_t)at, "%s\n", rest);
    struct loaded l = load_text(text, NULL, -1);
    if (l.status == DM2_OK) {
        CHECK_EQ_INT(model_build(&l.config, &model, &err), DM2_DECK);
        CHECK_CONTAINS(err.text, message);
        model_free(model);
    } else {
        CHECK_EQ_INT(l.status, DM2_DECK);
        CHECK_CONTAINS(l.report.text, message);
    }
    loaded_free(&l);
}

TEST(what_walls_cannot_be_is_refused)
{
    static const char *const seam = "; boundary = periodic free ";
    check_refused("", "wall w { material = a }", "lacks `line` or `circle`");
    check_refused("", "wall w { circle = 0 0 3 }", "lacks `material` or `rigid`");
    check_refused("", "wall w { circle = 0 0 3; line = 0 0 1 1; material = a }", "either `line` or `circle`");
    check_refused("", "wall w { circle = 0 0 3; rigid = yes; material = a }", "either `material` or `rigid`");
    check_refused("", "wall w { circle = 0 0 3; material = b }", "there is no material 'b'");
    check_refused("", "wall disc { circle = 0 0 3; material = a }", "there is a body 'disc'");
    check_refused("", "wall w { circle = 0 0 3; material = a }\nwall w { circle = 0 0 4; material = a }",
                  "there is a wall 'w' before");
    check_refused("", "wall w { circle = 0 0 0; material = a }", "must be greater than 0 cm");
    check_refused(seam, "wall w { circle = 0 0 9.5; material = a }", "meets its own image");
    check_refused("", "wall w { line = 0 0; material = a }", "at least 2 points: found 2");
    check_refused("", "wall w { line = 0 0 1; material = a }", "one is without its pair");
    check_refused("", "wall w { line = 0 3 1 3 1 3 4 4; material = a }", "comes twice in a row");
    check_refused("", "wall w { line = 0 3 1 us 3; material = a }",
                  "'line' is a length (cm), this is a time (us)");
    check_refused(seam, "wall w { line = -10 -3 11 -3; material = a }", "at most as long as the domain");
    check_refused(seam, "wall w { line = -10 -3 0 -4 10 -3; material = a; spin = 0.1 }", "cannot turn");
    check_refused("", "wall w { circle = 0 0 3; rigid = yes }\ninteraction a a { scope = all }", "scope");
    check_refused("", "wall w { circle = 0 0 3; material = a; temperature = -1 }", "'temperature' must be");
}

TEST(what_ends_a_run_names_element_and_wall)
{
    static const struct {
        double y, vy, speed; /* speed: of the wall, along y */
        int steps;
        enum dm2_status status;
        const char *message;
    } end[] = {{0.2, 0.0, 0.0, 1, DM2_DECK,
                "element 0, at (0, 0.2) cm at the start, is 0.6 of its radius deep in the "
                "wall 'w'; at most half"},
               {0.6, -20.0, 0.0, 5, DM2_DECK, "moves by 0.4 of its radius in a step against the wall 'w'"},
               {0.9, -3.0, 0.0, 100, DM2_NUMERIC, "of its radius deep in the wall 'w'; at most half"},
               {3.0, 0.0, 500.0, 5, DM2_NUMERIC, "step 0: the wall 'w' would move by 5 cm in one step"}};
    for (size_t k = 0; k < sizeof end / sizeof end[0]; k++) {
        char text[3000];
        struct engine g;
        enum dm2_status status = DM2_OK;
        int at = snprintf(text, sizeof text, domain_text, "", 0.01, "zeta = 0");
        at += snprintf(text + at, sizeof text - (size_t)at, DISC, BOX(0.0, end[k].y), 0.0, end[k].vy);
        snprintf(text + at, sizeof text - (size_t)at,
                 "wall w { line = -4 0 4 0; material = a; velocity = 0 %g }\n", end[k].speed);
        engine_start(&g, text, NULL, 1);
        for (int step = 0; step < end[k].steps && status == DM2_OK; step++) {
            status = engine_forces(&g, false);
            if (status == DM2_OK)
                status = engine_move(&g, NULL);
        }
        CHECK_EQ_INT(status, end[k].status);
        CHECK_CONTAINS(g.err.text, end[k].message);
        engine_stop(&g);
    }
}

/* The damping against a wall has m_eff = m_i, here beside fixed elements of the wall's material that weigh
 * nothing; the limit now is that of the one contact. */
TEST(walls_count_in_the_stable_step)
{
    struct engine g;
    struct measures m;
    char text[3000];
    const char *which;
    int at = snprintf(text, sizeof text, domain_text, "", 0.01, "zeta = 0");
    at += snprintf(text + at, sizeof text - (size_t)at, DISC, BOX(0.0, 0.499), 0.0, 0.0);
    snprintf(text + at, sizeof text - (size_t)at,
             "material light { mass = 1e-4 }\ninteraction a light { zeta = 0.9 }\nbody far { shape = disc 8 "
             "8 0.1; spacing = 1; origin = 8 8; "
             "motion = fixed; material = light }\nwall w { line = -4 0 4 0; material = light }\n");
    engine_start(&g, text, NULL, 1);
    CHECK_NEAR_REL(model_stable_dt(g.model, &which), 4.0 / (sqrt(5.4 * 5.4 + 12.0) + 5.4), 1e-12);
    CHECK_STR(which, "damping against a wall");
    engine_step(&g, &m);
    double damped = 0.01 * 2.0 * 0.9; /* with f^2/4 + 0.9 f = 1 at the limit f sqrt(m/k) */
    CHECK_NEAR_REL(m.dt_share, 0.5 * (0.5 * damped + sqrt(0.25 * damped * damped + 1e-4)), 1e-6);
    CHECK_NEAR(m.compression, 0.001, 1e-9);
    CHECK_EQ_INT(m.contacts, 1);
    engine_stop(&g);
}

TEST_MAIN(CASE(an_impact_is_that_of_a_plane), CASE(a_block_slides_by_coulomb_and_a_disc_rolls),
          CASE(corners_keep_energy), CASE(heat_does_not_depend_on_the_parts),
          CASE(same_bits_on_any_number_of_ranks), CASE(a_state_holds_the_memory_of_contacts),
          CASE(the_sums_of_walls_are_those_of_the_elements), CASE(the_work_of_moving_walls_is_booked),
          CASE(what_walls_cannot_be_is_refused), CASE(what_ends_a_run_names_element_and_wall),
          CASE(walls_count_in_the_stable_step))
