/* Drawing the inner list: one pass over the far list, four pairs at a time, which keeps those within the
 * smaller margin.
 *
 * The list is valid while no element, owned or mirrored, is further than half the margin from where it was:
 * then no pair that was left out can have come within the cutoff. Where elements are so fast that this lasts
 * only a few steps, drawing would cost more than it saves, and the next list keeps the whole far list until
 * the next rebuild. */
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
/* Evaluations that a drawing must serve to be worth its cost. */
static const int worth = 3;

#define POSITION(c) (*(const simd_real2 *)(const void *)(r + (c)))

/* The far list whole, in quads. */
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

/* The pairs within `reach`. Lanes are written one after the other and the cursor moves on where a pair is
 * kept. */
DM2_WIDE static void take_near(struct inner_list *inner, const struct half_list *far,
                               const struct inner_part *part, const struct particles *p, double reach,
                               const double period[2], const double half[2])
{
    const double *r = p->r, reach2 = reach * reach;
    const simd_real zero = {0.0}, period_x = zero + period[0], period_y = zero + period[1];
    const simd_real half_x = zero + half[0], half_y = zero + half[1];
    const uint32_t nobody = 2 * (uint32_t)p->n;
    size_t n = 0;
    for (size_t i = part->first; i < part->last; i++) {
        double x = r[2 * i], y = r[2 * i + 1];
        struct far_quad *q = &inner->quad[n];
        size_t lane = 0;
        q->i = 2 * (uint32_t)i;
        for (uint32_t k = far->start[i]; k < far->start[i + 1]; k += SIMD_LANES) {
            const uint32_t *j = far->j + k;
            simd_real a = SIMD_JOIN(POSITION(j[0]), POSITION(j[2])),
                      b = SIMD_JOIN(POSITION(j[1]), POSITION(j[3]));
            simd_real dx = x - SIMD_EVEN(a, b), dy = y - SIMD_ODD(a, b);
            dx = dx - SIMD_CHOOSE(dx > half_x, period_x, zero) + SIMD_CHOOSE(dx < -half_x, period_x, zero);
            dy = dy - SIMD_CHOOSE(dy > half_y, period_y, zero) + SIMD_CHOOSE(dy < -half_y, period_y, zero);
            simd_int kept = dx * dx + dy * dy <= reach2;
            for (int c = 0; c < SIMD_LANES; c++) {
                q->j[lane] = j[c];
                lane -= (size_t)kept[c]; /* a lane that holds is -1 */
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

/* Greatest squared distance from the positions of the last drawing. (A pair's lower slot is in the part's
 * rows.) */
static double moved2(const struct inner_list *inner, const struct inner_part *part, const struct particles *p,
                     const double period[2], const double half[2])
{
    const double *r = p->r + 2 * part->first, *was = inner->drawn;
    double most = 0.0;
    for (size_t i = 0; i < part->beyond - part->first; i++) {
        double dx = period_nearest(r[2 * i] - was[2 * i], period[0], half[0]);
        double dy = period_nearest(r[2 * i + 1] - was[2 * i + 1], period[1], half[1]), d2 = dx * dx + dy * dy;
        most = d2 > most ? d2 : most;
    }
    return most;
}

static int reserve(struct inner_list *inner, size_t pairs, size_t n)
{
    void *quad = inner->quad, *drawn = inner->drawn;
    int status = mem_grow(&quad, &inner->cap, 0, pairs / SIMD_LANES + 2, sizeof *inner->quad);
    inner->quad = quad;
    if (status == 0)
        status = mem_grow(&drawn, &inner->drawn_cap, 0, n + 1, 2 * sizeof *inner->drawn);
    inner->drawn = drawn;
    return status;
}

int inner_list_prepare(struct inner_list *inner, const struct half_list *far, const struct inner_part *part,
                       const struct particles *p, double cutoff, double reach_more, const double period[2],
                       const double half[2])
{
    size_t slots = part->beyond - part->first;
    inner->served++;
    if (inner->valid) {
        if (isinf(inner->margin) ||
            moved2(inner, part, p, period, half) <= 0.25 * (inner->margin * inner->margin))
            return 0;
        inner->margin = inner->served > worth ? margin_share * reach_more : INFINITY;
    } else {
        inner->margin = margin_share * reach_more;
    }
    if (reserve(inner, far->start[part->last] - far->start[part->first], slots) != 0)
        return -1;
    inner->n = 0;
    inner->served = 0;
    inner->valid = true;
    if (isinf(inner->margin)) {
        take_all(inner, far, part);
    } else {
        take_near(inner, far, part, p, cutoff + inner->margin, period, half);
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
