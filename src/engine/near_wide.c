/* Links four at a time: pair_interact of law.h in the lanes of a vector, for most pairs of a solid at most
 * steps: a Morse bond that does not break, with damping, yield in tension, shear spring and plastic slip,
 * viscosity, conduction. Every lane does the operations of the plain path in the same order, so both give the
 * same bits; a pair that needs more (it breaks, closes a void, leaves the range) takes the plain path.
 *
 * The operations on a pair depend on each other for some hundreds of cycles, and a processor looks ahead no
 * further than about one quad. So a block of quads goes through three short stages, one after the other:
 * within a stage no quad waits for the quad before it.
 *
 * Doubles become integers by SIMD_FIXED, which rounds as llrint does, so the range here is 2^50. */
#include <math.h>

#include "dm2/base/simd.h"
#include "pair_forces.h"
#include "pair_pass.h"

enum { BLOCK = 8 }; /* quads that go through the stages together */

/* The state of one quad between the three stages. */
struct lanes {
    simd_real dx, dy;                  /* from j to i, cm; for measuring */
    simd_real r, over, nx, ny, vn, vt; /* struct pair_view, and n */
    simd_real x, e, f;                 /* bond length, exp(-alpha (x - r0)), central force */
};

#define OF_I(array)   ((simd_real){(array)[q->i[0]], (array)[q->i[1]], (array)[q->i[2]], (array)[q->i[3]]})
#define OF_J(array)   ((simd_real){(array)[q->j[0]], (array)[q->j[1]], (array)[q->j[2]], (array)[q->j[3]]})
#define OF_K(array)   ((simd_real){(array)[q->k[0]], (array)[q->k[1]], (array)[q->k[2]], (array)[q->k[3]]})
#define WEAKER(a, b)  SIMD_CHOOSE(((a) < (b)) | ((b) != (b)), a, b) /* law_weaker */
#define KEPT(x, left) ((simd_real)((simd_int)(x) & ~(left)))        /* 0 in the lanes left */

/* Transposes four rows of four integers: component c of row q becomes component q of row c. */
DM2_INLINE void transpose(const simd_int in[4], simd_int out[4])
{
    simd_int a = SIMD_EVEN(in[0], in[1]), b = SIMD_ODD(in[0], in[1]); /* x0 y0 x2 y2, x1 y1 x3 y3 */
    simd_int c = SIMD_EVEN(in[2], in[3]), d = SIMD_ODD(in[2], in[3]);
    out[0] = SIMD_LOW(a, c);
    out[1] = SIMD_LOW(b, d);
    out[2] = SIMD_HIGH(a, c);
    out[3] = SIMD_HIGH(b, d);
}

/* Adds to the sums of both elements of each pair: `force` to i and its opposite to j, the second four sums
 * apart for i and j. */
DM2_INLINE void scatter_sums(const struct link_quad *q, int64_t *pair_sum, const simd_int force[4],
                             const simd_int other_i[4], const simd_int other_j[4])
{
    simd_int *sums = (simd_int *)(void *)pair_sum; /* cache lines: aligned */
    simd_int f[4], oi[4], oj[4];
    transpose(force, f);
    transpose(other_i, oi);
    transpose(other_j, oj);
    for (int c = 0; c < SIMD_LANES; c++) {
        simd_int *i = sums + 2 * (size_t)q->i[c], *j = sums + 2 * (size_t)q->j[c];
        i[0] += f[c];
        i[1] += oi[c];
        j[0] -= f[c];
        j[1] += oj[c];
    }
}

/* e^x of each lane, the operations of real_exp; |x| <= 700. */
DM2_INLINE void exp_lanes(const simd_real *in, simd_real *out)
{
    simd_real x = *in, shifted = x * 0x1.71547652b82fep0 + simd_shifter, kd = shifted - simd_shifter;
    simd_real z = (x - kd * 0x1.62e42fefa0000p-1) - kd * 0x1.cf79abc9e3b3ap-40;
    simd_real z2 = z * z, z4 = z2 * z2;
    simd_real p01 = 1.0 + z, p23 = 0.5 + z * 0x1.5555555555555p-3;
    simd_real p45 = 0x1.5555555555555p-5 + z * 0x1.1111111111111p-7;
    simd_real p67 = 0x1.6c16c16c16c17p-10 + z * 0x1.a01a01a01a01ap-13;
    simd_real p89 = 0x1.a01a01a01a01ap-16 + z * 0x1.71de3a556c734p-19;
    simd_real pab = 0x1.27e4fb7789f5cp-22 + z * 0x1.ae64567f544e4p-26;
    simd_real pcd = 0x1.1eed8eff8d898p-29 + z * 0x1.6124613a86d09p-33;
    simd_real low = p01 + z2 * p23, mid = p45 + z2 * p67, high = p89 + z2 * pab;
    simd_int scale = ((simd_int)shifted + 1023) << 52; /* the low bits of `shifted` are k */
    *out = ((low + z4 * mid) + (z4 * z4) * (high + z4 * pcd)) * (simd_real)scale;
}

/* log x of each lane, the operations of real_log; 1/2 <= x <= 1. */
DM2_INLINE void log_lanes(const simd_real *in, simd_real *out)
{
    const simd_real zero = {0.0};
    const simd_int low = *in < 0x1.6a09e667f3bcdp-1;
    simd_real m = SIMD_CHOOSE(low, 2.0 * *in, *in), power = SIMD_CHOOSE(low, zero - 1.0, zero);
    simd_real s = (m - 1.0) / (m + 1.0), q = s * s, sum = zero;
    for (int k = 21; k >= 3; k -= 2)
        sum = (sum + 1.0 / k) * q;
    *out = power * 0x1.62e42fefa0000p-1 + ((2.0 * s + 2.0 * s * sum) + power * 0x1.cf79abc9e3b3ap-40);
}

/* Is any lane, or are all lanes, of a comparison set? */
DM2_INLINE bool any_lane(const simd_int *mask)
{
    return ((*mask)[0] | (*mask)[1] | (*mask)[2] | (*mask)[3]) != 0;
}

DM2_INLINE bool all_lanes(const simd_int *mask)
{
    return ((*mask)[0] & (*mask)[1] & (*mask)[2] & (*mask)[3]) != 0;
}

/* Components 0 and 1 of an array of two-vectors: i less j, in lanes. */
DM2_INLINE void gather_differences(const double *array, const struct link_quad *q, simd_real *x, simd_real *y)
{
    const simd_real2 *a = (const simd_real2 *)(const void *)array;
    simd_real2 d0 = a[q->i[0]] - a[q->j[0]], d1 = a[q->i[1]] - a[q->j[1]];
    simd_real2 d2 = a[q->i[2]] - a[q->j[2]], d3 = a[q->i[3]] - a[q->j[3]];
    simd_real even = SIMD_JOIN(d0, d2), odd = SIMD_JOIN(d1, d3);
    *x = SIMD_EVEN(even, odd);
    *y = SIMD_ODD(even, odd);
}

/* Stage 1: distance, directions and relative velocity. Meanwhile the processor fetches the sums of j, most of
 * which were last used a step ago. */
DM2_INLINE void find_geometry(const struct pass *pass, const struct link_quad *q, bool periodic,
                              struct lanes *out)
{
    simd_real dx, dy, dvx, dvy;
    for (int c = 0; c < SIMD_LANES; c++)
        __builtin_prefetch(pass->p->pair_sum + SUM_COUNT * (size_t)q->j[c], 1);
    gather_differences(pass->p->r, q, &dx, &dy);
    if (periodic) {
        lanes_nearest(&dx, pass->period.size[0], pass->period.half[0]);
        lanes_nearest(&dy, pass->period.size[1], pass->period.half[1]);
    }
    gather_differences(pass->p->v, q, &dvx, &dvy);
    simd_real r2 = dx * dx + dy * dy;
    out->dx = dx;
    out->dy = dy;
    out->r = (simd_real){sqrt(r2[0]), sqrt(r2[1]), sqrt(r2[2]), sqrt(r2[3])};
    out->over = 1.0 / out->r;
    out->nx = dx * out->over;
    out->ny = dy * out->over;
    out->vn = dvx * out->nx + dvy * out->ny;
    out->vt = dvy * out->nx - dvx * out->ny;
}

/* Stage 2: the Morse force. Beyond the range of exp_lanes at->e is meaningless; find_left recognizes this by
 * at->x. */
DM2_INLINE void find_central(const struct pair_law *law, const struct lists *l, const struct link_quad *q,
                             struct lanes *at)
{
    at->x = at->r - OF_K(l->stretch);
    simd_real power = law->shape - law->bond.alpha * at->x;
    exp_lanes(&power, &at->e);
    at->f = law->bond.force * (at->e * at->e - at->e);
}

/* struct pair_effect (law.h) of four pairs. */
struct effects {
    simd_real fn, ft, fdn, fdt, arm_i, arm_j;
    simd_real heat, heat_damped, exchange, elastic;
};

/* The measures of four links, in fixed point. */
struct tally {
    simd_int virial[VIRIAL_COUNT], around[AROUND_COUNT], potential, elastic, magnitude, fabric[2];
};

/* The numbers of measure_pair in force.c. Lanes in which a number leaves the range are added to *left. */
DM2_INLINE void measure_lanes(const struct pass *pass, const struct bond *bond, const struct lanes *at,
                              const struct effects *e, struct tally *out, simd_int *left)
{
    const struct fixed_scales *scale = &pass->m->fixed;
    const simd_int link = {TALLY_LINK, TALLY_LINK, TALLY_LINK, TALLY_LINK}, one = link / TALLY_LINK;
    simd_real dx = at->dx, dy = at->dy, f2 = e->fn * e->fn + e->ft * e->ft;
    simd_int touching = at->r <= bond->touch;
    simd_real magnitude = (simd_real){sqrt(f2[0]), sqrt(f2[1]), sqrt(f2[2]), sqrt(f2[3])} * scale->force;
    simd_real fx = e->fn * at->nx - e->ft * at->ny, fy = e->fn * at->ny + e->ft * at->nx;
    simd_real xx = dx * fx * scale->virial, yy = dy * fy * scale->virial;
    simd_real xy = 0.5 * (dx * fy + dy * fx) * scale->virial;
    simd_real potential = bond->energy * ((1.0 - at->e) * (1.0 - at->e)) * scale->energy;
    simd_real elastic = e->elastic * scale->energy;
    simd_real largest = SIMD_MAGNITUDE(xx) + SIMD_MAGNITUDE(yy) + SIMD_MAGNITUDE(xy) +
                        SIMD_MAGNITUDE(potential) + SIMD_MAGNITUDE(elastic);
    *left |= ~(largest < 0x1p50);
    dx = KEPT(dx, *left);
    dy = KEPT(dy, *left);
    out->virial[VIRIAL_XX] = SIMD_FIXED(KEPT(xx, *left));
    out->virial[VIRIAL_YY] = SIMD_FIXED(KEPT(yy, *left));
    out->virial[VIRIAL_XY] = SIMD_FIXED(KEPT(xy, *left));
    out->around[AROUND_XX] = SIMD_FIXED(dx * dx * scale->around);
    out->around[AROUND_YY] = SIMD_FIXED(dy * dy * scale->around);
    out->around[AROUND_XY] = SIMD_FIXED(dx * dy * scale->around);
    out->virial[VIRIAL_TALLY] = one * TALLY_PAIR + link + (one * TALLY_CONTACT & touching);
    out->potential = SIMD_FIXED(KEPT(potential, *left));
    out->elastic = SIMD_FIXED(KEPT(elastic, *left));
    out->magnitude = SIMD_FIXED(KEPT(magnitude, *left));
    out->fabric[0] = SIMD_FIXED(KEPT(at->nx * at->nx * FABRIC_SCALE, *left)) & touching;
    out->fabric[1] = SIMD_FIXED(KEPT(at->nx * at->ny * FABRIC_SCALE, *left)) & touching;
}

/* Adds the tally of each lane not in *left to its two elements, and its energies where counts_here. */
DM2_INLINE void add_tally(struct pass *pass, const struct link_quad *q, const struct tally *t,
                          const simd_int *left)
{
    struct particles *p = pass->p;
    simd_int *sums = (simd_int *)(void *)p->virial, virial[4];
    struct pair_totals *totals = pass->totals;
    int64_t potential = 0, elastic = 0, magnitude = 0, fabric[2] = {0, 0};
    transpose(t->virial, virial);
    for (int c = 0; c < SIMD_LANES; c++) {
        if ((*left)[c])
            continue;
        int64_t *i = p->around + AROUND_COUNT * (size_t)q->i[c],
                *j = p->around + AROUND_COUNT * (size_t)q->j[c];
        sums[q->i[c]] += virial[c];
        sums[q->j[c]] += virial[c];
        for (int a = 0; a < AROUND_COUNT; a++) {
            i[a] += t->around[a][c];
            j[a] += t->around[a][c];
        }
        if (!counts_here(p, q->i[c], q->j[c]))
            continue;
        potential += t->potential[c];
        elastic += t->elastic[c];
        fabric[0] += t->fabric[0][c];
        fabric[1] += t->fabric[1][c];
        totals->links++;
        totals->pairs++;
        totals->contacts += (uint64_t)(t->virial[VIRIAL_TALLY][c] / TALLY_CONTACT);
        if (has_free_element(p, q->i[c], q->j[c])) {
            totals->loaded_pairs++;
            magnitude += t->magnitude[c];
        }
    }
    exact_add_units(&pass->potential, potential, pass->m->fixed.energy_left);
    exact_add_units(&pass->elastic, elastic, pass->m->fixed.energy_left);
    exact_add_units(&totals->magnitudes, magnitude, pass->m->fixed.energy_left);
    exact_add_units(&totals->fabric[0], fabric[0], 0);
    exact_add_units(&totals->fabric[1], fabric[1], 0);
}

/* Yield in tension, in the lanes *pulled: the residual stretch at which the bond holds its strength `cap`,
 * the heat of the yield, and the bond with this stretch. A lane in which the attraction never reaches the cap
 * is added to *left. */
DM2_INLINE void yield_lanes(const struct pass *pass, const struct pair_law *law, const simd_real *cap,
                            const simd_int *pulled, struct lanes *at, simd_real *stretch, simd_real *heat,
                            simd_int *left)
{
    const struct bond *bond = &law->bond;
    simd_real q = *cap * law->shape / (law->k * bond->r0), root = 1.0 - 4.0 * q, log, e;
    *left |= *pulled & ~(q < 0.25);
    root = (simd_real){sqrt(root[0]), sqrt(root[1]), sqrt(root[2]), sqrt(root[3])};
    root = 0.5 * (1.0 + root);
    log_lanes(&root, &log);
    simd_real held = at->r - (bond->r0 - log * bond->r0 / law->shape), f;
    simd_real x = at->r - held, power = law->shape - bond->alpha * x;
    exp_lanes(&power, &e);
    f = bond->force * (e * e - e);
    simd_real before = bond->energy * ((1.0 - at->e) * (1.0 - at->e)),
              after = bond->energy * ((1.0 - e) * (1.0 - e));
    *heat = KEPT((before - after) + (at->f - f) * (at->vn * (0.5 * pass->dt_path)), ~*pulled); /* law_freed */
    *stretch = SIMD_CHOOSE(*pulled, held, *stretch);
    at->x = SIMD_CHOOSE(*pulled, x, at->x);
    at->e = SIMD_CHOOSE(*pulled, e, at->e);
    at->f = SIMD_CHOOSE(*pulled, f, at->f);
}

static inline bool all_linked(const struct lists *l, const struct link_quad *q)
{
    return l->linked[q->k[0]] & l->linked[q->k[1]] & l->linked[q->k[2]] & l->linked[q->k[3]];
}

/* The strength in tension and the cap of the shear spring of each lane's link, Mbar cm2. */
DM2_INLINE void strength_lanes(const struct pair_law *law, const struct particles *p,
                               const struct link_quad *q, simd_real *tension, simd_real *shear)
{
    simd_real soft_i = OF_I(p->soft), soft_j = OF_J(p->soft);
    simd_real pull_i = law->tensile_i * soft_i, pull_j = law->tensile_j * soft_j;
    simd_real slip_i = law->yield_i * soft_i, slip_j = law->yield_j * soft_j;
    *tension = WEAKER(pull_i, pull_j) * law->bond.area;
    *shear = WEAKER(slip_i, slip_j) * law->bond.area;
}

/* The lanes whose pairs take the plain path: unlinked, breaking, beyond the strongest attraction, closing a
 * void, or out of the range of exp_lanes. */
DM2_INLINE void find_left(const struct pair_law *law, const struct lists *l, const struct link_quad *q,
                          const struct lanes *at, const simd_real *stretch, const simd_real *tension,
                          simd_int *left)
{
    simd_real power = law->shape - law->bond.alpha * at->x;
    *left = (at->r > law->bond.breaks) | (at->x > law->bond.peak) | ((*stretch > 0.0) & (at->f > *tension)) |
            ~((SIMD_MAGNITUDE(power) < 700.0) & (at->r > 0.0));
    if (!all_linked(l, q)) {
        for (int c = 0; c < SIMD_LANES; c++)
            (*left)[c] |= l->linked[q->k[c]] ? 0 : -1;
    }
}

/* fn and fdn: law_damping for links. */
DM2_INLINE void damping_lanes(const struct pair_law *law, const struct particles *p,
                              const struct link_quad *q, const struct lanes *at, struct effects *e)
{
    const simd_real zero = {0.0};
    simd_real cn = zero + law->cn_mass;
    if (law->a_p != 0.0 || law->a_t != 0.0) {
        simd_real pressure = zero; /* a deck without a_p keeps none */
        if (p->p != NULL)
            pressure = 0.5 * (OF_I(p->p) + OF_J(p->p));
        simd_real change = 1.0 + law->a_p * pressure +
                           law->a_t * (0.5 * (OF_I(p->temperature) + OF_J(p->temperature)) - law->t0_mean);
        cn = cn * SIMD_CHOOSE(change > 0.0, change, zero);
    }
    e->fdn = -cn * at->vn;
    e->fn = at->f + e->fdn;
}

/* law_tangential for links; `yields`: the spring slips at the cap `shear`. *spring: before the step, then
 * after. */
DM2_INLINE void tangential_lanes(const struct pass *pass, const struct pair_law *law,
                                 const struct link_quad *q, const struct lanes *at, bool yields,
                                 const simd_real *shear, simd_real *spring, struct effects *e)
{
    const struct particles *p = pass->p;
    const simd_real zero = {0.0};
    simd_real share = at->r * law->bond.over_r0, before = *spring, ct = zero + law->ct_mass;
    e->arm_i = share * law->radius_i;
    e->arm_j = share * law->radius_j;
    simd_real vt = at->vt - (OF_I(p->w) * e->arm_i + OF_J(p->w) * e->arm_j);
    simd_real after = before + vt * pass->dt_path;
    if (yields) {
        const simd_int sign = {INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN};
        simd_int slips = law->kt_link * SIMD_MAGNITUDE(after) > *shear;
        simd_real held = *shear / law->kt_link;
        held = (simd_real)(((simd_int)held & ~sign) | ((simd_int)after & sign));
        e->heat = e->heat + SIMD_CHOOSE(slips, law->kt_link * (0.5 * (before + held)) * (after - held), zero);
        after = SIMD_CHOOSE(slips, held, after);
    }
    simd_real fs = -law->kt_link * after;
    e->fdt = -ct * vt;
    e->ft = fs + e->fdt;
    e->heat_damped = e->heat_damped - e->fdt * vt * pass->dt_kick;
    *spring = after;
}

/* Sets the effects of the lanes *left to 0. */
DM2_INLINE void clear_left(const simd_int *left, struct lanes *at, struct effects *e)
{
    at->nx = KEPT(at->nx, *left), at->ny = KEPT(at->ny, *left);
    e->fn = KEPT(e->fn, *left), e->ft = KEPT(e->ft, *left);
    e->fdn = KEPT(e->fdn, *left), e->fdt = KEPT(e->fdt, *left);
    e->arm_i = KEPT(e->arm_i, *left), e->arm_j = KEPT(e->arm_j, *left);
    e->heat = KEPT(e->heat, *left), e->heat_damped = KEPT(e->heat_damped, *left);
    e->exchange = KEPT(e->exchange, *left);
}

/* Adds the effects to the sums of both elements of each pair. */
DM2_INLINE void add_lanes(const struct pass *pass, const struct link_quad *q, const struct lanes *at,
                          const struct effects *e)
{
    const struct fixed_scales *scale = &pass->m->fixed;
    simd_real sx = at->nx * scale->force, sy = at->ny * scale->force;
    simd_int force[4] = {SIMD_FIXED(e->fn * sx - e->ft * sy), SIMD_FIXED(e->fn * sy + e->ft * sx),
                         SIMD_FIXED(e->fdn * sx - e->fdt * sy), SIMD_FIXED(e->fdn * sy + e->fdt * sx)};
    simd_int freed = SIMD_FIXED(0.5 * e->heat * scale->heat),
             damped = SIMD_FIXED(0.5 * e->heat_damped * scale->heat);
    simd_int gained = SIMD_FIXED(e->exchange * scale->heat);
    simd_real tt = e->ft * scale->torque, tdt = e->fdt * scale->torque;
    simd_int other_i[4] = {-SIMD_FIXED(e->arm_i * tt), -SIMD_FIXED(e->arm_i * tdt), freed, damped + gained};
    simd_int other_j[4] = {-SIMD_FIXED(e->arm_j * tt), -SIMD_FIXED(e->arm_j * tdt), freed, damped - gained};
    scatter_sums(q, pass->p->pair_sum, force, other_i, other_j);
}

/* Keeps the forces of the lanes that are not left, for a snapshot. */
static void note_forces(const struct pass *pass, struct lists *l, const struct link_quad *q,
                        const struct lanes *at, const struct effects *e, const simd_int *left)
{
    for (int c = 0; c < SIMD_LANES; c++)
        if (!(*left)[c])
            pair_forces_note(l, q->k[c], pass->m->fixed.force, at->nx[c], at->ny[c], e->fn[c], e->ft[c]);
}

/* Has either side of the law a finite strength? */
static inline bool may_yield(const struct pair_law *law)
{
    return law->tensile_i < INFINITY || law->tensile_j < INFINITY || law->yield_i < INFINITY ||
           law->yield_j < INFINITY;
}

/* Stage 3: the law from status to conduction, and the sums. *left: the lanes whose pairs must take the plain
 * path; their sums and memory are unchanged. */
DM2_INLINE void interact(struct pass *pass, struct lists *l, const struct pair_law *law,
                         const struct link_quad *q, struct lanes *at, bool spin, bool measure, simd_int *left)
{
    const struct fixed_scales *scale = &pass->m->fixed;
    const struct particles *p = pass->p;
    const simd_real zero = {0.0};
    const bool yields = may_yield(law), tangential = spin && law->tangential;
    simd_real stretch = OF_K(l->stretch), tension = zero + INFINITY, shear = tension;
    simd_real before = zero, spring = zero;
    struct effects e = {.fn = zero};
    if (yields)
        strength_lanes(law, p, q, &tension, &shear);
    find_left(law, l, q, at, &stretch, &tension, left);
    simd_int pulled = (at->f < -tension) & ~*left;
    if (yields && any_lane(&pulled))
        yield_lanes(pass, law, &tension, &pulled, at, &stretch, &e.heat, left);
    damping_lanes(law, p, q, at, &e);
    if (tangential) {
        before = spring = OF_K(l->spring);
        tangential_lanes(pass, law, q, at, yields, &shear, &spring, &e);
    }
    e.heat_damped = e.heat_damped - e.fdn * at->vn * pass->dt_kick;
    if (law->conduction > 0.0)
        e.exchange = law->conduction * (law->bond.area * at->over) *
                     (OF_J(p->temperature) - OF_I(p->temperature)) * pass->dt_kick;

    simd_real largest =
        (SIMD_MAGNITUDE(e.fn) + SIMD_MAGNITUDE(e.fdn)) + (SIMD_MAGNITUDE(e.ft) + SIMD_MAGNITUDE(e.fdt));
    simd_real heat = SIMD_MAGNITUDE(e.heat) + SIMD_MAGNITUDE(e.heat_damped) + SIMD_MAGNITUDE(e.exchange);
    *left |= ~((largest * scale->force < 0x1p50) & (heat * scale->heat < 0x1p50));
    struct tally tally;
    if (measure) {
        e.elastic = 0.5 * law->kt_link * (spring * spring);
        measure_lanes(pass, &law->bond, at, &e, &tally, left);
    }
    const bool some = any_lane(left);
    if (some && all_lanes(left))
        return;
    if (measure)
        add_tally(pass, q, &tally, left);
    if (some) {
        clear_left(left, at, &e);
        spring = SIMD_CHOOSE(*left, before, spring);
    }
    add_lanes(pass, q, at, &e);
    if (measure && l->forces != NULL)
        note_forces(pass, l, q, at, &e, left);
    for (int c = 0; tangential && c < SIMD_LANES; c++)
        l->spring[q->k[c]] = spring[c];
    pulled = pulled & ~*left;
    if (yields && any_lane(&pulled)) {
        for (int c = 0; c < SIMD_LANES; c++)
            if (pulled[c])
                l->stretch[q->k[c]] = stretch[c];
    }
}

/* All quads of the part; compiled apart for each combination of the flags. */
DM2_INLINE void interact_groups(struct pass *pass, struct lists *l, bool spin, bool periodic, bool measure,
                                take_single *single)
{
    const struct link_list *links = &l->links[pass->part];
    for (size_t g = 0; g < links->n_groups; g++) {
        const struct link_group *group = &links->group[g];
        for (size_t done = 0; done < group->n; done += BLOCK) {
            const struct link_quad *q = links->quad + group->first + done;
            size_t n = group->n - done < BLOCK ? group->n - done : BLOCK;
            struct lanes at[BLOCK];
            for (size_t b = 0; b < n; b++)
                find_geometry(pass, &q[b], periodic, &at[b]);
            for (size_t b = 0; b < n; b++)
                find_central(group->law, l, &q[b], &at[b]);
            for (size_t b = 0; b < n; b++) {
                simd_int left;
                interact(pass, l, group->law, &q[b], &at[b], spin, measure, &left);
                if (!any_lane(&left))
                    continue;
                for (int c = 0; c < SIMD_LANES; c++) {
                    if (left[c])
                        single(pass, l, q[b].i[c], q[b].k[c]);
                }
            }
        }
    }
}

DM2_WIDE static void interact_spinning(struct pass *pass, struct lists *l, take_single *single)
{
    interact_groups(pass, l, true, false, false, single);
}

DM2_WIDE static void interact_spinning_periodic(struct pass *pass, struct lists *l, take_single *single)
{
    interact_groups(pass, l, true, true, false, single);
}

DM2_WIDE static void interact_central(struct pass *pass, struct lists *l, take_single *single)
{
    interact_groups(pass, l, false, false, false, single);
}

DM2_WIDE static void interact_central_periodic(struct pass *pass, struct lists *l, take_single *single)
{
    interact_groups(pass, l, false, true, false, single);
}

DM2_WIDE static void interact_measured(struct pass *pass, struct lists *l, take_single *single)
{
    interact_groups(pass, l, true, false, true, single);
}

DM2_WIDE static void interact_measured_periodic(struct pass *pass, struct lists *l, take_single *single)
{
    interact_groups(pass, l, true, true, true, single);
}

void near_wide(struct pass *pass, struct lists *lists, take_single *single)
{
    const struct model *m = pass->m;
    bool periodic = m->grid.periodic[0] || m->grid.periodic[1];
    if (pass->totals != NULL && periodic)
        interact_measured_periodic(pass, lists, single);
    else if (pass->totals != NULL)
        interact_measured(pass, lists, single);
    else if (m->has_spin && periodic)
        interact_spinning_periodic(pass, lists, single);
    else if (m->has_spin)
        interact_spinning(pass, lists, single);
    else if (periodic)
        interact_central_periodic(pass, lists, single);
    else
        interact_central(pass, lists, single);
}
