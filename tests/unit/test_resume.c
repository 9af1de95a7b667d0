/* Tables taken over at a checkpoint, and the distance between copies. */
#include "output/resume.h"

#include <string.h>

#include "cluster/copies.h"
#include "check.h"

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
    copy_plan_plain(&plan, false, 0.001);
    copy_plan_asked(&plan, 120);
    CHECK(!copy_plan_due(&plan, 121)); /* before the copy has arrived */
    CHECK_NEAR(copy_plan_done(&plan, false, 0.011), 0.010, 1e-12);
    for (int64_t n = 121; n <= 1090; n++) { /* two copies take 2 % of 1 s */
        CHECK(!copy_plan_due(&plan, n));
        copy_plan_plain(&plan, false, 0.001);
    }
    for (int64_t n = 1091; n <= 1110; n++)
        copy_plan_plain(&plan, false, 0.001);
    CHECK(copy_plan_due(&plan, 1111));
    copy_plan_asked(&plan, 1100); /* a checkpoint */
    CHECK(!copy_plan_due(&plan, 1111));
    copy_plan_start(&plan, 0, 0);
    CHECK(!copy_plan_due(&plan, 1000000));
    copy_plan_start(&plan, 7, 0);
    CHECK(copy_plan_due(&plan, 7));
    copy_plan_asked(&plan, 7);
    CHECK_NEAR(copy_plan_done(&plan, false, 1), 1, 1e-12);
    CHECK(!copy_plan_due(&plan, 13));
}

/* Runs in which every step, or some steps, have a snapshot that costs more than a copy: the share of the
 * copies. */
static double share(int snapshot_every, double step, double snapshot, double copy, int64_t steps)
{
    struct copy_plan plan;
    double all = 0, copies = 0;
    copy_plan_start(&plan, -1, 0);
    for (int64_t n = 1; n <= steps; n++) {
        bool snapped = snapshot_every > 0 && n % snapshot_every == 0, due = copy_plan_due(&plan, n);
        double seconds = step + (snapped ? snapshot : 0) + (due ? copy : 0);
        if (due) {
            copy_plan_asked(&plan, n);
            copies += copy_plan_done(&plan, snapped, seconds);
        } else {
            copy_plan_plain(&plan, snapped, seconds);
        }
        all += seconds;
    }
    return copies / all;
}

TEST(copies_beside_snapshots)
{
    const int every[] = {0, 1, 2, 7, 50};
    for (size_t k = 0; k < sizeof every / sizeof every[0]; k++) {
        double found = share(every[k], 0.001, 0.02, 0.004, 20000);
        CHECK_REPORT(found > 0.008 && found <= 0.02, "snapshots every %d steps: copies take %g", every[k],
                     found);
    }
}

TEST_MAIN(CASE(keeps_what_is_before_the_checkpoint), CASE(misses_no_row), CASE(copies_cost_two_percent),
          CASE(copies_beside_snapshots))
