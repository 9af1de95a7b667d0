/* The drift of the energy book: D/S row by row, the same from a table that is read back, its end and its
 * lines. */
#include "check.h"

#include <math.h>
#include <string.h>

#include "output/energy_book.h"

static struct book_row row(int64_t step, double kinetic, double potential, double work)
{
    return (struct book_row){.step = step,
                             .kinetic = kinetic,
                             .work = work,
                             .total = kinetic + potential - work,
                             .account = {potential},
                             .elements = 100};
}

TEST(drift_over_what_moved)
{
    struct energy_book book;
    struct dm2_error err = {0};
    struct results_verdict said;
    energy_book_start(&book, 80);
    struct book_row rows[] = {row(0, 4, -10, 0), row(10, 1, -7, 0), row(20, 0.5, -4.5, 2),
                              row(30, 4, -16, 0)};
    CHECK_NEAR(energy_book_add(&book, &rows[0]), 0, 0);
    energy_book_verdict(&book, 0.1, &said);
    CHECK_CONTAINS(said.energy, "not known");
    CHECK_NEAR(energy_book_add(&book, &rows[1]), 0, 0);
    CHECK_NEAR(energy_book_add(&book, &rows[2]), 0, 0);
    CHECK_NEAR(book.moved, 5.5, 0);
    CHECK_EQ_INT(energy_book_check(&book, 0.1, &err), DM2_OK);
    energy_book_verdict(&book, 0.1, &said);
    CHECK_STR(said.energy,
              "energy: total drifted by 0 % of what moved (5.50 g cm2/us2; worst 0 % at step 0)");
    CHECK_STR(said.warning, "");
    CHECK_NEAR(energy_book_add(&book, &rows[3]), -1, 0);
    CHECK_EQ_INT(energy_book_check(&book, 0.1, &err), DM2_NUMERIC);
    CHECK_CONTAINS(err.text, "step 30: the energy book is off by 100 % of what moved (6 g cm2/us2)");
    energy_book_verdict(&book, 0.1, &said);
    CHECK_CONTAINS(said.warning, "warning: the energy book is off by 100 % at step 30");
}

/* A lattice at rest: the last bits of its sums are no drift. */
TEST(rest_has_no_drift)
{
    struct energy_book book;
    energy_book_start(&book, 80);
    struct book_row rows[] = {row(0, 0, 0, 0), row(10, 0, 0x1p-51, 0)};
    CHECK_NEAR(energy_book_add(&book, &rows[0]), 0, 0);
    CHECK_NEAR(energy_book_add(&book, &rows[1]), 0, 1e-5);
}

TEST(rows_that_are_read_back)
{
    struct csv table;
    struct dm2_error err = {0};
    struct energy_book book;
    struct results_verdict said;
    char line[RESULTS_LINE];
    static const char text[] =
        "step,kinetic [g],potential,elastic,thermal,chemical,phase,work,total,elements,dt_share,compression,"
        "damped\n"
        "40,1,0,0,0,0,0,0,1,7,0.95,0.12,0\n50,0.5,0.25,0,0,0,0,0,0.75,7,0.5,0.2,0\n";
    energy_book_start(&book, 80);
    CHECK_EQ_INT(csv_parse("table", text, strlen(text), &table, &err), DM2_OK);
    CHECK_EQ_INT(energy_book_replay(&book, &table, &err), DM2_OK);
    csv_free(&table);
    CHECK_NEAR(book.drift, -0.25, 0);
    energy_book_verdict(&book, 0.1, &said);
    CHECK_CONTAINS(said.energy, "energy: since step 40 total drifted by -25 %");
    CHECK_CONTAINS(said.energy, "; dt at most 0.95 of the limit (step 40)");
    CHECK_CONTAINS(said.warning,
                   "at step 40 dt was 0.95 of what was stable then, bonds compressed by up to 12 %");
    CHECK(energy_book_warns(&book, 0.1, line));
    CHECK_CONTAINS(line, "warning: step 40: dt is 0.95 of what is stable now (0.105 us)");
    CHECK(!energy_book_warns(&book, 0.1, line)); /* once */
    static const char old[] = "step,kinetic\n0,1\n";
    CHECK_EQ_INT(csv_parse("table", old, strlen(old), &table, &err), DM2_OK);
    CHECK_EQ_INT(energy_book_replay(&book, &table, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "table: has no column 'work'");
    csv_free(&table);
}

TEST_MAIN(CASE(drift_over_what_moved), CASE(rest_has_no_drift), CASE(rows_that_are_read_back))
