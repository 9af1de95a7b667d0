/* The reaction pass.
 *
 * A pair reacts while its elements are linked or touch, by the reactants of its two elements at the start of
 * the step, independently of other pairs; each pair takes at most a fixed part of the reactants (1/8; 1/64
 * where radii differ so much that a disc may touch many), so that no order of pairs can overdraw an element.
 * Masses are added as integers: any order and any number of servers give the same bits. Product gains exactly
 * the mass that A and B lose, because the fraction of product is 1 less the fractions of A and B. Each
 * element gets the heat of the product that forms in it, so that the two elements come to the same
 * temperature.
 *
 * Rates are evaluated with the forces and applied after the move, so that a row of the history is taken
 * before the change of composition and before its heat. */
#include "reaction.h"

#include <math.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/real.h"
#include "periodic.h"
#include "phase.h"

void reaction_rate(const struct reaction_table *x, struct reaction_side a, struct reaction_side b,
                   double temperature, double area, double dt, double reacted[2])
{
    double held_a = a.mass * a.fraction, held_b = b.mass * b.fraction;
    reacted[0] = reacted[1] = 0.0;
    if (!(held_a > 0.0) || !(held_b > 0.0) || !(temperature > 0.0))
        return;
    double dm = x->k0 * real_exp(-(x->theta / temperature)) * (a.fraction * b.fraction) * area * dt;
    double da = dm * (x->stoichiometric ? x->share[0] : held_a / (held_a + held_b));
    double db = dm * (x->stoichiometric ? x->share[1] : held_b / (held_a + held_b));
    double part = 1.0;
    if (da > x->limit * held_a)
        part = x->limit * held_a / da;
    if (part * db > x->limit * held_b)
        part = x->limit * held_b / db;
    reacted[0] = part * da;
    reacted[1] = part * db;
}

/* Nearest integer of a scaled double, halves away from 0; |scaled| < 2^57. */
static int64_t to_fixed(double scaled)
{
    return (int64_t)(scaled + copysign(0.5, scaled));
}

/* Adds the reaction of A of element i with B of element j to `sums`. False: the heat is out of range. */
static bool react_pair(const struct model *m, const struct particles *p, size_t i, size_t j,
                       double temperature, double area, double dt, int64_t *sums)
{
    const struct reaction_table *x = &m->reaction;
    struct reaction_side a = {p->mass[i], p->share[2 * i]}, b = {p->mass[j], p->share[2 * j + 1]};
    double reacted[2];
    reaction_rate(x, a, b, temperature, area, dt, reacted);
    double heat = x->heat * m->fixed.heat;
    if (!(fabs(heat * (reacted[0] + reacted[1])) < 0x1p57))
        return false;
    int64_t *si = sums + REACTION_SUMS * i, *sj = sums + REACTION_SUMS * j;
    si[REACTION_A] += to_fixed(reacted[0] * x->mass_scale);
    sj[REACTION_B] += to_fixed(reacted[1] * x->mass_scale);
    si[REACTION_HEAT] += to_fixed(heat * reacted[0]);
    sj[REACTION_HEAT] += to_fixed(heat * reacted[1]);
    return true;
}

enum dm2_status reaction_evaluate(const struct model *m, const struct particles *p, const struct lists *lists,
                                  double dt_kick, int64_t step, struct reaction_sums *sums,
                                  struct dm2_error *err)
{
    const double facet = 0x1.279a74590331dp-1; /* 1/sqrt(3): the facet of a hexagon over r0, as in law.h */
    const struct period period = period_of(&m->grid);
    int64_t *grown = mem_grown(sums->item, &sums->cap, 0, p->n * REACTION_SUMS, sizeof *grown);
    if (grown == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the reactions of %zu elements", p->n);
    sums->item = grown;
    if (p->n > 0)
        memset(sums->item, 0, p->n * REACTION_SUMS * sizeof *sums->item);
    for (size_t i = 0; i < p->n_own; i++) {
        for (uint32_t k = lists->near.start[i]; k < lists->near.start[i + 1]; k++) {
            size_t j = lists->near.j[k];
            bool forward = p->share[2 * i] > 0.0 && p->share[2 * j + 1] > 0.0;
            bool backward = p->share[2 * j] > 0.0 && p->share[2 * i + 1] > 0.0;
            if (!forward && !backward)
                continue;
            double dx = period_nearest(p->r[2 * i] - p->r[2 * j], period.size[0], period.half[0]);
            double dy = period_nearest(p->r[2 * i + 1] - p->r[2 * j + 1], period.size[1], period.half[1]);
            double r0 = p->radius[i] + p->radius[j];
            if (!lists->linked[k] && !law_touches(sqrt(dx * dx + dy * dy), r0))
                continue;
            double mean = 0.5 * (p->temperature[i] + p->temperature[j]), area = r0 * facet;
            if ((forward && !react_pair(m, p, i, j, mean, area, dt_kick, sums->item)) ||
                (backward && !react_pair(m, p, j, i, mean, area, dt_kick, sums->item)))
                return dm2_fail(err, DM2_NUMERIC,
                                "step %lld: the heat of reaction of elements %u and %u, near (%g, %g) cm, is "
                                "out of range: "
                                "check the reaction's heat",
                                (long long)step, p->id[i], p->id[j], p->r[2 * i], p->r[2 * i + 1]);
        }
    }
    return DM2_OK;
}

enum dm2_status reaction_apply(const struct model *m, struct particles *p, const struct reaction_sums *sums,
                               int64_t step, struct dm2_error *err)
{
    const struct reaction_table *x = &m->reaction;
    for (size_t i = 0; i < p->n_own; i++) {
        const int64_t *s = sums->item + REACTION_SUMS * i;
        double *share = p->share + 2 * i;
        if (s[REACTION_A] == 0 && s[REACTION_B] == 0 && s[REACTION_HEAT] == 0)
            continue;
        for (int a = 0; a < 2; a++) {
            share[a] -= (double)s[REACTION_A + a] / x->mass_scale / p->mass[i];
            if (share[a] < -1e-9)
                return dm2_fail(err, DM2_NUMERIC,
                                "step %lld: element %u at (%g, %g) cm reacts with more partners than one "
                                "that size can touch; a "
                                "smaller dt or a lower rate may help",
                                (long long)step, p->id[i], p->r[2 * i], p->r[2 * i + 1]);
            share[a] = share[a] > 0.0 ? share[a] : 0.0;
        }
        p->heat[i] += (double)s[REACTION_HEAT] / m->fixed.heat;
        if (m->kinds[p->kind[i]].material != x->product && share[0] + share[1] < x->threshold)
            phase_become(m, p, i, (size_t)x->product);
        else
            particles_warm(p, m, i, 1.0 / p->mass[i]);
    }
    return DM2_OK;
}
