/* The general form against eqs. (18)-(20) on the same geometry and against the decomposition of runs, and
 * each option against its description. */
#include "check.h"

#include "dm2/cluster/decomposition.h"
#include "dm2/performance/predict.h"

static const struct predict_options PAPER_FORM = {0}, GENERAL = {.general = true};

/* Square cells of 4 x 4 elements at unit distance, so that grids of whole cells have round sizes. */
static struct perf simple(void)
{
    struct perf p = perf_paper();
    p.d_x = p.d_y = 1;
    p.l_x = p.l_y = 4;
    return p;
}

static struct prediction predicted(const struct perf *p, double n, double s, int servers,
                                   const struct predict_options *o)
{
    struct prediction out;
    struct dm2_error err = {0};
    CHECK_EQ_INT(predict(p, n, s, servers, o, &out, &err), DM2_OK);
    CHECK_STR(err.text, "");
    return out;
}

/* On grids of whole cells the general form equals the paper's to rounding. */
TEST(general_form_is_the_papers_on_its_geometry)
{
    const struct perf p = simple();
    const int sizes[][2] = {{16, 16}, {24, 16}, {27, 21}, {32, 16}, {48, 16}, {64, 16}, {65, 13},
                            {96, 8},  {16, 24}, {16, 32}, {16, 64}, {8, 96},  {7, 70},  {190, 140}};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (int servers = 2; servers <= 8; servers *= 2) {
            double n = 16.0 * sizes[k][0] * sizes[k][1], s = (double)sizes[k][0] / sizes[k][1];
            struct prediction paper = predicted(&p, n, s, servers, &PAPER_FORM);
            struct prediction general = predicted(&p, n, s, servers, &GENERAL);
            CHECK(!paper.general && general.general);
            CHECK_NEAR_REL(general.exchanged, paper.exchanged, 1e-12);
            CHECK_NEAR_REL(general.t_comp, paper.t_comp, 1e-12);
            CHECK_NEAR_REL(general.t_comm, paper.t_comm, 1e-12);
            CHECK_NEAR_REL(general.t_dist, paper.t_dist, 1e-12);
            CHECK_NEAR_REL(general.speedup, paper.speedup, 1e-12);
            CHECK_NEAR_REL(general.efficiency, paper.efficiency, 1e-12);
        }
}

/* With the paper's constants the grid is rounded to whole cells: near, not equal. */
TEST(general_form_near_the_papers_elsewhere)
{
    const struct perf p = perf_paper();
    for (double n = 20000; n < 1e7; n *= 1.7)
        for (double s = 1; s < 6; s += 0.21)
            for (int servers = 2; servers <= 8; servers *= 2) {
                struct prediction paper = predicted(&p, n, s, servers, &PAPER_FORM);
                struct prediction general = predicted(&p, n, s, servers, &GENERAL);
                CHECK_NEAR_REL(general.t_comm, paper.t_comm, 0.05);
            }
}

/* The predicted times equal the equations' own. */
TEST(special_form_is_the_equations)
{
    const struct perf p = perf_paper();
    for (int servers = 2; servers <= 8; servers *= 2)
        CHECK_NEAR_REL(predicted(&p, 1e5, 1.3571, servers, &PAPER_FORM).t_dist,
                       perf_t_dist(&p, 1e5, 1.3571, servers), 1e-14);
}

TEST(one_server_is_the_sequential_run)
{
    const struct perf p = perf_paper();
    struct prediction one = predicted(&p, 1689, 1.7735, 1, &GENERAL);
    CHECK_NEAR(one.t_dist, one.t_seq, 0);
    CHECK_NEAR(one.t_comm, 0, 0);
    CHECK_NEAR(one.speedup, 1, 0);
    CHECK_NEAR(one.efficiency, 1, 0);
    CHECK(one.measured);
}

/* The loads of rectangles, computed from their sides, against the decomposition's, which visits every
 * cell. */
static void check_loads(int cx, int cy, int servers, bool periodic_x, bool periodic_y)
{
    const struct grid grid = {.cx = cx, .cy = cy, .lx = 1, .ly = 1.5, .periodic = {periodic_x, periodic_y}};
    const struct predict_options edges = {.periodic = {periodic_x, periodic_y}};
    struct predict_options mirrored = edges;
    mirrored.mirrored = true;
    struct decomposition d;
    CHECK_EQ_INT(decomposition_bisect(&grid, servers, NULL, &d, NULL), DM2_OK);
    double share = 0;
    for (int rank = 0; rank < servers; rank++) {
        struct rank_boundary boundary;
        CHECK_EQ_INT(decomposition_boundary(&d, rank, &boundary, NULL), DM2_OK);
        double cells = (double)decomposition_cells(&d, rank);
        struct predict_load a = predict_rect_load(&d.rect[rank], cx, cy, 1, &edges);
        struct predict_load b = predict_rect_load(&d.rect[rank], cx, cy, 10, &mirrored);
        CHECK_NEAR(a.exchanged, (double)boundary.interface_cells, 0);
        CHECK_NEAR(b.exchanged, 10 * (double)boundary.outer, 0);
        CHECK_NEAR(a.inner, (cells - (double)boundary.inner) / cells, 1e-15);
        CHECK_NEAR(a.share, cells / (cx * cy), 1e-15);
        share += a.share;
    }
    CHECK_NEAR(share, 1, 1e-13);
    decomposition_free(&d);
}

TEST(loads_are_those_of_the_decomposition)
{
    const int sizes[][2] = {{19, 9}, {20, 20}, {40, 5}, {7, 30}, {3, 50}, {12, 3}};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (int servers = 1; servers <= 32; servers++)
            for (int periodic = 0; periodic < 4; periodic++)
                check_loads(sizes[k][0], sizes[k][1], servers, periodic % 2 != 0, periodic / 2 != 0);
}

/* 15 x 8 cells for 3 servers: strips of 5 x 8; the outer two exchange 8 cells each, the middle one 16. */
TEST(three_servers_by_hand)
{
    const struct perf p = simple();
    struct prediction mean = predicted(&p, 1920, 1.875, 3, &PAPER_FORM);
    double m, b;
    (void)perf_network(&p, 3, &m, &b);
    CHECK(mean.general && !mean.measured);
    CHECK_NEAR_REL(mean.exchanged, 16 * 32.0 / 3, 1e-12);
    CHECK_NEAR_REL(mean.t_dist, mean.t_seq / 3 + m * 88 * 16 * 32 / 3 + 2 * b, 1e-12);
    const struct predict_options slowest = {.slowest = true};
    struct prediction most = predicted(&p, 1920, 1.875, 3, &slowest);
    CHECK_NEAR_REL(most.exchanged, 16 * 16.0, 1e-12);
    CHECK_NEAR_REL(most.t_dist, mean.t_seq / 3 + m * 88 * 16 * 16 + 2 * b, 1e-12);
}

/* 5 x 5 cells for 2 servers: 10 cells and 15. */
TEST(the_slowest_server_has_the_larger_part)
{
    const struct perf p = simple();
    const struct predict_options slowest = {.slowest = true};
    struct prediction two = predicted(&p, 400, 1, 2, &slowest);
    CHECK_NEAR_REL(two.t_comp, two.t_seq * 0.6, 1e-12);
    for (int servers = 2; servers <= 25; servers++)
        CHECK(predicted(&p, 400, 1, servers, &slowest).t_dist >=
              predicted(&p, 400, 1, servers, &GENERAL).t_dist * (1 - 1e-12));
}

TEST(peers_halve_the_communication)
{
    const struct perf p = perf_paper();
    const struct predict_options peer = {.general = true, .peer = true}, special = {.peer = true};
    for (int servers = 2; servers <= 40; servers++) {
        struct prediction relay = predicted(&p, 1e5, 1.3571, servers, &GENERAL);
        CHECK_NEAR_REL(predicted(&p, 1e5, 1.3571, servers, &peer).t_comm, relay.t_comm / 2, 1e-14);
    }
    struct prediction relay = predicted(&p, 1e5, 1.3571, 8, &PAPER_FORM);
    struct prediction direct = predicted(&p, 1e5, 1.3571, 8, &special);
    CHECK(!direct.general);
    CHECK_NEAR_REL(direct.t_comm, relay.t_comm / 2, 1e-14);
    CHECK_NEAR_REL(direct.t_dist, relay.t_dist - relay.t_comm / 2, 1e-14);
}

TEST(migration_has_a_linear_term)
{
    const struct perf p = perf_paper();
    const struct predict_options some = {.migrants = 0.25}, heavy = {.migrants = 0.25, .migrant_bytes = 400};
    struct prediction none = predicted(&p, 1e5, 1.3571, 4, &GENERAL);
    double linear = 7.3e-6 * none.exchanged;
    CHECK_NEAR_REL(predicted(&p, 1e5, 1.3571, 4, &some).t_comm, none.t_comm + linear * 22, 1e-12);
    CHECK_NEAR_REL(predicted(&p, 1e5, 1.3571, 4, &heavy).t_comm, none.t_comm + linear * 100, 1e-12);
}

/* The exchange of four servers passes through the client twice. */
TEST(the_clients_link)
{
    const struct perf p = perf_paper();
    struct prediction none = predicted(&p, 1e5, 1.3571, 4, &GENERAL);
    double bytes = 2 * 4 * none.exchanged * 88;
    const struct predict_options slow = {.client_rate = 1e5}, fast = {.client_rate = 1e9};
    const struct predict_options peer = {.client_rate = 1e5, .peer = true};
    struct prediction bound = predicted(&p, 1e5, 1.3571, 4, &slow);
    CHECK(bound.client_bound && !none.client_bound);
    CHECK_NEAR_REL(bound.t_comm, bytes / 1e5 + 2 * 4.1e-3, 1e-12);
    struct prediction free = predicted(&p, 1e5, 1.3571, 4, &fast);
    CHECK(!free.client_bound);
    CHECK_NEAR(free.t_comm, none.t_comm, 0);
    CHECK_NEAR_REL(predicted(&p, 1e5, 1.3571, 4, &peer).t_comm, none.t_comm / 2, 1e-14);
}

TEST(communication_hides_behind_computing)
{
    const struct perf p = perf_paper();
    const struct predict_options full = {.overlap = 1}, tenth = {.overlap = 0.1},
                                 inner = {.overlap_inner = true};
    struct prediction none = predicted(&p, 1e5, 1.3571, 8, &GENERAL);
    struct prediction some = predicted(&p, 1e5, 1.3571, 8, &tenth);
    CHECK(none.t_comm < none.t_comp);
    CHECK_NEAR(predicted(&p, 1e5, 1.3571, 8, &full).t_dist, none.t_comp, 0);
    CHECK_NEAR_REL(some.t_dist, none.t_dist - 0.1 * none.t_comp, 1e-12);
    CHECK_NEAR(some.t_comm, none.t_comm, 0);
    CHECK_NEAR(predicted(&p, 1e5, 1.3571, 8, &inner).t_dist, none.t_comp,
               0); /* 88 % of the cells are inner */
    struct prediction small = predicted(&p, 1689, 1.7735, 8, &inner);
    CHECK(small.t_dist > small.t_comm); /* 171 cells among 8: few are inner */
    CHECK(small.t_dist < small.t_comm + small.t_comp);
}

TEST(periodic_sides_exchange_more)
{
    const struct perf p = simple();
    const struct predict_options x = {.periodic = {true, false}}, y = {.periodic = {false, true}};
    struct prediction none = predicted(&p, 1536, 1.5, 2, &GENERAL);
    CHECK_NEAR_REL(predicted(&p, 1536, 1.5, 2, &x).exchanged, 2 * none.exchanged, 1e-12);
    CHECK_NEAR_REL(predicted(&p, 1536, 1.5, 2, &y).exchanged, none.exchanged, 1e-12);
}

TEST(more_elements_are_never_less_efficient_by_much)
{
    const struct perf p = perf_paper();
    for (int servers = 3; servers <= 64; servers += 7) {
        double before = 0;
        for (double n = 2000; n < 1e12; n *= 4) {
            double now = predicted(&p, n, 1.3571, servers, &GENERAL).speedup;
            CHECK(now > before && now < servers);
            before = now;
        }
        CHECK_NEAR_REL(before, servers, 0.01);
    }
}

/* x = sqrt(n) solves a (1 - 1/N) x^2 - beta x - 2 b = 0, where T_seq = a n and the boundary costs beta
 * sqrt(n). */
TEST(break_even_solves_the_quadratic)
{
    const struct perf none = {0}, paper = perf_paper(), fast = perf_faster(&paper, 50, 1);
    const struct perf *all[] = {&paper, &fast};
    struct dm2_error err = {0};
    double n;
    for (int k = 0; k < 2; k++)
        for (int servers = 2; servers <= 8; servers *= 2) {
            double m, b, a = perf_t_seq(all[k], 1) * (1 - 1.0 / servers);
            (void)perf_network(all[k], servers, &m, &b);
            double beta = m * all[k]->g * perf_interface(all[k], 1, 1.3571, servers);
            double x = (beta + sqrt(beta * beta + 8 * a * b)) / (2 * a);
            CHECK_EQ_INT(predict_break_even(all[k], 1.3571, servers, &PAPER_FORM, &n, &err), DM2_OK);
            int cx, cy;
            if (predict_grid(all[k], ceil(x * x), 1.3571, &cx, &cy) && cx * cy >= servers)
                CHECK_NEAR(n, ceil(x * x), 0);
        }
    CHECK_EQ_INT(predict_break_even(&paper, 1.3571, 1, &PAPER_FORM, &n, &err), DM2_USAGE);
    CHECK_EQ_INT(predict_break_even(&none, 1.3571, 2, &PAPER_FORM, &n, &err), DM2_USAGE);
    struct perf hopeless = paper;
    CHECK_EQ_INT(perf_set_network(&hopeless, 2, true, 1e29, &err), DM2_OK);
    CHECK_EQ_INT(predict_break_even(&hopeless, 1.3571, 2, &PAPER_FORM, &n, &err), DM2_OK);
    CHECK_NEAR(n, 0, 0);
}

TEST(best_is_the_smallest_time)
{
    const struct perf p = perf_paper();
    const double sizes[] = {10, 100, 1689, 20000, 500000};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        struct prediction best, one;
        CHECK_EQ_INT(predict_best(&p, sizes[k], 1.3571, 32, &PAPER_FORM, &best, NULL), DM2_OK);
        for (int servers = 1; servers <= 32; servers++)
            if (predict(&p, sizes[k], 1.3571, servers, &PAPER_FORM, &one, NULL) == DM2_OK)
                CHECK(one.t_dist > best.t_dist || (one.t_dist == best.t_dist && servers >= best.servers));
    }
    struct prediction best;
    CHECK_EQ_INT(predict_best(&p, 10, 1.3571, 32, &PAPER_FORM, &best, NULL), DM2_OK);
    CHECK_EQ_INT(best.servers, 1);
}

static void refuse(double n, double s, int servers, const struct predict_options *o, const char *part)
{
    const struct perf p = perf_paper();
    struct prediction out;
    struct dm2_error err = {0};
    CHECK_EQ_INT(predict(&p, n, s, servers, o, &out, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, part);
}

TEST(bad_input)
{
    const double no_n[] = {0, -1, 0.5, NAN, INFINITY, 1e16}, no_s[] = {0, -1, NAN, INFINITY, 1e-9, 1e9};
    for (int k = 0; k < 6; k++) {
        refuse(no_n[k], 1, 2, &PAPER_FORM, "elements: 1 to");
        refuse(1000, no_s[k], 2, &PAPER_FORM, "aspect ratio");
    }
    refuse(1689, 1.7735, 0, &PAPER_FORM, "0 servers");
    refuse(1689, 1.7735, -3, &PAPER_FORM, "-3 servers");
    refuse(1689, 1.7735, 65536, &PAPER_FORM, "65536 servers");
    refuse(1689, 1.7735, 1000, &PAPER_FORM, "1000 servers for a grid of 153 cells (17 x 9)");
    refuse(10, 1, 2, &PAPER_FORM, "2 servers for a grid of 1 cell");
    const struct predict_options bad[] = {
        {.overlap = 1.1},      {.overlap = NAN},    {.migrants = -1},         {.migrants = NAN},
        {.migrant_bytes = -1}, {.client_rate = -1}, {.client_rate = INFINITY}};
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++)
        refuse(1689, 1.7735, 2, &bad[k], "is expected");
    struct perf p = perf_paper();
    struct prediction out;
    p.l_x = 1e-20;
    CHECK_EQ_INT(predict(&p, 1e6, 1, 2, &PAPER_FORM, &out, NULL), DM2_USAGE);
}

TEST_MAIN(CASE(general_form_is_the_papers_on_its_geometry), CASE(general_form_near_the_papers_elsewhere),
          CASE(special_form_is_the_equations), CASE(one_server_is_the_sequential_run),
          CASE(loads_are_those_of_the_decomposition), CASE(three_servers_by_hand),
          CASE(the_slowest_server_has_the_larger_part), CASE(peers_halve_the_communication),
          CASE(migration_has_a_linear_term), CASE(the_clients_link),
          CASE(communication_hides_behind_computing), CASE(periodic_sides_exchange_more),
          CASE(more_elements_are_never_less_efficient_by_much), CASE(break_even_solves_the_quadratic),
          CASE(best_is_the_smallest_time), CASE(bad_input))
