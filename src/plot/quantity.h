/* The quantity that colours the discs of a picture: an entry of the table in quantity.c, or any other
 * array of the points.
 *
 * A quantity gives one number per element, from the tuple that an array of the snapshot has for the
 * element. */
#ifndef DM2_PLOT_QUANTITY_H
#define DM2_PLOT_QUANTITY_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/plot/vtp_reader.h"

enum scheme { SCHEME_CATEGORY, SCHEME_SEQUENTIAL, SCHEME_DIVERGING };

enum { QUANTITY_CATEGORIES_MAX = 24 }; /* in a legend */

struct quantity_entry {
    const char *word, *label, *array; /* of --colour; beside the colour bar; in the file */
    enum scheme scheme;
    double (*value)(const double *tuple);
};

struct shown_quantity {
    const struct vtp *vtp;
    struct quantity_entry entry;
    char name[2 * VTP_NAME_MAX]; /* the label of an array that is not in the table */
    const double *values;        /* n_points tuples, `components` apart */
    size_t components;
    double low, high; /* the range of the colours */
};

/* The words for the command line, blank-separated. */
const char *quantity_words(void);

/* Writes the names of the arrays of the points, blank-separated, to out[0..size), cut where there are
 * many. */
void quantity_list_arrays(const struct vtp *vtp, char *out, size_t size);

/* Finds `word` in the table, else among the arrays of the file: NAME or NAME:COMPONENT, components from 1.
 * `vtp` and `word` are borrowed. Do not copy *q afterwards, because its label may point into *q.
 * DM2_USAGE: an unknown word, or the file lacks the array. */
enum dm2_status quantity_choose(struct shown_quantity *q, const struct vtp *vtp, const char *word,
                                struct dm2_error *err);

/* Sets q->low and q->high to `range`, or where range[0] is NaN to the smallest and largest finite value,
 * which a diverging scheme makes symmetric about 0. An empty range is widened. DM2_USAGE: `range` is given
 * but not finite with range[0] < range[1]. */
enum dm2_status quantity_choose_range(struct shown_quantity *q, const double range[2], struct dm2_error *err);

/* The value of point i. */
double quantity_value(const struct shown_quantity *q, size_t i);

/* Writes the name of a category for the legend: of its material or body, else the quantity's word and the
 * number. */
void quantity_category_name(const struct shown_quantity *q, size_t category, char *out, size_t size);

/* The colour of a category, an index below COLOUR_CATEGORIES. A value that is no category counts as
 * category 0. */
uint32_t quantity_category_colour(const struct shown_quantity *q, double value);

/* Writes the categories that occur to `out`, ascending, and returns their number. After
 * QUANTITY_CATEGORIES_MAX + 1 of them the others are left out. */
size_t quantity_categories(const struct shown_quantity *q, size_t out[QUANTITY_CATEGORIES_MAX + 1]);

#endif
