/* The neighbour lists (paper, sections 2.1 and 4), as half lists (half_list.h).
 *
 * There are two lists, because pairs without memory and status cost less: `far` holds the pairs within the
 * cutoff of a potential of scope `all`, plus dR; `near` holds the pairs that are linked or can come into
 * contact before the margin of close pairs is spent (struct margins), with the memory of each pair. A pair
 * may be in both. */
#ifndef DM2_ENGINE_LISTS_H
#define DM2_ENGINE_LISTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/status.h"
#include "dm2/engine/crack.h"
#include "dm2/engine/overlap.h"
#include "bins.h"
#include "cells.h"
#include "half_list.h"
#include "inner.h"
#include "links.h"
#include "particles.h"

/* The memory of a pair that survives a rebuild, in the row of its lower new slot. */
struct carried_pair {
    uint32_t b; /* higher new slot */
    bool linked;
    double stretch, spring; /* cm */
};

/* The force of a near pair on the element of its row. */
struct entry_force {
    int64_t f[2];              /* x, y: the integers that the sums add */
    double normal, tangential; /* Mbar cm2; normal: > 0 pushes apart */
    uint64_t acts;             /* 0: the pair neither touches nor is linked; all else is 0 then */
};

struct lists {
    struct half_list far, near;
    size_t n_inside;                     /* rows of PART_INSIDE */
    struct inner_list inner[PART_COUNT]; /* of the far list */
    struct link_list links[PART_COUNT];  /* of the near list */
    uint8_t *linked;                     /* memory of the near pairs, per entry */
    double *stretch, *spring;            /* likewise, cm */
    size_t memory_cap;
    struct entry_force *forces; /* [n_forces] per near entry; NULL: not kept (pair_forces.h) */
    size_t n_forces;
    struct bins bins;    /* of the last build that used bins */
    uint32_t *rows;      /* carried memory for the next build: where each row starts */
    double *carried;     /* [pairs][2] stretch and spring */
    uint32_t *carried_b; /* [pairs] behind `carried`: b, and CARRIED_LINKED */
    void *carried_own;   /* the block of both, where the lent room is too small */
    size_t carried_own_cap, rows_cap;
    double *kept; /* lists_keep_memory, of the near pairs of PART_INSIDE: spring (with `springs`), stretch,
                     linked */
    size_t kept_cap;
    struct crack_list cracks; /* of the last evaluation, or of the one under way */
    struct overlap overlap; /* of the initial build: pairs of this subdomain, each counted by the owner of its
                               lower id */
};
#define CARRIED_LINKED (UINT32_C(1) << 31) /* slots are below 2^31 */

/* Memory is carried to the next build in two passes, so that the only room needed is that of the sorted
 * pairs: lists_carry_start, lists_carry_count of every pair by its lower new slot a, lists_carry_reserve,
 * lists_carry_place of every pair (a pair may come twice with the same memory). room: `bytes` bytes aligned
 * for doubles, lent by the caller until lists_build returns; 20 bytes a pair are enough. lists_carry_start,
 * lists_carry_reserve: 0, or -1 without memory. */
int lists_carry_start(struct lists *lists, size_t n_own);
static inline void lists_carry_count(struct lists *lists, uint32_t a)
{
    lists->rows[a + 2]++;
}
int lists_carry_reserve(struct lists *lists, size_t n_own, void *room, size_t bytes);
static inline void lists_carry_place(struct lists *lists, uint32_t a, struct carried_pair pair)
{
    size_t at = lists->rows[a + 1]++;
    lists->carried[2 * at] = pair.stretch;
    lists->carried[2 * at + 1] = pair.spring;
    lists->carried_b[at] = pair.b | (pair.linked ? CARRIED_LINKED : 0u);
}

/* Builds both lists for the elements of p, which are in cell order, and gives the new entries the carried
 * memory (the calls above, for p->n_own rows, come first). With `initial`, lattice neighbours whose law has
 * initial_link start linked, unless the pair is pressed together, and lists->overlap has the pressed pairs.
 * DM2_MEMORY; DM2_NUMERIC:
 * more than 2^32 - 1 entries. */
enum dm2_status lists_build(struct lists *lists, const struct model *m, const struct particles *p,
                            const struct cells *cells, bool initial, struct dm2_error *err);

/* Copies the memory of the near pairs of PART_INSIDE, which force_ahead changes, and restores it. springs:
 * the springs too, for decks that have any. lists_keep_memory: 0, or -1 without memory. */
int lists_keep_memory(struct lists *lists, bool springs);
void lists_restore_memory(struct lists *lists, bool springs);
void lists_free(struct lists *lists);

/* Bytes allocated. */
size_t lists_bytes(const struct lists *lists);

/* The rows [*first, *last) of a part. */
static inline void lists_rows(const struct lists *l, const struct particles *p, enum list_part part,
                              uint32_t *first, uint32_t *last)
{
    *first = part == PART_INSIDE ? 0 : (uint32_t)l->n_inside;
    *last = (uint32_t)(part == PART_INSIDE ? l->n_inside : p->n_own);
}

/* Does the near entry have any memory? */
static inline bool lists_remembers(const struct lists *l, size_t entry)
{
    return l->linked[entry] || l->stretch[entry] != 0.0 || l->spring[entry] != 0.0;
}

#endif
