/* The generator: grains, powders, voids, flaws; and refusal of bodies that cannot be made. */
#include "engine_help.h"

#include "engine/generate.h"
#include "engine/grains.h"

#define HEAD                                                                                                 \
    "let phi = 0.6\n"                                                                                        \
    "domain { size = 1 1; r_c = 0.05; delta_r = 0.01; boundary = periodic free }\n"                          \
    "time { dt = 0.005; steps = 100 }\n"                                                                     \
    "material Cu { rho0 = 8.93; c0 = 0.394; s = 1.489; shear = 0.477; cp = 3.85e-6 }\n"                      \
    "material Al { rho0 = 2.703; c0 = 0.535; s = 1.34; shear = 0.276; cp = 8.97e-6 }\n"                      \
    "interaction { zeta = 0.1; ct_ratio = 0.02 }\n"
#define BODY "body b { shape = rectangle 0 0 1 1; spacing = 0.02; "

struct made {
    struct element *e;
    size_t n, cap;
};

static enum dm2_status keep(void *context, const struct element *e, struct dm2_error *err)
{
    struct made *m = context;
    (void)err;
    if (m->n == m->cap) {
        m->cap = 2 * m->cap + 64;
        m->e = realloc(m->e, m->cap * sizeof *m->e);
    }
    CHECK_EQ_INT(e->id, m->n);
    m->e[m->n++] = *e;
    return DM2_OK;
}

static struct made make(const char *text, const char *const *defines, struct engine *g)
{
    struct made m = {0};
    engine_load(g, text, defines, 1);
    CHECK_EQ_INT(generate_elements(g->model, keep, &m, &g->err), DM2_OK);
    CHECK_EQ_INT(m.n, model_elements(g->model));
    const struct model_estimate about = model_estimate(model_config(g->model));
    const struct grid *grid = model_grid(g->model);
    double n = (double)m.n, cells = (double)grid->cx * grid->cy;
    CHECK_REPORT(n < 1.02 * about.elements && n > about.elements / 4, "%g elements, about %g", n,
                 about.elements);
    CHECK_REPORT(n < 1.02 * about.places && about.places < 16 * about.elements, "%g of %g places", n,
                 about.places);
    CHECK_REPORT(cells <= about.cells && about.cells < 2 * cells + 8, "%g cells, about %g", cells,
                 about.cells);
    return m;
}

/* Shortest distance of two elements of different grains, of the same grain, in diameters; periodic in x. */
static void closest(const struct made *m, double same_other[2])
{
    same_other[0] = same_other[1] = INFINITY;
    for (size_t i = 0; i < m->n; i++) {
        for (size_t j = 0; j < i; j++) {
            double dx = m->e[i].r[0] - m->e[j].r[0], dy = m->e[i].r[1] - m->e[j].r[1];
            dx -= rint(dx);
            double r = sqrt(dx * dx + dy * dy) / 0.02;
            double *least = &same_other[m->e[i].grain != m->e[j].grain];
            *least = r < *least ? r : *least;
        }
    }
}

TEST(a_polycrystal_is_dense_and_does_not_overlap)
{
    static const char *const linked[2] = {
        HEAD BODY "material = Cu; structure = polycrystal; grain_size = 0.3; seed = 5 }\n"
                  "interface grain { linked = yes }\n",
        HEAD BODY "material = Cu; structure = polycrystal; grain_size = 0.3; seed = 5 }\n"};
    for (int k = 0; k < 2; k++) {
        struct engine g;
        struct made m = make(linked[k], NULL, &g);
        double d[2];
        closest(&m, d);
        CHECK_NEAR(d[0], 1.0, 1e-9);
        CHECK_REPORT(d[1] >= (k == 0 ? 0.8 : 1.0) - 1e-9 && d[1] < 1.1, "grains come as near as %g", d[1]);
        size_t bulk = (size_t)(1.0 / (0.02 * 0.02 * sqrt(0.75)));
        CHECK_REPORT(m.n > (k == 0 ? 93 : 88) * bulk / 100 && m.n < bulk, "%zu elements of %zu", m.n, bulk);
        CHECK_EQ_INT(m.e[m.n - 1].grain, 13); /* 1 cm2 in circles of 0.3 cm: 14 */
        free(m.e);
        engine_stop(&g);
    }
}

/* Every element belongs to the grain with the nearest seed. */
TEST(grains_are_voronoi_cells)
{
    struct engine g;
    struct grain_set set;
    struct made m =
        make(HEAD BODY "material = Cu; structure = polycrystal; grain_size = 0.3; seed = 9 }\n", NULL, &g);
    CHECK_EQ_INT(grains_build(model_config(g.model), 0, 0, 0.02, NULL, &set, &g.err), DM2_OK);
    CHECK(set.wraps[0] && !set.wraps[1]);
    for (size_t i = 0; i < m.n; i++) {
        size_t nearest = 0;
        double least = INFINITY;
        for (size_t k = 0; k < set.n; k++) {
            double dx = m.e[i].r[0] - set.grain[k].centre[0], dy = m.e[i].r[1] - set.grain[k].centre[1];
            dx -= rint(dx);
            if (dx * dx + dy * dy < least) {
                least = dx * dx + dy * dy;
                nearest = k;
            }
        }
        CHECK_EQ_INT(m.e[i].grain, nearest);
    }
    grains_free(&set);
    free(m.e);
    engine_stop(&g);
}

TEST(mixes_have_their_fractions)
{
    struct engine g;
    struct made m = make(HEAD BODY "mix = Cu 0.3, Al 0.7; seed = 2 }\n", NULL, &g);
    size_t copper = 0;
    for (size_t i = 0; i < m.n; i++) {
        copper += m.e[i].kind == 0;
        CHECK_NEAR(m.e[i].radius, 0.01, 0.0); /* one size: fractions by volume, too */
    }
    CHECK(m.n > 2500);
    CHECK_NEAR((double)copper / (double)m.n, 0.3, 0.03);
    free(m.e);
    engine_stop(&g);
}

/* Neighbours within a grain lie at multiples of 60 degrees to the grain's direction, and directions spread
 * over the 60 degrees of the lattice's symmetry. */
TEST(grains_have_orientations)
{
    struct engine g;
    struct grain_set set;
    struct made m =
        make(HEAD BODY "material = Cu; structure = polycrystal; grain_size = 0.12; seed = 3 }\n", NULL, &g);
    size_t rows = 0, thirds[3] = {0};
    CHECK_EQ_INT(grains_build(model_config(g.model), 0, 0, 0.02, NULL, &set, &g.err), DM2_OK);
    for (size_t i = 1; i < m.n; i++) {
        double dx = m.e[i].r[0] - m.e[i - 1].r[0], dy = m.e[i].r[1] - m.e[i - 1].r[1];
        if (m.e[i].grain != m.e[i - 1].grain || fabs(sqrt(dx * dx + dy * dy) - 0.02) > 1e-9)
            continue;
        const struct grain *grain = &set.grain[m.e[i].grain];
        double c = (dx * grain->cosine + dy * grain->sine) / 0.02, c2 = c * c;
        CHECK_NEAR(32 * c2 * c2 * c2 - 48 * c2 * c2 + 18 * c2 - 1, 1.0, 1e-9); /* cos 6 theta */
        rows++;
    }
    for (size_t k = 0; k < set.n; k++) {
        double turn = atan2(set.grain[k].sine, set.grain[k].cosine) / (3.14159265358979 / 3.0);
        CHECK(turn >= 0.0 && turn < 1.0);
        thirds[turn < 1.0 / 3.0 ? 0 : turn < 2.0 / 3.0 ? 1 : 2]++;
    }
    CHECK(rows > m.n / 2);
    CHECK(set.n > 60 && thirds[0] > set.n / 6 && thirds[1] > set.n / 6 && thirds[2] > set.n / 6);
    grains_free(&set);
    free(m.e);
    engine_stop(&g);
}

/* Linked or not, a polycrystal starts at rest without stress, and its first links are the links of the
 * lattice. */
TEST(a_polycrystal_starts_without_stress)
{
    struct engine one;
    engine_start(&one,
                 HEAD BODY "material = Cu; structure = polycrystal; grain_size = 0.3; seed = 5 }\n"
                           "interface grain { linked = yes }\n",
                 NULL, 1);
    struct measures m;
    engine_step(&one, &m);
    CHECK_NEAR(m.p_max, 0.0, 1e-12);
    CHECK_NEAR(m.p_min, 0.0, 1e-12);
    CHECK(m.links > m.elements * 27 / 10);
    engine_stop(&one);
}

static void check_same_on_ranks(const char *text, int64_t steps)
{
    struct engine one;
    engine_start(&one, text, NULL, 1);
    engine_run(&one, steps);
    struct engine_state want = engine_collect(&one, false);
    for (int ranks = 2; ranks <= 8; ranks += 3) {
        struct engine g;
        engine_start(&g, text, NULL, ranks);
        engine_run(&g, steps);
        struct engine_state got = engine_collect(&g, false);
        engine_check_same(&got, &want, "grains");
        engine_state_free(&got);
        engine_stop(&g);
    }
    engine_state_free(&want);
    engine_stop(&one);
}

TEST(every_rank_makes_the_same)
{
    check_same_on_ranks(
        HEAD BODY "material = Cu; structure = polycrystal; grain_size = 0.3; seed = 5; velocity = 0.1 0.1\n"
                  "jitter = 0.01; missing_links = 0.05 }\n"
                  "void hole { shape = disc 0.5 0.5 0.1 }\n flaw f { line = -0.1 0.2 0.2 0.3 }\n"
                  "interface grain { linked = yes }\n",
        40);
    check_same_on_ranks(HEAD BODY
                        "mix = Cu 0.5, Al 0.5; structure = discs; grain_size = 0.15; grain_spread = 0.3\n"
                        "solid_fraction = 0.62; jitter = 0.02 }\n",
                        40);
    check_same_on_ranks(HEAD BODY
                        "mix = Cu 0.5, Al 0.5; structure = polygons; grain_size = 0.15; grain_spread = 0.3\n"
                        "solid_fraction = 0.5; jitter = 0.02 }\n",
                        40);
}

TEST(powders_are_as_dense_as_asked_and_do_not_overlap)
{
    static const char *const deck[2] = {HEAD BODY "mix = Cu 0.5, Al 0.5; structure = discs; grain_size = "
                                                  "0.15; grain_spread = 0.4; solid_fraction = phi }\n",
                                        HEAD BODY "mix = Cu 0.5, Al 0.5; structure = polygons; grain_size = "
                                                  "0.15; grain_spread = 0.4; solid_fraction = phi }\n"};
    static const double phi[2] = {0.65, 0.5};
    const double cell = 0.02 * 0.02 * sqrt(0.75); /* of an element */
    for (int k = 0; k < 2; k++) {
        struct engine g;
        struct grain_set set;
        char define[32];
        snprintf(define, sizeof define, "phi=%g", phi[k]);
        const char *defines[] = {define, NULL};
        struct made m = make(deck[k], defines, &g);
        double d[2];
        closest(&m, d);
        CHECK_NEAR(d[0], 1.0, 1e-9);
        CHECK(d[1] >= 1.0 - 1e-6);
        CHECK_EQ_INT(grains_build(model_config(g.model), 0, 0, 0.02, NULL, &set, &g.err), DM2_OK);
        for (size_t i = 0; i < set.n; i++) { /* elements in the container, free in y */
            const struct grain *p = &set.grain[i];
            CHECK(p->reach <= p->radius && p->centre[1] - p->reach >= -1e-5 * 0.15 &&
                  p->centre[1] + p->reach <= 1.0 + 1e-5 * 0.15);
            CHECK(fabs(p->radius / 0.075 - 1.0) < 0.4 + 0.02);
        }
        CHECK_NEAR((double)m.n * cell, phi[k], 0.005 * phi[k]);
        for (size_t i = 1; i < m.n; i++) /* the mix is by grain */
            CHECK(m.e[i].grain != m.e[i - 1].grain || m.e[i].kind == m.e[i - 1].kind);
        grains_free(&set);
        free(m.e);
        engine_stop(&g);
    }
}

TEST(voids_hold_nothing)
{
    struct engine g;
    struct made m = make(HEAD BODY "material = Cu }\n"
                                   "void a { shape = disc 0.3 0.3 0.1 }\n"
                                   "void b { shape = rectangle 0.6 0.6 0.8 0.8; body = b }\n"
                                   "body c { shape = disc 0.7 0.7 0.05; spacing = 0.02; material = Al }\n",
                         NULL, &g);
    size_t inside = 0;
    for (size_t i = 0; i < m.n; i++) {
        double x = m.e[i].r[0] - 0.3, y = m.e[i].r[1] - 0.3;
        CHECK(x * x + y * y > 0.01);
        bool in_b = m.e[i].r[0] >= 0.6 && m.e[i].r[0] < 0.8 && m.e[i].r[1] >= 0.6 && m.e[i].r[1] < 0.8;
        CHECK_EQ_INT(m.e[i].body, in_b);
        inside += in_b;
    }
    CHECK(inside > 15);
    free(m.e);
    engine_stop(&g);
}

static size_t links_of(const char *text, int ranks)
{
    struct engine g;
    struct measures m;
    engine_start(&g, text, NULL, ranks);
    engine_step(&g, &m);
    size_t links = (size_t)m.links;
    engine_stop(&g);
    return links;
}

TEST(flaws_cut_links)
{
    /* The square lattice, 50 x 50 round in x: 50 links of a row across a column line; diagonals are not
     * linked. */
    static const char square[] = "row_spacing = 0.02; lattice = square; origin = 0.01 0.01; material = Cu; ";
    char text[1500];
    size_t whole, cut;
    snprintf(text, sizeof text, HEAD BODY "%s}\n", square);
    whole = links_of(text, 1);
    CHECK_EQ_INT(whole, 50 * 50 + 49 * 50);
    snprintf(text, sizeof text, HEAD BODY "%s}\nflaw f { line = 0.5 0.2 0.5 0.4 }\n", square);
    cut = links_of(text, 4);
    CHECK_EQ_INT(whole - cut, 10);
    /* At the seam, from both of its sides. */
    snprintf(text, sizeof text, HEAD BODY "%s}\nflaw f { line = 0.999 0.2 0.999 0.4; body = b }\n", square);
    CHECK_EQ_INT(whole - links_of(text, 4), 10);
    snprintf(text, sizeof text, HEAD BODY "%s}\nflaw f { line = 0.001 0.2 0.001 0.4 }\n", square);
    CHECK_EQ_INT(whole - links_of(text, 4), 10);
    snprintf(text, sizeof text, HEAD BODY "%smissing_links = 0.2; seed = 4 }\n", square);
    cut = links_of(text, 1);
    CHECK_NEAR((double)cut / (double)whole, 0.8, 0.02);
    CHECK_EQ_INT(links_of(text, 6), cut);
    snprintf(text, sizeof text, HEAD BODY "%smissing_links = 1 }\n", square);
    CHECK_EQ_INT(links_of(text, 3), 0);
}

static void check_refused(const char *rest, const char *message)
{
    char text[2000];
    struct model *model = NULL;
    struct dm2_error err;
    snprintf(text, sizeof text, HEAD "%s\n", rest);
    struct loaded l = load_text(text, NULL, -1);
    if (l.status == DM2_OK) { /* found only when the elements are generated */
        CHECK_EQ_INT(model_build(&l.config, &model, &err), DM2_DECK);
        CHECK_CONTAINS(err.text, message);
        model_free(model);
    } else {
        CHECK_EQ_INT(l.status, DM2_DECK);
        CHECK_CONTAINS(l.report.text, message);
    }
    loaded_free(&l);
}

TEST(what_cannot_be_made_is_refused)
{
    check_refused(BODY "material = Cu; structure = discs; grain_size = 0.2; solid_fraction = 0.95 }",
                  "the powder of the body 'b' cannot be packed to a solid fraction of 0.95");
    check_refused("body b { shape = disc 0.5 0.5 0.1; spacing = 0.02; material = Cu; structure = discs; "
                  "grain_size = 0.3; "
                  "solid_fraction = 0.5 }",
                  "a grain of ");
    check_refused(BODY "material = Cu; structure = discs; grain_size = 0.2 }",
                  "the body 'b' lacks 'solid_fraction'");
    check_refused(BODY "material = Cu; structure = polycrystal }", "the body 'b' lacks 'grain_size'");
    check_refused(BODY "material = Cu; structure = polycrystal; grain_size = 0.01 }",
                  "a grain of 0.01 cm is smaller than an element of 0.02 cm");
    check_refused(BODY "material = Cu; grain_size = 0.1 }",
                  "'grain_size' has no meaning for a body whose structure is crystal");
    check_refused(BODY "material = Cu; structure = polycrystal; grain_size = 0.1; solid_fraction = 0.5 }",
                  "'solid_fraction' has no meaning for a body whose structure is polycrystal");
    check_refused(BODY "material = Cu; structure = polycrystal; grain_size = 0.1; angle = 1 }",
                  "'angle' has no meaning");
    check_refused(
        "body b { shape = polygon 0 0 1 0 0 1; spacing = 0.02; material = Cu; structure = polygons; "
        "grain_size = 0.1; solid_fraction = 0.5 }",
        "a powder fills a rectangle or a disc, not a polygon");
    check_refused(BODY "material = Cu; structure = powder }", "'powder' is no value of 'structure'");
    check_refused(BODY "material = Cu; missing_links = 1.5 }",
                  "'missing_links' must be at least 0 and at most 1");
    check_refused(BODY "material = Cu }\nvoid v { shape = disc 3 3 0.1 }",
                  "the void 'v' lies outside every body");
    check_refused(BODY "material = Cu }\nvoid v { shape = disc 0.3 0.3 -1 }", "a disc is x y radius with");
    check_refused(BODY "material = Cu }\nvoid v { shape = disc 0.3 0.3 0.1; body = c }",
                  "there is no body 'c'");
    check_refused(BODY "material = Cu }\nvoid v { }", "the block 'void' lacks 'shape'");
    check_refused(BODY "material = Cu }\nflaw f { line = 2 2 3 3 }", "the flaw 'f' lies outside every body");
    check_refused(BODY "material = Cu }\nflaw f { line = 0.5 0.5 0.5 0.5 }",
                  "a line is x0 y0 x1 y1 between two points");
    check_refused(BODY "material = Cu }\nflaw f { line = 0.5 0.5 0.7 0.5; body = bb }",
                  "there is no body 'bb'");
    check_refused(BODY "material = Cu }\nvoid v { shape = rectangle -1 -1 2 2 }", "holds no element");
}

TEST_MAIN(CASE(a_polycrystal_is_dense_and_does_not_overlap), CASE(grains_are_voronoi_cells),
          CASE(mixes_have_their_fractions), CASE(grains_have_orientations),
          CASE(a_polycrystal_starts_without_stress), CASE(every_rank_makes_the_same),
          CASE(powders_are_as_dense_as_asked_and_do_not_overlap), CASE(voids_hold_nothing),
          CASE(flaws_cut_links), CASE(what_cannot_be_made_is_refused))
