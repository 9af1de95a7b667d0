/* In every instability D/S goes to 1, because the energy that appears becomes the largest that moved. So one
 * share tells an unstable run in any deck. */
#include "energy_book.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double share_of_warning = 0.01, share_of_end = 0.5;

static double larger(double a, double b)
{
    return a > b ? a : b;
}

/* --- rows --- */

void energy_book_start(struct energy_book *book, int shift)
{
    *book = (struct energy_book){.least = ldexp(1.0, 40 - shift)}; /* a bond at 100 %: 2^(80 - shift) */
}

double energy_book_add(struct energy_book *book, const struct book_row *row)
{
    if (book->rows++ == 0) {
        book->first = *row;
        book->moved = row->elements * book->least;
    }
    book->moved = larger(book->moved, larger(fabs(row->kinetic), fabs(row->work)));
    for (int a = 0; a < BOOK_ACCOUNTS; a++)
        book->moved = larger(book->moved, fabs(row->account[a] - book->first.account[a]));
    book->last = row->step;
    book->off = row->total - book->first.total;
    book->drift = book->moved > 0.0 ? book->off / book->moved : 0.0;
    if (fabs(book->drift) > fabs(book->worst)) {
        book->worst = book->drift;
        book->worst_step = row->step;
    }
    return book->drift;
}

enum dm2_status energy_book_replay(struct energy_book *book, const struct csv *table, struct dm2_error *err)
{
    static const char *const names[] = {"step",    "kinetic", "work",     "total", "potential",
                                        "elastic", "thermal", "chemical", "phase", "elements"};
    enum { COLUMNS = sizeof names / sizeof names[0] };
    double *column[COLUMNS] = {NULL};
    enum dm2_status status = DM2_OK;
    for (size_t k = 0; k < COLUMNS && status == DM2_OK; k++) {
        size_t at;
        if (csv_column(table, names[k], &at, err) != DM2_OK)
            status = dm2_fail(err, DM2_PROTOCOL,
                              "%s: has no column '%s': a table of this release is needed to continue the run",
                              table->path, names[k]);
        else
            status = csv_numbers(table, at, &column[k], err);
    }
    for (size_t r = 0; r < table->n_rows && status == DM2_OK; r++) {
        struct book_row row = {.step = (int64_t)column[0][r],
                               .kinetic = column[1][r],
                               .work = column[2][r],
                               .total = column[3][r],
                               .elements = column[9][r]};
        for (int a = 0; a < BOOK_ACCOUNTS; a++)
            row.account[a] = column[4 + a][r];
        (void)energy_book_add(book, &row);
    }
    for (size_t k = 0; k < COLUMNS; k++)
        free(column[k]);
    return status;
}

/* --- verdict --- */

enum dm2_status energy_book_check(const struct energy_book *book, double dt, struct dm2_error *err)
{
    if (!(fabs(book->drift) > share_of_end))
        return DM2_OK;
    return dm2_fail(err, DM2_NUMERIC,
                    "step %lld: the energy book is off by %.0f %% of what moved (%.3g g cm2/us2): the run is "
                    "unstable; choose dt below %.2g us",
                    (long long)book->last, 100.0 * fabs(book->drift), book->moved, 0.5 * dt);
}

void energy_book_verdict(const struct energy_book *book, double dt, struct results_verdict *out)
{
    char since[48] = "";
    *out = (struct results_verdict){.warning = ""};
    if (book->first.step > 0)
        (void)snprintf(since, sizeof since, "since step %" PRId64 " ", book->first.step);
    if (book->rows < 2)
        (void)snprintf(out->energy, sizeof out->energy,
                       "energy: the drift of total is not known, because history.csv has fewer than two rows "
                       "(output.history_every)");
    else
        (void)snprintf(out->energy, sizeof out->energy,
                       "energy: %stotal drifted by %.3g %% of what moved (%#.3g g cm2/us2; worst %.2g %% at "
                       "step %" PRId64 ")",
                       since, 100.0 * book->drift, book->moved, 100.0 * book->worst, book->worst_step);
    if (fabs(book->worst) > share_of_warning)
        (void)snprintf(out->warning, sizeof out->warning,
                       "warning: the energy book is off by %.3g %% at step %" PRId64 ": halve dt (%.3g us)",
                       100.0 * fabs(book->worst), book->worst_step, 0.5 * dt);
}
