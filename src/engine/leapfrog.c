/* Integration of the owned elements.
 *
 * Energy book (docs/physics.md, section 7): the pairs book damping heat with the velocities of the half step
 * before. The sums of each element are enough to correct this lag exactly, because sum over pairs of -F_d .
 * (v(n-1/2) + v(n+1/2))/2 dt = lagged heat - 1/2 dt sum_i (F_d,i . dv_i + tau_d,i dw_i). At the whole step,
 * kinetic energy is that of the mean velocity, and thermal energy counts half of the damping heat of the
 * surrounding step and all heat freed so far. What local damping takes is booked like the work of driven
 * elements: its power at a whole step is that of the mean velocity, and a whole step counts half of it. */
#include "leapfrog.h"

#include <math.h>

#include "dm2/base/number.h"
#include "dm2/base/simd.h"
#include "drive.h"
#include "lists.h"
#include "probes.h"

double leapfrog_kick_time(const struct model *m, int64_t step)
{
    const struct config *c = m->config;
    return step == c->n_start ? 0.5 * (c->dt_before + c->dt) : c->dt;
}

double leapfrog_path_time(const struct model *m, int64_t step)
{
    return step == m->config->n_start ? m->config->dt_before : m->config->dt;
}

/* The part of a kick before its whole step: all but dt/2, that is half of the kick, and nothing where the
 * velocities are already those of the whole step. */
static double find_share(const struct model *m, double dt_kick)
{
    return 1.0 - 0.5 * m->config->dt / dt_kick;
}

/* The changes of one element by one kick. */
struct kick {
    double dv[2], dw;          /* cm/us, 1/us; 0 for a driven element */
    double heat_now;           /* freed at once, g cm2/us2 */
    double heat_damped;        /* of the kick, corrected, with conduction, g cm2/us2 */
    double force[2];           /* total pair force, Mbar cm2 */
    double torque;             /* total pair torque, Mbar cm3; where the deck has drives */
    double held[2], held_spin; /* the parts of dv and dw that local damping took; 0 without local damping */
};

/* The change of a velocity that local damping (Cundall 1987) leaves of `change`: less where `change` and the
 * velocity of the half step before agree in sign, more where they do not. */
DM2_INLINE double damp_change(double change, double velocity, double alpha)
{
    int agree = ((change > 0.0) - (change < 0.0)) * ((velocity > 0.0) - (velocity < 0.0));
    return change * (1.0 - alpha * agree);
}

/* Damps the changes of slot i, which are those of the undamped kick. */
DM2_INLINE void damp_kick(const struct particles *p, size_t i, double alpha, struct kick *k)
{
    for (size_t a = 0; a < 2; a++) {
        double whole = k->dv[a];
        k->dv[a] = damp_change(whole, p->v[2 * i + a], alpha);
        k->held[a] = whole - k->dv[a];
    }
    double whole = k->dw;
    k->dw = damp_change(whole, p->w[i], alpha);
    k->held_spin = whole - k->dw;
}

/* The changes of slot i that a drive makes: to the velocity and the spin of the next half step, where the
 * elements of the body follow their homes, or by an acceleration. */
static void drive_kick(const struct particles *p, size_t i, const struct body_drive *d, double dt,
                       struct kick *k)
{
    if (d->placed) {
        double v[2];
        drive_velocity(d, p->home + 2 * i, v);
        k->dv[0] = v[0] - p->v[2 * i];
        k->dv[1] = v[1] - p->v[2 * i + 1];
        k->dw = d->w - p->w[i];
    } else if (d->pushed) {
        k->dv[0] += d->a[0] * dt;
        k->dv[1] += d->a[1] * dt;
    }
}

/* near: the deck has near pairs; without near pairs pair_sum is not valid. damped: the deck has local
 * damping. drives: p->drives. dt: of the kick, us. */
DM2_INLINE struct kick find_kick(const struct model *m, const struct particles *p, size_t i, double dt,
                                 bool near, bool damped, const struct body_drive *drives)
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
    if (near && drives != NULL)
        k.torque = (double)s[SUM_TORQUE] * x->over_torque;
    if (drives != NULL)
        drive_kick(p, i, &drives[p->body[i]], dt, &k);
    if (damped && !(p->flags[i] & ELEMENT_FIXED_MOTION))
        damp_kick(p, i, m->config->damping, &k);
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
    double share = find_share(m, leapfrog_kick_time(m, step));
    struct kick k = find_kick(m, p, i, leapfrog_kick_time(m, step), m->has_near, m->has_damping, p->drives);
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

/* Kinetic energy of slot i with these velocities. */
static inline double find_kinetic(const struct particles *p, size_t i, const double v[2], double w)
{
    double inertia = 0.5 * p->mass[i] * (p->radius[i] * p->radius[i]);
    return 0.5 * p->mass[i] * (v[0] * v[0] + v[1] * v[1]) + 0.5 * inertia * w * w;
}

/* The work on slot i by a drive, up to a share of the step's kick: 1 for the whole of it. Of an element that
 * follows its home the power is that of the pair forces with the mean of the two half steps, and the change
 * of kinetic energy counts; step 0 begins with the velocity at the start. `mean`: 1/2, and 0 at step 0. */
static double find_drive_work(const struct particles *p, size_t i, const struct body_drive *d,
                              const struct kick *k, double dt, double share, double mean)
{
    const double *v = p->v + 2 * i, w = p->w[i], middle[2] = {v[0] + mean * k->dv[0], v[1] + mean * k->dv[1]};
    if (!d->placed)
        return d->pushed ? share * dt * p->mass[i] * (d->a[0] * middle[0] + d->a[1] * middle[1]) : 0.0;
    double end = share == 1.0 ? 1.0 : mean, to[2] = {v[0] + end * k->dv[0], v[1] + end * k->dv[1]};
    double power = k->force[0] * middle[0] + k->force[1] * middle[1] + k->torque * (w + mean * k->dw);
    return find_kinetic(p, i, to, w + end * k->dw) - find_kinetic(p, i, v, w) - share * dt * power;
}

/* The energy that local damping takes from slot i in kick k, g cm2/us2. `share` of the kick is done at the
 * whole step, where the power of the damping is taken. */
DM2_INLINE double find_damped(const struct particles *p, size_t i, const struct kick *k, double share)
{
    double mass = p->mass[i], inertia = 0.5 * mass * (p->radius[i] * p->radius[i]);
    return mass * (k->held[0] * (p->v[2 * i] + share * k->dv[0]) +
                   k->held[1] * (p->v[2 * i + 1] + share * k->dv[1])) +
           inertia * (k->held_spin * (p->w[i] + share * k->dw));
}

DM2_INLINE void add_damped(const struct particles *p, size_t i, const struct kick *k, double share,
                           bool damped)
{
    if (damped)
        p->damped[i] += find_damped(p, i, k, share);
}

/* Adds the part of slot i to the measures of this step. False where a value leaves the range of its sum. */
static bool measure_element(const struct model *m, const struct particles *p, size_t i, int64_t step,
                            const struct kick *k, struct measures *out)
{
    const struct measure_scales *s = &m->scales;
    double share = find_share(m, leapfrog_kick_time(m, step)), mass = p->mass[i];
    double v[2] = {p->v[2 * i] + share * k->dv[0], p->v[2 * i + 1] + share * k->dv[1]};
    double w = p->w[i] + share * k->dw, spin = 0.5 * mass * (p->radius[i] * p->radius[i]) * w;
    double x = particles_unwrapped(p, m, i, 0), y = particles_unwrapped(p, m, i, 1),
           work = p->work != NULL ? p->work[i] : 0.0;
    double temperature = number_plus_zero(particles_temperature(p, m, i));
    const struct body_drive *drive = p->drives != NULL ? &p->drives[p->body[i]] : NULL;
    if (drive != NULL && (drive->placed || drive->pushed))
        work += find_drive_work(p, i, drive, k, leapfrog_kick_time(m, step), share, share);
    else if (p->flags[i] & ELEMENT_FIXED_MOTION)
        work += share * leapfrog_kick_time(m, step) * find_drive_power(p, i, k);
    double kinetic = 0.5 * mass * (v[0] * v[0] + v[1] * v[1]) + 0.5 * spin * w;
    bool fits = exact_add(&out->kinetic, kinetic, s->energy);
    fits &= exact_add(&out->thermal, p->heat[i] + k->heat_now + share * k->heat_damped, s->energy);
    if (m->has_kinds) {
        const struct kind *kind = &m->kinds[p->kind[i]];
        double left = p->share != NULL ? p->share[2 * i] + p->share[2 * i + 1] : 0.0;
        fits &= exact_add(&out->chemical, m->reaction.heat * (mass * left), s->energy);
        fits &= exact_add(&out->phase, mass * kind->energy + p->moved[i], s->energy);
    }
    fits &= exact_add(&out->work, work, s->energy);
    if (p->damped != NULL)
        fits &= exact_add(&out->damped, p->damped[i] + share * find_damped(p, i, k, share), s->energy);
    fits &= exact_add(&out->momentum[0], mass * v[0], s->momentum);
    fits &= exact_add(&out->momentum[1], mass * v[1], s->momentum);
    fits &= exact_add(&out->angular, mass * (x * v[1] - y * v[0]) + spin, s->momentum);
    out->elements++;
    if (!m->has_far && !(p->flags[i] & ELEMENT_FIXED_MOTION)) {
        double fx = k->force[0] + mass * m->config->gravity[0],
               fy = k->force[1] + mass * m->config->gravity[1];
        if (drive != NULL && drive->pushed) {
            fx += mass * drive->a[0];
            fy += mass * drive->a[1];
        }
        fits &= exact_add(&out->resultants, sqrt(fx * fx + fy * fy), s->force);
        out->free_elements++;
    }
    double pressure = find_pressure(m, p, i);
    out->p_min = pressure < out->p_min ? pressure : out->p_min;
    out->p_max = pressure > out->p_max ? pressure : out->p_max;
    out->t_max = temperature > out->t_max ? temperature : out->t_max;
    if (m->probes.n > 0) {
        const struct probe_sample at = {{x, y},      {v[0], v[1]}, w, {k->force[0], k->force[1]},
                                        temperature, kinetic};
        fits &= probes_add(m, p, i, &at, out);
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

/* The sums of unwrapped places hold a million times the domain (scales.c), fewer than the counts of turns. */
static enum dm2_status fail_to_measure(const struct model *m, const struct particles *p, size_t i,
                                       int64_t step, struct dm2_error *err)
{
    for (size_t a = 0; a < 2; a++)
        if (m->grid.periodic[a] && (p->image[2 * i + a] > 1000000 || p->image[2 * i + a] < -1000000))
            return dm2_fail(
                err, DM2_NUMERIC,
                "step %lld: element %u has gone round the periodic domain %ld times, and the sums "
                "of the history hold a million: end the run earlier",
                (long long)step, p->id[i], (long)p->image[2 * i + a]);
    return fail_out_of_range(p, i, step, "left the range that sums can hold", err);
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

/* Puts coordinate `at`, along periodic direction a, to x, not wrapped, of an element that follows its home.
 * The turn is that of the path, of less than half of the domain, because x counts from no start. False as
 * wrap_place. */
static bool set_place(const struct model *m, const struct particles *p, size_t at, size_t a, double x)
{
    int32_t turns;
    double before = p->r[at], half = 0.5 * m->grid.size[a];
    p->r[at] = grid_wrap(m->grid.origin[a], m->grid.size[a], x, &turns);
    p->image[at] += p->r[at] - before < -half ? 1 : p->r[at] - before > half ? -1 : 0;
    return p->image[at] <= IMAGE_MOST && p->image[at] >= -IMAGE_MOST;
}

/* Puts coordinate `at`, along direction a, to x. False as wrap_place. */
DM2_INLINE bool put_coordinate(const struct model *m, const struct particles *p, size_t at, size_t a,
                               double x, bool placed)
{
    if (placed && m->grid.periodic[a])
        return set_place(m, p, at, a, x);
    p->r[at] = x;
    return !m->grid.periodic[a] || wrap_place(m, p, at, a);
}

/* Slots that are moved in one go. */
struct range {
    size_t first, last;
};

/* Kicks and drifts the elements of a range of owned slots; compiled apart for decks with near pairs, without,
 * with local damping, and for slots with drives. Returns the largest squared speed; *bad is the first slot
 * whose squared speed is not below limit2, or that has gone round the domain more than IMAGE_MOST times,
 * n_own if there is none. `own` is a copy of the columns that no other pointer reaches, so that a store to
 * one column does not force the processor to reload the addresses of all. */
DM2_INLINE double kick_and_drift(const struct model *m, const struct particles *columns, struct range slots,
                                 double dt_kick, double limit2, bool near, bool damped,
                                 const struct body_drive *drives, size_t *bad)
{
    struct particles own = *columns, *p = &own;
    const struct config *c = m->config;
    const bool pulled = c->gravity[0] != 0.0 || c->gravity[1] != 0.0;
    double dt = c->dt, fastest2 = 0.0;
    double share = find_share(m, dt_kick);
    *bad = p->n_own;
    for (size_t i = slots.first; i < slots.last; i++) {
        const struct body_drive *drive = drives != NULL ? &drives[p->body[i]] : NULL;
        const bool placed = drive != NULL && drive->placed;
        struct kick k = find_kick(m, p, i, dt_kick, near, damped, drives);
        add_damped(p, i, &k, dt_kick == dt ? 0.5 : 0.0, damped); /* the share as in measure_element */
        double v[2] = {p->v[2 * i] + k.dv[0], p->v[2 * i + 1] + k.dv[1]},
               r[2] = {p->r[2 * i], p->r[2 * i + 1]};
        if (placed) /* exactly, not but for the rounding of the kick */
            drive_velocity(drive, p->home + 2 * i, v);
        double speed2 = v[0] * v[0] + v[1] * v[1];
        if (!(speed2 < limit2)) {
            *bad = i;
            return speed2;
        }
        if (drive != NULL)
            p->work[i] += find_drive_work(p, i, drive, &k, dt_kick, 1.0, share);
        if (placed)
            drive_place(drive, p->home + 2 * i, r);
        for (size_t a = 0; a < 2; a++) {
            p->v[2 * i + a] = v[a];
            if (!placed)
                r[a] += v[a] * dt;
            if (!put_coordinate(m, p, 2 * i + a, a, r[a], placed)) {
                *bad = i;
                return speed2;
            }
        }
        if (placed)
            p->w[i] = drive->w;
        else if (p->work != NULL && (p->flags[i] & ELEMENT_FIXED_MOTION))
            p->work[i] += find_drive_power(p, i, &k) * dt_kick;
        else if (pulled)
            p->work[i] += p->mass[i] * (c->gravity[0] * v[0] + c->gravity[1] * v[1]) * dt;
        if (near) {
            if (!placed)
                p->w[i] += k.dw;
            p->heat[i] += k.heat_now + k.heat_damped;
            particles_warm(p, m, i, 1.0 / p->mass[i]);
        }
        fastest2 = speed2 > fastest2 ? speed2 : fastest2;
    }
    return fastest2;
}

DM2_WIDE static double kick_and_drift_near(const struct model *m, const struct particles *p,
                                           struct range slots, double dt_kick, double limit2, size_t *bad)
{
    return kick_and_drift(m, p, slots, dt_kick, limit2, true, false, NULL, bad);
}

DM2_WIDE static double kick_and_drift_far(const struct model *m, const struct particles *p,
                                          struct range slots, double dt_kick, double limit2, size_t *bad)
{
    return kick_and_drift(m, p, slots, dt_kick, limit2, false, false, NULL, bad);
}

DM2_WIDE static double kick_and_drift_damped(const struct model *m, const struct particles *p,
                                             struct range slots, double dt_kick, double limit2, size_t *bad)
{
    return kick_and_drift(m, p, slots, dt_kick, limit2, m->has_near, true, NULL, bad);
}

/* Most decks with drives have near pairs alone and no damping. Slots that no drive moves go the ways above.
 */
DM2_WIDE static double kick_and_drift_driven(const struct model *m, const struct particles *p,
                                             struct range slots, double dt_kick, double limit2, size_t *bad)
{
    if (m->has_near && !m->has_damping)
        return kick_and_drift(m, p, slots, dt_kick, limit2, true, false, p->drives, bad);
    return kick_and_drift(m, p, slots, dt_kick, limit2, m->has_near, m->has_damping, p->drives, bad);
}

/* kick_and_drift for all owned slots, in their order. */
static double move_runs(const struct model *m, const struct particles *p, double dt_kick, double limit2,
                        size_t *bad)
{
    const size_t n_edges = p->runs != NULL ? p->runs->n : 0;
    double fastest2 = 0.0;
    struct range slots = {0, 0};
    *bad = p->n_own;
    for (size_t k = 0; k <= n_edges; k++, slots.first = slots.last) {
        slots.last = k < n_edges ? p->runs->edge[k] : p->n_own;
        double most2 = k % 2 == 1       ? kick_and_drift_driven(m, p, slots, dt_kick, limit2, bad)
                       : m->has_damping ? kick_and_drift_damped(m, p, slots, dt_kick, limit2, bad)
                       : m->has_near    ? kick_and_drift_near(m, p, slots, dt_kick, limit2, bad)
                                        : kick_and_drift_far(m, p, slots, dt_kick, limit2, bad);
        if (*bad < p->n_own)
            return most2;
        fastest2 = most2 > fastest2 ? most2 : fastest2;
    }
    return fastest2;
}

enum dm2_status leapfrog_move(const struct model *m, struct particles *p, int64_t step, bool drift,
                              double *dmax, struct measures *out, struct dm2_error *err)
{
    double dt = m->config->dt, dt_kick = leapfrog_kick_time(m, step);
    double edge = m->grid.lx < m->grid.ly ? m->grid.lx : m->grid.ly, limit2 = (edge / dt) * (edge / dt);
    for (size_t i = 0; out != NULL && i < p->n_own; i++) {
        struct kick k = find_kick(m, p, i, dt_kick, m->has_near, m->has_damping, p->drives);
        if (!measure_element(m, p, i, step, &k, out))
            return fail_to_measure(m, p, i, step, err);
    }
    if (!drift)
        return DM2_OK;
    size_t bad;
    double fastest2 = move_runs(m, p, dt_kick, limit2, &bad);
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
