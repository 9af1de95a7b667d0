/* The strain measure against motions of known strain: homogeneous deformation, rigid rotation, a stretch in
 * many steps against the logarithm, neighbours on one line; and the same bits on any number of ranks. */
#include "engine_help.h"

#include <math.h>

static const char SHEET[] = "domain { size = 0.8 0.8; r_c = 0.1; delta_r = 0.03 }\n"
                            "time { dt = 0.01; steps = 50 }\n"
                            "material m { rho0 = 8; c0 = 0.4; s = 1.4 }\n"
                            "interaction { zeta = 0; link_break = 1.5 }\n"
                            "body sheet { shape = rectangle 0.1 0.1 0.7 0.7; spacing = 0.04; material = m }\n"
                            "output { strain = yes }\n";

/* x = x0 + G x0 with the velocity G x0/dt: the state that a homogeneous motion reaches in one step.
 * Positions are relative to the centre; `from` and `to` are n x 2. */
static void move(const struct engine_state *s, const double g[2][2], double dt, const double *from)
{
    for (size_t i = 0; i < s->n; i++) {
        for (int a = 0; a < 2; a++) {
            double x = from[2 * i] - 0.4, y = from[2 * i + 1] - 0.4, u = g[a][0] * x + g[a][1] * y;
            s->e[i].r[a] = from[2 * i + (size_t)a] + u;
            s->e[i].v[a] = u / dt;
        }
    }
}

static double *positions(const struct engine_state *s)
{
    double *r = malloc(2 * s->n * sizeof *r);
    for (size_t i = 0; i < 2 * s->n; i++)
        r[i] = s->e[i / 2].r[i % 2];
    return r;
}

/* sym(G (1 + G/2)^-1): the strain of one step x0 -> (1 + G) x0, measured midway. */
static void expected(const double g[2][2], double out[3])
{
    double m[2][2] = {{1 + g[0][0] / 2, g[0][1] / 2}, {g[1][0] / 2, 1 + g[1][1] / 2}};
    double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    double inverse[2][2] = {{m[1][1] / det, -m[0][1] / det}, {-m[1][0] / det, m[0][0] / det}}, l[2][2];
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            l[a][b] = g[a][0] * inverse[0][b] + g[a][1] * inverse[1][b];
    out[0] = l[0][0];
    out[1] = l[1][1];
    out[2] = 0.5 * (l[0][1] + l[1][0]);
}

static void check_strain(const struct engine_state *s, const double want[3], double tolerance,
                         const char *what)
{
    double worst = 0.0;
    for (size_t i = 0; i < s->n; i++)
        for (int c = 0; c < 3; c++)
            worst = fmax(worst, fabs(s->e[i].strain[c] - want[c]));
    printf("%s: strain (%.6g, %.6g, %.6g), worst error %.2g\n", what, want[0], want[1], want[2], worst);
    CHECK(s->n > 200);
    CHECK_REPORT(worst <= tolerance, "%s: off by %g", what, worst);
}

static void homogeneous(const double g[2][2], int ranks, const char *what)
{
    struct engine e;
    double want[3];
    engine_start(&e, SHEET, NULL, ranks);
    struct engine_state s = engine_collect(&e, false);
    double *r = positions(&s);
    move(&s, g, 0.01, r);
    engine_restore(&e, 1, &s);
    engine_must(&e, engine_forces(&e, false));
    engine_state_free(&s);
    s = engine_collect(&e, false);
    expected(g, want);
    check_strain(&s, want, 2e-13, what);
    free(r);
    engine_state_free(&s);
    engine_stop(&e);
}

TEST(a_homogeneous_motion_is_measured_exactly)
{
    const double uniaxial[2][2] = {{0, 0}, {0, -0.03}}, shear[2][2] = {{0, 0.02}, {0, 0}};
    const double any[2][2] = {{0.004, -0.013}, {0.021, -0.008}};
    homogeneous(uniaxial, 1, "uniaxial compression");
    homogeneous(shear, 1, "simple shear");
    homogeneous(any, 1, "any gradient");
    homogeneous(any, 4, "any gradient, 4 ranks");
}

TEST(a_rotation_strains_nothing)
{
    double c = cos(0.1), s = sin(0.1);
    const double turn[2][2] = {{c - 1, -s}, {s, c - 1}};
    homogeneous(turn, 2, "rotation by 0.1 radians");
}

TEST(many_small_steps_are_the_logarithm)
{
    enum { STEPS = 40 };
    struct engine e;
    engine_start(&e, SHEET, NULL, 3);
    struct engine_state s = engine_collect(&e, false);
    double *r = positions(&s);
    for (int k = 1; k <= STEPS; k++) {
        double before = 1 + 0.2 * (k - 1) / STEPS, now = 1 + 0.2 * k / STEPS;
        const double g[2][2] = {{now / before - 1, 0}, {0, 0}};
        move(&s, g, 0.01, r);
        free(r);
        engine_restore(&e, k, &s);
        engine_must(&e, engine_forces(&e, false));
        engine_state_free(&s);
        s = engine_collect(&e, false);
        r = positions(&s);
    }
    const double want[3] = {log(1.2), 0, 0};
    check_strain(&s, want, 1e-6, "a stretch by 20 % in 40 steps");
    free(r);
    engine_state_free(&s);
    engine_stop(&e);
}

TEST(neighbours_on_one_line_measure_nothing)
{
    static const char ROW[] =
        "domain { size = 0.8 0.2; r_c = 0.1; delta_r = 0.03 }\n"
        "time { dt = 0.01; steps = 50 }\n"
        "material m { rho0 = 8; c0 = 0.4; s = 1.4 }\n"
        "body row { shape = rectangle 0.1 0.1 0.7 0.12; spacing = 0.04; origin = 0 0.11;\n"
        "  material = m; jitter = 0.001 }\n"
        "output { strain = yes }\n";
    struct engine e;
    engine_start(&e, ROW, NULL, 1);
    engine_run(&e, 20);
    struct engine_state s = engine_collect(&e, false);
    CHECK_EQ_INT(s.n, 15);
    for (size_t i = 0; i < s.n; i++)
        CHECK(s.e[i].strain[0] == 0 && s.e[i].strain[1] == 0 && s.e[i].strain[2] == 0);
    engine_state_free(&s);
    engine_stop(&e);
}

/* A sheet that flies apart across a periodic seam, with elements that change their owner. */
static const char SEAM[] =
    "domain { size = 1.2 0.52; r_c = 0.1; delta_r = 0.02; boundary = periodic free;\n"
    "  rebuild_every = 3 }\n"
    "time { dt = 0.02; steps = 60 }\n"
    "material m { rho0 = 8; c0 = 0.4; s = 1.4; tensile = 0.01 }\n"
    "interaction { link_break = 1.05 }\n"
    "body a { shape = rectangle 0 0.05 1.2 0.25; spacing = 0.04; material = m;\n"
    "  velocity = 0.03 0.02; jitter = 0.02 }\n"
    "body b { shape = rectangle 0.3 0.3 0.9 0.5; spacing = 0.04; origin = 0 0.3; material = m;\n"
    "  velocity = -0.05 -0.02 }\n"
    "output { strain = yes }\n";

TEST(the_same_bits_on_any_number_of_ranks)
{
    struct engine one;
    engine_start(&one, SEAM, NULL, 1);
    engine_run(&one, 60);
    struct engine_state want = engine_collect(&one, false);
    double largest = 0;
    for (size_t i = 0; i < want.n; i++)
        largest = fmax(largest, fabs(want.e[i].strain[0]));
    printf("largest strain xx %.3g\n", largest);
    CHECK(largest > 0.01 && largest < 1);
    for (int ranks = 2; ranks <= 5; ranks += 3) {
        struct engine many;
        engine_start(&many, SEAM, NULL, ranks);
        engine_run(&many, 60);
        CHECK(many.migrants > 10);
        struct engine_state got = engine_collect(&many, false);
        engine_check_same(&got, &want, "strain, 60 steps");
        engine_state_free(&got);
        engine_stop(&many);
    }
    engine_state_free(&want);
    engine_stop(&one);
}

TEST(without_linked_or_touching_pairs_it_is_refused)
{
    struct loaded deck =
        load_text("domain { size = 20 20; r_c = 2.5; delta_r = 0.25 }\n"
                  "time { dt = 0.005; steps = 10 }\n"
                  "material atom { mass = 1 }\n"
                  "interaction { potential = lennard-jones; scope = all; epsilon = 1; sigma = 0.9;\n"
                  "  linked = no }\n"
                  "body sheet { shape = rectangle 1 1 9 9; spacing = 1; material = atom }\n"
                  "output { strain = yes }\n",
                  NULL, -1);
    struct model *model;
    struct dm2_error err = {0};
    CHECK_EQ_INT(deck.status, DM2_OK);
    CHECK_EQ_INT(model_build(&deck.config, &model, &err), DM2_DECK);
    CHECK_CONTAINS(err.text, "strain = yes measures the motion of linked or touching neighbours");
    loaded_free(&deck);
}

TEST_MAIN(CASE(a_homogeneous_motion_is_measured_exactly), CASE(a_rotation_strains_nothing),
          CASE(many_small_steps_are_the_logarithm), CASE(neighbours_on_one_line_measure_nothing),
          CASE(the_same_bits_on_any_number_of_ranks), CASE(without_linked_or_touching_pairs_it_is_refused))
