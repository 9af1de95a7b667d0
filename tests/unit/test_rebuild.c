/* dmax and dumax: when lists must be renewed. */
#include "check.h"

#include "dm2/engine/rebuild.h"

static const struct margins both = {.close = 1.0, .wide = 1.0};

TEST(lists_last_while_twice_dumax_is_within_the_margin)
{
    struct config c = {0};
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c, both);
    CHECK(!rebuild_plan_step(&plan, 0.25, NULL));
    CHECK(!rebuild_plan_step(&plan, 0.249, NULL)); /* 2 * 0.499 < 1: still valid */
    CHECK(rebuild_plan_step(&plan, 0.002, NULL));
    rebuild_plan_done(&plan);
    CHECK(!rebuild_plan_step(&plan, 0.499, NULL));
    CHECK(rebuild_plan_step(&plan, 0.499, NULL));
}

TEST(every_k_steps_as_well)
{
    struct config c = {.rebuild_every = 3};
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c, both);
    for (int k = 1; k <= 9; k++) {
        bool expected = rebuild_plan_expected(&plan);
        bool due = rebuild_plan_step(&plan, 0, NULL);
        CHECK_EQ_INT(due, k % 3 == 0);
        CHECK_EQ_INT(expected, due);
        if (due)
            rebuild_plan_done(&plan);
    }
}

TEST(cells_alone_rebuild_every_step)
{
    struct config c = {.search = SEARCH_CELLS};
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c, both);
    CHECK(rebuild_plan_expected(&plan));
    CHECK(rebuild_plan_step(&plan, 0, NULL));
    rebuild_plan_done(&plan);
    CHECK(rebuild_plan_step(&plan, 0, NULL));
}

TEST(the_guess_looks_one_step_ahead)
{
    struct config c = {0};
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c, both);
    CHECK(!rebuild_plan_expected(&plan));         /* nothing has moved */
    CHECK(!rebuild_plan_step(&plan, 0.19, NULL)); /* 2 * (0.19 + 1.1 * 0.19) < 1 */
    CHECK(!rebuild_plan_expected(&plan));
    CHECK(!rebuild_plan_step(&plan, 0.2, NULL)); /* 2 * (0.39 + 1.1 * 0.2) > 1 */
    CHECK(rebuild_plan_expected(&plan));
}

TEST(nonsense_rebuilds)
{
    struct config c = {0};
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c, both);
    CHECK(rebuild_plan_step(&plan, NAN, NULL));
}

static struct spread spread_of(double x0, double y0, double x1, double y1, double most)
{
    return (struct spread){.low = {x0, y0}, .high = {x1, y1}, .most = most, .close = INFINITY};
}

TEST(a_pair_approaches_by_no_more_than_box_and_circle_allow)
{
    struct spread none = spread_none(), random = spread_of(-1, -1, 1, 1, 1.1),
                  flyer = spread_of(0, 0, 3, 0, 3), whole = spread_of(5, 5, 5, 5, 8);
    CHECK_SAME_BITS(spread_approach(&none), 0.0);
    CHECK_SAME_BITS(spread_approach(&random), 2.2);
    CHECK_SAME_BITS(spread_approach(&flyer), 3.0);
    CHECK_SAME_BITS(spread_approach(&whole), 0.0);
    spread_merge(&none, &flyer);
    CHECK_SAME_BITS(spread_approach(&none), 3.0);
    spread_merge(&flyer, &random);
    CHECK(flyer.low[0] == -1 && flyer.low[1] == -1 && flyer.high[0] == 3 && flyer.high[1] == 1 &&
          flyer.most == 3);
}

TEST(a_survey_lowers_the_bound_and_never_raises_it)
{
    struct config c = {0};
    struct spread whole = spread_of(0.3, 0, 0.35, 0, 0.35), wide = spread_of(-0.6, 0, 0.6, 0, 0.6);
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c, both);
    CHECK(!rebuild_plan_survey(&plan));
    CHECK(!rebuild_plan_step(&plan, 0.1, NULL)); /* 0.2 + 4 * 1.1 * 0.1 < 1 */
    CHECK(!rebuild_plan_survey(&plan));
    CHECK(!rebuild_plan_step(&plan, 0.15, NULL)); /* 0.5 + 2 * 1.1 * 0.15 < 1 < 0.5 + 4 * 1.1 * 0.15 */
    CHECK(rebuild_plan_survey(&plan) && !rebuild_plan_expected(&plan));
    CHECK(!rebuild_plan_step(&plan, 0.1, &whole));
    CHECK(!rebuild_plan_survey(&plan) && !rebuild_plan_expected(&plan));
    CHECK_NEAR(plan.approach, 0.05, 1e-15);
    CHECK(!rebuild_plan_step(&plan, 0.1, &wide)); /* 0.05 + 0.2 bounds the approach */
    CHECK_NEAR(plan.approach, 0.25, 1e-15);
    CHECK(rebuild_plan_step(&plan, 0.5, &wide)); /* both bounds exceed the margin */
    CHECK(rebuild_plan_expected(&plan) && !rebuild_plan_survey(&plan));
}

TEST(bins_are_compared_by_their_boxes_and_circles)
{
    struct spread none = spread_none(), still = spread_of(0, 0, 0, 0, 0), left = spread_of(1, 0, 2, 0, 2),
                  right = spread_of(-3, -4, -2, 0, 5), near = spread_of(-1, -1, 1, 1, 1.1);
    const int either[2] = {0, 0};
    CHECK_SAME_BITS(spread_between(&none, &none, either), 0.0);
    CHECK_SAME_BITS(spread_between(&none, &left, either), 0.0);
    CHECK_SAME_BITS(spread_between(&left, &none, either), 0.0);
    CHECK_SAME_BITS(spread_between(&still, &left, either), 2.0);
    CHECK_SAME_BITS(spread_between(&left, &right, either), sqrt(41.0));
    CHECK_SAME_BITS(spread_between(&right, &left, either), sqrt(41.0));
    CHECK_SAME_BITS(spread_between(&near, &still, either), 1.1); /* the circle, not the corner of the box */
    CHECK_SAME_BITS(spread_between(&left, &left, either), 1.0);
}

TEST(what_parts_them_does_not_count)
{
    struct spread a = spread_of(0, -1, 1, 0, 10), b = spread_of(3, 2, 5, 4, 10), none = spread_none();
    const int east[2] = {1, 0}, west[2] = {-1, 0}, north[2] = {0, 1}, south_west[2] = {-1, -1},
              north_east[2] = {1, 1};
    CHECK_SAME_BITS(spread_between(&a, &b, east), 5.0); /* b went east, and north or south of a */
    CHECK_SAME_BITS(spread_between(&a, &b, west), sqrt(50.0));
    CHECK_SAME_BITS(spread_between(&a, &b, north), 5.0);
    CHECK_SAME_BITS(spread_between(&a, &b, south_west), sqrt(50.0));
    CHECK_SAME_BITS(spread_between(&a, &b, north_east), 0.0);
    CHECK_SAME_BITS(spread_between(&b, &a, south_west), 0.0);
    CHECK_SAME_BITS(spread_between(&b, &a, north_east), sqrt(50.0));
    CHECK_SAME_BITS(spread_between(&a, &none, east), 0.0);
    CHECK_SAME_BITS(spread_between(&none, &a, south_west), 0.0);
}

TEST(close_ones_and_any_two_have_margins_of_their_own)
{
    struct config c = {0};
    struct spread wave = spread_of(0, 0, 2.5, 0, 2.5);
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c, (struct margins){.close = 1.0, .wide = 3.0});
    CHECK(!rebuild_plan_step(&plan, 0.4, NULL));
    CHECK(rebuild_plan_step(&plan, 0.2, NULL)); /* 1.2: no survey shows that neighbours moved alike */
    wave.close = 0.3;
    CHECK(!rebuild_plan_step(&plan, 0.4, &wave)); /* 0.3, and 0.4 for mirrored elements a step behind */
    CHECK_NEAR(plan.close, 0.7, 1e-15);
    CHECK_NEAR(plan.approach, 2.0, 1e-15);
    wave.close = 2.0;
    CHECK(!rebuild_plan_step(&plan, 0.1, &wave)); /* known to be at most 0.9 */
    CHECK_NEAR(plan.close, 0.9, 1e-15);
    wave.close = 0.0;
    CHECK(!rebuild_plan_step(&plan, 0.5, &wave));
    CHECK(plan.close <= plan.approach);
    CHECK_NEAR(plan.approach, 2.5, 1e-15);
}

TEST_MAIN(CASE(bins_are_compared_by_their_boxes_and_circles), CASE(what_parts_them_does_not_count),
          CASE(close_ones_and_any_two_have_margins_of_their_own),
          CASE(a_pair_approaches_by_no_more_than_box_and_circle_allow),
          CASE(a_survey_lowers_the_bound_and_never_raises_it),
          CASE(lists_last_while_twice_dumax_is_within_the_margin), CASE(every_k_steps_as_well),
          CASE(cells_alone_rebuild_every_step), CASE(the_guess_looks_one_step_ahead), CASE(nonsense_rebuilds))
