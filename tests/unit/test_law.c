/* The pair law: potentials against their closed forms and against the slope of their energies, yield lengths
 * against the force at these lengths, damping and conduction against their equations, and the invariant that
 * the exchange of the two elements changes only signs, to the last bit. */
#include "check.h"

#include "engine/law.h"

static const double r0 = 0.04;

static struct pair_law law_of(enum potential_kind potential)
{
    return (struct pair_law){.potential = potential,
                             .scope = SCOPE_LINKED,
                             .near = true,
                             .tangential = true,
                             .k = 1.4,
                             .shape = 2.9,
                             .kt_link = 0.5,
                             .kt_contact = 0.5,
                             .mu = 0.3,
                             .link_break = 1.3,
                             .link_form = 0.9,
                             .yield_i = INFINITY,
                             .yield_j = INFINITY,
                             .tensile_i = INFINITY,
                             .tensile_j = INFINITY,
                             .cn = 0.4,
                             .ct = 0.1,
                             .cn_mass = -1.0,
                             .ct_mass = -1.0};
}

static const enum potential_kind kinds[] = {POTENTIAL_QUADRATIC, POTENTIAL_MORSE, POTENTIAL_LENNARD_JONES};

static double closed_force(const struct pair_law *law, double x)
{
    double alpha = law->shape / r0, depth = law->k / (2.0 * alpha * alpha), e = exp(-alpha * (x - r0));
    if (law->potential == POTENTIAL_QUADRATIC)
        return -law->k * (x - r0);
    if (law->potential == POTENTIAL_MORSE)
        return 2.0 * depth * alpha * (e * e - e);
    double eps = law->k * r0 * r0 / 72.0;
    return 12.0 * eps / x * (pow(r0 / x, 12.0) - pow(r0 / x, 6.0));
}

TEST(potentials_have_their_closed_forms)
{
    for (int p = 0; p < 3; p++) {
        struct pair_law law = law_of(kinds[p]);
        double u, scale = law.k * r0;
        for (double q = 0.7; q < 2.0; q += 0.0137)
            CHECK_NEAR(potential_force(&law, q * r0, r0, &u), closed_force(&law, q * r0),
                       1e-13 * (scale + fabs(closed_force(&law, q * r0))));
        CHECK_NEAR(potential_force(&law, r0, r0, &u), 0.0, 1e-15 * scale);
        CHECK_NEAR(u, 0.0, 1e-15 * scale * r0);
    }
}

TEST(force_is_the_slope_of_the_energy)
{
    for (int p = 0; p < 3; p++) {
        struct pair_law law = law_of(kinds[p]);
        double u[2], h = 1e-6 * r0;
        for (double q = 0.75; q < 1.8; q += 0.031) {
            double f = potential_force(&law, q * r0, r0, &u[0]);
            (void)potential_force(&law, q * r0 + h, r0, &u[1]);
            (void)potential_force(&law, q * r0 - h, r0, &u[0]);
            CHECK_NEAR(-(u[1] - u[0]) / (2.0 * h), f, 1e-8 * (law.k * r0 + fabs(f)));
        }
    }
}

/* Stiffness k at r0, whatever the potential. */
TEST(stiffness_at_contact)
{
    for (int p = 0; p < 3; p++) {
        struct pair_law law = law_of(kinds[p]);
        double u, h = 1e-6 * r0;
        double slope =
            (potential_force(&law, r0 + h, r0, &u) - potential_force(&law, r0 - h, r0, &u)) / (2.0 * h);
        CHECK_NEAR_REL(-slope, law.k, 1e-8);
    }
}

TEST(yield_lengths_carry_the_cap)
{
    for (int p = 0; p < 3; p++) {
        struct pair_law law = law_of(kinds[p]);
        double u, cap = 0.02 * law.k * r0;
        CHECK_NEAR_REL(potential_force(&law, law_yield_length(&law, r0, cap, true), r0, &u), -cap, 1e-12);
        CHECK_NEAR_REL(potential_force(&law, law_yield_length(&law, r0, cap, false), r0, &u), cap, 1e-12);
    }
    /* caps that no attraction reaches */
    struct pair_law morse = law_of(POTENTIAL_MORSE), lj = law_of(POTENTIAL_LENNARD_JONES);
    CHECK(isinf(law_yield_length(&morse, r0, 0.2501 * morse.k * r0 / morse.shape, true)));
    CHECK(isinf(law_yield_length(&lj, r0, 0.05 * lj.k * r0, true)));
}

static double uniform(void)
{
    static uint64_t state = 1;
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-53;
}

static struct pair_law swap_law(struct pair_law law)
{
    double y = law.yield_i, t = law.tensile_i;
    law.yield_i = law.yield_j;
    law.yield_j = y;
    law.tensile_i = law.tensile_j;
    law.tensile_j = t;
    return law;
}

#define SWAP(field)                                                                                          \
    do {                                                                                                     \
        double swap_kept = v.field##_i;                                                                      \
        v.field##_i = v.field##_j;                                                                           \
        v.field##_j = swap_kept;                                                                             \
    } while (0)

/* The pair as seen from the other element: n, t and the relative velocity change sign, so vn and vt stay. */
static struct pair_view swap_view(struct pair_view v)
{
    SWAP(radius);
    SWAP(w);
    SWAP(mass);
    SWAP(soft);
    SWAP(t);
    SWAP(p);
    bool held = v.held_i;
    v.held_i = v.held_j;
    v.held_j = held;
    return v;
}

/* A law that yields, damps by pressure and temperature, and conducts. */
static struct pair_law random_law(enum potential_kind potential)
{
    struct pair_law law = law_of(potential);
    law.tensile_i = 0.02 + 0.02 * uniform();
    law.tensile_j = 0.02 + 0.02 * uniform();
    law.yield_i = 0.02 * uniform();
    law.yield_j = 0.02 * uniform();
    law.a_p = uniform();
    law.a_t = 0.001 * uniform();
    law.t0_mean = 300.0;
    law.conduction = 0.1;
    return law;
}

static struct pair_view random_view(void)
{
    double ri = 0.015 + 0.01 * uniform(), rj = 0.015 + 0.01 * uniform();
    struct pair_view view = {.r = (ri + rj) * (0.85 + 0.5 * uniform()),
                             .radius_i = ri,
                             .radius_j = rj,
                             .vn = 0.1 * (uniform() - 0.5),
                             .vt = 0.1 * (uniform() - 0.5),
                             .w_i = uniform() - 0.5,
                             .w_j = uniform() - 0.5,
                             .mass_i = 0.01 * (1.0 + uniform()),
                             .mass_j = 0.01 * (1.0 + uniform()),
                             .soft_i = uniform(),
                             .soft_j = uniform(),
                             .t_i = 300.0 + 500.0 * uniform(),
                             .t_j = 300.0 + 500.0 * uniform(),
                             .p_i = uniform(),
                             .p_j = uniform()};
    static int count;
    view.over_r = 1.0 / view.r;
    view.held_i = ++count % 4 == 1;
    view.held_j = count % 5 == 1;
    view.walls = view.held_i && view.held_j && count % 8 == 1;
    return view;
}

static struct pair_state random_state(void)
{
    struct pair_state s = {.linked = uniform() < 0.6, .stretch = 0.0, .spring = 0.004 * (uniform() - 0.5)};
    if (s.linked && uniform() < 0.5)
        s.stretch = 0.1 * r0 * uniform();
    return s;
}

/* one: the effect of a pair; two: the effect of the exchanged pair. */
static void check_exchanged(const struct pair_effect *one, const struct pair_effect *two)
{
    CHECK_SAME_BITS(one->fn, two->fn);
    CHECK_SAME_BITS(one->ft, two->ft);
    CHECK_SAME_BITS(one->fdn, two->fdn);
    CHECK_SAME_BITS(one->fdt, two->fdt);
    CHECK_SAME_BITS(one->arm_i, two->arm_j);
    CHECK_SAME_BITS(one->arm_j, two->arm_i);
    CHECK_SAME_BITS(one->heat, two->heat);
    CHECK_SAME_BITS(one->heat_damped, two->heat_damped);
    CHECK_SAME_BITS(one->exchange + 0.0, -two->exchange + 0.0);
    CHECK_SAME_BITS(one->potential, two->potential);
    CHECK_SAME_BITS(one->elastic, two->elastic);
}

/* The most that the heat of one step may lie below 0: of a bond that ends or yields in this step, and of a
 * spring that would have swung through 0. */
static double overdue_heat(const struct pair_law *law, const struct pair_view *v, const struct pair_state *s,
                           double dt)
{
    double ri = v->radius_i, rj = v->radius_j, share = v->r / (ri + rj), u;
    double f = potential_force(law, v->r - s->stretch, ri + rj, &u);
    double vt = fabs(v->vt) + share * (fabs(v->w_i) * ri + fabs(v->w_j) * rj);
    return 0.5 * fabs(f * v->vn) * dt + law->kt_link * fabs(s->spring * vt) * dt;
}

TEST(exchange_changes_signs_alone)
{
    int yielded = 0, slid = 0, broken = 0, formed = 0;
    for (int k = 0; k < 30000; k++) {
        struct pair_law law = random_law(kinds[k % 3]), other = swap_law(law);
        struct pair_view view = random_view(), back = swap_view(view);
        struct pair_state start = random_state(), s = start, t = start;
        struct pair_effect one, two;
        pair_interact(&law, &view, 0.025, 0.025, &s, &one);
        pair_interact(&other, &back, 0.025, 0.025, &t, &two);
        CHECK(s.linked == t.linked);
        CHECK_SAME_BITS(s.stretch, t.stretch);
        CHECK_SAME_BITS(s.spring, t.spring);
        check_exchanged(&one, &two);
        yielded += s.linked && s.stretch != start.stretch;
        slid += one.heat > 0.0 && s.stretch == start.stretch && s.linked == start.linked;
        broken += start.linked && !s.linked;
        formed += !start.linked && s.linked;
        if (!s.linked)
            CHECK(one.fn >= 0.0); /* an unlinked contact never pulls */
        CHECK(one.heat_damped >= 0.0);
        CHECK(one.heat >= -overdue_heat(&law, &view, &start, 0.025));
    }
    CHECK(yielded > 1000 && slid > 1000 && broken > 300 && formed > 300);
}

/* A bond that is stretched beyond its strength holds the cap and keeps the stretch when the load is taken
 * off; the work done on the bond is the sum of its potential energy and the heat freed. */
TEST(tension_yield_is_a_return_map)
{
    for (int p = 0; p < 3; p++) {
        struct pair_law law = law_of(kinds[p]);
        law.tensile_i = 0.03;
        law.tensile_j = 0.05;
        law.cn = law.ct = law.kt_link = law.kt_contact = 0.0;
        double cap = 0.03 * 0.8 * r0 / sqrt(3.0), work = 0.0, heat = 0.0, before = 0.0;
        struct pair_state s = {.linked = true};
        struct pair_effect e = {0};
        int steps = 40000;
        for (int k = 0; k <= 2 * steps; k++) { /* stretched by 10 %, then compressed by 3 % */
            double x = k <= steps ? (double)k / steps : 2.3 - 1.3 * (double)k / steps;
            struct pair_view v = {.r = r0 * (1.0 + 0.1 * x),
                                  .over_r = 1.0 / (r0 * (1.0 + 0.1 * x)),
                                  .radius_i = 0.5 * r0,
                                  .radius_j = 0.5 * r0,
                                  .mass_i = 1.0,
                                  .mass_j = 1.0,
                                  .soft_i = 0.8,
                                  .soft_j = 0.9};
            pair_interact(&law, &v, 1.0, 1.0, &s, &e);
            if (k > 0)
                work -= 0.5 * (before + e.fn) * (k <= steps ? 0.1 * r0 / steps : -0.13 * r0 / steps);
            before = e.fn;
            heat += e.heat;
            CHECK(e.fn >= -cap * (1.0 + 1e-12));
            if (k == steps) {
                CHECK_NEAR_REL(e.fn, -cap, 1e-12);
                CHECK_NEAR(s.stretch, 1.1 * r0 - law_yield_length(&law, r0, cap, true), 1e-15);
            }
        }
        CHECK_SAME_BITS(s.stretch, 0.0); /* the void is closed: no stretched link pushes */
        CHECK_NEAR_REL(work, heat + e.potential, 1e-3);
    }
}

/* c_n = zeta 2 sqrt(k m_eff) (1 + a_p P + a_t (T - T0)), never below 0; an unlinked contact never pulls. */
TEST(damping_follows_pressure_and_temperature)
{
    static const double zeta = 0.1, k = 2.0, m_i = 0.3, m_j = 0.6, a_p = 0.7, a_t = 1e-3;
    struct pair_law law = {.potential = POTENTIAL_QUADRATIC,
                           .scope = SCOPE_LINKED,
                           .near = true,
                           .k = k,
                           .cn = zeta * 2.0 * sqrt(k),
                           .cn_mass = -1.0,
                           .ct_mass = -1.0,
                           .a_p = a_p,
                           .a_t = a_t,
                           .t0_mean = 300.0,
                           .yield_i = INFINITY,
                           .yield_j = INFINITY,
                           .tensile_i = INFINITY,
                           .tensile_j = INFINITY,
                           .link_break = 1.05};
    struct pair_view v = {.r = r0,
                          .over_r = 1.0 / r0,
                          .radius_i = 0.5 * r0,
                          .radius_j = 0.5 * r0,
                          .vn = -0.02,
                          .mass_i = m_i,
                          .mass_j = m_j,
                          .soft_i = 1.0,
                          .soft_j = 1.0,
                          .t_i = 500.0,
                          .t_j = 600.0,
                          .p_i = 0.1,
                          .p_j = 0.3};
    struct pair_state s = {.linked = true};
    struct pair_effect e;
    double plain = zeta * 2.0 * sqrt(k * (m_i * m_j / (m_i + m_j)));
    pair_interact(&law, &v, 1.0, 1.0, &s, &e);
    CHECK_NEAR_REL(e.fdn, 0.02 * plain * (1.0 + a_p * 0.2 + a_t * 250.0), 1e-14);
    CHECK_NEAR_REL(e.heat_damped, 0.02 * e.fdn, 1e-14);
    law.a_t = -0.1; /* a factor below 0 would add energy */
    pair_interact(&law, &v, 1.0, 1.0, &s, &e);
    CHECK_NEAR(e.fdn, 0.0, 0.0);
    law.a_t = a_t;
    v.vn = 0.02; /* separating: a link pulls, a contact does not */
    pair_interact(&law, &v, 1.0, 1.0, &s, &e);
    CHECK(e.fn < 0.0);
    s.linked = false;
    pair_interact(&law, &v, 1.0, 1.0, &s, &e);
    CHECK_NEAR(e.fn, 0.0, 0.0);
}

/* Q = kappa (A/r)(T_j - T_i) dt, A = r0/sqrt(3), in a link and in a contact; 0 for any other pair. */
TEST(conduction_is_fouriers)
{
    struct pair_law law = {.potential = POTENTIAL_QUADRATIC,
                           .scope = SCOPE_LINKED,
                           .near = true,
                           .k = 2.0,
                           .cn_mass = -1.0,
                           .ct_mass = -1.0,
                           .yield_i = INFINITY,
                           .yield_j = INFINITY,
                           .tensile_i = INFINITY,
                           .tensile_j = INFINITY,
                           .link_break = 1.05,
                           .conduction = 3e-11};
    for (int linked = 0; linked < 2; linked++) {
        for (int apart = 0; apart < 2; apart++) {
            double r = r0 * (apart ? 1.02 : 0.99);
            struct pair_view v = {.r = r,
                                  .over_r = 1.0 / r,
                                  .radius_i = 0.5 * r0,
                                  .radius_j = 0.5 * r0,
                                  .mass_i = 1.0,
                                  .mass_j = 1.0,
                                  .soft_i = 1.0,
                                  .soft_j = 1.0,
                                  .t_i = 300.0,
                                  .t_j = 700.0};
            struct pair_state s = {.linked = linked};
            struct pair_effect e;
            pair_interact(&law, &v, 0.5, 1.0, &s, &e);
            CHECK_NEAR(e.exchange, linked || !apart ? 3e-11 * (r0 / sqrt(3.0) / r) * 400.0 * 0.5 : 0.0,
                       1e-22);
        }
    }
}

/* A contact has a tolerance of 2^-26 of its r0; from r0 on its force and energy are 0. */
TEST(touching_ends_behind_the_repulsion)
{
    static const double beyond[] = {-1e-9, 0.0, 1e-9, 1.4e-8, 1.6e-8, 1e-6};
    for (int p = 0; p < 3; p++) {
        struct pair_law law = law_of(kinds[p]);
        law.cn = law.ct = 0.0;
        law.conduction = 1.0;
        for (int k = 0; k < 6; k++) {
            double r = r0 * (1.0 + beyond[k]);
            struct pair_view v = {.r = r,
                                  .over_r = 1.0 / r,
                                  .radius_i = 0.5 * r0,
                                  .radius_j = 0.5 * r0,
                                  .vt = 0.01,
                                  .mass_i = 1.0,
                                  .mass_j = 1.0,
                                  .t_j = 100.0};
            struct pair_state s = {.linked = false};
            struct pair_effect e;
            pair_interact(&law, &v, 1.0, 1.0, &s, &e);
            CHECK(e.contacting == (k < 4) && e.contacting == law_touches(r, r0));
            CHECK((e.exchange > 0.0) == (k < 4));
            CHECK((e.fn > 0.0) == (k == 0) && (e.potential > 0.0) == (k == 0) && (e.ft != 0.0) == (k == 0));
            s = (struct pair_state){.linked = true};
            pair_interact(&law, &v, 1.0, 1.0, &s, &e);
            CHECK(e.contacting == (k < 4) && e.exchange > 0.0 && s.linked);
            CHECK(k == 1 || (e.fn > 0.0) == (k == 0));
        }
        CHECK(!law_far_apart(law_touch_length(r0) * law_touch_length(r0), r0));
    }
}

/* Two elements of mass 1 in motion, and one change of their bond or more. */
struct book_case {
    const char *what;
    double strength, soft_later, forms, kt_link, kt_contact, mu; /* soft_later: from time 1 on */
    bool linked;
    double r, vn, vt, w; /* at the start: distance in r0, velocities in r0 per unit of time */
};

/* One step of the pair: forces, half a kick, the total energy, the rest of the kick, drift. d, u: relative
 * position and velocity; w: sum of the spins. Adds to *heat; returns the total. */
static double step_pair(const struct pair_law *law, double soft, double dt, bool first, double d[2],
                        double u[2], double *w, struct pair_state *s, double *heat)
{
    double r = sqrt(d[0] * d[0] + d[1] * d[1]), n[2] = {d[0] / r, d[1] / r}, radius = 0.5 * r0;
    struct pair_view v = {.r = r,
                          .over_r = 1.0 / r,
                          .radius_i = radius,
                          .radius_j = radius,
                          .vn = u[0] * n[0] + u[1] * n[1],
                          .vt = u[1] * n[0] - u[0] * n[1],
                          .w_i = 0.5 * *w,
                          .w_j = 0.5 * *w,
                          .mass_i = 1.0,
                          .mass_j = 1.0,
                          .soft_i = soft,
                          .soft_j = soft};
    struct pair_effect e;
    double kick = first ? 0.5 * dt : dt, half = first ? 0.0 : 0.5 * dt, inertia = 0.5 * radius * radius;
    pair_interact(law, &v, kick, first ? 0.0 : dt, s, &e);
    double f[2] = {e.fn * n[0] - e.ft * n[1], e.fn * n[1] + e.ft * n[0]};
    double turn = -2.0 * e.arm_i * e.ft / inertia, total = e.potential + e.elastic;
    for (int a = 0; a < 2; a++) {
        double whole = u[a] + 2.0 * f[a] * half;
        total += 0.25 * whole * whole;
        u[a] += 2.0 * f[a] * kick;
        d[a] += u[a] * dt;
    }
    total += 0.25 * inertia * (*w + turn * half) * (*w + turn * half);
    *w += turn * kick;
    *heat += e.heat;
    return total + *heat;
}

/* The largest change of the total, as a share of its first value, in 6 units of time. *changes: steps in
 * which the link or stretch of the pair changes, or its spring ends. */
static double find_book_error(const struct book_case *c, enum potential_kind potential, double dt,
                              int *changes)
{
    struct pair_law law = law_of(potential);
    law.cn = law.ct = 0.0;
    law.k = 2.0;
    law.link_break = 1.1;
    law.link_form = c->forms;
    law.kt_link = c->kt_link;
    law.kt_contact = c->kt_contact;
    law.mu = c->mu;
    law.tensile_i = law.tensile_j = c->strength > 0.0 ? c->strength : INFINITY;
    struct pair_state s = {.linked = c->linked};
    double d[2] = {c->r * r0, 0.0}, u[2] = {c->vn * r0, c->vt * r0}, w = c->w, heat = 0.0, start = 0.0,
           worst = 0.0;
    *changes = 0;
    for (int k = 0; k * dt < 6.0; k++) {
        struct pair_state before = s;
        double total = step_pair(&law, k * dt < 1.0 ? 1.0 : c->soft_later, dt, k == 0, d, u, &w, &s, &heat);
        start = k == 0 ? total : start;
        worst = fmax(worst, fabs(total / start - 1.0));
        *changes += before.linked != s.linked || before.stretch != s.stretch ||
                    (before.spring != 0.0 && s.spring == 0.0);
    }
    return worst;
}

/* The total of a pair is constant, to second order in the step, through every change of its bond. */
TEST(the_energy_book_closes_through_every_change)
{
    static const struct book_case cases[] = {
        {"break", 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, true, 1.0, 0.4, 0.0, 0.0},
        {"break with a spring", 0.0, 1.0, 0.0, 0.6, 0.6, 0.0, true, 1.0, 0.4, 0.1, 0.05},
        {"yield, and the void closes", 0.03, 1.0, 0.0, 0.0, 0.0, 0.0, true, 1.0, 0.12, 0.0, 0.0},
        {"softening", 0.06, 0.3, 0.0, 0.0, 0.0, 0.0, true, 1.0, 0.1, 0.0, 0.0},
        {"contact that slides, then ends", 0.0, 1.0, 0.0, 0.5, 0.5, 0.3, false, 1.05, -0.2, 0.1, 0.02},
        {"contact that sticks, then ends", 0.0, 1.0, 0.0, 0.5, 0.5, 9.0, false, 1.05, -0.2, 0.02, 0.0},
        {"link that forms, with softer springs", 0.0, 1.0, 0.97, 0.2, 0.6, 9.0, false, 1.05, -0.2, 0.03,
         0.0}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        for (int p = 0; p < 3; p++) {
            double error[3];
            int changes[3];
            for (int h = 0; h < 3; h++)
                error[h] = find_book_error(&cases[k], kinds[p], 0.04 / (1 << 2 * h), &changes[h]);
            printf("%s: off by %.2g, %.2g, %.2g of the total at dt, dt/4, dt/16; %d changes\n", cases[k].what,
                   error[0], error[1], error[2], changes[2]);
            CHECK(changes[2] > 0);
            CHECK_REPORT(error[1] < 1e-3 && error[2] < error[0] / 30.0, "%s: the book is off by %g",
                         cases[k].what, error[2]);
        }
    }
}

TEST_MAIN(CASE(the_energy_book_closes_through_every_change), CASE(touching_ends_behind_the_repulsion),
          CASE(damping_follows_pressure_and_temperature), CASE(conduction_is_fouriers),
          CASE(potentials_have_their_closed_forms), CASE(force_is_the_slope_of_the_energy),
          CASE(stiffness_at_contact), CASE(yield_lengths_carry_the_cap), CASE(exchange_changes_signs_alone),
          CASE(tension_yield_is_a_return_map))
