/* schedule.csv: which rows are due, what a change of schedule leaves, and files that are no schedule. */
#include "output/schedule_book.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "scratch.h"

static struct output_config every(int64_t history, int64_t snapshots, int64_t *at, size_t n)
{
    return (struct output_config){
        .history_every = history, .snapshot_every = snapshots, .snapshot_at = at, .n_snapshot_at = n};
}

/* The file of a book. */
static void check_text(const struct schedule_book *b, const char *want)
{
    struct dm2_error err = {0};
    CHECK_EQ_INT(schedule_book_write(scratch_path("schedule.csv"), b, &err), DM2_OK);
    char *text = scratch_read("schedule.csv", NULL);
    CHECK_STR(text, want);
    free(text);
}

TEST(changes_of_a_schedule)
{
    struct schedule_book b = {0};
    struct dm2_error err = {0};
    struct profile_config profile = {.name = "across", .every = 20};
    int64_t at[] = {3, 30};
    struct config c = {.profiles = &profile, .n_profiles = 1, .output = every(10, 0, at, 2)};
    scratch_begin();
    CHECK_EQ_INT(schedule_book_change(&b, 0, &c, &err), DM2_OK);
    check_text(&b, "from_step,table,every,also\n0,history.csv,10,\n0,profile-across.csv,20,\n"
                   "0,fragments.csv,0,3 30\n");
    CHECK_EQ_INT(schedule_book_change(&b, 40, &c, &err), DM2_OK); /* the same schedule: no line */
    CHECK_EQ_INT(b.n, 3);
    c.output = every(15, 7, at, 2);
    CHECK_EQ_INT(schedule_book_change(&b, 40, &c, &err), DM2_OK);
    check_text(&b, "from_step,table,every,also\n0,history.csv,10,\n0,profile-across.csv,20,\n"
                   "0,fragments.csv,0,3 30\n40,history.csv,15,\n40,fragments.csv,7,3 30\n");
    CHECK(schedule_book_due(&b, "history.csv", 30) && !schedule_book_due(&b, "history.csv", 40));
    CHECK(schedule_book_due(&b, "history.csv", 45) && !schedule_book_due(&b, "history.csv", 50));
    CHECK(schedule_book_due(&b, "fragments.csv", 30) && !schedule_book_due(&b, "fragments.csv", 7));
    CHECK(schedule_book_due(&b, "fragments.csv", 42) && !schedule_book_due(&b, "cracks.csv", 0));
    CHECK_EQ_INT(schedule_book_stop(&b, 63, &err), DM2_OK);
    /* A run that goes on from before these changes drops them. */
    c.output = every(10, 0, at, 2);
    CHECK_EQ_INT(schedule_book_change(&b, 40, &c, &err), DM2_OK);
    CHECK_EQ_INT(b.n, 3);
    CHECK(schedule_book_line(&b, "stop", 63) == NULL);
    schedule_book_free(&b);
    scratch_end();
}

TEST(a_file_reads_back)
{
    struct schedule_book b = {0};
    struct dm2_error err = {0};
    static const char text[] = "from_step,table,every,also\n5,history.csv,10,\n5,fragments.csv,0,5 8 13\n"
                               "9,fragments.csv,4,5 8 13\n12,stop,0,\n";
    scratch_begin();
    CHECK_EQ_INT(schedule_book_read(scratch_path("absent"), &b, &err), DM2_OK);
    CHECK_EQ_INT(b.n, 0);
    scratch_write("schedule.csv", text);
    CHECK_EQ_INT(schedule_book_read(scratch_path("schedule.csv"), &b, &err), DM2_OK);
    CHECK_EQ_INT(b.n, 4);
    CHECK(!schedule_book_due(&b, "history.csv", 0)); /* before its first line */
    CHECK(schedule_book_due(&b, "fragments.csv", 8) && schedule_book_due(&b, "fragments.csv", 12));
    CHECK(schedule_book_line(&b, "stop", 12) != NULL && schedule_book_line(&b, "stop", 11) == NULL);
    check_text(&b, text);
    schedule_book_free(&b);
    scratch_end();
}

TEST(files_that_are_no_schedule)
{
    static const char *const rows[] = {"x,history.csv,10,\n",
                                       "-1,history.csv,10,\n",
                                       "0,history.csv,-1,\n",
                                       "0,history.csv,1.5,\n",
                                       "0,history.csv,,\n",
                                       "0,fragments.csv,0,3 3\n",
                                       "0,fragments.csv,0,4 3\n",
                                       "0,fragments.csv,0,a\n",
                                       "99999999999999999999,history.csv,1,\n",
                                       "7,history.csv,1,\n7,history.csv,2,\n",
                                       "7,history.csv,1,\n3,history.csv,2,\n"};
    scratch_begin();
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        struct schedule_book b;
        struct dm2_error err = {0};
        char text[200];
        (void)snprintf(text, sizeof text, "from_step,table,every,also\n%s", rows[k]);
        scratch_write("schedule.csv", text);
        CHECK_REPORT(schedule_book_read(scratch_path("schedule.csv"), &b, &err) == DM2_PROTOCOL, "%s",
                     rows[k]);
        CHECK_CONTAINS(err.text, "is no line of a schedule");
        schedule_book_free(&b);
    }
    struct schedule_book b;
    struct dm2_error err = {0};
    scratch_write("schedule.csv", "step,table,every,also\n");
    CHECK_EQ_INT(schedule_book_read(scratch_path("schedule.csv"), &b, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "has not the columns of a schedule");
    schedule_book_free(&b);
    scratch_end();
}

TEST_MAIN(CASE(changes_of_a_schedule), CASE(a_file_reads_back), CASE(files_that_are_no_schedule))
