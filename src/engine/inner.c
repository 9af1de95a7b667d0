/* Drawing the inner list: one pass over the far list, four pairs at a time, that keeps the pairs within the
 * smaller margin.
 *
 * Invariant: the list is valid while no element, owned or mirrored, is further than half the margin from its
 * position at the drawing; until then no omitted pair can come within the cutoff. Where elements are so fast
 * that a drawing lasts only a few steps, drawings cost more than they save, and the next list keeps the whole
 * far list until the next rebuild. */
#include "inner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "half_list.h"
#include "particles.h"
#include "periodic.h"

/* Share of dR that the inner list reaches beyond the cutoff (measured: docs/performance.md). */
static const double margin_share = 0.5;
/* Evaluations that a drawing must outlast to save more than its cost. */
static const int worth = 3;

/* The whole far list, in quads. */
static void take_all(struct inner_list *inner, const struct half_list *far, const struct inner_part *part)
{
    for (size_t i = part->first; i < part->last; i++) {
        for (uint32_t k = far->start[i]; k < far->start[i + 1]; k += SIMD_LANES) {
            struct far_quad *q = &inner->quad[inner->n++];
            q->i = 2 * (uint32_t)i;
            memcpy(q->j, far->j + k, sizeof q->j);
        }
    }
}

/* The pairs within `reach`, cm. Each pair is written at the cursor, which advances only where the pair is
 * kept. */
DM2_WIDE static void take_near(struct inner_list *inner, const struct half_list *far,
                               const struct inner_part *part, const struct particles *p, double reach,
                               const struct period *period)
{
    const double *r = p->r, reach2 = reach * reach;
    const uint32_t nobody = 2 * (uint32_t)p->n;
    size_t n = 0;
    for (size_t i = part->first; i < part->last; i++) {
        double x = r[2 * i], y = r[2 * i + 1];
        struct far_quad *q = &inner->quad[n];
        size_t lane = 0;
        q->i = 2 * (uint32_t)i;
        for (uint32_t k = far->start[i]; k < far->start[i + 1]; k += SIMD_LANES) {
            const uint32_t *j = far->j + k;
            simd_real a = SIMD_JOIN(SIMD_AT(r, j[0]), SIMD_AT(r, j[2])),
                      b = SIMD_JOIN(SIMD_AT(r, j[1]), SIMD_AT(r, j[3]));
            simd_real dx = x - SIMD_EVEN(a, b), dy = y - SIMD_ODD(a, b);
            lanes_nearest(&dx, period->size[0], period->half[0]);
            lanes_nearest(&dy, period->size[1], period->half[1]);
            simd_int kept = dx * dx + dy * dy <= reach2;
            for (int c = 0; c < SIMD_LANES; c++) {
                q->j[lane] = j[c];
                lane -= (size_t)kept[c]; /* a true lane is -1 */
                if (lane == SIMD_LANES) {
                    q = &inner->quad[++n];
                    q->i = 2 * (uint32_t)i;
                    lane = 0;
                }
            }
        }
        if (lane > 0) {
            for (; lane < SIMD_LANES; lane++)
                q->j[lane] = nobody;
            n++;
        }
    }
    inner->n = n;
}

/* Greatest squared distance from the positions of the last drawing, cm2. (The lower slot of each pair is in
 * the rows of the part, so slots from part->first on are enough.) */
static double find_moved2(const struct inner_list *inner, const struct inner_part *part,
                          const struct particles *p, const struct period *period)
{
    const double *r = p->r + 2 * part->first, *was = inner->drawn;
    double most = 0.0;
    for (size_t i = 0; i < part->beyond - part->first; i++) {
        double dx = period_nearest(r[2 * i] - was[2 * i], period->size[0], period->half[0]);
        double dy = period_nearest(r[2 * i + 1] - was[2 * i + 1], period->size[1], period->half[1]),
               d2 = dx * dx + dy * dy;
        most = d2 > most ? d2 : most;
    }
    return most;
}

static int reserve_quads(struct inner_list *inner, size_t pairs, size_t n)
{
    struct far_quad *quad = mem_grown(inner->quad, &inner->cap, 0, pairs / SIMD_LANES + 2, sizeof *quad);
    if (quad == NULL)
        return -1;
    inner->quad = quad;
    double *drawn = mem_grown(inner->drawn, &inner->drawn_cap, 0, n + 1, 2 * sizeof *drawn);
    if (drawn == NULL)
        return -1;
    inner->drawn = drawn;
    return 0;
}

int inner_list_prepare(struct inner_list *inner, const struct half_list *far, const struct inner_part *part,
                       const struct particles *p, double cutoff, double reach_more,
                       const struct period *period)
{
    size_t slots = part->beyond - part->first;
    inner->served++;
    if (inner->valid) {
        if (isinf(inner->margin) ||
            find_moved2(inner, part, p, period) <= 0.25 * (inner->margin * inner->margin))
            return 0;
        inner->margin = inner->served > worth ? margin_share * reach_more : INFINITY;
    } else {
        inner->margin = margin_share * reach_more;
    }
    if (reserve_quads(inner, far->start[part->last] - far->start[part->first], slots) != 0)
        return -1;
    inner->n = 0;
    inner->served = 0;
    inner->valid = true;
    if (isinf(inner->margin)) {
        take_all(inner, far, part);
    } else {
        take_near(inner, far, part, p, cutoff + inner->margin, period);
        memcpy(inner->drawn, p->r + 2 * part->first, slots * 2 * sizeof *inner->drawn);
    }
    if (inner->n > 0)
        inner->quad[inner->n] = inner->quad[inner->n - 1];
    return 0;
}

void inner_list_free(struct inner_list *inner)
{
    free(inner->quad);
    free(inner->drawn);
    *inner = (struct inner_list){0};
}

size_t inner_list_bytes(const struct inner_list *inner)
{
    return inner->cap * sizeof *inner->quad + inner->drawn_cap * 2 * sizeof *inner->drawn;
}
