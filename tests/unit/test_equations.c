/* The paper's equations against the paper's numbers, and relations that must hold among the equations. */
#include "check.h"

#include "dm2/performance/equations.h"

static const double SIZES[] = {1, 171, 1689, 10000, 100000, 200000, 1e9};
static const double ASPECTS[] = {0.01, 0.5, 1, 1.3571, 2, 3.7, 4, 8, 100};

enum { N_SIZES = sizeof SIZES / sizeof SIZES[0], N_ASPECTS = sizeof ASPECTS / sizeof ASPECTS[0] };

/* A spacing and cells without equal numbers where the equations distinguish them. */
static struct perf skewed(void)
{
    struct perf p = perf_paper();
    p.d_x = 0.05;
    p.d_y = 0.02;
    p.l_x = 0.13;
    p.l_y = 0.21;
    return p;
}

/* The scan finds the root of eq. (7) over s alone and misses both conditions. */
TEST(equation_7_keeps_n_and_s)
{
    const struct perf all[] = {perf_paper(), skewed()};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < N_SIZES; i++)
            for (int j = 0; j < N_ASPECTS; j++) {
                const struct perf *p = &all[k];
                double n = SIZES[i], s = ASPECTS[j];
                CHECK_NEAR_REL(perf_n_x(p, n, s) * perf_n_y(p, n, s), n, 1e-14);
                CHECK_NEAR_REL(perf_width(p, n, s) / perf_height(p, n, s), s, 1e-14);
            }
}

TEST(cells_and_the_forms_of_t_seq_and_p)
{
    const struct perf p = skewed();
    for (int i = 0; i < N_SIZES; i++)
        for (int j = 0; j < N_ASPECTS; j++) {
            double n = SIZES[i], s = ASPECTS[j], c = perf_c(&p, n);
            CHECK_NEAR_REL(perf_c_x(&p, n, s) * perf_c_y(&p, n, s), c, 1e-14);
            CHECK_NEAR_REL(perf_t_seq_cells(&p, n, c), perf_t_seq(&p, n), 1e-14);  /* (11) and (12) */
            CHECK_NEAR_REL(perf_pairs(n, c) * p.k / 81, perf_t_seq(&p, n), 1e-14); /* (10) and (11) */
            CHECK_NEAR_REL(perf_c_x(&p, n, s) * n / c, perf_p_x(&p, n, s), 1e-14); /* both forms of (14) */
            CHECK_NEAR_REL(perf_c_y(&p, n, s) * n / c, perf_p_y(&p, n, s), 1e-14); /* and of (15) */
            CHECK_NEAR_REL(perf_p_x(&p, n, s) / perf_p_y(&p, n, s), s * p.l_y / p.l_x, 1e-14);
        }
}

/* Section 6.1: T_seq = 0.3316 n ms and k = 0.0314 ms. */
TEST(equation_13)
{
    const struct perf p = perf_paper();
    CHECK_NEAR(p.k * 1e3, 0.0314, 0.00005);
    CHECK_NEAR_REL(perf_t_seq(&p, 1), 0.3316e-3, 1e-14);
    CHECK_NEAR_REL(perf_t_seq(&p, 200000), 66.32, 1e-14);
}

/* Eqs. (2)-(4), and an 88-byte element. */
TEST(communication)
{
    const struct perf p = perf_paper();
    double m, b;
    CHECK(perf_network(&p, 2, &m, &b));
    CHECK_NEAR_REL(perf_t_comm_bytes(m, b, 10000), 0.0393, 1e-14);
    CHECK(perf_network(&p, 4, &m, &b));
    CHECK_NEAR_REL(perf_t_comm_bytes(m, b, 10000), 0.0771, 1e-14);
    CHECK(perf_network(&p, 8, &m, &b));
    CHECK_NEAR_REL(perf_t_comm_bytes(m, b, 10000), 0.1718, 1e-14);
    CHECK_NEAR_REL(perf_t_comm(&p, m, b, 100), perf_t_comm_bytes(m, b, 8800), 1e-14);
}

TEST(networks_between_and_beyond_the_measured_ones)
{
    const struct perf p = perf_paper();
    double m, b;
    CHECK(!perf_network(&p, 6, &m, &b));
    CHECK_NEAR_REL(m, (7.3e-6 + 14.6e-6) / 2, 1e-14);
    CHECK_NEAR_REL(b, (4.1e-3 + 25.8e-3) / 2, 1e-14);
    CHECK(!perf_network(&p, 24, &m, &b));
    CHECK_NEAR_REL(m, 3 * 14.6e-6, 1e-14);
    CHECK_NEAR_REL(b, 3 * 25.8e-3, 1e-14);
    CHECK(!perf_network(&p, 1, &m, &b));
    CHECK_NEAR_REL(m, 1.8e-6, 1e-14);
    CHECK_NEAR_REL(b, 3.3e-3, 1e-14);
    double before_m = 0, before_b = 0;
    for (int servers = 1; servers <= 64; servers++) {
        (void)perf_network(&p, servers, &m, &b);
        CHECK(m > before_m && b >= before_b);
        before_m = m;
        before_b = b;
    }
}

static double speedup(double n, double s, int servers)
{
    const struct perf p = perf_paper();
    return perf_t_seq(&p, n) / perf_t_dist(&p, n, s, servers);
}

/* Fig. 14 at n = 100,000, from the equations by hand: T_seq = 33.16 s, p_y = 882.4, p_x = 1197.5. */
/* Linear in log n between sizes and constant beyond them; linear in the number of busy processors. */
TEST(k_of_a_size)
{
    struct perf p = perf_paper();
    CHECK_SAME_BITS(perf_k_at(&p, 5000, 2, 2), p.k);
    p.size[0] = (struct perf_size){.n = 1000, .alone = 1, .shared = 2};
    p.size[1] = (struct perf_size){.n = 100000, .alone = 3, .shared = 8};
    p.n_size = 2;
    CHECK_EQ_INT(perf_check(&p, NULL), DM2_OK);
    CHECK_NEAR(perf_k_at(&p, 10, 1, 2), 1, 1e-15);
    CHECK_NEAR(perf_k_at(&p, 1000, 1, 2), 1, 1e-15);
    CHECK_NEAR(perf_k_at(&p, 10000, 1, 2), 2, 1e-12);
    CHECK_NEAR(perf_k_at(&p, 10000, 2, 2), 5, 1e-12);
    CHECK_NEAR(perf_k_at(&p, 1e7, 1, 2), 3, 1e-15);
    CHECK_NEAR(perf_k_at(&p, 1e7, 2, 2), 8, 1e-15);
    CHECK_NEAR(perf_k_at(&p, 1e7, 3, 5), 5.5, 1e-12);
    CHECK_NEAR(perf_k_at(&p, 1e7, 9, 5), 8, 1e-15);
    CHECK_NEAR(perf_k_at(&p, 1e7, 1, 0), 3, 1e-15); /* each on its own machine */
    struct perf faster = perf_faster(&p, 2, 1);
    CHECK_NEAR(perf_k_at(&faster, 1e7, 2, 2), 4, 1e-15);
    p.size[1].n = 1000;
    CHECK_EQ_INT(perf_check(&p, NULL), DM2_USAGE);
    p.size[1].n = 2000;
    p.size[1].shared = 0;
    CHECK_EQ_INT(perf_check(&p, NULL), DM2_USAGE);
}

TEST(the_papers_speedups)
{
    const struct perf p = perf_paper();
    CHECK_NEAR(perf_p_y(&p, 1e5, 1.3571), 882.4, 0.05);
    CHECK_NEAR(perf_p_x(&p, 1e5, 1.3571), 1197.5, 0.05);
    CHECK_NEAR(speedup(1e5, 1.3571, 2), 1.966, 0.0005);
    CHECK_NEAR(speedup(1e5, 1.3571, 4), 3.698, 0.0005);
    CHECK_NEAR(speedup(1e5, 1.3571, 8), 6.105, 0.0005);
}

/* Section 6.2: the cuts change at the aspect ratios 2 (4 servers) and 4 (8 servers). */
TEST(thresholds_of_the_aspect_ratio)
{
    const struct perf p = perf_paper();
    for (double s = 1; s < 10; s += 0.03125) {
        double n = 50000, p_x = perf_p_x(&p, n, s), p_y = perf_p_y(&p, n, s);
        CHECK_NEAR_REL(perf_interface(&p, n, s, 2), p_y, 1e-15);
        CHECK_NEAR_REL(perf_interface(&p, n, s, 4), s > 2 ? 3 * p_y / 2 : (p_x + p_y) / 2, 1e-13);
        CHECK_NEAR_REL(perf_interface(&p, n, s, 8), s > 4 ? 7 * p_y / 4 : (3 * p_y + p_x) / 4, 1e-13);
    }
}

/* A domain turned by 90 degrees with its spacing and cells costs the same. */
TEST(high_domains_are_turned_wide_ones)
{
    const struct perf p = skewed();
    struct perf turned = p;
    turned.d_x = p.d_y;
    turned.d_y = p.d_x;
    turned.l_x = p.l_y;
    turned.l_y = p.l_x;
    for (int servers = 2; servers <= 8; servers *= 2)
        for (double s = 1.0625; s < 12; s *= 1.25) {
            CHECK_NEAR_REL(perf_interface(&turned, 3000, 1 / s, servers),
                           perf_interface(&p, 3000, s, servers), 1e-13);
            CHECK_NEAR_REL(perf_t_dist(&turned, 3000, 1 / s, servers), perf_t_dist(&p, 3000, s, servers),
                           1e-13);
        }
}

/* Speedup and efficiency rise with n towards N and 1; communication grows as sqrt(n); at fixed n efficiency
 * falls with N. */
TEST(limits_and_monotony)
{
    for (int servers = 2; servers <= 8; servers *= 2) {
        double before = 0;
        for (double n = 100; n < 1e14; n *= 1.5) {
            double now = speedup(n, 1.3571, servers);
            CHECK(now > before && now < servers);
            before = now;
        }
        CHECK_NEAR_REL(before, servers, 1e-4);
        const struct perf p = perf_paper();
        CHECK_NEAR_REL(perf_interface(&p, 4e6, 1.5, servers), 2 * perf_interface(&p, 1e6, 1.5, servers),
                       1e-14);
    }
    for (int i = 2; i < N_SIZES; i++)
        CHECK(speedup(SIZES[i], 1.3571, 2) / 2 > speedup(SIZES[i], 1.3571, 4) / 4 &&
              speedup(SIZES[i], 1.3571, 4) / 4 > speedup(SIZES[i], 1.3571, 8) / 8);
}

/* A network without cost divides the time by N, for any size. */
TEST(faster_parts)
{
    const struct perf p = perf_paper(), cpu = perf_faster(&p, 10, 1), net = perf_faster(&p, 1, 100);
    CHECK_NEAR_REL(perf_t_seq(&cpu, 1e5), 3.316, 1e-14);
    CHECK_NEAR_REL(net.network[2].m, 14.6e-8, 1e-14);
    CHECK_NEAR_REL(net.network[2].b, 25.8e-5, 1e-14);
    double t = perf_t_dist(&p, 1e5, 1, 8), comp = perf_t_seq(&p, 1e5) / 8;
    CHECK_NEAR_REL(perf_t_dist(&net, 1e5, 1, 8) - comp, (t - comp) / 100, 1e-10);
    struct perf ideal = p;
    for (size_t i = 0; i < ideal.n_network; i++)
        ideal.network[i].m = ideal.network[i].b = 0;
    CHECK_EQ_INT(perf_check(&ideal, NULL), DM2_OK);
    CHECK_NEAR_REL(perf_t_dist(&ideal, 1e5, 1, 8), comp, 1e-14);
}

static void refuse(const struct perf *p, const char *part)
{
    struct dm2_error err = {0};
    CHECK_EQ_INT(perf_check(p, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, part);
}

TEST(constants_that_cannot_be)
{
    const double bad[] = {0, -1, NAN, INFINITY, -INFINITY, 1e-31, 1e31};
    const struct perf good = perf_paper();
    CHECK_EQ_INT(perf_check(&good, NULL), DM2_OK);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct perf p = good;
        p.d_x = bad[i];
        refuse(&p, "d_x");
        p = good;
        p.l_y = bad[i];
        refuse(&p, "L_y");
        p = good;
        p.k = bad[i];
        refuse(&p, "k = ");
        p = good;
        p.g = bad[i];
        refuse(&p, "g = ");
        if (bad[i] == 0)
            continue;
        p = good;
        p.network[1].b = bad[i];
        refuse(&p, isnan(bad[i]) ? "4 servers has m but no b" : "b = ");
    }
    struct perf p = good;
    p.n_network = 0;
    refuse(&p, "no m and b");
    p = good;
    p.network[1].servers = 2;
    refuse(&p, "rising");
}

TEST(rows_of_the_network)
{
    struct perf p = perf_paper();
    struct dm2_error err = {0};
    CHECK_EQ_INT(perf_set_network(&p, 6, false, 1e-5, &err), DM2_OK);
    CHECK_EQ_INT(p.n_network, 4);
    CHECK_EQ_INT(p.network[2].servers, 6);
    refuse(&p, "6 servers has m but no b");
    CHECK_EQ_INT(perf_set_network(&p, 6, true, 1e-2, &err), DM2_OK);
    CHECK_EQ_INT(perf_set_network(&p, 8, true, 0.5, &err), DM2_OK);
    CHECK_EQ_INT(perf_check(&p, &err), DM2_OK);
    CHECK_EQ_INT(p.n_network, 4);
    CHECK_NEAR(p.network[3].b, 0.5, 0);
    CHECK_NEAR(p.network[3].m, 14.6e-6, 0);
    CHECK_EQ_INT(perf_set_network(&p, 0, true, 1, &err), DM2_USAGE);
    CHECK_EQ_INT(perf_set_network(&p, 65536, true, 1, &err), DM2_USAGE);
    enum dm2_status status = DM2_OK;
    for (int servers = 100; servers < 200 && status == DM2_OK; servers++)
        status = perf_set_network(&p, servers, true, 1, &err);
    CHECK_EQ_INT(status, DM2_USAGE);
    CHECK_EQ_INT(p.n_network, PERF_NETWORK_MAX);
}

TEST_MAIN(CASE(equation_7_keeps_n_and_s), CASE(cells_and_the_forms_of_t_seq_and_p), CASE(equation_13),
          CASE(communication), CASE(networks_between_and_beyond_the_measured_ones), CASE(k_of_a_size),
          CASE(the_papers_speedups), CASE(thresholds_of_the_aspect_ratio),
          CASE(high_domains_are_turned_wide_ones), CASE(limits_and_monotony), CASE(faster_parts),
          CASE(constants_that_cannot_be), CASE(rows_of_the_network))
