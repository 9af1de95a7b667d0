/* The energy book of a run: by how much `total` has drifted, compared with the energies that moved. It is
 * computed from the numbers of history.csv as written, so that a continued run, which reads the rows before
 * its checkpoint, has the same book without any state.
 *
 *   D = total - total of the first row
 *   S = largest so far of |kinetic|, |work| and |A - A of the first row| for each account A
 *   drift = D/S
 *
 * S is at least elements * 2^-40 * (the energy of a bond strained by 100 %), because below this the rounding
 * of fixed-point sums alone makes D. */
#ifndef DM2_OUTPUT_ENERGY_BOOK_H
#define DM2_OUTPUT_ENERGY_BOOK_H

#include <stdbool.h>
#include <stdint.h>

#include "dm2/base/csv.h"
#include "dm2/base/status.h"
#include "dm2/output/results.h"

enum { BOOK_ACCOUNTS = 6 }; /* potential, elastic, thermal, chemical, phase, damped */

/* The numbers of one row of history.csv that the book needs; energies in g cm2/us2. */
struct book_row {
    int64_t step;
    double kinetic, work, total, account[BOOK_ACCOUNTS];
    double elements;
    double dt_share, compression; /* dm2/engine/measures.h */
};

struct energy_book {
    double least; /* of S per element, g cm2/us2 */
    int64_t rows; /* rows so far */
    struct book_row first;
    double moved, off;  /* S and D of the last row, g cm2/us2 */
    double drift;       /* D/S of the last row */
    int64_t last;       /* step of the last row */
    double worst;       /* the drift of largest magnitude so far, with its sign */
    int64_t worst_step; /* of `worst` */
    double dt_share;    /* the largest so far, */
    double compression; /* the compression with it, */
    int64_t share_step; /* and their step */
    bool told;          /* energy_book_warns has been true */
};

/* A book without rows. shift: measure_scales.energy. */
void energy_book_start(struct energy_book *book, int shift);

/* Adds the next row. Returns its drift. */
double energy_book_add(struct energy_book *book, const struct book_row *row);

/* Adds the rows of a table of the history. DM2_MEMORY; DM2_PROTOCOL where a column is absent or a field is
 * not a number. */
enum dm2_status energy_book_replay(struct energy_book *book, const struct csv *table, struct dm2_error *err);

/* DM2_NUMERIC where the last row is off by more than 50 %: the run is unstable. dt in us. */
enum dm2_status energy_book_check(const struct energy_book *book, double dt, struct dm2_error *err);

/* True once, with a line for the user (RESULTS_LINE bytes), when dt first comes near the limit that holds
 * now: 0.9 of it or more. dt in us. */
bool energy_book_warns(struct energy_book *book, double dt, char *line);

/* What results_verdict gives. dt in us. */
void energy_book_verdict(const struct energy_book *book, double dt, struct results_verdict *out);

#endif
