/* The near pairs sorted for the pair loop: links of one law in fours, and the rest.
 *
 * Most near pairs of a solid are links whose law has all its constants worked out. They stand here in quads
 * of one law, so that the loop over them gathers nothing but the state of the elements; whatever is left,
 * unlinked pairs, other laws, and up to three links of each law and chunk of rows, is taken one by one. The
 * list says where a pair is looked at, not what happens to it: a link that has broken since is found by its
 * memory in the near list. */
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

/* The quads first .. first + n - 1 have one law. */
struct link_group {
    const struct pair_law *law;
    size_t first, n;
};

/* An entry that is taken alone: row and entry. */
struct single_pair {
    uint32_t i, k;
};

struct link_list {
    struct link_quad *quad;
    struct link_group *group; /* [chunks of rows][laws of the model] */
    struct single_pair *single;
    uint16_t
        *kind; /* [n] of each slot when the pairs were sorted; kept where elements may change their kind */
    size_t quad_cap, n_groups, group_cap, n_single, single_cap, kind_cap;
    bool valid; /* false after a rebuild */
};

/* Sorts the pairs of rows [first, last) of the near list into `links`, where they are not sorted yet or
 * elements have changed their kind since. linked: of each entry of `near`. 0, or -1 without memory. */
int link_list_prepare(struct link_list *links, const struct half_list *near, const uint8_t *linked,
                      uint32_t first, uint32_t last, const struct model *m, const struct particles *p);
void link_list_free(struct link_list *links);
size_t link_list_bytes(const struct link_list *links);

#endif
