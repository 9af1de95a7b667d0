/* Tables taken over at a checkpoint, and the distance between copies. */
#include "dm2/sim/resume.h"

#include <string.h>

#include "check.h"
#include "dm2/dist/copies.h"

static bool tens(const void *context, int64_t step)
{
    (void)context;
    return step % 10 == 0;
}

static enum dm2_status keep(const char *text, int64_t step, int64_t rows, size_t *kept, struct dm2_error *err)
{
    const struct resume_plan plan = {.due = tens, .rows = rows, .step = step};
    return resume_keep("table", (const unsigned char *)text, strlen(text), &plan, kept, err);
}

TEST(keeps_what_is_before_the_checkpoint)
{
    struct dm2_error err = {0};
    size_t kept = 0;
    const char *text = "step,a\n0,1\n10,2\n20,3\n30,";
    CHECK_EQ_INT(keep(text, 20, 1, &kept, &err), DM2_OK);
    CHECK_EQ_INT(kept, strlen("step,a\n0,1\n10,2\n"));
    CHECK_EQ_INT(keep(text, 21, 1, &kept, &err), DM2_OK);
    CHECK_EQ_INT(kept, strlen("step,a\n0,1\n10,2\n20,3\n"));
    CHECK_EQ_INT(keep("step,a\n0,1\n0,2\n10,1\n10,2\n", 10, 2, &kept, &err), DM2_OK);
    CHECK_EQ_INT(kept, strlen("step,a\n0,1\n0,2\n"));
}

TEST(misses_no_row)
{
    struct dm2_error err = {0};
    size_t kept = 0;
    CHECK_EQ_INT(keep("step,a\n0,1\n20,3\n", 25, 1, &kept, &err), DM2_PROTOCOL);
    CHECK(strstr(err.text, "table: the row of step 10 is missing") != NULL);
    CHECK_EQ_INT(keep("step,a\n0,1\n10,2\n20,3", 25, 1, &kept, &err), DM2_PROTOCOL);
    CHECK_EQ_INT(keep("step,a\n0,1\n100,2\n20,3\n", 25, 1, &kept, &err), DM2_PROTOCOL);
    CHECK_EQ_INT(keep("", 25, 1, &kept, &err), DM2_PROTOCOL);
    CHECK_EQ_INT(keep("step,a\n0,1\n0,1\n10,2\n", 15, 1, &kept, &err), DM2_PROTOCOL);
}

TEST(copies_cost_two_percent)
{
    struct copy_plan plan;
    copy_plan_start(&plan, -1, 100);
    CHECK(!copy_plan_due(&plan, 119));
    CHECK(copy_plan_due(&plan, 120));
    copy_plan_plain(&plan, 0.001);
    copy_plan_done(&plan, 120, 0.011);
    CHECK(!copy_plan_due(&plan, 619));
    CHECK(copy_plan_due(&plan, 621));
    copy_plan_start(&plan, 0, 0);
    CHECK(!copy_plan_due(&plan, 1000000));
    copy_plan_start(&plan, 7, 0);
    CHECK(copy_plan_due(&plan, 7));
    copy_plan_done(&plan, 7, 1);
    CHECK(!copy_plan_due(&plan, 13));
}

TEST_MAIN(CASE(keeps_what_is_before_the_checkpoint), CASE(misses_no_row), CASE(copies_cost_two_percent))
