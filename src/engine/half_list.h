/* Half lists: a pair is in the row of its lower slot, which is owned. lists.h builds the two half lists of a
 * subdomain; inner.h and links.h draw their lists from these two. */
#ifndef DM2_ENGINE_HALF_LIST_H
#define DM2_ENGINE_HALF_LIST_H

#include <stddef.h>
#include <stdint.h>

/* Row i is entries start[i] .. start[i+1]-1. */
struct half_list {
    uint32_t *start; /* [n_own + 1] */
    uint32_t *j;     /* [start[n_own]] partner of each entry: its slot in the near list, twice its slot (the
                        component x) in the far list */
    size_t row_cap, cap;
};

/* The rows are in two parts. No pair of the first has a mirrored element, so the forces of its pairs can be
 * evaluated before the mirrored elements' new positions are known. */
enum list_part {
    PART_INSIDE, /* rows [0, n_inside): elements of own cells that no mirrored cell surrounds */
    PART_EDGE,   /* rows [n_inside, n_own) */
    PART_COUNT
};

#endif
