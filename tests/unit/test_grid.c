/* Places in a periodic domain: half-open, whole turns. */
#include "check.h"

#include <math.h>

#include "dm2/base/grid.h"

static void check_wrap(double low, double size, double x, double place, int32_t turns)
{
    int32_t got = 99;
    double to = grid_wrap(low, size, x, &got);
    CHECK_REPORT(to == place && got == turns, "%g in [%g, %g + %g) is %.17g after %d turns", x, low, low,
                 size, to, got);
}

TEST(edges)
{
    check_wrap(0, 4, 0, 0, 0);
    check_wrap(0, 4, -0.0, 0, 0);
    check_wrap(0, 4, 4, 0, 1);
    check_wrap(0, 4, nextafter(4, 0), nextafter(4, 0), 0);
    check_wrap(0, 4, -0.5, 3.5, -1);
    check_wrap(-1, 2, 1, -1, 1);
    check_wrap(-1, 2, nextafter(1, 2), nextafter(1, 2) - 2, 1);
    check_wrap(0, 4, 4.25, 0.25, 1);
}

/* What rounds to the upper edge is at the lower edge, and has made no turn. */
TEST(less_than_a_rounding_below_the_edge)
{
    check_wrap(0, 4, -1e-18, 0, 0);
    check_wrap(0, 4, -5e-324, 0, 0);
    check_wrap(0, 8, -4e-16, 0, 0);
}

TEST(several_sizes_away)
{
    check_wrap(0, 4, 9, 1, 2);
    check_wrap(0, 4, 8, 0, 2);
    check_wrap(0, 4, -9, 3, -3);
    check_wrap(1, 0.5, -24, 1, -50);
    check_wrap(1, 0.5, 26.25, 1.25, 50);
}

/* In domains of any place and size a place is always within, and place + turns size is x, to rounding. */
TEST(places_are_within)
{
    uint64_t state = 5;
    for (int k = 0; k < 200000; k++) {
        double u[4];
        for (int j = 0; j < 4; j++) {
            state = state * 6364136223846793005u + 1442695040888963407u;
            u[j] = (double)(state >> 11) * 0x1p-53;
        }
        double low = (u[0] - 0.5) * 10, size = 0.001 + 3 * u[1], high = low + size;
        const double near[4] = {low, high, low - size, high + size};
        double x = k % 2 == 0 ? low + (7 * u[2] - 3) * size : near[k / 2 % 4];
        for (int j = (int)(7 * u[3]) - 3; k % 2 == 1 && j != 0; j += j < 0 ? 1 : -1)
            x = nextafter(x, j < 0 ? -100 : 100);
        int32_t turns;
        double place = grid_wrap(low, size, x, &turns);
        CHECK_REPORT(place >= low && place < high, "%.17g of %.17g + %.17g is at %.17g", x, low, size, place);
        CHECK_NEAR(place + turns * size, x, 1e-14 * (fabs(x) + fabs(low) + size));
    }
}

TEST_MAIN(CASE(edges), CASE(less_than_a_rounding_below_the_edge), CASE(several_sizes_away),
          CASE(places_are_within))
