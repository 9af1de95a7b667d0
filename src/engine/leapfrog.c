/* Integration of the owned elements.
 *
 * Energy book (docs/physics.md, section 7): the pairs book damping heat with the velocities of the half step
 * before. The sums of each element are enough to correct this lag exactly, because sum over pairs of -F_d .
 * (v(n-1/2) + v(n+1/2))/2 dt = lagged heat - 1/2 dt sum_i (F_d,i . dv_i + tau_d,i dw_i). At the whole step,
 * kinetic energy is that of the mean velocity, and thermal energy counts half of the damping heat of the
 * surrounding step and all heat freed so far. */
#include "leapfrog.h"

#include <math.h>

#include "dm2/base/number.h"
#include "dm2/base/simd.h"
#include "lists.h"

double leapfrog_kick_time(const struct model *m, int64_t step)
{
    return step == 0 ? 0.5 * m->config->dt : m->config->dt;
}

double leapfrog_path_time(const struct model *m, int64_t step)
{
    return step == 0 ? 0.0 : m->config->dt;
}

/* The changes of one element by one kick. */
struct kick {
    double dv[2], dw;   /* cm/us, 1/us; 0 for a driven element */
    double heat_now;    /* freed at once, g cm2/us2 */
    double heat_damped; /* of the kick, corrected, with conduction, g cm2/us2 */
    double force[2];    /* total pair force, Mbar cm2 */
};

/* near: the deck has near pairs; without near pairs pair_sum is not valid. dt: of the kick, us. */
DM2_INLINE struct kick find_kick(const struct model *m, const struct particles *p, size_t i, double dt,
                                 bool near)
{
    const int64_t *s = near ? p->pair_sum + SUM_COUNT * i : NULL;
    const struct fixed_scales *x = &m->fixed;
    double over_mass = 1.0 / p->mass[i];
    struct kick k = {.dw = 0.0};
    for (int a = 0; a < 2; a++) {
        if (p->far_sum != NULL)
            k.force[a] = (double)p->far_sum[2 * i + (size_t)a] * x->over_far_force;
        if (near)
            k.force[a] += (double)s[SUM_FX + a] * x->over_force;
        k.dv[a] = (k.force[a] * over_mass + m->config->gravity[a]) * dt;
    }
    if (near && m->has_spin) /* the inertia of a disc is m R^2/2 */
        k.dw =
            (double)s[SUM_TORQUE] * x->over_torque * (2.0 * over_mass / (p->radius[i] * p->radius[i])) * dt;
    if (p->flags[i] & ELEMENT_FIXED_MOTION)
        k.dv[0] = k.dv[1] = k.dw = 0.0;
    if (near) {
        double lost = (double)s[SUM_DX] * x->over_force * k.dv[0] +
                      (double)s[SUM_DY] * x->over_force * k.dv[1] +
                      (double)s[SUM_DTORQUE] * x->over_torque * k.dw;
        k.heat_now = (double)s[SUM_HEAT] * x->over_heat;
        k.heat_damped = (double)s[SUM_DHEAT] * x->over_heat - 0.5 * dt * lost;
    }
    return k;
}

void leapfrog_whole_velocity(const struct model *m, const struct particles *p, size_t i, int64_t step,
                             double v[2], double *w)
{
    double share = step == 0 ? 0.0 : 0.5; /* step 0 starts at the whole step */
    struct kick k = find_kick(m, p, i, leapfrog_kick_time(m, step), m->has_near);
    for (size_t a = 0; a < 2; a++)
        v[a] = p->v[2 * i + a] + share * k.dv[a];
    *w = p->w[i] + share * k.dw;
}

/* The volume of slot i among its neighbours, cm3. Six neighbours give the sides of a deformed hexagonal cell:
 * with M = sum r (x) r, which is 3 d^2 F F^T for a lattice deformed by F, the area of the cell is sqrt(det
 * M)/(2 sqrt 3), exact for any homogeneous F. Otherwise, at surfaces and in loose packings, the cell is that
 * of the element at rest. */
static double find_volume(const struct model *m, const struct particles *p, size_t i)
{
    const int64_t *s = p->around != NULL ? p->around + AROUND_COUNT * i : NULL;
    double d = 2.0 * p->radius[i], over = 1.0 / m->fixed.around; /* a power of two: exact */
    if (s != NULL && p->virial[VIRIAL_COUNT * i + VIRIAL_TALLY] % TALLY_LINK == 6 * TALLY_PAIR) {
        double xx = (double)s[AROUND_XX] * over, yy = (double)s[AROUND_YY] * over,
               xy = (double)s[AROUND_XY] * over;
        double det = xx * yy - xy * xy;
        if (det > 0.0)
            return 0x1.279a74590331dp-2 * sqrt(det); /* 1/(2 sqrt(3)) */
    }
    return 0x1.bb67ae8584caap-1 * (d * d); /* sqrt(3)/2 d^2 h */
}

/* The first n components of leapfrog_stress. */
static inline void find_stress(const struct model *m, const struct particles *p, size_t i, size_t n,
                               double *stress)
{
    double volume = find_volume(m, p, i), over = 1.0 / m->fixed.virial; /* a power of two: exact */
    for (size_t a = 0; a < n; a++)
        stress[a] = -0.5 * ((double)p->virial[VIRIAL_COUNT * i + a] * over) / volume;
}

void leapfrog_stress(const struct model *m, const struct particles *p, size_t i, double stress[3])
{
    find_stress(m, p, i, VIRIAL_TALLY, stress);
}

/* P = -tr(sigma)/2 of slot i, Mbar; never -0. */
static inline double find_pressure(const struct model *m, const struct particles *p, size_t i)
{
    double stress[VIRIAL_XY];
    find_stress(m, p, i, VIRIAL_XY, stress);
    return number_plus_zero(-0.5 * (stress[VIRIAL_XX] + stress[VIRIAL_YY]));
}

void leapfrog_set_pressure(const struct model *m, struct particles *p)
{
    for (size_t i = 0; i < p->n_own; i++)
        p->p[i] = find_pressure(m, p, i);
}

/* The power that keeps a driven element at its velocity against the pair forces. Its work up to a whole step
 * counts half of the power at this step and half of the power at the start: the trapezoidal rule, as accurate
 * as the leapfrog. */
static double find_drive_power(const struct particles *p, size_t i, const struct kick *k)
{
    return -(k->force[0] * p->v[2 * i] + k->force[1] * p->v[2 * i + 1]);
}

/* Adds the part of slot i to the measures of this step. False where a value leaves the range of its sum. */
static bool measure_element(const struct model *m, const struct particles *p, size_t i, int64_t step,
                            const struct kick *k, struct measures *out)
{
    const struct measure_scales *s = &m->scales;
    double share = step == 0 ? 0.0 : 0.5, mass = p->mass[i];
    double v[2] = {p->v[2 * i] + share * k->dv[0], p->v[2 * i + 1] + share * k->dv[1]};
    double w = p->w[i] + share * k->dw, spin = 0.5 * mass * (p->radius[i] * p->radius[i]) * w;
    double x = particles_unwrapped(p, m, i, 0), y = particles_unwrapped(p, m, i, 1),
           work = p->work != NULL ? p->work[i] : 0.0;
    double temperature = number_plus_zero(particles_temperature(p, m, i));
    if (p->flags[i] & ELEMENT_FIXED_MOTION)
        work += share * leapfrog_kick_time(m, step) * find_drive_power(p, i, k);
    bool fits =
        exact_add(&out->kinetic, 0.5 * mass * (v[0] * v[0] + v[1] * v[1]) + 0.5 * spin * w, s->energy);
    fits &= exact_add(&out->thermal, p->heat[i] + k->heat_now + share * k->heat_damped, s->energy);
    if (m->has_kinds) {
        const struct kind *kind = &m->kinds[p->kind[i]];
        double left = p->share != NULL ? p->share[2 * i] + p->share[2 * i + 1] : 0.0;
        fits &= exact_add(&out->chemical, m->reaction.heat * (mass * left), s->energy);
        fits &= exact_add(&out->phase, mass * kind->energy + p->moved[i], s->energy);
    }
    fits &= exact_add(&out->work, work, s->energy);
    fits &= exact_add(&out->momentum[0], mass * v[0], s->momentum);
    fits &= exact_add(&out->momentum[1], mass * v[1], s->momentum);
    fits &= exact_add(&out->angular, mass * (x * v[1] - y * v[0]) + spin, s->momentum);
    out->elements++;
    double pressure = find_pressure(m, p, i);
    out->p_min = pressure < out->p_min ? pressure : out->p_min;
    out->p_max = pressure > out->p_max ? pressure : out->p_max;
    out->t_max = temperature > out->t_max ? temperature : out->t_max;
    for (int b = 0; p->probes[i] >> b != 0; b++) {
        if (!(p->probes[i] >> b & 1))
            continue;
        out->probe[b].count++;
        const double r[2] = {x, y};
        for (int a = 0; a < 2; a++) {
            fits &= exact_add(&out->probe[b].r[a], r[a], s->length);
            fits &= exact_add(&out->probe[b].v[a], v[a], s->velocity);
        }
    }
    return fits;
}

static enum dm2_status fail_out_of_range(const struct particles *p, size_t i, int64_t step, const char *what,
                                         struct dm2_error *err)
{
    return dm2_fail(err, DM2_NUMERIC,
                    "step %lld: element %u at (%g, %g) cm %s (velocity (%g, %g) cm/us): the run is unstable; "
                    "choose a smaller "
                    "dt or check the deck's velocities and stiffnesses",
                    (long long)step, p->id[i], p->r[2 * i], p->r[2 * i + 1], what, p->v[2 * i],
                    p->v[2 * i + 1]);
}

/* Wraps coordinate `at` of the places, along periodic direction a, into the domain. False where the element
 * has gone round more than IMAGE_MOST times. */
DM2_INLINE bool wrap_place(const struct model *m, const struct particles *p, size_t at, size_t a)
{
    int32_t turns;
    p->r[at] = grid_wrap(m->grid.origin[a], m->grid.size[a], p->r[at], &turns);
    if (turns == 0)
        return true;
    p->image[at] += turns;
    return p->image[at] <= IMAGE_MOST && p->image[at] >= -IMAGE_MOST;
}

/* Kicks and drifts the owned elements; compiled apart for decks with near pairs and without. Returns the
 * largest squared speed; *bad is the first slot whose squared speed is not below limit2, or that has gone
 * round the domain more than IMAGE_MOST times, n_own if there is none. `own` is a copy of the columns that no
 * other pointer reaches, so that a store to one column does not force the processor to reload the addresses
 * of all. */
DM2_INLINE double kick_and_drift(const struct model *m, const struct particles *columns, double dt_kick,
                                 double limit2, bool near, size_t *bad)
{
    struct particles own = *columns, *p = &own;
    const struct config *c = m->config;
    const bool pulled = c->gravity[0] != 0.0 || c->gravity[1] != 0.0;
    double dt = c->dt, fastest2 = 0.0;
    *bad = p->n_own;
    for (size_t i = 0; i < p->n_own; i++) {
        struct kick k = find_kick(m, p, i, dt_kick, near);
        double v[2] = {p->v[2 * i] + k.dv[0], p->v[2 * i + 1] + k.dv[1]},
               r[2] = {p->r[2 * i], p->r[2 * i + 1]};
        double speed2 = v[0] * v[0] + v[1] * v[1];
        if (!(speed2 < limit2)) {
            *bad = i;
            return speed2;
        }
        for (size_t a = 0; a < 2; a++) {
            r[a] += v[a] * dt;
            p->v[2 * i + a] = v[a];
            p->r[2 * i + a] = r[a];
            if (m->grid.periodic[a] && !wrap_place(m, p, 2 * i + a, a)) {
                *bad = i;
                return speed2;
            }
        }
        if (p->work != NULL && (p->flags[i] & ELEMENT_FIXED_MOTION))
            p->work[i] += find_drive_power(p, i, &k) * dt_kick;
        else if (pulled)
            p->work[i] += p->mass[i] * (c->gravity[0] * v[0] + c->gravity[1] * v[1]) * dt;
        if (near) {
            p->w[i] += k.dw;
            p->heat[i] += k.heat_now + k.heat_damped;
            particles_warm(p, m, i, 1.0 / p->mass[i]);
        }
        fastest2 = speed2 > fastest2 ? speed2 : fastest2;
    }
    return fastest2;
}

DM2_WIDE static double kick_and_drift_near(const struct model *m, const struct particles *p, double dt_kick,
                                           double limit2, size_t *bad)
{
    return kick_and_drift(m, p, dt_kick, limit2, true, bad);
}

DM2_WIDE static double kick_and_drift_far(const struct model *m, const struct particles *p, double dt_kick,
                                          double limit2, size_t *bad)
{
    return kick_and_drift(m, p, dt_kick, limit2, false, bad);
}

enum dm2_status leapfrog_move(const struct model *m, struct particles *p, int64_t step, bool drift,
                              double *dmax, struct measures *out, struct dm2_error *err)
{
    double dt = m->config->dt, dt_kick = leapfrog_kick_time(m, step);
    double edge = m->grid.lx < m->grid.ly ? m->grid.lx : m->grid.ly, limit2 = (edge / dt) * (edge / dt);
    for (size_t i = 0; out != NULL && i < p->n_own; i++) {
        struct kick k = find_kick(m, p, i, dt_kick, m->has_near);
        if (!measure_element(m, p, i, step, &k, out))
            return fail_out_of_range(p, i, step, "left the range that sums can hold", err);
    }
    if (!drift)
        return DM2_OK;
    size_t bad;
    double fastest2 = m->has_near ? kick_and_drift_near(m, p, dt_kick, limit2, &bad)
                                  : kick_and_drift_far(m, p, dt_kick, limit2, &bad);
    if (bad < p->n_own && fastest2 < limit2)
        return dm2_fail(
            err, DM2_NUMERIC,
            "step %lld: element %u has gone round the periodic domain more than 2^30 times, more than "
            "its counts of turns hold: end the run earlier",
            (long long)step, p->id[bad]);
    if (bad < p->n_own)
        return fail_out_of_range(p, bad, step, "would move further than a cell edge in one step", err);
    *dmax = sqrt(fastest2) * dt;
    return DM2_OK;
}
