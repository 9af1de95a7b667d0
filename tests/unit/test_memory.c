/* Memory per element: lists, cells, sums and the buffers of a rebuild included. */
#include "engine_help.h"

/* About 27 thousand elements, so that the memory per element dominates. */
static const char solid[] = "domain { size = 6 6; r_c = 0.1; delta_r = 0.01 }\n"
                            "time { dt = 0.02; steps = 100 }\n"
                            "material Ni { rho0 = 8.9; c0 = 0.46; s = 1.4; shear = 0.76; yield = 0.005 }\n"
                            "interaction { zeta = 0.1; ct_ratio = 0.05; mu = 0.2 }\n"
                            "body block { shape = rectangle 0 0 6 6; spacing = 0.04; material = Ni; velocity "
                            "= 0.02 0; jitter = 0.01 }\n";

static const char sheet[] =
    "domain { size = 160 160; r_c = 2.5; delta_r = 0.25 }\n"
    "time { dt = 0.005; steps = 100 }\n"
    "material atom { mass = 1 }\n"
    "interaction { potential = lennard-jones; scope = all; epsilon = 1; sigma = 0.9; cutoff = 2.5; linked = "
    "no }\n"
    "body block { shape = rectangle 0 0 160 160; spacing = 1; material = atom; jitter = 0.4 }\n";

/* Bytes per element after steps with rebuilds and measures. */
static double bytes_of(const char *deck, int ranks)
{
    struct engine g;
    struct measures m;
    size_t bytes = 0, elements = 0;
    engine_start(&g, deck, NULL, ranks);
    for (int step = 0; step < 12; step++)
        engine_step(&g, step % 4 == 0 ? &m : NULL);
    engine_rebuild(&g);
    for (int r = 0; r < ranks; r++) {
        bytes += subdomain_bytes(g.sd[r]);
        elements += subdomain_owned(g.sd[r]);
    }
    engine_stop(&g);
    CHECK(elements > 20000);
    return (double)bytes / (double)elements;
}

TEST(plain_mechanics_needs_less_than_400_bytes_per_element)
{
    double bytes = bytes_of(solid, 1);
    CHECK_REPORT(bytes < 400, "%.0f bytes per element", bytes);
    CHECK_REPORT(bytes > 200, "%.0f bytes per element: something is not counted", bytes);
}

TEST(pairs_without_memory_need_less)
{
    double bytes = bytes_of(sheet, 1);
    CHECK_REPORT(bytes < 400, "%.0f bytes per element", bytes);
}

TEST(several_ranks_pay_for_their_boundaries_alone)
{
    double one = bytes_of(solid, 1), four = bytes_of(solid, 4);
    CHECK_REPORT(four < 1.25 * one, "%.0f bytes per element on four ranks, %.0f on one", four, one);
}

TEST_MAIN(CASE(plain_mechanics_needs_less_than_400_bytes_per_element), CASE(pairs_without_memory_need_less),
          CASE(several_ranks_pay_for_their_boundaries_alone))
