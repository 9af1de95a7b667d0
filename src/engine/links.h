/* The near pairs sorted for the pair loop: links of one law in fours, and single pairs.
 *
 * Most near pairs of a solid are links whose law has all its constants (law.h, bond). The list holds these
 * links in quads of one law, so that the loop over quads gathers only the state of the elements. All other
 * pairs are single: unlinked pairs, pairs of other laws, and up to three links of each law and chunk of rows.
 * The list decides how a pair is evaluated, not its status: the memory in the near list tells that a link has
 * broken since. */
#ifndef DM2_ENGINE_LINKS_H
#define DM2_ENGINE_LINKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/simd.h"

struct model;
struct particles;
struct half_list;
struct pair_law;

/* Four entries k of the near list, of rows i, with partners j. */
struct link_quad {
    uint32_t i[SIMD_LANES], j[SIMD_LANES], k[SIMD_LANES];
};

/* Quads first .. first + n - 1, of one law. */
struct link_group {
    const struct pair_law *law;
    size_t first, n;
};

/* Entry k of the near list, of row i, evaluated alone. */
struct single_pair {
    uint32_t i, k;
};

struct link_list {
    struct link_quad *quad;
    struct link_group *group; /* [chunks of rows][laws of the model] */
    struct single_pair *single;
    uint16_t *kind; /* [n] kinds of the slots at the sorting; only where elements may change their kind */
    size_t quad_cap, n_groups, group_cap, n_single, single_cap, kind_cap;
    bool valid; /* false from a rebuild to the next sorting */
};

/* Sorts the pairs of rows [first, last) of the near list into `links`, unless these pairs are sorted already
 * and no element has changed its kind since. linked: of each entry of `near`. 0, or -1 without memory. */
int link_list_prepare(struct link_list *links, const struct half_list *near, const uint8_t *linked,
                      uint32_t first, uint32_t last, const struct model *m, const struct particles *p);
void link_list_free(struct link_list *links);

/* Bytes allocated. */
size_t link_list_bytes(const struct link_list *links);

#endif
