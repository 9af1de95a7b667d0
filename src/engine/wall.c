/* The evaluation of walls. Entries of an element come in the order of features, and every sum that is not an
 * integer is one element's own, so that no result depends on the decomposition or on when lists are built. */
#include "wall.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "loading_parts.h"
#include "motion.h"
#include "pair_pass.h"

/* --- poses --- */

void wall_pose_at(const struct model *m, const struct loading *l, const struct wall *w, int64_t step,
                  struct wall_pose *out)
{
    struct rigid_motion now, next;
    loading_motion(l, m, w->mover, step, &now);
    loading_motion(l, m, w->mover, step + 1, &next);
    *out = (struct wall_pose){.d = {now.dx, now.dy},
                              .v = {now.vx, now.vy},
                              .next_v = {next.vx, next.vy},
                              .spin = now.spin,
                              .next_spin = next.spin,
                              .angle = now.angle,
                              .cosine = 1.0,
                              .temperature = w->config->temperature};
    if (w->temperature_load < m->config->n_loads)
        out->temperature = motion_load(m, w->temperature_load, step);
    if (!w->circle && now.angle != 0.0) {
        out->cosine = real_cos(now.angle);
        out->sine = real_sin(now.angle);
    }
}

void walls_place(struct walls *ws, const struct model *m, const struct loading *l, int64_t step)
{
    for (size_t k = 0; k < m->n_walls; k++)
        wall_pose_at(m, l, &m->walls[k], step, &ws->pose[k]);
}

/* --- memory of a subdomain --- */

enum dm2_status walls_start(struct walls *ws, const struct model *m, struct dm2_error *err)
{
    ws->pose = mem_zalloc(m->n_walls, sizeof *ws->pose);
    ws->anchor = mem_zalloc(m->n_walls, sizeof *ws->anchor);
    ws->sums = mem_zalloc(m->n_walls, sizeof *ws->sums);
    if (ws->pose == NULL || ws->anchor == NULL || ws->sums == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %zu walls", m->n_walls);
    return DM2_OK;
}

void walls_free(struct walls *ws)
{
    free(ws->slot);
    free(ws->start);
    free(ws->work);
    free(ws->entry);
    free(ws->next);
    free(ws->carried);
    free(ws->pose);
    free(ws->anchor);
    free(ws->sums);
    free(ws->forces.records);
    *ws = (struct walls){0};
}

size_t walls_bytes(const struct walls *ws, const struct model *m)
{
    return (ws->row_cap + ws->start_cap) * sizeof(uint32_t) + ws->work_cap * sizeof(double) +
           (ws->entry_cap + ws->next_cap) * sizeof(struct wall_entry) +
           ws->carried_cap * sizeof(struct wall_carried) + ws->forces.cap * sizeof(struct wall_force) +
           m->n_walls * (2 * sizeof(struct wall_pose) + sizeof(struct wall_sums));
}

void wall_sums_merge(struct wall_sums *into, const struct wall_sums *part)
{
    exact_merge(&into->force[0], &part->force[0]);
    exact_merge(&into->force[1], &part->force[1]);
    exact_merge(&into->torque, &part->torque);
    exact_merge(&into->heat, &part->heat);
    into->contacts += part->contacts;
}

/* --- geometry --- */

/* Turns x by the angle of the pose, or back. */
static inline void turn(const struct wall_pose *pose, const double x[2], bool back, double out[2])
{
    double s = back ? -pose->sine : pose->sine, a = pose->cosine * x[0] - s * x[1],
           b = s * x[0] + pose->cosine * x[1];
    out[0] = a;
    out[1] = b;
}

void wall_place(const struct model *m, const struct wall *w, const struct wall_pose *pose, const double r[2],
                const int32_t turns[2], double out[2])
{
    for (size_t a = 0; a < 2; a++)
        out[a] = (r[a] + (double)turns[a] * m->grid.size[a]) - pose->d[a];
    if (pose->sine == 0.0 && pose->cosine == 1.0)
        return;
    const double arm[2] = {out[0] - w->centre[0], out[1] - w->centre[1]};
    turn(pose, arm, true, out);
    out[0] += w->centre[0];
    out[1] += w->centre[1];
}

/* The part of c - p along the direction `along`. */
static inline double along_of(const double along[2], const double c[2], const double p[2])
{
    return along[0] * (c[0] - p[0]) + along[1] * (c[1] - p[1]);
}

static void find_vertex(const struct wall *w, size_t k, const double q[2], struct wall_meeting *out)
{
    const struct wall_vertex *v = &w->vertex[k];
    double b = along_of(v->before, q, v->p), f = along_of(v->after, q, v->p);
    if (!w->closed && k == 0)
        out->sign = f < 0.0;
    else if (!w->closed && k + 1 == w->n_vertices)
        out->sign = b >= 0.0;
    else
        out->sign = b >= 0.0 && f < 0.0 ? 1 : b < 0.0 && f >= 0.0 ? -1 : 0;
    double x = q[0] - v->p[0], y = q[1] - v->p[1], d = sqrt(x * x + y * y), over = d > 0.0 ? 1.0 / d : 0.0;
    out->d = d;
    out->n[0] = x * over;
    out->n[1] = y * over;
}

/* q_end: the place with respect to the end, which is an image of the first vertex where the line closes
 * across a periodic side. */
static void find_segment(const struct wall *w, size_t k, const double q[2], const double q_end[2],
                         struct wall_meeting *out)
{
    const struct wall_vertex *v = &w->vertex[k], *end = &w->vertex[k + 1 == w->n_vertices ? 0 : k + 1];
    double f = along_of(v->after, q, v->p), b = along_of(end->before, q_end, end->p);
    double side = v->after[0] * (q[1] - v->p[1]) - v->after[1] * (q[0] - v->p[0]),
           s = side < 0.0 ? -1.0 : 1.0;
    out->sign = f >= 0.0 && b < 0.0;
    out->d = fabs(side);
    out->n[0] = -s * v->after[1];
    out->n[1] = s * v->after[0];
}

static void find_circle(const struct wall *w, const double q[2], struct wall_meeting *out)
{
    double x = q[0] - w->centre[0], y = q[1] - w->centre[1], rho = sqrt(x * x + y * y);
    double over = rho < w->radius ? -1.0 / rho : 1.0 / rho;
    out->sign = rho > 0.0;
    out->d = fabs(rho - w->radius);
    out->n[0] = rho > 0.0 ? x * over : 0.0;
    out->n[1] = rho > 0.0 ? y * over : 0.0;
}

void wall_meet(const struct model *m, const struct wall *w, const struct wall_pose *pose,
               const struct particles *p, size_t i, const struct wall_entry *entry, struct wall_meeting *out)
{
    int32_t turns[2] = {entry->base[0], entry->base[1]};
    size_t k = entry->feature - w->first;
    double q[2], n[2];
    for (size_t a = 0; p->image != NULL && a < 2; a++)
        turns[a] += p->image[2 * i + a];
    const double *r = p->r + 2 * i;
    wall_place(m, w, pose, r, turns, q);
    if (w->circle) {
        find_circle(w, q, out);
    } else if (k % 2 == 0) {
        find_vertex(w, k / 2, q, out);
    } else {
        double q_end[2] = {q[0], q[1]};
        if (k / 2 + 1 == w->n_vertices && (w->seam[0] != 0 || w->seam[1] != 0)) {
            const int32_t end[2] = {turns[0] - w->seam[0], turns[1] - w->seam[1]};
            wall_place(m, w, pose, r, end, q_end);
        }
        find_segment(w, k / 2, q, q_end, out);
    }
    turn(pose, out->n, false, n);
    for (size_t a = 0; a < 2; a++) {
        out->n[a] = n[a];
        out->lever[a] =
            ((r[a] + (double)turns[a] * m->grid.size[a]) - pose->d[a]) - w->centre[a] - out->d * n[a];
    }
}

/* --- one contact --- */

/* The evaluation under way. */
struct wall_pass {
    struct walls *ws;
    const struct model *m;
    const struct particles *p;
    int64_t step;
    double dt_kick, dt_path;
    struct pair_totals *totals;
    bool note;
};

/* The pair as the law sees it. The wall's side moves as the foot does; the lever of the tangential force is
 * the distance of the foot. */
static struct pair_view view_of(const struct wall_pass *a, size_t i, const struct wall_pose *pose,
                                const struct wall_meeting *at, const double v_wall[2])
{
    const struct particles *p = a->p;
    double r = at->d + p->radius[i], dvx = p->v[2 * i] - v_wall[0], dvy = p->v[2 * i + 1] - v_wall[1];
    double t = particles_temperature(p, a->m, i), pressure = p->p != NULL ? p->p[i] : 0.0;
    return (struct pair_view){
        .r = r,
        .over_r = 1.0 / r,
        .radius_i = at->d * (2.0 * p->radius[i]) / r,
        .vn = dvx * at->n[0] + dvy * at->n[1],
        .vt = dvy * at->n[0] - dvx * at->n[1],
        .w_i = p->w[i],
        .mass_i = p->mass[i],
        .mass_j = p->mass[i],
        .soft_i = 1.0,
        .soft_j = 1.0,
        .t_i = t,
        .t_j = isnan(pose->temperature) ? t : pose->temperature,
        .p_i = pressure,
        .p_j = pressure,
        .held_j = true,
    };
}

/* The law between an element and a feature that it touches. */
static void interact(const struct pair_law *law, const struct bond *bond, const struct pair_view *view,
                     bool held, double dt_kick, double dt_path, struct pair_state *s, struct pair_effect *out)
{
    if (!held) {
        double f = law_central(law, bond, view, dt_path, s, out);
        double ct = law_damping(law, bond, view, false, f, dt_path, out);
        if (law->tangential)
            law_tangential(law, bond, view, ct, dt_kick, dt_path, s, out);
        out->heat_damped -= out->fdn * view->vn * dt_kick;
    }
    out->exchange = law->conduction * (bond->area * view->over_r) * (view->t_j - view->t_i) * dt_kick;
}

/* The spring that a feature takes over which comes up in the row: of the contact at the feature itself with
 * the other sign, or beside it along the wall, the nearer one and the lower number first. */
static double inherit_spring(const struct wall *w, const struct wall_entry *row, size_t n, uint32_t feature)
{
    static const int beside[] = {0, -1, 1, -2, 2};
    long count = (long)w->n_features, at = (long)(feature - w->first);
    for (size_t b = 0; b < sizeof beside / sizeof beside[0]; b++) {
        long other = at + beside[b];
        if (w->closed)
            other = (other + count) % count;
        for (size_t k = 0; k < n && other >= 0 && other < count; k++)
            if (row[k].sign != 0 && row[k].feature == w->first + (uint32_t)other)
                return row[k].spring;
    }
    return 0.0;
}

/* Adds the effect of a feature to the sums of slot i and of the wall. False where it is out of range. */
static bool add_effect(const struct wall_pass *a, size_t i, size_t wall, const struct wall_meeting *at,
                       const struct pair_effect *e, int sign, double force[2])
{
    const struct fixed_scales *s = &a->m->fixed;
    int64_t *sum = a->p->pair_sum + SUM_COUNT * i;
    struct wall_sums *on = &a->ws->sums[wall];
    double largest = (fabs(e->fn) + fabs(e->fdn)) + (fabs(e->ft) + fabs(e->fdt));
    double heat = fabs(e->heat) + fabs(e->heat_damped) + fabs(e->exchange);
    if (!(largest * s->force < FIXED_RANGE) || !(heat * s->heat < FIXED_RANGE))
        return false;
    double sx = at->n[0] * s->force, sy = at->n[1] * s->force;
    int64_t fx = sign * to_fixed(e->fn * sx - e->ft * sy), fy = sign * to_fixed(e->fn * sy + e->ft * sx);
    sum[SUM_FX] += fx;
    sum[SUM_FY] += fy;
    sum[SUM_DX] += sign * to_fixed(e->fdn * sx - e->fdt * sy);
    sum[SUM_DY] += sign * to_fixed(e->fdn * sy + e->fdt * sx);
    sum[SUM_TORQUE] -= sign * to_fixed(e->arm_i * (e->ft * s->torque));
    sum[SUM_DTORQUE] -= sign * to_fixed(e->arm_i * (e->fdt * s->torque));
    sum[SUM_HEAT] += sign * to_fixed(e->heat * s->heat);
    sum[SUM_DHEAT] += sign * (to_fixed(e->heat_damped * s->heat) + to_fixed(e->exchange * s->heat));
    force[0] = (double)fx * s->over_force;
    force[1] = (double)fy * s->over_force;
    exact_add_units(&on->force[0], -fx, 0);
    exact_add_units(&on->force[1], -fy, 0);
    double torque = at->lever[1] * force[0] - at->lever[0] * force[1];
    return exact_add(&on->torque, torque, a->m->scales.energy) &&
           exact_add(&on->heat, sign * e->exchange / a->dt_kick, a->m->scales.energy);
}

/* Adds what a measuring step asks for. The branch of a wall's contact reaches from the foot to the centre; in
 * the virial, half of which is the element's, it counts twice, as the contact with the mirror image. */
static bool measure_contact(const struct wall_pass *a, size_t i, const struct wall_meeting *at,
                            const struct pair_effect *e, int sign, const double force[2])
{
    const struct fixed_scales *s = &a->m->fixed;
    double x = 2.0 * at->d * at->n[0], y = 2.0 * at->d * at->n[1];
    int64_t *virial = a->p->virial + VIRIAL_COUNT * i, *around = a->p->around + AROUND_COUNT * i;
    if (!(fabs(e->potential * s->energy) < FIXED_RANGE) || !(fabs(e->elastic * s->energy) < FIXED_RANGE))
        return false;
    virial[VIRIAL_XX] += to_fixed(x * force[0] * s->virial);
    virial[VIRIAL_YY] += to_fixed(y * force[1] * s->virial);
    virial[VIRIAL_XY] += to_fixed(0.5 * (x * force[1] + y * force[0]) * s->virial);
    virial[VIRIAL_TALLY] += sign * (TALLY_PAIR + TALLY_CONTACT);
    around[AROUND_XX] += sign * to_fixed(x * x * s->around);
    around[AROUND_YY] += sign * to_fixed(y * y * s->around);
    around[AROUND_XY] += sign * to_fixed(x * y * s->around);
    exact_add_units(&a->totals->potential, sign * to_fixed(e->potential * s->energy), s->energy_left);
    exact_add_units(&a->totals->elastic, sign * to_fixed(e->elastic * s->energy), s->energy_left);
    a->totals->contacts += (uint64_t)(int64_t)sign;
    a->totals->wall_contacts += (uint64_t)(int64_t)sign;
    if ((a->p->flags[i] & ELEMENT_FIXED_MOTION) == 0) {
        double magnitude = sqrt(e->fn * e->fn + e->ft * e->ft) * s->force;
        a->totals->loaded_pairs += (uint64_t)(int64_t)sign;
        exact_add_units(&a->totals->magnitudes, sign * to_fixed(magnitude), s->energy_left);
    }
    return true;
}

static enum dm2_status fail_at(const struct wall_pass *a, size_t i, const struct wall *w, double depth,
                               double move, struct dm2_error *err)
{
    const struct particles *p = a->p;
    char what[160], how[120];
    if (move > 0.0)
        (void)snprintf(what, sizeof what, "moves by %.3g of its radius in a step against the wall '%s'",
                       move / p->radius[i], w->config->name);
    else
        (void)snprintf(what, sizeof what, "is %.3g of its radius deep in the wall '%s'", depth / p->radius[i],
                       w->config->name);
    (void)snprintf(how, sizeof how, "%s",
                   move > 0.0
                       ? "more than a quarter can pass through: choose a smaller dt"
                       : "at most half is allowed: begin outside, choose a smaller dt, or a stiffer wall");
    if (a->step == a->m->config->n_start)
        return config_fail(w->config->place, err, DM2_DECK, "element %u, at (%g, %g) cm at the start, %s; %s",
                           p->id[i], p->r[2 * i], p->r[2 * i + 1], what, how);
    return dm2_fail(err, DM2_NUMERIC, "step %lld: element %u at (%g, %g) cm %s; %s", (long long)a->step,
                    p->id[i], p->r[2 * i], p->r[2 * i + 1], what, how);
}

static enum dm2_status fail_range(const struct wall_pass *a, size_t i, const struct wall *w,
                                  struct dm2_error *err)
{
    return dm2_fail(err, DM2_NUMERIC,
                    "step %lld: the force between element %u, at (%g, %g) cm, and the wall '%s' is out of "
                    "range: a smaller dt may help",
                    (long long)a->step, a->p->id[i], a->p->r[2 * i], a->p->r[2 * i + 1], w->config->name);
}

/* The energy book. The lagged heat of a damping force is put right for the element's change of velocity by
 * the kick (leapfrog.c), for the wall's here. The work is that of the force at the mean of the wall's two
 * velocities, and the heat that the wall conducts. */
static double book_work(const struct wall_pass *a, const struct wall_pose *pose,
                        const struct wall_meeting *at, struct pair_effect *e, int sign)
{
    double v[2], next[2], t[2] = {-at->n[1], at->n[0]};
    wall_velocity(pose, at->lever, false, v);
    wall_velocity(pose, at->lever, true, next);
    double dn = (next[0] - v[0]) * at->n[0] + (next[1] - v[1]) * at->n[1],
           dt = (next[0] - v[0]) * t[0] + (next[1] - v[1]) * t[1];
    e->heat_damped += 0.5 * a->dt_kick * (e->fdn * dn + e->fdt * dt);
    double mean[2] = {0.5 * (v[0] + next[0]), 0.5 * (v[1] + next[1])};
    double power =
        e->fn * (mean[0] * at->n[0] + mean[1] * at->n[1]) + e->ft * (mean[0] * t[0] + mean[1] * t[1]);
    return sign * (power * a->dt_kick + e->exchange);
}

static enum dm2_status note_force(const struct wall_pass *a, size_t i, size_t wall, uint32_t feature,
                                  const struct wall_meeting *at, const struct pair_effect *e,
                                  const double force[2], struct dm2_error *err)
{
    struct wall_force note;
    memset(&note, 0, sizeof note);
    note.id = a->p->id[i];
    note.feature = feature;
    note.wall = (uint16_t)wall;
    for (size_t c = 0; c < 2; c++) {
        note.foot[c] = a->p->r[2 * i + c] - at->d * at->n[c];
        note.force[c] = force[c];
    }
    note.normal = number_plus_zero(at->sign * e->fn);
    note.tangential = number_plus_zero(at->sign * e->ft);
    return section_append(SECTION_WFOR, &a->ws->forces, &note, 1)
               ? DM2_OK
               : dm2_fail(err, DM2_MEMORY, "no memory for the forces of walls");
}

/* Entry k of the row of slot i: its memory after the evaluation goes to *next. */
static enum dm2_status evaluate_entry(const struct wall_pass *a, size_t i, const struct wall_entry *row,
                                      size_t n, size_t k, struct wall_entry *next, double *work,
                                      struct dm2_error *err)
{
    const struct particles *p = a->p;
    const struct wall *w = walls_of_feature(a->m, row[k].feature);
    const size_t wall = (size_t)(w - a->m->walls);
    const struct wall_pose *pose = &a->ws->pose[wall];
    const double radius = p->radius[i];
    struct wall_meeting at;
    *next = row[k];
    wall_meet(a->m, w, pose, p, i, &row[k], &at);
    if (at.sign == 0 && row[k].sign == 0)
        return DM2_OK;
    const bool held = wall_holds(a->m, w, p, i);
    double v_wall[2], dt = a->m->config->dt;
    wall_velocity(pose, at.lever, false, v_wall);
    double ux = p->v[2 * i] - v_wall[0], uy = p->v[2 * i + 1] - v_wall[1],
           move = sqrt(ux * ux + uy * uy) * dt;
    if (!held && at.sign > 0 && move > 0.25 * radius && at.d < radius + move)
        return fail_at(a, i, w, 0.0, move, err);
    if (!held && at.sign > 0 && at.d < 0.5 * radius)
        return fail_at(a, i, w, radius - at.d, 0.0, err);
    const struct pair_law *law = &w->laws[p->kind[i]];
    const struct bond made = 2.0 * radius == law->bond.r0 ? law->bond : law_bond(law, 2.0 * radius);
    bool touches = at.sign != 0 && at.d + radius <= made.touch;
    next->sign = touches ? at.sign : 0;
    next->spring = 0.0;
    if (!touches && row[k].sign == 0)
        return DM2_OK;
    struct pair_view view = view_of(a, i, pose, &at, v_wall);
    struct pair_state state = {.spring = row[k].spring};
    struct pair_effect ended = {0}, effect = {.contacting = true};
    double force[2];
    if (row[k].sign != 0 && row[k].sign != next->sign) {
        law_end_spring(law->kt_contact, &made, &view, a->dt_path, &state, &ended);
        if (!held && !add_effect(a, i, wall, &at, &ended, row[k].sign, force))
            return fail_range(a, i, w, err);
    }
    if (!touches)
        return DM2_OK;
    if (row[k].sign != next->sign) {
        state.spring = inherit_spring(w, row, n, row[k].feature);
        effect.heat -=
            law_spring_freed(law->kt_contact, state.spring, law_sliding(&made, &view, &effect), a->dt_path);
    }
    interact(law, &made, &view, held, a->dt_kick, a->dt_path, &state, &effect);
    if (isnan(pose->temperature))
        effect.exchange = 0.0;
    next->spring = held ? 0.0 : state.spring;
    *work += book_work(a, pose, &at, &effect, at.sign);
    if (!add_effect(a, i, wall, &at, &effect, at.sign, force) ||
        (a->totals != NULL && !measure_contact(a, i, &at, &effect, at.sign, force)))
        return fail_range(a, i, w, err);
    a->ws->sums[wall].contacts += at.sign;
    return a->note ? note_force(a, i, wall, row[k].feature, &at, &effect, force, err) : DM2_OK;
}

/* --- all contacts --- */

enum dm2_status walls_evaluate(struct walls *ws, const struct model *m, const struct particles *p,
                               int64_t step, double dt_kick, double dt_path, struct pair_totals *totals,
                               bool note, struct dm2_error *err)
{
    const struct wall_pass pass = {.ws = ws,
                                   .m = m,
                                   .p = p,
                                   .step = step,
                                   .dt_kick = dt_kick,
                                   .dt_path = dt_path,
                                   .totals = totals,
                                   .note = note};
    ws->forces.n = 0;
    memset(ws->sums, 0, m->n_walls * sizeof *ws->sums);
    for (size_t row = 0; row < ws->n_rows; row++) {
        struct wall_entry *entry = ws->entry + ws->start[row];
        size_t n = ws->start[row + 1] - ws->start[row];
        ws->work[row] = 0.0;
        for (size_t k = 0; k < n; k++) {
            enum dm2_status status =
                evaluate_entry(&pass, ws->slot[row], entry, n, k, &ws->next[k], &ws->work[row], err);
            if (status != DM2_OK)
                return status;
        }
        memcpy(entry, ws->next, n * sizeof *entry);
    }
    return DM2_OK;
}

void walls_add_work(const struct walls *ws, const struct particles *p, double share)
{
    for (size_t row = 0; row < ws->n_rows; row++)
        p->work[ws->slot[row]] += share * ws->work[row];
}
