/* In every instability D/S goes to 1, because the energy that appears becomes the largest that moved. So one
 * share tells an unstable run in any deck. */
#include "energy_book.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double share_of_warning = 0.01, share_of_end = 0.5, share_of_limit = 0.9;

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
    if (row->dt_share > book->dt_share) {
        book->dt_share = row->dt_share;
        book->compression = row->compression;
        book->share_step = row->step;
    }
    return book->drift;
}

enum dm2_status energy_book_replay(struct energy_book *book, const struct csv *table, struct dm2_error *err)
{
    static const char *const names[] = {"step",     "kinetic",  "work",       "total", "potential",
                                        "elastic",  "thermal",  "chemical",   "phase", "damped",
                                        "elements", "dt_share", "compression"};
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
                               .elements = column[10][r],
                               .dt_share = column[11][r],
                               .compression = column[12][r]};
        for (int a = 0; a < BOOK_ACCOUNTS; a++)
            row.account[a] = column[4 + a][r];
        (void)energy_book_add(book, &row);
    }
    for (size_t k = 0; k < COLUMNS; k++)
        free(column[k]);
    return status;
}

/* --- verdict --- */

/* A compression in %, without the rounding of places. */
static double percent(double compression)
{
    return compression > 1e-8 ? 100.0 * compression : 0.0;
}

/* "; at step N dt was 0.86 of what was stable then, bonds compressed by up to 12 %", or nothing where the
 * limit is not known. */
static void describe_limit(const struct energy_book *book, char *out, size_t size)
{
    out[0] = '\0';
    if (book->dt_share > 0.0)
        (void)snprintf(out, size,
                       "; at step %" PRId64 " dt was %.2g of what was stable then, bonds compressed by up to "
                       "%.2g %%",
                       book->share_step, book->dt_share, percent(book->compression));
}

enum dm2_status energy_book_check(const struct energy_book *book, double dt, struct dm2_error *err)
{
    char limit[160];
    if (!(fabs(book->drift) > share_of_end))
        return DM2_OK;
    describe_limit(book, limit, sizeof limit);
    return dm2_fail(err, DM2_NUMERIC,
                    "step %" PRId64 ": the energy book is off by %.0f %% of what moved (%.3g g cm2/us2): the "
                    "run is unstable, or dt is far too large%s; choose dt below %.2g us",
                    book->last, 100.0 * fabs(book->drift), book->moved, limit, 0.5 * dt);
}

bool energy_book_warns(struct energy_book *book, double dt, char *line)
{
    if (book->told || book->dt_share < share_of_limit)
        return false;
    book->told = true;
    (void)snprintf(line, RESULTS_LINE,
                   "warning: step %" PRId64
                   ": dt is %.2g of what is stable now (%.3g us), bonds are compressed "
                   "by up to %.2g %%: the run may become unstable; choose half of dt",
                   book->share_step, book->dt_share, dt / book->dt_share, percent(book->compression));
    return true;
}

static void write_energy(const struct energy_book *book, char *out)
{
    char since[48] = "", limit[80] = "";
    if (book->first.step > 0)
        (void)snprintf(since, sizeof since, "since step %" PRId64 " ", book->first.step);
    if (book->dt_share > 0.0)
        (void)snprintf(limit, sizeof limit, "; dt at most %.2g of the limit (step %" PRId64 ")",
                       book->dt_share, book->share_step);
    if (book->rows < 2)
        (void)snprintf(out, RESULTS_LINE,
                       "energy: the drift of total is not known, because history.csv has fewer than two rows "
                       "(output.history_every)%s",
                       limit);
    else
        (void)snprintf(out, RESULTS_LINE,
                       "energy: %stotal drifted by %.3g %% of what moved (%#.3g g cm2/us2; worst %.2g %% at "
                       "step %" PRId64 ")%s",
                       since, 100.0 * book->drift, book->moved, 100.0 * book->worst, book->worst_step, limit);
}

void energy_book_verdict(const struct energy_book *book, double dt, struct results_verdict *out)
{
    char limit[160];
    describe_limit(book, limit, sizeof limit);
    out->warning[0] = '\0';
    write_energy(book, out->energy);
    if (fabs(book->worst) > share_of_warning)
        (void)snprintf(out->warning, sizeof out->warning,
                       "warning: the energy book is off by %.3g %% at step %" PRId64 "%s: halve dt (%.3g us)",
                       100.0 * fabs(book->worst), book->worst_step, limit, 0.5 * dt);
    else if (book->dt_share >= share_of_limit)
        (void)snprintf(out->warning, sizeof out->warning,
                       "warning: dt came near its limit%s: halve dt (%.3g us)", limit, 0.5 * dt);
}
