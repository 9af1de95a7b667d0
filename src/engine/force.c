/* The near pairs, and one evaluation of all pairs. The physics of a pair is in law.h; the loops here take the
 * pairs from the half lists and add their effects to both elements as 64-bit integers. Integer addition does
 * not depend on order, so neither do the results. Conversion is an odd function, so action and reaction
 * cancel to the last bit. The range of each conversion is checked; no sum wraps. */
#include "force.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/simd.h"
#include "crack_note.h"
#include "pair_forces.h"
#include "pair_pass.h"

/* --- near pairs --- */

/* Adds the effect of a pair to the sums `a` of i and `b` of j. False where the effect is out of range. */
DM2_INLINE bool add_effect(const struct fixed_scales *s, int64_t *a, int64_t *b, double nx, double ny,
                           const struct pair_effect *e, bool spin)
{
    double largest = (fabs(e->fn) + fabs(e->fdn)) + (fabs(e->ft) + fabs(e->fdt));
    double heat = fabs(e->heat) + fabs(e->heat_damped) + fabs(e->exchange);
    if (!(largest * s->force < FIXED_RANGE) || !(heat * s->heat < FIXED_RANGE))
        return false;
    double sx = nx * s->force, sy = ny * s->force;
    int64_t fx = to_fixed(e->fn * sx - e->ft * sy), fy = to_fixed(e->fn * sy + e->ft * sx);
    int64_t dx = to_fixed(e->fdn * sx - e->fdt * sy), dy = to_fixed(e->fdn * sy + e->fdt * sx);
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
    if (spin) {
        double ft = e->ft * s->torque, fdt = e->fdt * s->torque;
        a[SUM_TORQUE] -= to_fixed(e->arm_i * ft);
        a[SUM_DTORQUE] -= to_fixed(e->arm_i * fdt);
        b[SUM_TORQUE] -= to_fixed(e->arm_j * ft);
        b[SUM_DTORQUE] -= to_fixed(e->arm_j * fdt);
    }
    return true;
}

/* A pair that touches or is linked counts in both elements' surroundings; r stays below link_break r0. */
static void add_around(const struct pass *pass, uint32_t i, uint32_t j, double dx, double dy, bool linked,
                       bool contacting)
{
    double s = pass->m->fixed.around;
    const int64_t part[AROUND_COUNT] = {[AROUND_XX] = to_fixed(dx * dx * s),
                                        [AROUND_YY] = to_fixed(dy * dy * s),
                                        [AROUND_XY] = to_fixed(dx * dy * s)};
    const int64_t tally = TALLY_PAIR + (linked ? TALLY_LINK : 0) + (contacting ? TALLY_CONTACT : 0);
    int64_t *a = pass->p->around + AROUND_COUNT * (size_t)i, *b = pass->p->around + AROUND_COUNT * (size_t)j;
    for (int k = 0; k < AROUND_COUNT; k++) {
        a[k] += part[k];
        b[k] += part[k];
    }
    pass->p->virial[VIRIAL_COUNT * (size_t)i + VIRIAL_TALLY] += tally;
    pass->p->virial[VIRIAL_COUNT * (size_t)j + VIRIAL_TALLY] += tally;
}

/* Adds the virial, surroundings, energies and counts of a pair. */
static void measure_pair(struct pass *pass, uint32_t i, uint32_t j, double dx, double dy, double nx,
                         double ny, const struct pair_effect *e, bool linked)
{
    struct particles *p = pass->p;
    const struct fixed_scales *s = &pass->m->fixed;
    add_virial(pass, i, j, dx, dy, e->fn * nx - e->ft * ny, e->fn * ny + e->ft * nx);
    if (linked || e->contacting)
        add_around(pass, i, j, dx, dy, linked, e->contacting);
    if (!counts_here(p, i, j))
        return;
    if (!(fabs(e->potential * s->energy) < FIXED_RANGE) || !(fabs(e->elastic * s->energy) < FIXED_RANGE)) {
        note_bad(pass, i, j);
        return;
    }
    exact_add_units(&pass->potential, to_fixed(e->potential * s->energy), s->energy_left);
    exact_add_units(&pass->elastic, to_fixed(e->elastic * s->energy), s->energy_left);
    struct pair_totals *t = pass->totals;
    t->links += linked;
    t->contacts += e->contacting;
    t->pairs += linked || e->contacting;
    if (e->contacting) {
        exact_add_units(&t->fabric[0], to_fixed(nx * nx * FABRIC_SCALE), 0);
        exact_add_units(&t->fabric[1], to_fixed(nx * ny * FABRIC_SCALE), 0);
    }
    if ((linked || e->contacting) && has_free_element(p, i, j)) {
        double magnitude = sqrt(e->fn * e->fn + e->ft * e->ft);
        t->loaded_pairs++;
        exact_add_units(&t->magnitudes, to_fixed(magnitude * s->force), s->energy_left);
    }
}

/* The plain path, with the whole law: entry k of the near row of owned slot i. Effects on i go to `sums`,
 * which may be kept apart from pair_sum. */
DM2_INLINE void evaluate_pair(struct pass *pass, struct lists *l, uint32_t i, uint32_t k, int64_t *sums,
                              bool measure, bool spin, bool periodic)
{
    const struct model *m = pass->m;
    struct particles *p = pass->p;
    const double *r = p->r, *v = p->v;
    size_t j = l->near.j[k];
    double dx = r[2 * i] - r[2 * j], dy = r[2 * i + 1] - r[2 * j + 1];
    if (periodic) {
        dx = period_nearest(dx, pass->period.size[0], pass->period.half[0]);
        dy = period_nearest(dy, pass->period.size[1], pass->period.half[1]);
    }
    double r2 = dx * dx + dy * dy, r0 = p->radius[i] + p->radius[j];
    if (law_far_apart(r2, r0) && !lists_remembers(l, k))
        return; /* no contact, no memory: most near pairs that are not linked */
    const struct pair_law *law = particles_law(m, p, i, j);
    double distance = sqrt(r2), over = r2 > 0.0 ? 1.0 / distance : 0.0, nx = dx * over, ny = dy * over;
    double dvx = v[2 * i] - v[2 * j], dvy = v[2 * i + 1] - v[2 * j + 1];
    struct pair_view view = {
        .r = distance,
        .over_r = over,
        .radius_i = p->radius[i],
        .radius_j = p->radius[j],
        .vn = dvx * nx + dvy * ny,
        .vt = dvy * nx - dvx * ny,
        .w_i = p->w[i],
        .w_j = p->w[j],
        .mass_i = p->mass[i],
        .mass_j = p->mass[j],
        .soft_i = p->soft[i],
        .soft_j = p->soft[j],
        .t_i = p->temperature[i],
        .t_j = p->temperature[j],
        .held_i = particles_held(p, i, j),
        .held_j = particles_held(p, j, i),
        .walls = particles_walls(p, i, j),
    };
    if (p->p != NULL) {
        view.p_i = p->p[i];
        view.p_j = p->p[j];
    }
    struct pair_state state = {.linked = l->linked[k], .stretch = l->stretch[k], .spring = l->spring[k]};
    const struct pair_state before = state;
    struct pair_effect effect;
    pair_interact(law, &view, pass->dt_kick, pass->dt_path, &state, &effect);
    if (before.linked && !state.linked && !pass->plain)
        crack_note(pass, &l->cracks, i, j, law, distance, &before, effect.heat);
    l->linked[k] = state.linked;
    l->stretch[k] = state.stretch;
    l->spring[k] = state.spring;
    if (!add_effect(&m->fixed, sums, p->pair_sum + SUM_COUNT * j, nx, ny, &effect, spin))
        note_bad(pass, i, (uint32_t)j); /* not measured: the virial would be out of range, too */
    else if (measure)
        measure_pair(pass, i, (uint32_t)j, dx, dy, nx, ny, &effect, state.linked);
    if (measure && l->forces != NULL && !pass->bad && (state.linked || effect.contacting))
        pair_forces_note(l, k, m->fixed.force, nx, ny, effect.fn, effect.ft);
}

/* The pairs in the row of owned slot i. */
DM2_INLINE void evaluate_row(struct pass *pass, struct lists *l, uint32_t i, bool measure, bool spin,
                             bool periodic)
{
    int64_t sums[SUM_COUNT] = {0};
    for (uint32_t k = l->near.start[i]; k < l->near.start[i + 1]; k++)
        evaluate_pair(pass, l, i, k, sums, measure, spin, periodic);
    for (size_t s = 0; s < SUM_COUNT; s++)
        pass->p->pair_sum[SUM_COUNT * (size_t)i + s] += sums[s];
}

/* The rows of a part; compiled apart for each combination of the flags that decks need. */
DM2_INLINE void evaluate_rows(struct pass *pass, struct lists *l, bool measure, bool spin, bool periodic)
{
    uint32_t first, last;
    lists_rows(l, pass->p, pass->part, &first, &last);
    for (uint32_t i = first; i < last; i++)
        evaluate_row(pass, l, i, measure, spin, periodic);
}

DM2_WIDE static void evaluate_measured(struct pass *pass, struct lists *l)
{
    evaluate_rows(pass, l, true, true, true);
}

DM2_WIDE static void evaluate_periodic(struct pass *pass, struct lists *l)
{
    evaluate_rows(pass, l, false, true, true);
}

DM2_WIDE static void evaluate_spinning(struct pass *pass, struct lists *l)
{
    evaluate_rows(pass, l, false, true, false);
}

DM2_WIDE static void evaluate_central(struct pass *pass, struct lists *l)
{
    evaluate_rows(pass, l, false, false, false);
}

/* The plain path for the links that near_wide leaves to it. */
static void evaluate_single(struct pass *pass, struct lists *l, uint32_t i, uint32_t k)
{
    evaluate_pair(pass, l, i, k, pass->p->pair_sum + SUM_COUNT * (size_t)i, pass->totals != NULL, true, true);
}

DM2_INLINE void evaluate_single_rows(struct pass *pass, struct lists *l, bool measure)
{
    const struct link_list *links = &l->links[pass->part];
    for (size_t s = 0; s < links->n_single; s++) {
        uint32_t i = links->single[s].i;
        evaluate_pair(pass, l, i, links->single[s].k, pass->p->pair_sum + SUM_COUNT * (size_t)i, measure,
                      true, true);
    }
}

DM2_WIDE static void evaluate_singles(struct pass *pass, struct lists *l)
{
    evaluate_single_rows(pass, l, false);
}

DM2_WIDE static void evaluate_singles_measured(struct pass *pass, struct lists *l)
{
    evaluate_single_rows(pass, l, true);
}

/* Links in quads, then the single pairs. */
static void evaluate_sorted(struct pass *pass, struct lists *l)
{
    uint32_t first, last;
    lists_rows(l, pass->p, pass->part, &first, &last);
    pass->no_memory |=
        link_list_prepare(&l->links[pass->part], &l->near, l->linked, first, last, pass->m, pass->p) != 0;
    if (pass->no_memory)
        return;
    near_wide(pass, l, evaluate_single);
    pulse_beat(&pass->m->pulse);
    if (pass->totals != NULL)
        evaluate_singles_measured(pass, l);
    else
        evaluate_singles(pass, l);
}

static void evaluate_near(struct pass *pass, struct lists *l)
{
    const struct model *m = pass->m;
    pulse_beat(&m->pulse);
    if (m->wide_near && !pass->plain)
        evaluate_sorted(pass, l);
    else if (pass->totals != NULL)
        evaluate_measured(pass, l);
    else if (m->grid.periodic[0] || m->grid.periodic[1])
        evaluate_periodic(pass, l);
    else if (m->has_spin)
        evaluate_spinning(pass, l);
    else
        evaluate_central(pass, l);
}

/* --- one evaluation --- */

static void clear_far(const struct pass *pass)
{
    const struct particles *p = pass->p;
    if (pass->totals != NULL)
        memset(p->virial, 0, p->n * VIRIAL_COUNT * sizeof *p->virial);
    if (p->far_sum != NULL)
        memset(p->far_sum, 0, (p->n + 1) * 2 * sizeof *p->far_sum);
}

static void clear_sums(const struct pass *pass)
{
    const struct particles *p = pass->p;
    clear_far(pass);
    if (pass->totals != NULL && pass->m->has_near)
        memset(p->around, 0, p->n * AROUND_COUNT * sizeof *p->around);
    if (pass->m->has_near)
        memset(p->pair_sum, 0, p->n * SUM_COUNT * sizeof *p->pair_sum);
}

/* Evaluates the parts that force_ahead left out. Where measured far pairs leave the range of lanes, their
 * evaluation starts again with plain loops: no near pair has been measured by then. */
static void evaluate_parts(struct pass *pass, struct lists *l)
{
    const struct model *m = pass->m;
    int first = pass->ahead ? PART_EDGE : PART_INSIDE;
    if (!pass->ahead)
        clear_sums(pass);
    for (int part = first; part < PART_COUNT && m->has_far; part++) {
        pass->part = (enum list_part)part;
        bool plain = pass->far_plain;
        far_evaluate(pass, l);
        if (pass->far_plain && !plain) {
            clear_far(pass);
            pass->potential = (struct exact_sum){0};
            part = PART_INSIDE - 1;
        }
    }
    for (int part = first; part < PART_COUNT && m->has_near; part++) {
        pass->part = (enum list_part)part;
        evaluate_near(pass, l);
    }
}

static struct pass start_pass(const struct model *m, struct particles *p, double dt_kick, double dt_path,
                              struct pair_totals *totals)
{
    struct pass pass = {.m = m,
                        .p = p,
                        .period = period_of(&m->grid),
                        .dt_kick = dt_kick,
                        .dt_path = dt_path,
                        .totals = totals};
    if (totals != NULL)
        *totals = (struct pair_totals){0};
    return pass;
}

#ifdef DM2_DEBUG
/* An array that an evaluation changes, with copies from before the evaluation and from after the fast paths.
 */
struct watched {
    void *array, *before, *after;
    size_t bytes;
    bool result; /* written, not read, by an evaluation */
};

enum { WATCHED = 8 };
struct force_check {
    struct watched w[WATCHED];
};

/* A copy of `bytes` bytes, which the caller frees; NULL without memory: then the debug flavour omits its
 * check. */
static void *copy_bytes(const void *from, size_t bytes)
{
    void *copy = from != NULL ? malloc(bytes + 1) : NULL;
    if (copy != NULL)
        memcpy(copy, from, bytes);
    return copy;
}

/* Before an evaluation: copies the memory of the pairs. */
static void start_check(struct pass *pass, const struct lists *l)
{
    const struct particles *p = pass->p;
    size_t pairs = pass->m->has_near ? l->near.start[p->n_own] : 0;
    const struct force_check check = {
        .w = {{.array = l->linked, .bytes = pairs * sizeof *l->linked},
              {.array = l->stretch, .bytes = pairs * sizeof *l->stretch},
              {.array = l->spring, .bytes = pairs * sizeof *l->spring},
              {.array = p->far_sum, .bytes = p->n * 2 * sizeof *p->far_sum, .result = true},
              {.array = p->pair_sum, .bytes = p->n * SUM_COUNT * sizeof *p->pair_sum, .result = true},
              {.array = p->virial, .bytes = p->n * VIRIAL_COUNT * sizeof *p->virial, .result = true},
              {.array = p->around, .bytes = p->n * AROUND_COUNT * sizeof *p->around, .result = true},
              {.array = l->forces, .bytes = l->n_forces * sizeof *l->forces, .result = true}}};
    pass->check = malloc(sizeof check);
    if (pass->check == NULL)
        return;
    *pass->check = check;
    for (int k = 0; k < WATCHED; k++)
        pass->check->w[k].before = copy_bytes(check.w[k].array, check.w[k].bytes);
}

static void end_check(struct pass *pass)
{
    for (int k = 0; pass->check != NULL && k < WATCHED; k++) {
        free(pass->check->w[k].before);
        free(pass->check->w[k].after);
    }
    free(pass->check);
    pass->check = NULL;
}

/* After the fast paths: evaluates again with the plain loops from the same memory. Every bit must agree. */
static void check_against_plain(struct pass *pass, struct lists *l)
{
    struct watched *w = pass->check != NULL ? pass->check->w : NULL;
    struct pair_totals totals = {0};
    struct pass plain = *pass;
    plain.plain = true;
    plain.ahead = false;
    plain.potential = plain.elastic = (struct exact_sum){0};
    plain.totals = pass->totals != NULL ? &totals : NULL;
    bool check = w != NULL && !pass->bad && !pass->no_memory;
    for (int k = 0; k < WATCHED && check; k++) {
        w[k].after = copy_bytes(w[k].array, w[k].bytes);
        check = w[k].array == NULL || (w[k].before != NULL && w[k].after != NULL);
    }
    for (int k = 0; k < WATCHED && check; k++) {
        if (w[k].array != NULL && !w[k].result)
            memcpy(w[k].array, w[k].before, w[k].bytes);
    }
    if (check) {
        evaluate_parts(&plain, l);
        assert(memcmp(&plain.potential, &pass->potential, sizeof plain.potential) == 0);
        assert(memcmp(&plain.elastic, &pass->elastic, sizeof plain.elastic) == 0);
        assert(pass->totals == NULL || memcmp(&totals, pass->totals, sizeof totals) == 0);
    }
    for (int k = 0; k < WATCHED; k++)
        assert(!check || w[k].array == NULL || memcmp(w[k].array, w[k].after, w[k].bytes) == 0);
    end_check(pass);
}
#else
static void start_check(struct pass *pass, const struct lists *l)
{
    (void)pass;
    (void)l;
}

static void end_check(struct pass *pass)
{
    (void)pass;
}

static void check_against_plain(struct pass *pass, struct lists *l)
{
    (void)pass;
    (void)l;
}
#endif

void force_ahead(struct pass *pass, const struct model *m, struct particles *p, struct lists *lists,
                 double dt_kick, double dt_path, struct pair_totals *totals)
{
    *pass = start_pass(m, p, dt_kick, dt_path, totals);
    if (lists->n_inside == 0 || m->has_kinds || (m->has_far && totals != NULL) ||
        (m->has_near && lists_keep_memory(lists, m->has_spin) != 0))
        return;
    start_check(pass, lists);
    pass->ahead = true;
    clear_sums(pass);
    lists->cracks.n = 0;
    pass->part = PART_INSIDE;
    if (m->has_far)
        far_evaluate(pass, lists);
    if (m->has_near)
        evaluate_near(pass, lists);
}

void force_drop(struct pass *pass, struct lists *lists)
{
    if (pass->ahead && pass->m->has_near)
        lists_restore_memory(lists, pass->m->has_spin);
    if (pass->ahead)
        lists->cracks.n = 0;
    end_check(pass);
    pass->ahead = false;
}

enum dm2_status force_rest(struct pass *pass, struct lists *lists, int64_t step, struct dm2_error *err)
{
    const struct particles *p = pass->p;
    if (!pass->ahead)
        lists->cracks.n = 0;
    if (p->n == 0)
        return DM2_OK; /* the arrays may be NULL */
    if (!pass->ahead)
        start_check(pass, lists);
    evaluate_parts(pass, lists);
    check_against_plain(pass, lists);
    pass->ahead = false;
    if (pass->no_memory)
        return dm2_fail(err, DM2_MEMORY, "no memory to sort the pairs of %zu elements", p->n_own);
    if (pass->bad)
        return dm2_fail(err, DM2_NUMERIC,
                        "step %lld: the force between elements %u and %u, near (%g, %g) cm, is out of range: "
                        "they are too "
                        "close or too fast; a smaller dt may help",
                        (long long)step, p->id[pass->bad_i], p->id[pass->bad_j], p->r[2 * pass->bad_i],
                        p->r[2 * pass->bad_i + 1]);
    if (pass->totals != NULL) {
        pass->totals->potential = pass->potential;
        pass->totals->elastic = pass->elastic;
    }
    return DM2_OK;
}

enum dm2_status force_evaluate(const struct model *m, struct particles *p, struct lists *lists,
                               double dt_kick, double dt_path, struct pair_totals *totals, int64_t step,
                               struct dm2_error *err)
{
    struct pass pass = start_pass(m, p, dt_kick, dt_path, totals);
    return force_rest(&pass, lists, step, err);
}
