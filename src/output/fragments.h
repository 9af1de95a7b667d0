/* Fragments: the connected components of the graph of links. */
#ifndef DM2_OUTPUT_FRAGMENTS_H
#define DM2_OUTPUT_FRAGMENTS_H

#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/element.h"

struct fragment_counts {
    size_t fragments; /* number of fragments */
    size_t single;    /* number of fragments of one element */
    size_t largest;   /* number of elements in the largest fragment */
};

/* Numbers the fragments from 0, by falling number of elements and, of equally large fragments, by rising
 * lowest id, and writes each element's fragment to fragment[0 .. n_elements). `elements` in id order; `pairs`
 * in any order: a linked pair joins its elements, a pair that names an absent element joins nothing. The
 * result depends on the set of links alone. DM2_MEMORY. */
enum dm2_status fragments_find(const struct element *elements, size_t n_elements,
                               const struct pair_record *pairs, size_t n_pairs, uint32_t *fragment,
                               struct fragment_counts *counts, struct dm2_error *err);

#endif
