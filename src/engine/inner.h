/* The inner list: the pairs of the far list that can come within the cutoff in a few steps, in fours.
 *
 * The far list reaches dR beyond the cutoff, so most of its pairs are out of reach at any one step. The inner
 * list keeps the pairs within a smaller margin and is drawn anew from the far list once an element has moved
 * half of that margin. Only pairs of force zero are left out, so no bit depends on the inner list, and each
 * server draws its own at any step. Source: two lists with two margins, Pall and Hess, Comput. Phys. Commun.
 * 184, 2641 (2013). */
#ifndef DM2_ENGINE_INNER_H
#define DM2_ENGINE_INNER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dm2/base/simd.h"

struct model;
struct particles;
struct half_list;
struct period;

/* Four pairs of one element. Elements are given by their x component, twice the slot; unused lanes hold slot
 * n, which is far from all elements. */
struct far_quad {
    uint32_t i, j[SIMD_LANES];
};

struct inner_list {
    struct far_quad *quad; /* [n + 1]; the last quad is a copy, for loops that load one quad ahead */
    size_t n, cap;
    double *drawn; /* [beyond - first of struct inner_part][2] positions at the drawing, cm */
    size_t drawn_cap;
    double margin; /* reach beyond the cutoff, cm; infinite: the whole far list */
    int served;    /* evaluations since the drawing */
    bool valid;    /* false from a rebuild to the next drawing */
};

/* Rows [first, last) of the far list; their pairs are of slots below `beyond`. */
struct inner_part {
    size_t first, last, beyond;
};

/* Draws the list anew unless the list is valid for the present positions of p. far: the far list of p, with
 * rows padded to fours, of which `part` is taken; cutoff: of the potential, cm; reach_more: the margin dR of
 * the far list, cm. 0, or -1 without memory. */
int inner_list_prepare(struct inner_list *inner, const struct half_list *far, const struct inner_part *part,
                       const struct particles *p, double cutoff, double reach_more,
                       const struct period *period);
void inner_list_free(struct inner_list *inner);

/* Bytes allocated. */
size_t inner_list_bytes(const struct inner_list *inner);

#endif
