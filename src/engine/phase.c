/* Phase transitions.
 *
 * Every phase but the first of a material names the phase it forms from and a line in the plane of pressure
 * and temperature. An element changes above the line, and back when its distance below the line exceeds the
 * hysteresis, so that the drop of pressure or temperature caused by the change does not undo the change.
 *
 * Energy: the internal energy of a phase is m (cp (T - T0) + e), e a constant of the phase that follows from
 * the latent heat; a change keeps this sum, so that m e leaves the thermal energy. The energies that bonds
 * gain at their present lengths by new stiffness and size, and that the spin gains by a new radius, are taken
 * from the account `moved` of the element. The step across the change uses the forces after the change, and
 * the book of a bond (law_freed) takes this into account. So the sum of kinetic, potential, elastic and
 * thermal energy and the two accounts does not change.
 *
 * Sums over bonds are integers, so their order does not matter; mirrored elements carry their marks, so both
 * owners of a bond get the same numbers. */
#include "phase.h"

#include <math.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "leapfrog.h"
#include "periodic.h"

/* The height of (p, t) above the line of the phase, Mbar or K. */
static double height_above_line(const struct phase_config *phase, double p, double t)
{
    if (phase->transition == TRANSITION_PRESSURE)
        return p - (phase->p_line + phase->dp_dt * (t - phase->t_line));
    return t - (phase->t_line + phase->dt_dp * (p - phase->p_line));
}

size_t phase_of(const struct model *m, size_t kind, double p, double t)
{
    for (size_t k = m->config->n_materials; k < m->n_kinds; k++)
        if (m->kinds[k].from == kind && height_above_line(m->kinds[k].phase, p, t) > 0.0)
            return k;
    const struct kind *now = &m->kinds[kind];
    if (now->phase != NULL && now->phase->reversible &&
        height_above_line(now->phase, p, t) < -now->hysteresis)
        return now->from;
    return kind;
}

double phase_radius(const struct model *m, double radius, size_t was, size_t kind)
{
    const struct kind *from = &m->kinds[was], *to = &m->kinds[kind];
    return from->material == to->material && from != to ? radius * (to->size / from->size) : radius;
}

void phase_become(const struct model *m, struct particles *p, size_t i, size_t kind)
{
    size_t was = p->kind[i];
    double before = p->radius[i], after = phase_radius(m, before, was, kind);
    if (after != before) {
        double w = p->w[i], spun = w * ((before * before) / (after * after));
        p->moved[i] += 0.25 * p->mass[i] * ((before * before) * (w * w) - (after * after) * (spun * spun));
        p->w[i] = spun;
    }
    p->heat[i] += p->mass[i] * (m->kinds[was].energy - m->kinds[kind].energy);
    p->kind[i] = (uint16_t)kind;
    p->radius[i] = after;
    particles_warm(p, m, i, 1.0 / p->mass[i]);
}

void phase_follow(const struct model *m, struct particles *p, size_t i, size_t was, size_t kind)
{
    if (p->kind[i] != kind)
        p->radius[i] = phase_radius(m, p->radius[i], was, kind);
    p->kind[i] = (uint16_t)kind;
    p->was[i] = (uint16_t)was;
}

void phase_apply(const struct model *m, struct particles *p)
{
    for (size_t i = 0; i < p->n_own; i++) {
        if (p->was[i] != p->kind[i])
            continue; /* already changed in this step: the product of a reaction */
        size_t kind = phase_of(m, p->kind[i], p->p[i], p->temperature[i]);
        if (kind != p->kind[i])
            phase_become(m, p, i, kind);
    }
}

double phase_bond_book(const struct pair_law *law, const struct pair_view *v, bool linked, double stretch,
                       double spring, double dt_path)
{
    double u = 0.0, f = 0.0, r0 = v->radius_i + v->radius_j, kt = linked ? law->kt_link : law->kt_contact;
    const struct bond bond = law_bond(law, r0);
    struct pair_effect arms;
    if (linked || v->r < r0)
        f = bond_force(law, &bond, linked ? v->r - stretch : v->r, &u);
    return law_freed(u, 0.0, f, 0.0, v->vn, dt_path) +
           law_spring_freed(kt, spring, law_sliding(&bond, v, &arms), dt_path);
}

/* The view of near pair i, j after the change of kinds. */
static struct pair_view view_pair(const struct model *m, const struct particles *p, size_t i, size_t j)
{
    const struct period period = period_of(&m->grid);
    double d[2], dv[2];
    for (size_t a = 0; a < 2; a++) {
        d[a] = period_nearest(p->r[2 * i + a] - p->r[2 * j + a], period.size[a], period.half[a]);
        dv[a] = p->v[2 * i + a] - p->v[2 * j + a];
    }
    double r = sqrt(d[0] * d[0] + d[1] * d[1]), over = r > 0.0 ? 1.0 / r : 0.0;
    double nx = d[0] * over, ny = d[1] * over;
    return (struct pair_view){.r = r,
                              .over_r = over,
                              .radius_i = p->radius[i],
                              .radius_j = p->radius[j],
                              .vn = dv[0] * nx + dv[1] * ny,
                              .vt = dv[1] * nx - dv[0] * ny,
                              .w_i = p->w[i],
                              .w_j = p->w[j]};
}

/* The energy that the change of i's or j's kind adds to their bond, near entry `entry`. */
static double find_bond_change(const struct model *m, const struct particles *p, const struct lists *l,
                               size_t i, size_t j, uint32_t entry, double dt_path)
{
    enum relation relation = relation_of(p->body[i], p->grain[i], p->body[j], p->grain[j]);
    struct pair_view now = view_pair(m, p, i, j), was = now;
    was.radius_i = phase_radius(m, now.radius_i, p->kind[i], p->was[i]);
    was.radius_j = phase_radius(m, now.radius_j, p->kind[j], p->was[j]);
    was.w_i *= (now.radius_i * now.radius_i) / (was.radius_i * was.radius_i); /* as phase_become */
    was.w_j *= (now.radius_j * now.radius_j) / (was.radius_j * was.radius_j);
    double before = phase_bond_book(model_law(m, p->was[i], p->was[j], relation), &was, l->linked[entry],
                                    l->stretch[entry], l->spring[entry], dt_path);
    double after = phase_bond_book(model_law(m, p->kind[i], p->kind[j], relation), &now, l->linked[entry],
                                   l->stretch[entry], l->spring[entry], dt_path);
    return after - before;
}

static bool any_changed(const struct particles *p)
{
    for (size_t i = 0; i < p->n; i++)
        if (p->was[i] != p->kind[i])
            return true;
    return false;
}

enum dm2_status phase_account(const struct model *m, struct particles *p, const struct lists *lists,
                              int64_t step, struct dm2_error *err)
{
    if (!any_changed(p))
        return DM2_OK;
    int64_t *sum = mem_zalloc(p->n, sizeof *sum);
    if (sum == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory to account for phase changes of %zu elements", p->n);
    enum dm2_status status = DM2_OK;
    double scale = m->fixed.energy, dt_path = leapfrog_path_time(m, step);
    for (size_t i = 0; i < p->n_own && status == DM2_OK; i++) {
        for (uint32_t k = lists->near.start[i]; k < lists->near.start[i + 1]; k++) {
            size_t j = lists->near.j[k];
            if ((p->was[i] == p->kind[i] && p->was[j] == p->kind[j]) || particles_walls(p, i, j))
                continue;
            double half = 0.5 * find_bond_change(m, p, lists, i, j, k, dt_path) * scale;
            if (!(fabs(half) < 0x1p57)) {
                status = dm2_fail(
                    err, DM2_NUMERIC,
                    "step %lld: the change of phase of element %u or %u, near (%g, %g) cm, moves more energy "
                    "than sums can hold: check the densities and stiffnesses of the phases",
                    (long long)step, p->id[i], p->id[j], p->r[2 * i], p->r[2 * i + 1]);
                break;
            }
            int64_t moved = (int64_t)(half + copysign(0.5, half));
            sum[i] -= moved;
            sum[j] -= moved;
        }
    }
    for (size_t i = 0; i < p->n; i++) {
        if (i < p->n_own)
            p->moved[i] += (double)sum[i] / scale;
        p->was[i] = p->kind[i];
    }
    free(sum);
    return status;
}
