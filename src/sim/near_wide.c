/* Linked pairs four at a time: pair_interact of law.h in the lanes of a vector, for what most pairs of a solid do at most
 * steps: a Morse bond that neither breaks nor yields in tension, with constant damping, shear spring and plastic slip,
 * viscosity, conduction. Every lane does the operations of the plain path in the same order, so the bits do not tell which
 * ran; where one of four needs more (it breaks, yields, closes a void, leaves the range), all four take the plain path.
 *
 * Doubles become integers by adding 1.5 * 2^52 (see far.c), which rounds as llrint does, so here the range is 2^50. */
#include <math.h>

#include "dm2/base/simd.h"
#include "dm2/sim/pair_pass.h"

static const double shifter = 0x1.8p52;

/* Four entries of the near list that wait for each other. */
struct batch {
    uint32_t i[SIMD_LANES], j[SIMD_LANES], k[SIMD_LANES];
    const struct pair_law *law[SIMD_LANES];
    int n;
};

#define LAW(field) ((simd_real){b->law[0]->field, b->law[1]->field, b->law[2]->field, b->law[3]->field})
#define OF_I(array) ((simd_real){(array)[b->i[0]], (array)[b->i[1]], (array)[b->i[2]], (array)[b->i[3]]})
#define OF_J(array) ((simd_real){(array)[b->j[0]], (array)[b->j[1]], (array)[b->j[2]], (array)[b->j[3]]})
#define OF_K(array) ((simd_real){(array)[b->k[0]], (array)[b->k[1]], (array)[b->k[2]], (array)[b->k[3]]})
#define LESSER(a, b) SIMD_CHOOSE((a) < (b), a, b)
#define FIXED(x) ((simd_int)((x) + shifter) - (simd_int)(zero + shifter))
#define MAGNITUDE(x) ((simd_real)((simd_int)(x) & (simd_int){INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX}))

/* Four rows of four integers, transposed: component c of lane q becomes component q of lane c. */
DM2_INLINE void transpose(const simd_int in[4], simd_int out[4])
{
    simd_int a = SIMD_EVEN(in[0], in[1]), b = SIMD_ODD(in[0], in[1]); /* x0 y0 x2 y2, x1 y1 x3 y3 */
    simd_int c = SIMD_EVEN(in[2], in[3]), d = SIMD_ODD(in[2], in[3]);
    out[0] = SIMD_LOW(a, c);
    out[1] = SIMD_LOW(b, d);
    out[2] = SIMD_HIGH(a, c);
    out[3] = SIMD_HIGH(b, d);
}

/* Adds the effects to the sums of both elements of each pair. far: what differs in the second four sums of j. */
DM2_INLINE void scatter(const struct batch *b, int64_t *pair_sum, const simd_int force[4], const simd_int other_i[4],
                        const simd_int other_j[4])
{
    simd_int *sums = (simd_int *)(void *)pair_sum; /* cache lines: aligned */
    simd_int f[4], oi[4], oj[4];
    transpose(force, f);
    transpose(other_i, oi);
    transpose(other_j, oj);
    for (int q = 0; q < SIMD_LANES; q++) {
        simd_int *i = sums + 2 * (size_t)b->i[q], *j = sums + 2 * (size_t)b->j[q];
        i[0] += f[q];
        i[1] += oi[q];
        j[0] -= f[q];
        j[1] += oj[q];
    }
}

/* e^x of each lane, the operations of real_exp; |x| <= 700. */
DM2_INLINE void exp_lanes(const simd_real *in, simd_real *out)
{
    simd_real x = *in, shifted = x * 0x1.71547652b82fep0 + shifter, kd = shifted - shifter;
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

/* Is any lane set? */
DM2_INLINE bool any(const simd_int *mask)
{
    return ((*mask)[0] | (*mask)[1] | (*mask)[2] | (*mask)[3]) != 0;
}

/* True when all four pairs were evaluated; false, and nothing changed, when the plain path must. */
DM2_INLINE bool batch_interact(const struct pass *pass, struct lists *l, const struct batch *b, bool spin)
{
    const struct fixed_scales *scale = &pass->m->fixed;
    const struct particles *p = pass->p;
    const simd_real zero = {0.0};
    const simd_real2 *r2d = (const simd_real2 *)(const void *)p->r, *v2d = (const simd_real2 *)(const void *)p->v;
    simd_real2 d0 = r2d[b->i[0]] - r2d[b->j[0]], d1 = r2d[b->i[1]] - r2d[b->j[1]];
    simd_real2 d2 = r2d[b->i[2]] - r2d[b->j[2]], d3 = r2d[b->i[3]] - r2d[b->j[3]];
    simd_real even = SIMD_JOIN(d0, d2), odd = SIMD_JOIN(d1, d3);
    simd_real dx = SIMD_EVEN(even, odd), dy = SIMD_ODD(even, odd);
    d0 = v2d[b->i[0]] - v2d[b->j[0]], d1 = v2d[b->i[1]] - v2d[b->j[1]];
    d2 = v2d[b->i[2]] - v2d[b->j[2]], d3 = v2d[b->i[3]] - v2d[b->j[3]];
    even = SIMD_JOIN(d0, d2), odd = SIMD_JOIN(d1, d3);
    simd_real dvx = SIMD_EVEN(even, odd), dvy = SIMD_ODD(even, odd);
    simd_real r2 = dx * dx + dy * dy, r = {sqrt(r2[0]), sqrt(r2[1]), sqrt(r2[2]), sqrt(r2[3])};
    simd_real over = 1.0 / r, nx = dx * over, ny = dy * over;
    simd_real vn = dvx * nx + dvy * ny, vt = dvy * nx - dvx * ny;

    simd_real stretch = OF_K(l->stretch), x = r - stretch, area = LAW(bond.area), soft_i = OF_I(p->soft), soft_j = OF_J(p->soft);
    simd_real power = LAW(shape) - LAW(bond.alpha) * x, e;
    exp_lanes(&power, &e);
    simd_real f = LAW(bond.force) * (e * e - e);
    simd_real pull_i = LAW(tensile_i) * soft_i, pull_j = LAW(tensile_j) * soft_j, cap = LESSER(pull_i, pull_j) * area;
    simd_int more = (r > LAW(bond.breaks)) | (f < -cap) | (x > LAW(bond.peak)) | ((stretch > 0.0) & (f > cap)) |
                    ~((MAGNITUDE(power) < 700.0) & (r2 > 0.0));

    simd_real fdn = -LAW(cn_mass) * vn, fn = f + fdn;
    simd_real ft = zero, fdt = zero, arm_i = zero, arm_j = zero, freed = zero, damped = zero, spring = OF_K(l->spring);
    if (spin) {
        simd_real share = r * LAW(bond.over_r0), before = spring;
        arm_i = share * OF_I(p->radius);
        arm_j = share * OF_J(p->radius);
        vt = vt - (OF_I(p->w) * arm_i + OF_J(p->w) * arm_j);
        simd_real kt = LAW(kt_link);
        simd_real yield_i = LAW(yield_i) * soft_i, yield_j = LAW(yield_j) * soft_j;
        simd_real held = LESSER(yield_i, yield_j) * area;
        spring = spring + vt * pass->dt_path;
        simd_int slips = kt * MAGNITUDE(spring) > held;
        if (any(&slips)) {
            const simd_int sign = {INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN};
            held = held / kt;
            held = (simd_real)(((simd_int)held & ~sign) | ((simd_int)spring & sign));
            held = SIMD_CHOOSE(slips, held, spring);
            freed = SIMD_CHOOSE(slips, kt * (0.5 * (before + held)) * (spring - held), zero);
            spring = held;
        }
        simd_real fs = -kt * spring;
        fdt = -LAW(ct_mass) * vt;
        ft = fs + fdt;
        damped = damped - fdt * vt * pass->dt_kick;
    }
    damped = damped - fdn * vn * pass->dt_kick;
    simd_real gained = LAW(conduction) * (area * over) * (OF_J(p->temperature) - OF_I(p->temperature)) * pass->dt_kick;

    simd_real largest = (MAGNITUDE(fn) + MAGNITUDE(fdn)) + (MAGNITUDE(ft) + MAGNITUDE(fdt));
    simd_real heat = MAGNITUDE(freed) + MAGNITUDE(damped) + MAGNITUDE(gained);
    more |= ~((largest * scale->force < 0x1p50) & (heat * scale->heat < 0x1p50));
    if (any(&more))
        return false;

    simd_real sx = nx * scale->force, sy = ny * scale->force;
    simd_int force[4] = {FIXED(fn * sx - ft * sy), FIXED(fn * sy + ft * sx), FIXED(fdn * sx - fdt * sy),
                         FIXED(fdn * sy + fdt * sx)};
    simd_int qfreed = FIXED(0.5 * freed * scale->heat), qdamped = FIXED(0.5 * damped * scale->heat);
    simd_int qgained = FIXED(gained * scale->heat);
    simd_real tt = ft * scale->torque, tdt = fdt * scale->torque;
    simd_int other_i[4] = {-FIXED(arm_i * tt), -FIXED(arm_i * tdt), qfreed, qdamped + qgained};
    simd_int other_j[4] = {-FIXED(arm_j * tt), -FIXED(arm_j * tdt), qfreed, qdamped - qgained};
    scatter(b, p->pair_sum, force, other_i, other_j);
    for (int q = 0; spin && q < SIMD_LANES; q++)
        l->spring[b->k[q]] = spring[q];
    return true;
}

DM2_INLINE void wide_rows(struct pass *pass, struct lists *l, bool spin,
                          void (*single)(struct pass *, struct lists *, uint32_t, uint32_t))
{
    const struct model *m = pass->m;
    const struct particles *p = pass->p;
    struct batch b = {.n = 0};
    for (uint32_t i = 0; i < p->n_own; i++) {
        double x = p->r[2 * i], y = p->r[2 * i + 1], radius = p->radius[i];
        for (uint32_t k = l->near.start[i]; k < l->near.start[i + 1]; k++) {
            size_t j = l->near.j[k];
            double r0 = radius + p->radius[j];
            if (l->linked[k]) {
                const struct pair_law *law = model_law(m, p->kind[i], p->kind[j],
                                                       relation_of(p->body[i], p->grain[i], p->body[j], p->grain[j]));
                if (law->wide && law->bond.r0 == r0) {
                    b.i[b.n] = i;
                    b.j[b.n] = (uint32_t)j;
                    b.k[b.n] = k;
                    b.law[b.n++] = law;
                    if (b.n < SIMD_LANES)
                        continue;
                    b.n = 0;
                    if (batch_interact(pass, l, &b, spin))
                        continue;
                    for (int q = 0; q < SIMD_LANES; q++)
                        single(pass, l, b.i[q], b.k[q]);
                    continue;
                }
            }
            double dx = x - p->r[2 * j], dy = y - p->r[2 * j + 1];
            if (l->linked[k] || dx * dx + dy * dy <= r0 * r0 * (1.0 + 0x1p-40) || lists_remembers(l, k))
                single(pass, l, i, k);
        }
    }
    for (int q = 0; q < b.n; q++)
        single(pass, l, b.i[q], b.k[q]);
}

DM2_WIDE static void wide_spinning(struct pass *pass, struct lists *l,
                                   void (*single)(struct pass *, struct lists *, uint32_t, uint32_t))
{
    wide_rows(pass, l, true, single);
}

DM2_WIDE static void wide_central(struct pass *pass, struct lists *l,
                                  void (*single)(struct pass *, struct lists *, uint32_t, uint32_t))
{
    wide_rows(pass, l, false, single);
}

void near_wide(struct pass *pass, struct lists *lists,
               void (*single)(struct pass *pass, struct lists *lists, uint32_t i, uint32_t k))
{
    if (pass->m->has_spin)
        wide_spinning(pass, lists, single);
    else
        wide_central(pass, lists, single);
}
