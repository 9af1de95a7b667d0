/* The bisection's cuts: computed cuts against searched ones, and grids too large for a search.
 * test_decomposition checks the properties of the rectangles. */
#include "check.h"

#include "dm2/base/bisect.h"

TEST(computed_cuts_are_the_searched_ones)
{
    static uint32_t ones[24 * 24];
    static struct cell_rect computed[24 * 24], searched[24 * 24];
    for (size_t k = 0; k < sizeof ones / sizeof ones[0]; k++)
        ones[k] = 1;
    size_t differing = 0, compared = 0;
    for (int cx = 1; cx <= 24; cx++)
        for (int cy = 1; cy <= 24; cy += cx % 3 + 1)
            for (int parts = 1; parts <= cx * cy; parts += 1 + parts / 24) {
                bisect_grid(cx, cy, 1, 1.25, parts, NULL, computed);
                bisect_grid(cx, cy, 1, 1.25, parts, ones, searched);
                for (int k = 0; k < parts; k++, compared++)
                    differing += memcmp(&computed[k], &searched[k], sizeof computed[k]) != 0;
            }
    CHECK(compared > 100000);
    CHECK_EQ_INT(differing, 0);
}

TEST(grids_of_any_size)
{
    static struct cell_rect r[BISECT_PARTS_MAX];
    const int width = 2000000000;
    bisect_grid(width, 3, 1e-9, 1, BISECT_PARTS_MAX, NULL, r);
    uint64_t cells = 0;
    for (int k = 0; k < BISECT_PARTS_MAX; k++)
        cells += bisect_cells(&r[k]);
    CHECK_EQ_INT(cells, 6000000000LL);
    CHECK_EQ_INT(r[BISECT_PARTS_MAX - 1].x1, width);
}

TEST(what_cannot_be_bisected)
{
    struct dm2_error err = {0};
    CHECK_EQ_INT(bisect_check(3, 4, 12, &err), DM2_OK);
    CHECK_EQ_INT(bisect_check(3, 4, 13, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, "13 servers for a grid of 12 cells (3 x 4)");
    CHECK_EQ_INT(bisect_check(3, 4, 0, &err), DM2_USAGE);
    CHECK_EQ_INT(bisect_check(1000, 1000, BISECT_PARTS_MAX + 1, &err), DM2_USAGE);
}

TEST_MAIN(CASE(computed_cuts_are_the_searched_ones), CASE(grids_of_any_size), CASE(what_cannot_be_bisected))
