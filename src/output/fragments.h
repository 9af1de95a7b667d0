/* Fragments: the connected components of the graph of links. */
#ifndef DM2_OUTPUT_FRAGMENTS_H
#define DM2_OUTPUT_FRAGMENTS_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/element.h"

struct fragment_counts {
    size_t fragments; /* all of them, */
    size_t single;    /* those of one element, */
    size_t largest;   /* and the elements of the largest */
};

/* Numbers the fragments from 0, the one with most elements first and of equal ones that with the lowest id,
 * and writes each element's fragment to fragment[0 .. n_elements). Elements in id order; of the pairs, in any
 * order, those that are linked join their elements; one that names an absent element joins nothing. The
 * result depends on which links there are alone. DM2_MEMORY. */
enum dm2_status fragments_find(const struct element *elements, size_t n_elements,
                               const struct pair_record *pairs, size_t n_pairs, uint32_t *fragment,
                               struct fragment_counts *counts, struct dm2_error *err);

#endif
