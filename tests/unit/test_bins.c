/* Bins: every element is in a bin, also outside the domain, and elements within reach are in bins that
 * touch. */
#include "check.h"

#include <math.h>

#include "dm2/base/random.h"
#include "engine/bins.h"

enum { N = 400 };

static const double reach = 0.3;

/* Points in and around a domain of 4 x 3 cm; along periodic sides inside the domain. */
static struct grid cells_and_points(bool periodic_x, bool periodic_y, double r[2 * N])
{
    const double origin[2] = {-1.0, 2.0}, size[2] = {4.0, 3.0};
    const bool periodic[2] = {periodic_x, periodic_y};
    struct grid cells;
    CHECK_EQ_INT(grid_build(origin, size, periodic, 0.5, &cells, NULL), DM2_OK);
    for (size_t k = 0; k < 2 * N; k++) {
        double share = random_uniform(1, k, 0);
        r[k] = periodic[k % 2] ? origin[k % 2] + share * size[k % 2]
                               : origin[k % 2] + (3.0 * share - 1.0) * size[k % 2];
    }
    return cells;
}

static double apart(const struct grid *g, const double *r, size_t i, size_t j, int axis)
{
    double d = fabs(r[2 * i + (size_t)axis] - r[2 * j + (size_t)axis]);
    return g->periodic[axis] ? fmin(d, g->size[axis] - d) : d;
}

static bool touch(const struct grid *g, int a, int b)
{
    int around[8], n = grid_neighbours(g, a, around);
    bool found = a == b;
    for (int k = 0; k < n; k++)
        found |= around[k] == b;
    return found;
}

static void check_bins(bool periodic_x, bool periodic_y)
{
    double r[2 * N];
    struct grid cells = cells_and_points(periodic_x, periodic_y, r);
    struct bins b = {0};
    CHECK(bins_lay_out(&b, &cells, r, N, reach, 1e6));
    CHECK(b.grid.lx > reach && b.grid.ly > reach);
    CHECK(periodic_x || b.grid.lx < reach * (1.0 + 1e-6));
    CHECK(periodic_y || b.grid.ly < reach * (1.0 + 1e-6));
    CHECK_EQ_INT(bins_assign(&b, r, N), 0);
    size_t seen = 0;
    for (int k = 0; k < b.grid.cx * b.grid.cy; k++) {
        for (uint32_t s = b.start[k]; s < b.start[k + 1]; s++, seen++) {
            CHECK_EQ_INT(b.bin[b.slot[s]], k);
            CHECK(s == b.start[k] || b.slot[s - 1] < b.slot[s]);
        }
    }
    CHECK_EQ_INT(seen, N);
    size_t near = 0;
    for (size_t i = 0; i < N; i++) {
        for (size_t j = 0; j < i; j++) {
            if (apart(&b.grid, r, i, j, 0) > reach || apart(&b.grid, r, i, j, 1) > reach)
                continue;
            near++;
            CHECK(touch(&b.grid, (int)b.bin[i], (int)b.bin[j]));
        }
    }
    CHECK(near > 100);
    bins_free(&b);
}

TEST(who_is_near_stands_in_a_touching_bin)
{
    check_bins(false, false);
    check_bins(true, false);
    check_bins(true, true);
}

TEST(bins_that_would_be_too_many_or_too_few_are_refused)
{
    double r[2 * N];
    struct grid cells = cells_and_points(false, true, r);
    struct bins b = {0};
    CHECK(!bins_lay_out(&b, &cells, r, N, reach, 100.0));
    CHECK(!bins_lay_out(&b, &cells, r, N, 1.2, 1e6)); /* two bins along the periodic side of 3 cm */
    r[0] = 1e300;
    CHECK(!bins_lay_out(&b, &cells, r, N, reach, 1e6));
    bins_free(&b);
}

TEST(few_elements_are_binned_as_well)
{
    double r[2] = {7.0, -5.0};
    struct grid cells = cells_and_points(false, false, (double[2 * N]){0});
    struct bins b = {0};
    CHECK(bins_lay_out(&b, &cells, r, 1, reach, 1.0));
    CHECK_EQ_INT(bins_assign(&b, r, 1), 0);
    CHECK_EQ_INT(b.start[1], 1);
    CHECK(bins_lay_out(&b, &cells, r, 0, reach, 1e6));
    CHECK_EQ_INT(bins_assign(&b, r, 0), 0);
    CHECK_EQ_INT(b.start[b.grid.cx * b.grid.cy], 0);
    bins_free(&b);
}

TEST_MAIN(CASE(who_is_near_stands_in_a_touching_bin),
          CASE(bins_that_would_be_too_many_or_too_few_are_refused), CASE(few_elements_are_binned_as_well))
