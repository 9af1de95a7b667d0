/* The inner list of the far pairs: those of the far list that a few steps can bring within the cutoff, in
 * fours.
 *
 * The far list reaches dR beyond the cutoff, so most of its pairs are out of reach at any one step. The inner
 * list keeps the pairs within a smaller margin and is drawn anew from the far list once an element has moved
 * half of that margin. It decides nothing but which pairs of force zero are looked at, so no bit depends on
 * it, and each server draws its own when it likes. (Two lists with two margins: Pall and Hess, Comput. Phys.
 * Commun. 184, 2641 (2013).) */
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

/* Four pairs of one element. Numbers are those of x components: twice the slot; lanes left over hold slot n,
 * which is far from everything. */
struct far_quad {
    uint32_t i, j[SIMD_LANES];
};

struct inner_list {
    struct far_quad *quad; /* [n + 1]; the last one is a copy, for loops that load one ahead */
    size_t n, cap;
    double *drawn; /* [slots that its pairs are of][2] positions when it was drawn, cm */
    size_t drawn_cap;
    double margin; /* reach beyond the cutoff, cm; infinite: that of the far list */
    int served;    /* evaluations since it was drawn */
    bool valid;    /* false until it is drawn after a rebuild */
};

/* Rows [first, last) of the far list; their pairs are of slots below `beyond`. */
struct inner_part {
    size_t first, last, beyond;
};

/* Draws the list if it is not valid for the present positions of p. `far` is the far list of p, with rows
 * padded to fours, of which the inner list is drawn from `part`; cutoff: of the potential; reach_more: the
 * far list's margin dR, cm; 0, or -1 without memory. */
int inner_list_prepare(struct inner_list *inner, const struct half_list *far, const struct inner_part *part,
                       const struct particles *p, double cutoff, double reach_more,
                       const struct period *period);
void inner_list_free(struct inner_list *inner);
size_t inner_list_bytes(const struct inner_list *inner);

#endif
