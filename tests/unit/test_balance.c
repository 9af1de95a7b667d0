/* The balance of forces, the coordination and the fabric of a row of the history: cases with known numbers,
 * and the same bits on any number of ranks, as links and as loose discs. */
#include "engine_help.h"

#include <math.h>

/* A fixed disc, and a free one 0.95 contact distances above it along (0.6, 0.8), pushed off by 0.05 k r0. */
static const char TWO[] =
    "domain { size = 1 1; r_c = 0.15; delta_r = 0.02; gravity = PULL }\n"
    "time { dt = 0.001; steps = 10 }\n"
    "material m { mass = 2 }\n"
    "interaction { potential = quadratic; k = 3; linked = no }\n"
    "body base { shape = disc 0.4 0.4 0.01; origin = 0.4 0.4; spacing = 0.1; material = m; motion = fixed }\n"
    "body ball { shape = disc 0.457 0.476 0.01; origin = 0.457 0.476; spacing = 0.1; material = m }\n";

static struct measures measure(struct engine *g)
{
    struct measures m;
    engine_step(g, &m);
    return m;
}

/* pull: the gravity; load: a block that acts on the free disc. */
static struct measures two_discs(const char *pull, const char *load)
{
    char text[sizeof TWO + 160];
    const char *at = strstr(TWO, "PULL");
    struct engine g;
    snprintf(text, sizeof text, "%.*s%s%s%s", (int)(at - TWO), TWO, pull, at + 4, load);
    engine_start(&g, text, NULL, 1);
    struct measures m = measure(&g);
    double fabric[3];
    measures_fabric(&m, fabric);
    CHECK_NEAR(measures_coordination(&m), 1, 0);
    CHECK_NEAR(fabric[0], 0.36, 1e-11);
    CHECK_NEAR(fabric[1], 0.64, 1e-11);
    CHECK_NEAR(fabric[2], 0.48, 1e-11);
    struct measure_scales scales = model_scales(g.model);
    CHECK_NEAR(exact_value(&m.magnitudes, scales.force), 3 * 0.005, 1e-12);
    m.dt_share = measures_unbalanced(&m, &scales);
    engine_stop(&g);
    return m;
}

TEST(two_discs_along_a_line)
{
    CHECK_NEAR(two_discs("0 0", "").dt_share, 1, 1e-10);
    /* the weight of the free disc is the force, or half of it */
    CHECK_NEAR(two_discs("-0.6*0.0075 -0.8*0.0075", "").dt_share, 0, 1e-10);
    CHECK_NEAR(two_discs("-0.6*0.00375 -0.8*0.00375", "").dt_share, 0.5, 1e-10);
    /* a load's acceleration balances as the weight does */
    CHECK_NEAR(two_discs("0 0", "load push { body = ball; acceleration_x = 0 -0.0045, 1 -0.0045;\n"
                                "  acceleration_y = 0 -0.006, 1 -0.006 }\n")
                   .dt_share,
               0, 1e-10);
}

/* A lattice: all pairs within and between its bodies count once, whoever owns them. */
static const char LATTICE[] =
    "domain { size = 0.8 0.6; r_c = 0.1; delta_r = 0.02; boundary = periodic free; gravity = 0 -1e-5 }\n"
    "time { dt = 0.01; steps = 40 }\n"
    "material heavy { rho0 = 8; c0 = 0.4; s = 1.4; cp = 4e-6; yield = 2e-3; tensile = 4e-3; shear = 0.2 }\n"
    "material light { rho0 = 2; c0 = 0.5; s = 1.3; cp = 9e-6; shear = 0.1 }\n"
    "interaction { zeta = 0.1; mu = 0.3; LINKED }\n"
    "body low { shape = rectangle 0 0.01 0.8 0.21; spacing = 0.04; origin = 0.01 0.02; material = heavy;\n"
    "  velocity = 0.01 0.04; jitter = 0.01 }\n"
    "body mid { shape = rectangle 0 0.21 0.8 0.31; spacing = 0.04; origin = 0.01 0.02; material = heavy;\n"
    "  motion = driven; velocity = 0.001 -0.01 }\n"
    "body high { shape = rectangle 0 0.31 0.8 0.4; spacing = 0.04; origin = 0.01 0.02; material = light }\n";

static void start_lattice(struct engine *g, const char *linked, int ranks)
{
    char text[sizeof LATTICE + 60];
    const char *at = strstr(LATTICE, "LINKED");
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - LATTICE), LATTICE, linked, at + 6);
    engine_start(g, text, NULL, ranks);
}

static void compare_ranks(const char *linked)
{
    struct engine one, many;
    struct measures want[3], got;
    for (int ranks = 1; ranks <= 5; ranks++) {
        struct engine *g = ranks == 1 ? &one : &many;
        start_lattice(g, linked, ranks);
        for (int row = 0; row < 3; row++) {
            engine_run(g, 9);
            got = measure(g);
            if (ranks == 1)
                want[row] = got;
            CHECK(got.pairs == want[row].pairs && got.loaded_pairs == want[row].loaded_pairs);
            CHECK_EQ_INT(got.free_elements, want[row].free_elements);
            CHECK(memcmp(got.fabric, want[row].fabric, sizeof got.fabric) == 0);
            CHECK(memcmp(&got.resultants, &want[row].resultants, sizeof got.resultants) == 0);
            CHECK(memcmp(&got.magnitudes, &want[row].magnitudes, sizeof got.magnitudes) == 0);
            CHECK(got.pairs > 100 && got.loaded_pairs > 50 && got.pairs > got.loaded_pairs);
            CHECK(measures_unbalanced(&got, &(struct measure_scales){.force = 40}) > 0);
        }
        engine_stop(g);
    }
}

TEST(ranks_agree_on_links)
{
    compare_ranks("linked = yes");
}

TEST(ranks_agree_on_loose_discs)
{
    compare_ranks("linked = no");
}

/* Rows of 20 elements round the period: 3 pairs an element but for the last row, all at 0, 60 and 120
 * degrees. */
TEST(a_lattice_has_an_isotropic_fabric)
{
    struct engine g;
    start_lattice(&g, "linked = yes", 2);
    struct measures m = measure(&g);
    double fabric[3], rows = (double)m.elements / 20;
    CHECK_EQ_INT(m.pairs, 3 * m.elements - 2 * 20);
    CHECK_NEAR(measures_coordination(&m), 2 * (3 - 2 / rows), 1e-14);
    measures_fabric(&m, fabric);
    double along = (double)m.elements, slant = 2 * (double)(m.elements - 20);
    CHECK_NEAR(fabric[0], (along + 0.25 * slant) / (along + slant), 1e-9);
    CHECK_NEAR(fabric[0] + fabric[1], 1, 0x1p-52);
    CHECK_NEAR(fabric[2], 0, 1e-9);
    engine_stop(&g);
}

/* The pairs of a potential of scope `all` are not measured one by one. */
TEST(no_balance_with_a_potential_of_scope_all)
{
    struct engine g;
    engine_start(
        &g,
        "domain { size = 9 9; r_c = 2.5; delta_r = 0.25 }\n"
        "time { dt = 0.005; steps = 100 }\n"
        "material a { mass = 1 }\n"
        "interaction { potential = lennard-jones; scope = all; epsilon = 1; sigma = 0.9; cutoff = 2.5; "
        "linked = no }\n"
        "body block { shape = rectangle 0 0 9 9; spacing = 1; origin = 0.25 0.3; material = a }\n",
        NULL, 1);
    struct measures m = measure(&g);
    struct measure_scales scales = model_scales(g.model);
    CHECK(isnan(measures_unbalanced(&m, &scales)));
    CHECK_NEAR(measures_coordination(&m), 0, 0);
    engine_stop(&g);
}

TEST_MAIN(CASE(two_discs_along_a_line), CASE(ranks_agree_on_links), CASE(ranks_agree_on_loose_discs),
          CASE(a_lattice_has_an_isotropic_fabric), CASE(no_balance_with_a_potential_of_scope_all))
