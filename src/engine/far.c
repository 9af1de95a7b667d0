/* Potentials of scope `all`: every pair within a cutoff, without memory or status. A molecular-dynamics deck
 * spends nearly all of its time in this loop, so the common case, one kind of element with a Lennard-Jones
 * potential, has a path for four pairs at a time, over the quads of the inner list (inner.h), whose unused
 * lanes hold a slot that is far from all elements. Both paths do the same operations on each pair, so both
 * give the same bits.
 *
 * Forces become integers as by SIMD_FIXED, exact below 2^51. A Lennard-Jones pair leaves this range only
 * where it is closer than law->r2_least; the forces of other potentials are checked one by one. */
#include <string.h>

#include "dm2/base/simd.h"
#include "pair_pass.h"

static const double far_range = 0x1p50; /* of each component of a force, in fixed point */

/* SIMD_FIXED of one double. */
static inline int64_t far_to_fixed(double scaled)
{
    double shifted = scaled + simd_shifter;
    int64_t bits, zero;
    memcpy(&bits, &shifted, sizeof bits);
    memcpy(&zero, &simd_shifter, sizeof zero);
    return bits - zero;
}

/* Force over distance, f/r, of the potential at r^2, and, with energy != NULL, its energy above that at the
 * cutoff.
 */
static inline double find_far_force(const struct pair_law *law, double r2, double r0, double *energy)
{
    if (law->eps12 > 0.0) {
        double w = law->rm2 / r2, w3 = w * w * w;
        if (energy != NULL)
            *energy = law->eps12 * (1.0 / 12.0) * (w3 * w3 - 2.0 * w3) - law->u_cut;
        return law->strength * w * w3 * (w3 - 1.0);
    }
    double r = sqrt(r2), u, u_end, f = potential_force(law, r, r0, &u);
    if (energy != NULL) {
        (void)potential_force(law, sqrt(law->cutoff2), r0, &u_end);
        *energy = u - u_end;
    }
    return f / r;
}

/* The plain loop: any mix of kinds and potentials, with or without measures. */
static inline void evaluate_rows(struct pass *pass, const struct lists *lists, bool uniform, bool measure)
{
    const struct half_list *list = &lists->far;
    const struct model *m = pass->m;
    struct particles *p = pass->p;
    const double *r = p->r, scale = m->fixed.far_force;
    int64_t *sum = p->far_sum;
    const struct pair_law *law = m->laws;
    double r0 = 2.0 * m->radius_max;
    uint32_t first, last;
    lists_rows(lists, p, pass->part, &first, &last);
    for (uint32_t i = first; i < last; i++) {
        double x = r[2 * i], y = r[2 * i + 1];
        int64_t fx_i = 0, fy_i = 0;
        bool bad = false;
        for (uint32_t k = list->start[i]; k < list->start[i + 1]; k++) {
            uint32_t j = list->j[k] / 2;
            double dx = period_nearest(x - r[2 * (size_t)j], pass->period.size[0], pass->period.half[0]);
            double dy = period_nearest(y - r[2 * (size_t)j + 1], pass->period.size[1], pass->period.half[1]);
            double r2 = dx * dx + dy * dy, energy = 0.0;
            if (!uniform) {
                law = particles_law(m, p, i, j);
                r0 = p->radius[i] + p->radius[j];
            }
            if (r2 > law->cutoff2)
                continue;
            double f = find_far_force(law, r2, r0, measure ? &energy : NULL), fs = f * scale;
            double fx = fs * dx, fy = fs * dy;
            bad |= !(r2 >= law->r2_least) | !(fabs(fx) < far_range) | !(fabs(fy) < far_range);
            if (bad) { /* the force has no integer */
                note_bad(pass, i, j);
                break;
            }
            int64_t qx = far_to_fixed(fx), qy = far_to_fixed(fy);
            fx_i += qx;
            fy_i += qy;
            sum[2 * (size_t)j] -= qx;
            sum[2 * (size_t)j + 1] -= qy;
            if (measure) {
                double us = energy * m->fixed.energy;
                add_virial(pass, i, j, dx, dy, f * dx, f * dy);
                bad |= !(fabs(us) < FIXED_RANGE);
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

/* The force sum of the element whose x is component c; the arrays are aligned to cache lines. */
#define FORCE(c) (*(simd_int2 *)(void *)(sum + (c)))

/* Four pairs between geometry and force. */
struct far_lanes {
    simd_real dx, dy, r2, w; /* w = r_m^2/r^2 */
};

/* Differences, r^2 and w of a quad; rm2: r_m^2, cm2. */
DM2_INLINE void find_geometry(const struct far_quad *quad, const double *r, double rm2,
                              const struct pass *pass, bool periodic, struct far_lanes *out)
{
    const uint32_t *j = quad->j;
    simd_real a = SIMD_JOIN(SIMD_AT(r, j[0]), SIMD_AT(r, j[2])),
              b = SIMD_JOIN(SIMD_AT(r, j[1]), SIMD_AT(r, j[3]));
    simd_real dx = r[quad->i] - SIMD_EVEN(a, b), dy = r[quad->i + 1] - SIMD_ODD(a, b);
    if (periodic) {
        lanes_nearest(&dx, pass->period.size[0], pass->period.half[0]);
        lanes_nearest(&dy, pass->period.size[1], pass->period.half[1]);
    }
    simd_real r2 = dx * dx + dy * dy;
    *out = (struct far_lanes){dx, dy, r2, rm2 / r2};
}

/* One Lennard-Jones law for all, four pairs at a time: the plain loop in lanes. The distances of a quad are
 * computed beside the forces of the quad before it, so that the processor waits for neither. Returns the
 * least r^2 of all pairs, cm2. */
DM2_INLINE double add_forces(const struct pass *pass, const struct inner_list *list, bool periodic)
{
    const struct pair_law *law = pass->m->laws;
    const double *r = pass->p->r, cutoff2 = law->cutoff2, rm2 = law->rm2;
    const double strength = law->strength * pass->m->fixed.far_force; /* the scale is a power of two: exact */
    int64_t *sum = pass->p->far_sum;
    const simd_real zero = {0.0};
    simd_real least = zero + INFINITY;
    struct far_lanes next;
    if (list->n > 0)
        find_geometry(list->quad, r, rm2, pass, periodic, &next);
    for (size_t k = 0; k < list->n; k++) {
        const struct far_quad *quad = &list->quad[k];
        struct far_lanes now = next;
        find_geometry(quad + 1, r, rm2, pass, periodic, &next);
        least = SIMD_CHOOSE(now.r2 < least, now.r2, least);
        simd_real w3 = now.w * now.w * now.w;
        simd_real fs = strength * now.w * w3 * (w3 - 1.0);
        fs = SIMD_CHOOSE(now.r2 <= cutoff2, fs, zero);
        simd_int qx = SIMD_FIXED(fs * now.dx);
        simd_int qy = SIMD_FIXED(fs * now.dy);
        union simd_int_halves even = {.all = SIMD_EVEN(qx, qy)}, odd = {.all = SIMD_ODD(qx, qy)};
        union simd_int_halves both = {.all = even.all + odd.all};
        FORCE(quad->j[0]) -= even.half[0];
        FORCE(quad->j[1]) -= odd.half[0];
        FORCE(quad->j[2]) -= even.half[1];
        FORCE(quad->j[3]) -= odd.half[1];
        FORCE(quad->i) += both.half[0] + both.half[1];
    }
    double of_all = least[0];
    for (int lane = 1; lane < SIMD_LANES; lane++)
        of_all = least[lane] < of_all ? least[lane] : of_all;
    return of_all;
}

DM2_WIDE static double add_forces_free(const struct pass *pass, const struct inner_list *list)
{
    return add_forces(pass, list, false);
}

DM2_WIDE static double add_forces_periodic(const struct pass *pass, const struct inner_list *list)
{
    return add_forces(pass, list, true);
}

/* The measures of the plain loop, four pairs at a time: virial and energy, no forces. Returns the largest
 * magnitude that became an integer: from far_range on, the integers are meaningless. */
DM2_INLINE double measure_quads(struct pass *pass, const struct inner_list *list, bool periodic)
{
    const struct model *m = pass->m;
    const struct particles *p = pass->p;
    const struct pair_law *law = m->laws;
    const double scale = m->fixed.virial, depth = law->eps12 * (1.0 / 12.0);
    const simd_real zero = {0.0};
    const simd_int none = {0};
    simd_int *virial = (simd_int *)(void *)p->virial;
    simd_real largest = zero;
    int64_t energy = 0;
    for (size_t k = 0; k < list->n; k++) {
        const struct far_quad *quad = &list->quad[k];
        struct far_lanes at;
        find_geometry(quad, p->r, law->rm2, pass, periodic, &at);
        simd_int within = at.r2 <= law->cutoff2;
        simd_real w3 = at.w * at.w * at.w, f = law->strength * at.w * w3 * (w3 - 1.0);
        simd_real fx = f * at.dx, fy = f * at.dy;
        simd_real xx = SIMD_CHOOSE(within, at.dx * fx * scale, zero),
                  yy = SIMD_CHOOSE(within, at.dy * fy * scale, zero);
        simd_real xy = SIMD_CHOOSE(within, 0.5 * (at.dx * fy + at.dy * fx) * scale, zero);
        simd_real u =
            SIMD_CHOOSE(within, (depth * (w3 * w3 - 2.0 * w3) - law->u_cut) * m->fixed.energy, zero);
        simd_real size = SIMD_MAGNITUDE(xx) + SIMD_MAGNITUDE(yy) + SIMD_MAGNITUDE(xy) + SIMD_MAGNITUDE(u);
        largest = SIMD_CHOOSE(size > largest, size, largest);
        simd_int qxx = SIMD_FIXED(xx), qyy = SIMD_FIXED(yy), qxy = SIMD_FIXED(xy), qu = SIMD_FIXED(u);
        /* transposed: the sums of each pair */
        simd_int a = SIMD_EVEN(qxx, qyy), b = SIMD_ODD(qxx, qyy), c = SIMD_EVEN(qxy, none),
                 d = SIMD_ODD(qxy, none);
        simd_int part[SIMD_LANES] = {SIMD_LOW(a, c), SIMD_LOW(b, d), SIMD_HIGH(a, c), SIMD_HIGH(b, d)};
        for (int lane = 0; lane < SIMD_LANES; lane++) {
            size_t j = quad->j[lane] / 2;
            virial[j] += part[lane];
            if (j < p->n_own || (j < p->n && counts_here(p, quad->i / 2, (uint32_t)j)))
                energy += qu[lane];
        }
        virial[quad->i / 2] += (part[0] + part[1]) + (part[2] + part[3]);
        if (k % 256 == 255 || k + 1 == list->n) { /* 1024 energies below 2^50 */
            exact_add_units(&pass->potential, energy, m->fixed.energy_left);
            energy = 0;
        }
    }
    double most = 0.0;
    for (int c = 0; c < SIMD_LANES; c++)
        most = largest[c] > most ? largest[c] : most;
    return most;
}

DM2_WIDE static double measure_free(struct pass *pass, const struct inner_list *list)
{
    return measure_quads(pass, list, false);
}

DM2_WIDE static double measure_periodic(struct pass *pass, const struct inner_list *list)
{
    return measure_quads(pass, list, true);
}

/* Adds virial and energy of all pairs. False: a number left the range of lanes, and both sums are
 * meaningless. */
static bool measure_wide(struct pass *pass, const struct inner_list *list)
{
    bool periodic = pass->m->grid.periodic[0] || pass->m->grid.periodic[1];
    return (periodic ? measure_periodic(pass, list) : measure_free(pass, list)) < far_range;
}

/* One kind of element and one plain Lennard-Jones law. */
static void evaluate_quads(struct pass *pass, struct lists *lists)
{
    const struct model *m = pass->m;
    struct inner_list *inner = &lists->inner[pass->part];
    uint32_t first, last;
    lists_rows(lists, pass->p, pass->part, &first, &last);
    const struct inner_part part = {first, last, pass->part == PART_INSIDE ? pass->p->n_own : pass->p->n};
    if (inner_list_prepare(inner, &lists->far, &part, pass->p, m->far_cutoff, m->config->delta_r,
                           &pass->period) != 0) {
        pass->no_memory = true;
        return;
    }
    pulse_beat(&m->pulse);
    if (pass->totals != NULL && !measure_wide(pass, inner)) {
        pass->far_plain = true;
        return;
    }
    bool periodic = m->grid.periodic[0] || m->grid.periodic[1];
    double least = periodic ? add_forces_periodic(pass, inner) : add_forces_free(pass, inner);
    if (least < m->laws->r2_least)
        evaluate_rows(pass, lists, true, false); /* finds the pair; the run ends */
}

void far_evaluate(struct pass *pass, struct lists *lists)
{
    const struct model *m = pass->m;
    bool measure = pass->totals != NULL;
    pulse_beat(&m->pulse);
    if (m->wide_far && !pass->plain && !pass->far_plain)
        evaluate_quads(pass, lists);
    else if (m->uniform_far && measure)
        evaluate_rows(pass, lists, true, true);
    else if (m->uniform_far)
        evaluate_rows(pass, lists, true, false);
    else if (measure)
        evaluate_rows(pass, lists, false, true);
    else
        evaluate_rows(pass, lists, false, false);
}
