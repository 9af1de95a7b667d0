/* The pair loops. The physics of a pair is in law.h; here pairs are found in the half lists and their effects added
 * to both elements as 64-bit integers: integer addition does not depend on order, so neither do the results.
 *
 * Conversion: near effects by rounding to the nearest integer, up to 2^57 (64 pairs may meet in one element); far
 * forces by adding 1.5 * 2^52, which leaves the rounded integer in the low bits of the double: exact below 2^51, and
 * it vectorizes. Both are odd functions, so action and reaction cancel to the last bit. Each conversion's range is
 * checked; nothing wraps. */
#include "dm2/sim/force.h"

#include <math.h>
#include <string.h>

static const double near_range = 0x1p57;
static const double far_range = 0x1p50;

static inline int64_t to_fixed(double scaled)
{
    return (int64_t)(scaled + copysign(0.5, scaled));
}

static inline int64_t far_to_fixed(double scaled)
{
    const double shifter = 0x1.8p52;
    double shifted = scaled + shifter;
    int64_t bits, zero;
    memcpy(&bits, &shifted, sizeof bits);
    memcpy(&zero, &shifter, sizeof zero);
    return bits - zero;
}

/* What both loops know. */
struct pass {
    const struct model *m;
    struct particles *p;
    double period[2], half[2];
    double dt_kick, dt_path;
    struct pair_totals *totals;
    struct exact_sum potential, elastic;
    uint32_t bad_i, bad_j; /* a pair out of range, if any */
    bool bad;
};

static void note_bad(struct pass *pass, uint32_t i, uint32_t j)
{
    if (!pass->bad) {
        pass->bad = true;
        pass->bad_i = i;
        pass->bad_j = j;
    }
}

/* A pair's energies and counts belong to one server: the owner of the lower id. */
static inline bool counts_here(const struct particles *p, uint32_t i, uint32_t j)
{
    return j < p->n_own || p->id[i] < p->id[j];
}

static inline void add_virial(const struct pass *pass, uint32_t i, uint32_t j, double dx, double dy, double fx, double fy)
{
    double s = pass->m->fixed.virial;
    int64_t xx = to_fixed(dx * fx * s), yy = to_fixed(dy * fy * s), xy = to_fixed(0.5 * (dx * fy + dy * fx) * s);
    int64_t *vi = pass->p->virial + 3 * i, *vj = pass->p->virial + 3 * (size_t)j;
    vi[0] += xx;
    vi[1] += yy;
    vi[2] += xy;
    vj[0] += xx;
    vj[1] += yy;
    vj[2] += xy;
}

/* --- potentials of scope all ------------------------------------------------------------------------------------ */

/* Force over distance, f/r, of the potential at r^2, and its energy above the cutoff where asked. */
static inline double far_pair(const struct pair_law *law, double r2, double r0, double *energy)
{
    if (law->eps12 > 0.0) {
        double q = law->rm2 / r2, q3 = q * q * q;
        if (energy != NULL)
            *energy = law->eps12 * (1.0 / 12.0) * (q3 * q3 - 2.0 * q3) - law->u_cut;
        return law->eps12 * (q3 * q3 - q3) / r2;
    }
    double r = sqrt(r2), u, u_end, f = potential_force(law, r, r0, &u);
    if (energy != NULL) {
        (void)potential_force(law, sqrt(law->cutoff2), r0, &u_end);
        *energy = u - u_end;
    }
    return f / r;
}

static inline void far_rows(struct pass *pass, const struct half_list *list, bool uniform, bool measure)
{
    const struct model *m = pass->m;
    struct particles *p = pass->p;
    const double *r = p->r, scale = m->fixed.far_force;
    int64_t *sum = p->far_sum;
    const struct pair_law *law = m->laws;
    double r0 = 2.0 * m->radius_max;
    for (uint32_t i = 0; i < p->n_own; i++) {
        double x = r[2 * i], y = r[2 * i + 1];
        int64_t fx_i = 0, fy_i = 0;
        bool bad = false;
        for (uint32_t k = list->start[i]; k < list->start[i + 1]; k++) {
            uint32_t j = list->j[k];
            double dx = lists_wrap(x - r[2 * (size_t)j], pass->period[0], pass->half[0]);
            double dy = lists_wrap(y - r[2 * (size_t)j + 1], pass->period[1], pass->half[1]);
            double r2 = dx * dx + dy * dy, energy = 0.0;
            if (!uniform) {
                law = model_law(m, p->kind[i], p->kind[j],
                                relation_of(p->body[i], p->grain[i], p->body[j], p->grain[j]));
                r0 = p->radius[i] + p->radius[j];
            }
            if (r2 > law->cutoff2)
                continue;
            double f = far_pair(law, r2, r0, measure ? &energy : NULL), fs = f * scale;
            double fx = fs * dx, fy = fs * dy;
            bad |= !(fabs(fx) < far_range) | !(fabs(fy) < far_range);
            int64_t qx = far_to_fixed(fx), qy = far_to_fixed(fy);
            fx_i += qx;
            fy_i += qy;
            sum[2 * (size_t)j] -= qx;
            sum[2 * (size_t)j + 1] -= qy;
            if (measure) {
                double us = energy * m->fixed.energy;
                add_virial(pass, i, j, dx, dy, f * dx, f * dy);
                bad |= !(fabs(us) < near_range);
                if (counts_here(p, i, j) && !bad)
                    exact_add_units(&pass->potential, to_fixed(us), m->fixed.energy_left);
            }
        }
        sum[2 * i] += fx_i;
        sum[2 * i + 1] += fy_i;
        if (bad)
            note_bad(pass, i, i);
    }
}

/* --- near pairs -------------------------------------------------------------------------------------------------- */

static inline void near_add(struct pass *pass, uint32_t i, uint32_t j, double nx, double ny,
                            const struct pair_effect *e)
{
    const struct fixed_scales *s = &pass->m->fixed;
    int64_t *a = pass->p->pair_sum + SUM_COUNT * (size_t)i, *b = pass->p->pair_sum + SUM_COUNT * (size_t)j;
    double largest = fabs(e->fn) + fabs(e->ft) + fabs(e->fdn) + fabs(e->fdt);
    double heat = fabs(e->heat) + fabs(e->heat_damped) + fabs(e->exchange);
    if (!(largest * s->force < near_range) || !(heat * s->heat < near_range)) {
        note_bad(pass, i, j);
        return;
    }
    int64_t fx = to_fixed((e->fn * nx - e->ft * ny) * s->force), fy = to_fixed((e->fn * ny + e->ft * nx) * s->force);
    int64_t dx = to_fixed((e->fdn * nx - e->fdt * ny) * s->force), dy = to_fixed((e->fdn * ny + e->fdt * nx) * s->force);
    int64_t freed = to_fixed(0.5 * e->heat * s->heat), damped = to_fixed(0.5 * e->heat_damped * s->heat);
    int64_t gained = to_fixed(e->exchange * s->heat);
    a[SUM_FX] += fx;
    a[SUM_FY] += fy;
    a[SUM_DX] += dx;
    a[SUM_DY] += dy;
    a[SUM_HEAT] += freed;
    a[SUM_DHEAT] += damped + gained;
    b[SUM_FX] -= fx;
    b[SUM_FY] -= fy;
    b[SUM_DX] -= dx;
    b[SUM_DY] -= dy;
    b[SUM_HEAT] += freed;
    b[SUM_DHEAT] += damped - gained;
    if (e->ft != 0.0 || e->fdt != 0.0) {
        a[SUM_TORQUE] -= to_fixed(e->arm_i * e->ft * s->torque);
        a[SUM_DTORQUE] -= to_fixed(e->arm_i * e->fdt * s->torque);
        b[SUM_TORQUE] -= to_fixed(e->arm_j * e->ft * s->torque);
        b[SUM_DTORQUE] -= to_fixed(e->arm_j * e->fdt * s->torque);
    }
}

static void near_measure(struct pass *pass, uint32_t i, uint32_t j, double dx, double dy, double nx, double ny,
                         const struct pair_effect *e, bool linked)
{
    struct particles *p = pass->p;
    const struct fixed_scales *s = &pass->m->fixed;
    add_virial(pass, i, j, dx, dy, e->fn * nx - e->ft * ny, e->fn * ny + e->ft * nx);
    p->links[i] = (uint16_t)(p->links[i] + linked);
    p->links[j] = (uint16_t)(p->links[j] + linked);
    p->contacts[i] = (uint16_t)(p->contacts[i] + e->contacting);
    p->contacts[j] = (uint16_t)(p->contacts[j] + e->contacting);
    if (!counts_here(p, i, j))
        return;
    if (!(fabs(e->potential * s->energy) < near_range) || !(fabs(e->elastic * s->energy) < near_range)) {
        note_bad(pass, i, j);
        return;
    }
    exact_add_units(&pass->potential, to_fixed(e->potential * s->energy), s->energy_left);
    exact_add_units(&pass->elastic, to_fixed(e->elastic * s->energy), s->energy_left);
    pass->totals->links += linked;
    pass->totals->contacts += e->contacting;
}

static inline void near_rows(struct pass *pass, struct lists *l, bool measure)
{
    const struct model *m = pass->m;
    struct particles *p = pass->p;
    for (uint32_t i = 0; i < p->n_own; i++) {
        for (uint32_t k = l->near.start[i]; k < l->near.start[i + 1]; k++) {
            size_t j = l->near.j[k];
            double dx = lists_wrap(p->r[2 * i] - p->r[2 * j], pass->period[0], pass->half[0]);
            double dy = lists_wrap(p->r[2 * i + 1] - p->r[2 * j + 1], pass->period[1], pass->half[1]);
            double r2 = dx * dx + dy * dy, r0 = p->radius[i] + p->radius[j];
            if (r2 > r0 * r0 * (1.0 + 0x1p-40) && !lists_remembers(l, k))
                continue; /* neither touches nor remembers: most near pairs that are not linked */
            const struct pair_law *law = model_law(m, p->kind[i], p->kind[j],
                                                   relation_of(p->body[i], p->grain[i], p->body[j], p->grain[j]));
            double r = sqrt(r2);
            double nx = r > 0.0 ? dx / r : 0.0, ny = r > 0.0 ? dy / r : 0.0;
            double dvx = p->v[2 * i] - p->v[2 * j], dvy = p->v[2 * i + 1] - p->v[2 * j + 1];
            struct pair_view view = {.r = r, .radius_i = p->radius[i], .radius_j = p->radius[j],
                                     .vn = dvx * nx + dvy * ny, .vt = dvy * nx - dvx * ny,
                                     .w_i = p->w[i], .w_j = p->w[j], .mass_i = p->mass[i], .mass_j = p->mass[j],
                                     .soft_i = p->soft[i], .soft_j = p->soft[j],
                                     .t_i = p->temperature[i], .t_j = p->temperature[j], .p_i = p->p[i], .p_j = p->p[j]};
            struct pair_state state = {.linked = l->linked[k], .stretch = l->stretch[k], .spring = l->spring[k]};
            struct pair_effect effect;
            pair_interact(law, &view, pass->dt_kick, pass->dt_path, &state, &effect);
            l->linked[k] = state.linked;
            l->stretch[k] = state.stretch;
            l->spring[k] = state.spring;
            near_add(pass, i, (uint32_t)j, nx, ny, &effect);
            if (measure)
                near_measure(pass, i, (uint32_t)j, dx, dy, nx, ny, &effect, state.linked);
        }
    }
}

/* The loops, compiled for what each deck needs. */
static void far_all(struct pass *pass, const struct half_list *list)
{
    bool uniform = pass->m->uniform_far, measure = pass->totals != NULL;
    if (uniform && measure)
        far_rows(pass, list, true, true);
    else if (uniform)
        far_rows(pass, list, true, false);
    else if (measure)
        far_rows(pass, list, false, true);
    else
        far_rows(pass, list, false, false);
}

enum dm2_status force_evaluate(const struct model *m, struct particles *p, struct lists *lists, double dt_kick,
                               double dt_path, struct pair_totals *totals, int64_t step, struct dm2_error *err)
{
    struct pass pass = {.m = m, .p = p, .dt_kick = dt_kick, .dt_path = dt_path, .totals = totals};
    for (int a = 0; a < 2; a++) {
        pass.period[a] = m->grid.periodic[a] ? m->grid.size[a] : 0.0;
        pass.half[a] = m->grid.periodic[a] ? 0.5 * m->grid.size[a] : INFINITY;
    }
    if (totals != NULL) {
        *totals = (struct pair_totals){0};
        memset(p->virial, 0, p->n * 3 * sizeof *p->virial);
        memset(p->links, 0, p->n * sizeof *p->links);
        memset(p->contacts, 0, p->n * sizeof *p->contacts);
    }
    memset(p->far_sum, 0, p->n * 2 * sizeof *p->far_sum);
    memset(p->pair_sum, 0, p->n * SUM_COUNT * sizeof *p->pair_sum);
    if (m->has_far)
        far_all(&pass, &lists->far);
    if (m->has_near && totals != NULL)
        near_rows(&pass, lists, true);
    else if (m->has_near)
        near_rows(&pass, lists, false);
    if (pass.bad)
        return dm2_fail(err, DM2_NUMERIC,
                        "step %lld: the force between elements %u and %u, near (%g, %g) cm, is out of range: they are too "
                        "close or too fast; a smaller dt may help",
                        (long long)step, p->id[pass.bad_i], p->id[pass.bad_j], p->r[2 * pass.bad_i],
                        p->r[2 * pass.bad_i + 1]);
    if (totals != NULL) {
        totals->potential = pass.potential;
        totals->elastic = pass.elastic;
    }
    return DM2_OK;
}
