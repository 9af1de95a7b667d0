/* Stiffness and damping are summed apart, because the share of the limit then follows without a search: with
 * s = A f^2 + B f at the time step f dt, the share is 1/f at s = 1. Both largest eigenvalues are taken apart,
 * too, which is exact where damping goes with stiffness and never too low. The sums are integers, so that the
 * order of pairs does not matter. A pair stands in the row of its lower slot, so an element's sums are
 * complete after its own row, and room is needed for the elements between it and its partners alone. */
#include "stiffness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/simd.h"
#include "pair_pass.h"

/* Where an element has its sums: stiffness from 0 on; 2 c_n/dt from `c` on where a law damps; of the rotation
 * kt and 2 c_t/dt from `turn` on where elements rotate, all in Mbar cm; the share of the limit by conduction
 * at `heat` where a law conducts; 0: not there. */
struct sum_layout {
    size_t c, turn, heat, count;
};
enum { LAYOUT_MECHANICAL = 8, LAYOUT_MOST = 9 };

static struct sum_layout layout_of(const struct model *m)
{
    const size_t laws = m->n_kinds * m->n_kinds * RELATION_COUNT;
    bool damps = false;
    for (size_t k = 0; k < laws && !damps; k++)
        damps = m->laws[k].cn > 0.0 || m->laws[k].ct > 0.0; /* of walls, too: theirs are laws of the table */
    struct sum_layout at = {.c = damps ? 3 : 0, .count = damps ? 6 : 3};
    if (m->has_spin) {
        at.turn = at.count;
        at.count += 2;
    }
    for (size_t k = 0; k < laws && at.heat == 0; k++)
        if (m->laws[k].conduction > 0.0)
            at.heat = at.count++;
    return at;
}

static const double range = 0x1p50;      /* of a pair's part: thousands of pairs fit in an integer */
static const double heat_scale = 0x1p40; /* of shares */

void stiffness_free(struct stiffness_sums *s)
{
    free(s->sum);
    *s = (struct stiffness_sums){0};
}

size_t stiffness_bytes(const struct stiffness_sums *s)
{
    return s->cap * sizeof *s->sum;
}

/* A pair, as both of its elements count it. */
struct pair_part {
    double xx, yy, xy;  /* n (x) n */
    double k, c;        /* along n: u'' and 2 c_n/dt, times the scale */
    double kt, ct;      /* along t, likewise; 0 without spin */
    double compression; /* 1 - x/r0 */
    double conductance; /* heat per time and kelvin, g cm2/us3/K */
};

/* u'' of the bond at length x, Mbar cm; at least 0. */
DM2_INLINE double curvature(const struct pair_law *law, const struct bond *b, double x)
{
    if (law->potential == POTENTIAL_QUADRATIC)
        return law->k;
    double k;
    if (law->potential == POTENTIAL_MORSE) {
        double e = real_exp(law->shape - b->alpha * x);
        k = law->k * (2.0 * e * e - e);
    } else {
        double over = 1.0 / x, q = b->r0 * over, q2 = q * q, q6 = q2 * q2 * q2;
        k = b->force * (13.0 * q6 * q6 - 7.0 * q6) * (over * over);
    }
    return k > 0.0 ? k : 0.0;
}

static bool is_driven(const struct particles *p, size_t i)
{
    return (p->flags[i] & ELEMENT_FIXED_MOTION) != 0;
}

/* c_n, returned, and c_t of the pair, Mbar us cm: of the damping force at unit velocity, without the factors
 * of a contact's time step, which only make it smaller. */
DM2_INLINE double damping(const struct model *m, const struct particles *p, size_t i, size_t j,
                          const struct pair_law *law, const struct bond *bond, bool linked, double *ct)
{
    struct pair_effect effect = {.contacting = !linked};
    struct pair_view view = {.vn = -1.0,
                             .mass_i = p->mass[i],
                             .mass_j = p->mass[j],
                             .held_i = is_driven(p, i),
                             .held_j = is_driven(p, j),
                             .t_i = particles_temperature(p, m, i),
                             .t_j = particles_temperature(p, m, j)};
    *ct = 0.0;
    if (!(law->cn > 0.0) && !(law->ct > 0.0))
        return 0.0;
    if (p->p != NULL) {
        view.p_i = p->p[i];
        view.p_j = p->p[j];
    }
    *ct = law_damping(law, bond, &view, linked, 0.0, 0.0, &effect);
    return effect.fdn;
}

/* Fills *out for entry k of the near row of i; false where the pair is neither linked nor touching. */
DM2_INLINE bool find_part(const struct model *m, const struct particles *p, const struct lists *l,
                          const struct period *period, size_t i, size_t k, double scale,
                          struct pair_part *out)
{
    const double *r = p->r;
    size_t j = l->near.j[k];
    bool linked = l->linked[k];
    double dx = period_nearest(r[2 * i] - r[2 * j], period->size[0], period->half[0]);
    double dy = period_nearest(r[2 * i + 1] - r[2 * j + 1], period->size[1], period->half[1]);
    double r2 = dx * dx + dy * dy, r0 = p->radius[i] + p->radius[j];
    if (!(r2 > 0.0) || (!linked && law_far_apart(r2, r0)))
        return false;
    double distance = sqrt(r2), x = distance - l->stretch[k], ct;
    if (!linked && !law_touches(distance, r0))
        return false;
    const struct pair_law *law = particles_law(m, p, i, j);
    const struct bond made = r0 == law->bond.r0 ? (struct bond){0} : law_bond(law, r0);
    const struct bond *bond = r0 == law->bond.r0 ? &law->bond : &made;
    double conductance = law->conduction * bond->area / distance;
    if (is_driven(p, i) && is_driven(p, j)) {
        *out = (struct pair_part){.conductance = conductance};
        return conductance > 0.0;
    }
    double cn = damping(m, p, i, j, law, bond, linked, &ct), of_c = scale * (2.0 / m->config->dt);
    bool turns = m->has_spin && law->tangential;
    double over = 1.0 / r2, kt = linked ? law->kt_link : law->kt_contact;
    *out = (struct pair_part){.xx = dx * dx * over,
                              .yy = dy * dy * over,
                              .xy = dx * dy * over,
                              .k = scale * curvature(law, bond, x),
                              .c = of_c * cn,
                              .kt = turns ? scale * kt : 0.0,
                              .ct = turns ? of_c * ct : 0.0,
                              .compression = 1.0 - x * bond->over_r0,
                              .conductance = conductance};
    return true;
}

/* The sums that a pair adds to its element of mass m, whose partner has mass m_j, in fixed point. */
DM2_INLINE void fix_part(const struct sum_layout *at, const struct pair_part *part, double m, double m_j,
                         bool driven_j, int64_t *out)
{
    double w = 1.0 + (driven_j ? 0.0 : m == m_j ? 1.0 : sqrt(m / m_j)), third = w * (1.0 / 3.0);
    double n = law_lesser(part->k * w, range), t = law_lesser(part->kt * third, range);
    out[0] = to_fixed(n * part->xx + t * part->yy);
    out[1] = to_fixed(n * part->yy + t * part->xx);
    out[2] = to_fixed(n * part->xy - t * part->xy);
    if (at->c > 0) {
        n = law_lesser(part->c * w, range);
        t = law_lesser(part->ct * third, range);
        out[at->c] = to_fixed(n * part->xx + t * part->yy);
        out[at->c + 1] = to_fixed(n * part->yy + t * part->xx);
        out[at->c + 2] = to_fixed(n * part->xy - t * part->xy);
    }
    if (at->turn > 0) {
        double turn = 2.0 * (w > 2.0 ? w : 2.0);
        out[at->turn] = to_fixed(law_lesser(part->kt * turn, range));
        out[at->turn + 1] = to_fixed(law_lesser(part->ct * turn, range));
    }
}

/* The share of the limit by conduction that a pair adds to slot i, in fixed point. Of the forward steps of
 * temperatures Gershgorin's bound is dt sum of G (1 + sqrt(C_i/C_j))/C_i < 2; 3/4 of it is exact in the
 * hexagonal lattice. */
static int64_t fix_heat(const struct model *m, const struct particles *p, const struct pair_part *part,
                        size_t i, size_t j)
{
    if (!(part->conductance > 0.0))
        return 0;
    double one = p->mass[i] * particles_heat_capacity(p, m, i);
    double other = p->mass[j] * particles_heat_capacity(p, m, j);
    if (!isfinite(one))
        return 0;
    double w = 1.0 + (isfinite(other) ? sqrt(one / other) : 0.0);
    return to_fixed(law_lesser(0.375 * part->conductance * m->config->dt * w / one * heat_scale, range));
}

/* Fills *out for an entry of slot i; false where it does not touch. As find_part for a driven partner, with
 * m_eff the mass of the element. */
static bool find_wall_part(const struct model *m, const struct particles *p, size_t i,
                           const struct wall_pose *pose, const struct wall_entry *entry, double scale,
                           struct pair_part *out)
{
    const struct wall *w = walls_of_feature(m, entry->feature);
    struct wall_meeting at;
    if (entry->sign == 0)
        return false;
    pose += w - m->walls;
    wall_meet(m, w, pose, p, i, entry, &at);
    const struct pair_law *law = &w->laws[p->kind[i]];
    const struct bond bond = law_bond(law, 2.0 * p->radius[i]);
    double r = at.d + p->radius[i], root = sqrt(p->mass[i]), of_c = scale * (2.0 / m->config->dt);
    double pressure = p->p != NULL ? p->p[i] : 0.0,
           warm = isnan(pose->temperature) ? particles_temperature(p, m, i) : pose->temperature;
    double change =
        1.0 + law->a_p * pressure + law->a_t * (0.5 * (particles_temperature(p, m, i) + warm) - law->t0_mean);
    change = change > 0.0 ? change : 0.0;
    *out =
        (struct pair_part){.xx = at.n[0] * at.n[0],
                           .yy = at.n[1] * at.n[1],
                           .xy = at.n[0] * at.n[1],
                           .k = scale * curvature(law, &bond, r),
                           .c = of_c * law->cn * root * change,
                           .kt = m->has_spin ? scale * law->kt_contact : 0.0,
                           .ct = m->has_spin ? of_c * law->ct * root * change : 0.0,
                           .compression = 1.0 - r * bond.over_r0,
                           .conductance = isnan(pose->temperature) ? 0.0 : law->conduction * bond.area / r};
    return true;
}

/* Adds the contacts with walls of row `row` to the sums of slot i. */
static void add_walls(const struct model *m, const struct particles *p, const struct walls *ws, size_t row,
                      const struct sum_layout *at, int64_t *sum, struct stiffness *out)
{
    size_t i = ws->slot[row];
    for (uint32_t k = ws->start[row]; k < ws->start[row + 1]; k++) {
        struct pair_part part;
        int64_t fixed[LAYOUT_MOST] = {0};
        const int sign = ws->entry[k].sign;
        if (!find_wall_part(m, p, i, ws->pose, &ws->entry[k], m->fixed.stiffness, &part))
            continue;
        if (!is_driven(p, i))
            fix_part(at, &part, p->mass[i], p->mass[i], true, fixed);
        double capacity = p->mass[i] * particles_heat_capacity(p, m, i);
        if (at->heat > 0 && isfinite(capacity))
            fixed[at->heat] =
                to_fixed(law_lesser(0.375 * part.conductance * m->config->dt / capacity * heat_scale, range));
        for (size_t c = 0; c < at->count; c++)
            sum[c] += sign * fixed[c];
        if (!is_driven(p, i) && part.compression > out->compression)
            out->compression = part.compression;
    }
}

/* The largest eigenvalue of the symmetric tensor xx, yy, xy. */
static double largest_eigenvalue(const int64_t *sum)
{
    double xx = (double)sum[0], yy = (double)sum[1], xy = (double)sum[2], half = 0.5 * (xx - yy);
    return 0.5 * (xx + yy) + sqrt(half * half + xy * xy);
}

/* 1/f with a f^2 + b f = 1. */
static double share_of(double a, double b)
{
    return 0.5 * (b + sqrt(b * b + 4.0 * a));
}

/* The share of its limit that the deck's dt is for slot i, whose sums are complete. */
static double element_share(const struct model *m, const struct particles *p, size_t i,
                            const struct sum_layout *at, const int64_t *sum, double over_scale)
{
    double dt = m->config->dt, unit = over_scale * (dt * dt) / (4.0 * p->mass[i]);
    double share = at->heat > 0 ? (double)sum[at->heat] / heat_scale : 0.0;
    if (is_driven(p, i))
        return share;
    double damped = at->c > 0 ? unit * largest_eigenvalue(sum + at->c) : 0.0;
    double shift = share_of(unit * largest_eigenvalue(sum), damped);
    share = shift > share ? shift : share;
    if (at->turn > 0) {
        double turn = share_of(unit * (double)sum[at->turn], unit * (double)sum[at->turn + 1]);
        share = turn > share ? turn : share;
    }
    return share;
}

/* Where the sums of the elements are while rows are under way: those of PART_INSIDE in a ring, because its
 * rows come in cell order and partners are near; those of the edge behind the ring. */
struct places {
    size_t n_inside, width; /* width: of the ring, a power of two */
};

static inline size_t place_of(const struct places *at, size_t i)
{
    return i < at->n_inside ? (i & (at->width - 1)) : at->width + (i - at->n_inside);
}

/* The ring is wider than the distance, in slots, of any of its elements from a partner in the lists. */
static struct places find_places(const struct lists *l)
{
    struct places at = {.n_inside = l->n_inside, .width = 1};
    size_t furthest = 0;
    for (size_t i = 0; i < l->n_inside; i++)
        for (uint32_t k = l->near.start[i]; k < l->near.start[i + 1]; k++)
            if (l->near.j[k] < l->n_inside && l->near.j[k] - i > furthest)
                furthest = l->near.j[k] - i;
    while (at.width <= furthest)
        at.width *= 2;
    return at;
}

/* Adds the pairs in the row of owned slot i; the sums of slot j are at place_of(j). Compiled
 * apart for decks with all mechanical sums and for others. */
DM2_INLINE void add_row(const struct model *m, const struct particles *p, const struct lists *l,
                        const struct period *period, size_t i, const struct sum_layout *at, int64_t *sum,
                        const struct places *places, struct stiffness *out)
{
    struct pair_part part = {0};
    int64_t *own = sum + place_of(places, i) * at->count, fixed[LAYOUT_MOST];
    for (size_t k = l->near.start[i]; k < l->near.start[i + 1]; k++) {
        size_t j = l->near.j[k];
        if (!find_part(m, p, l, period, i, k, m->fixed.stiffness, &part))
            continue;
        bool driven_i = is_driven(p, i), driven_j = is_driven(p, j);
        fix_part(at, &part, p->mass[i], p->mass[j], driven_j, fixed);
        if (at->heat > 0)
            fixed[at->heat] = fix_heat(m, p, &part, i, j);
        for (size_t c = 0; c < at->count; c++)
            own[c] += fixed[c];
        out->compression = part.compression > out->compression ? part.compression : out->compression;
        if (j >= p->n_own)
            continue;
        int64_t *other = sum + place_of(places, j) * at->count;
        if (p->mass[i] != p->mass[j] || driven_i || driven_j)
            fix_part(at, &part, p->mass[j], p->mass[i], driven_i, fixed);
        if (at->heat > 0)
            fixed[at->heat] = fix_heat(m, p, &part, j, i);
        for (size_t c = 0; c < at->count; c++)
            other[c] += fixed[c];
    }
}

/* All rows, one after the other; an element's sums are complete after its own row, and are set to 0. */
DM2_INLINE void add_rows(const struct model *m, const struct particles *p, const struct lists *l,
                         const struct walls *ws, const struct sum_layout *at, int64_t *sum,
                         const struct places *places, struct stiffness *out)
{
    const struct period period = period_of(&m->grid);
    size_t row = 0;
    for (size_t i = 0; i < p->n_own; i++) {
        int64_t *own = sum + place_of(places, i) * at->count;
        add_row(m, p, l, &period, i, at, sum, places, out);
        if (row < ws->n_rows && ws->slot[row] == i)
            add_walls(m, p, ws, row++, at, own, out);
        double share = element_share(m, p, i, at, own, 1.0 / m->fixed.stiffness);
        out->dt_share = share > out->dt_share ? share : out->dt_share;
        for (size_t c = 0; c < at->count; c++)
            own[c] = 0;
    }
}

DM2_WIDE static void add_rows_all(const struct model *m, const struct particles *p, const struct lists *l,
                                  const struct walls *ws, int64_t *sum, const struct places *places,
                                  struct stiffness *out)
{
    const struct sum_layout at = {.c = 3, .turn = 6, .count = LAYOUT_MECHANICAL};
    add_rows(m, p, l, ws, &at, sum, places, out);
}

DM2_WIDE static void add_rows_some(const struct model *m, const struct particles *p, const struct lists *l,
                                   const struct walls *ws, int64_t *sum, const struct places *places,
                                   struct stiffness *out)
{
    const struct sum_layout at = layout_of(m);
    add_rows(m, p, l, ws, &at, sum, places, out);
}

enum dm2_status stiffness_measure(const struct model *m, const struct particles *p, const struct lists *l,
                                  const struct walls *walls, struct stiffness_sums *s, struct stiffness *out,
                                  struct dm2_error *err)
{
    *out = (struct stiffness){0};
    if (!m->has_near || m->has_far || p->n_own == 0)
        return DM2_OK;
    const struct sum_layout at = layout_of(m);
    const struct places places = find_places(l);
    const size_t n = places.width + (p->n_own - places.n_inside);
    int64_t *sum = mem_grown(s->sum, &s->cap, 0, n * at.count, sizeof *sum);
    if (sum == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for the stiffness of %zu elements", n);
    s->sum = sum;
    memset(sum, 0, n * at.count * sizeof *sum);
    if (at.count == LAYOUT_MECHANICAL && at.heat == 0)
        add_rows_all(m, p, l, walls, sum, &places, out);
    else
        add_rows_some(m, p, l, walls, sum, &places, out);
    return DM2_OK;
}
