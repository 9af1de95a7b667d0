/* dmax and dumax: when lists must be renewed. */
#include "check.h"

#include "dm2/sim/rebuild.h"

TEST(lists_last_while_twice_dumax_is_within_the_margin)
{
    struct config c = {.delta_r = 1.0};
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c);
    CHECK(!rebuild_plan_step(&plan, 0.25));
    CHECK(!rebuild_plan_step(&plan, 0.25)); /* 2 * 0.5 = dR: still valid */
    CHECK(rebuild_plan_step(&plan, 1e-9));
    rebuild_plan_done(&plan);
    CHECK(!rebuild_plan_step(&plan, 0.5));
    CHECK(rebuild_plan_step(&plan, 0.5));
}

TEST(every_k_steps_as_well)
{
    struct config c = {.delta_r = 1.0, .rebuild_every = 3};
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c);
    for (int k = 1; k <= 9; k++) {
        bool expected = rebuild_plan_expected(&plan);
        bool due = rebuild_plan_step(&plan, 0);
        CHECK_EQ_INT(due, k % 3 == 0);
        CHECK_EQ_INT(expected, due);
        if (due)
            rebuild_plan_done(&plan);
    }
}

TEST(cells_alone_rebuild_every_step)
{
    struct config c = {.delta_r = 1.0, .search = SEARCH_CELLS};
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c);
    CHECK(rebuild_plan_expected(&plan));
    CHECK(rebuild_plan_step(&plan, 0));
    rebuild_plan_done(&plan);
    CHECK(rebuild_plan_step(&plan, 0));
}

TEST(the_guess_looks_one_step_ahead)
{
    struct config c = {.delta_r = 1.0};
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c);
    CHECK(!rebuild_plan_expected(&plan));  /* nothing moved yet */
    CHECK(!rebuild_plan_step(&plan, 0.2)); /* 2 * (0.2 + 0.3) = 1 */
    CHECK(!rebuild_plan_expected(&plan));
    CHECK(!rebuild_plan_step(&plan, 0.2)); /* 2 * (0.4 + 0.3) > 1 */
    CHECK(rebuild_plan_expected(&plan));
}

TEST(nonsense_rebuilds)
{
    struct config c = {.delta_r = 1.0};
    struct rebuild_plan plan;
    rebuild_plan_start(&plan, &c);
    CHECK(rebuild_plan_step(&plan, NAN));
}

TEST_MAIN(CASE(lists_last_while_twice_dumax_is_within_the_margin), CASE(every_k_steps_as_well),
          CASE(cells_alone_rebuild_every_step), CASE(the_guess_looks_one_step_ahead), CASE(nonsense_rebuilds))
