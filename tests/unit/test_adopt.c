/* The state from which a run goes on becomes checkpoint.dm2; the states that the run has not come to go. */
#include "output/adopt.h"

#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "scratch.h"

static const char *const names[] = {"checkpoint.dm2", "checkpoint.prev.dm2", "final.dm2", "mine.dm2"};
enum { NAMES = sizeof names / sizeof names[0] };

/* Adopts `state` in a directory that has the states of `there`, a letter each (now, before, last, mine; '-':
 * absent), and compares what is left. */
static void check_adopted(const char *state, bool ended, const char *there, const char *left)
{
    struct dm2_error err = {0};
    scratch_begin();
    for (int k = 0; k < NAMES; k++)
        if (there[k] != '-')
            scratch_write(names[k], (char[]){there[k], '\0'});
    char directory[600], path[700];
    (void)snprintf(directory, sizeof directory, "%s", scratch_path("."));
    (void)snprintf(path, sizeof path, "%s/%s", directory, state);
    CHECK_EQ_INT(adopt_state(directory, path, ended, &err), DM2_OK);
    for (int k = 0; k < NAMES; k++) {
        char *text = scratch_exists(names[k]) ? scratch_read(names[k], NULL) : NULL;
        CHECK_REPORT((text == NULL ? '-' : text[0]) == left[k], "%s of %s: %s is %s, not %c", state, there,
                     names[k], text == NULL ? "absent" : text, left[k]);
        free(text);
    }
    scratch_end();
}

TEST(the_newest_state_is_the_checkpoint)
{
    check_adopted("checkpoint.dm2", false, "nbl-", "nb--"); /* later states go, earlier ones stay */
    check_adopted("checkpoint.dm2", false, "n---", "n---");
    check_adopted("checkpoint.prev.dm2", false, "nbl-", "b---");
    check_adopted("final.dm2", false, "nbl-", "ln--");
    check_adopted("final.dm2", false, "--l-", "l---");
    check_adopted("mine.dm2", false, "nblm", "m--m"); /* a file of the user's is copied */
}

TEST(the_last_state_of_a_run_keeps_its_name)
{
    check_adopted("final.dm2", true, "nbl-", "nbl-");
    check_adopted("final.dm2", true, "--l-", "--l-");
}

TEST(a_state_that_is_not_there)
{
    struct dm2_error err = {0};
    char directory[600], path[700];
    scratch_begin();
    (void)snprintf(directory, sizeof directory, "%s", scratch_path("."));
    (void)snprintf(path, sizeof path, "%s/mine.dm2", directory);
    scratch_write("checkpoint.dm2", "n");
    scratch_write("final.dm2", "l");
    CHECK_EQ_INT(adopt_state(directory, path, false, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "mine.dm2");
    CHECK(scratch_exists("checkpoint.dm2") && scratch_exists("final.dm2")); /* a state still leads on */
    scratch_end();
}

TEST_MAIN(CASE(the_newest_state_is_the_checkpoint), CASE(the_last_state_of_a_run_keeps_its_name),
          CASE(a_state_that_is_not_there))
