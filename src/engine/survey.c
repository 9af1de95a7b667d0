/* The survey of the displacements since the last rebuild, from which struct rebuild_plan takes its bounds.
 * Where elements only touch, the displacements in each bin are compared with those in the bins around. */
#include "dm2/engine/subdomain.h"

#include <math.h>

#include "dm2/base/clock.h"
#include "bins.h"
#include "periodic.h"
#include "subdomain_parts.h"

/* The spread of the slots s in [first, last), or of slots[s] where `slots` is not NULL. */
static inline struct spread survey_slots(const struct subdomain *sd, const uint32_t *slots, size_t first,
                                         size_t last)
{
    const struct grid *g = &sd->model->grid;
    const bool periodic = g->periodic[0] || g->periodic[1];
    const struct period period = period_of(g);
    const double *r = sd->p.r, *anchor = sd->anchors.item;
    struct spread out = spread_none();
    double most2 = 0.0;
    for (size_t s = first; s < last; s++) {
        size_t i = slots != NULL ? slots[s] : s;
        double d[2];
        for (size_t a = 0; a < 2; a++) {
            d[a] = r[2 * i + a] - anchor[2 * i + a];
            if (periodic)
                d[a] = period_nearest(d[a], period.size[a], period.half[a]);
            out.low[a] = d[a] < out.low[a] ? d[a] : out.low[a];
            out.high[a] = d[a] > out.high[a] ? d[a] : out.high[a];
        }
        double d2 = d[0] * d[0] + d[1] * d[1];
        most2 = d2 > most2 ? d2 : most2;
    }
    out.most = sqrt(most2);
    return out;
}

/* Sorts the anchors into bins, once after each rebuild. Edges are longer than R_c + dR, doubled while there
 * would be more bins than elements and 1024. False where no such bins exist, or without memory. */
static bool sort_anchors(struct subdomain *sd)
{
    const struct config *c = sd->model->config;
    double reach = c->r_c + c->delta_r, most = (double)sd->p.n + 1024.0;
    for (int k = 0; k < 16 && !sd->anchors_sorted; k++, reach *= 2.0) {
        if (!bins_lay_out(&sd->anchor_bins, &sd->model->grid, sd->anchors.item, sd->p.n, reach, most))
            continue;
        if (bins_assign(&sd->anchor_bins, sd->anchors.item, sd->p.n) != 0)
            return false;
        sd->anchors_sorted = true;
    }
    return sd->anchors_sorted;
}

/* Room for the spread of each bin: the pair sums, which hold no values between a move and the next forces, or
 * sd->spreads where the pair sums are too small. NULL without memory. */
static struct spread *hold_spreads(struct subdomain *sd)
{
    size_t bins = (size_t)sd->anchor_bins.grid.cx * (size_t)sd->anchor_bins.grid.cy;
    return bins <= particles_sum_bytes(&sd->p) / sizeof(struct spread)
               ? (struct spread *)(void *)sd->p.pair_sum
               : block_hold(&sd->spreads, bins, sizeof(struct spread));
}

/* Upper bound of the approach, cm, of two elements in bin (i, j), and of an element in bin (i, j) and an
 * element in a later bin around: in the next bin of the row, or in the row above. */
static double bound_approach(const struct grid *g, const struct spread *of, int i, int j)
{
    static const int later[4][2] = {{1, 0}, {-1, 1}, {0, 1}, {1, 1}};
    const struct spread *here = &of[j * g->cx + i];
    double close = spread_approach(here);
    for (int k = 0; k < 4; k++) {
        int x = i + later[k][0], y = j + later[k][1];
        if (g->periodic[0])
            x = (x + g->cx) % g->cx;
        if (g->periodic[1])
            y %= g->cy;
        if (x < 0 || x >= g->cx || y >= g->cy)
            continue;
        double between = spread_between(here, &of[y * g->cx + x], later[k]);
        close = between > close ? between : close;
    }
    return close;
}

/* Takes the spread of each bin to of[bins], and then compares each bin with the bins around. In a bin owned
 * slots come first, because slots ascend. */
static struct spread survey_bins(const struct subdomain *sd, struct spread *of)
{
    const struct bins *b = &sd->anchor_bins;
    const struct grid *g = &b->grid;
    struct spread out = spread_none();
    for (int k = 0; k < g->cx * g->cy; k++) {
        size_t first = b->start[k], last = b->start[k + 1], own = last;
        while (own > first && b->slot[own - 1] >= sd->p.n_own)
            own--;
        of[k] = survey_slots(sd, b->slot, first, own);
        spread_merge(&out, &of[k]);
        if (own < last) {
            struct spread mirrored = survey_slots(sd, b->slot, own, last);
            spread_merge(&of[k], &mirrored);
        }
    }
    for (int j = 0; j < g->cy; j++) {
        for (int i = 0; i < g->cx; i++) {
            double close =
                b->start[j * g->cx + i + 1] > b->start[j * g->cx + i] ? bound_approach(g, of, i, j) : 0.0;
            out.close = close > out.close ? close : out.close;
        }
    }
    return out;
}

void subdomain_survey(struct subdomain *sd, struct spread *out)
{
    double started = clock_now();
    struct spread *of = subdomain_surveys_close(sd) && sort_anchors(sd) ? hold_spreads(sd) : NULL;
    if (of != NULL) {
        *out = survey_bins(sd, of);
    } else {
        *out = survey_slots(sd, NULL, 0, sd->p.n_own);
        out->close = INFINITY;
    }
    walls_survey(&sd->walls, sd->model, sd->loading, sd->step, out);
    sd->times.integrate += clock_now() - started;
}
