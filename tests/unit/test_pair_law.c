/* The whole law of a pair against the equations of docs/physics.md, written out here anew, for pairs near
 * each of its thresholds: the tests of the parts of the law would not notice a part that is joined to another
 * wrongly. */
#include "check.h"

#include "engine/law.h"

static double uniform(void)
{
    static uint64_t state = 7;
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (double)(state >> 11) * 0x1p-53;
}

static double between(double low, double high)
{
    return low + (high - low) * uniform();
}

static bool chance(double p)
{
    return uniform() < p;
}

/* --- the equations --- */

/* Section 3: force and energy of a bond of length x. */
static double potential(const struct pair_law *law, double r0, double x, double *u)
{
    if (law->potential == POTENTIAL_QUADRATIC) {
        *u = law->k * (x - r0) * (x - r0) / 2.0;
        return -law->k * (x - r0);
    }
    if (law->potential == POTENTIAL_MORSE) {
        double alpha = law->shape / r0, d = law->k / (2.0 * alpha * alpha), e = exp(-alpha * (x - r0));
        *u = d * (1.0 - e) * (1.0 - e);
        return 2.0 * d * alpha * (e * e - e);
    }
    double eps = law->k * r0 * r0 / 72.0;
    *u = eps * pow(pow(r0 / x, 6.0) - 1.0, 2.0);
    return 12.0 * eps / x * (pow(r0 / x, 12.0) - pow(r0 / x, 6.0));
}

static double peak_of(const struct pair_law *law, double r0)
{
    return law->potential == POTENTIAL_QUADRATIC ? INFINITY
           : law->potential == POTENTIAL_MORSE   ? r0 * (1.0 + log(2.0) / law->shape)
                                                 : r0 * pow(13.0 / 7.0, 1.0 / 6.0);
}

/* Section 4: the length at which a bond carries `cap`, by bisection. */
static double yield_length(const struct pair_law *law, double r0, double cap, bool tension)
{
    double u, near = r0, far = tension ? fmin(peak_of(law, r0), 1e3 * r0) : 0.25 * r0;
    if (tension && -potential(law, r0, far, &u) <= cap)
        return INFINITY;
    if (!tension && potential(law, r0, far, &u) <= cap)
        return law->potential == POTENTIAL_QUADRATIC ? r0 - cap / law->k : 0.0;
    for (int k = 0; k < 200; k++) {
        double middle = 0.5 * (near + far);
        if (fabs(potential(law, r0, middle, &u)) < cap)
            near = middle;
        else
            far = middle;
    }
    return 0.5 * (near + far);
}

/* The strength of two sides, of which one without limit has none when it is molten, too. */
static double weaker(double limit_i, double soft_i, double limit_j, double soft_j)
{
    double i = isinf(limit_i) ? INFINITY : limit_i * soft_i, j = isinf(limit_j) ? INFINITY : limit_j * soft_j;
    return i < j ? i : j;
}

/* v_t of the contact points, section 6. */
static double sliding(const struct pair_view *p)
{
    double share = p->r / (p->radius_i + p->radius_j);
    return p->vt - p->w_i * share * p->radius_i - p->w_j * share * p->radius_j;
}

/* Section 7: what a bond, and a spring, free that end. */
static double bond_ends(double u, double f, double vn, double dt)
{
    return u + f * vn * dt / 2.0;
}

static double spring_ends(double kt, double s, double vt, double dt)
{
    return kt * s * (s + vt * dt) / 2.0;
}

/* Section 2. False: no force. */
static bool settle(const struct pair_law *law, const struct pair_view *p, double dt, struct pair_state *s,
                   struct pair_effect *out)
{
    double r0 = p->radius_i + p->radius_j, vt = sliding(p), u = 0.0, f = 0.0;
    if (s->linked && p->r > law->link_break * r0) {
        if (law->scope == SCOPE_LINKED)
            f = potential(law, r0, p->r - s->stretch, &u);
        out->heat += bond_ends(u, f, p->vn, dt) + spring_ends(law->kt_link, s->spring, vt, dt);
        *s = (struct pair_state){.linked = false};
    } else if (!s->linked && p->r <= law->link_form * r0) {
        if (law->kt_link < law->kt_contact || law->kt_link > law->kt_contact) {
            out->heat += spring_ends(law->kt_contact, s->spring, vt, dt);
            s->spring = 0.0;
        }
        *s = (struct pair_state){.linked = true, .spring = s->spring};
    }
    if (s->linked || out->contacting)
        return true;
    out->heat += spring_ends(law->kt_contact, s->spring, vt, dt);
    s->spring = 0.0;
    return false;
}

/* Sections 3 and 4: the central force with its return map. */
static double central(const struct pair_law *law, const struct pair_view *p, double dt, struct pair_state *s,
                      struct pair_effect *out)
{
    double r0 = p->radius_i + p->radius_j, u = 0.0;
    if (law->scope == SCOPE_ALL || (!s->linked && p->r >= r0))
        return 0.0;
    double f = potential(law, r0, p->r - s->stretch, &u), old = s->stretch;
    double cap = weaker(law->tensile_i, p->soft_i, law->tensile_j, p->soft_j) * r0 / sqrt(3.0);
    if (s->linked && cap < INFINITY) {
        double pull = yield_length(law, r0, cap, true), push = yield_length(law, r0, cap, false);
        if (p->r - old > pull)
            s->stretch = p->r - pull;
        else if (old > 0.0 && p->r - old < push)
            s->stretch = fmax(p->r - push, 0.0);
        double held = u, pulled = f;
        f = potential(law, r0, p->r - s->stretch, &u);
        if (s->stretch < old || s->stretch > old)
            out->heat += held - u + (pulled - f) * p->vn * dt / 2.0;
    }
    out->potential = u;
    return f;
}

static double effective_mass(const struct pair_view *p, bool linked)
{
    if (!linked && p->held_i != p->held_j)
        return p->held_i ? p->mass_j : p->mass_i;
    return 1.0 / (1.0 / p->mass_i + 1.0 / p->mass_j);
}

static void interact(const struct pair_law *law, const struct pair_view *p, double dt_kick, double dt,
                     struct pair_state *s, struct pair_effect *out)
{
    double r0 = p->radius_i + p->radius_j, touch = r0 * (1.0 + 0x1p-26), vt = sliding(p);
    *out = (struct pair_effect){.contacting = p->r <= touch};
    bool acts = settle(law, p, dt, s, out);
    if (p->walls)
        out->heat = 0.0;
    if (!acts)
        return;
    out->exchange = law->conduction * (r0 / sqrt(3.0)) / p->r * (p->t_j - p->t_i) * dt_kick;
    if (p->walls)
        return;
    /* Section 5. */
    double f = central(law, p, dt, s, out), m = effective_mass(p, s->linked);
    double change =
        1.0 + law->a_p * (p->p_i + p->p_j) / 2.0 + law->a_t * ((p->t_i + p->t_j) / 2.0 - law->t0_mean);
    double cn = law->cn * sqrt(m) * fmax(change, 0.0), ct = law->ct * sqrt(m);
    out->fdn = -cn * p->vn;
    if (!s->linked) {
        double path = -p->vn * dt, depth = touch - p->r;
        out->fdn *= (path > 0.0 && depth < path ? 0.5 + depth / path : 1.0) / (1.0 + cn * dt / (4.0 * m));
        out->fdn = fmax(out->fdn, -f); /* never pulls */
    }
    out->fn = f + out->fdn;
    out->heat_damped = -out->fdn * p->vn * dt_kick;
    if (!law->tangential)
        return;
    /* Section 6. */
    double kt = s->linked ? law->kt_link : law->kt_contact, spring = s->spring + vt * dt;
    double cap = s->linked ? weaker(law->yield_i, p->soft_i, law->yield_j, p->soft_j) * r0 / sqrt(3.0)
                           : law->mu * out->fn;
    if (kt * fabs(spring) > cap) {
        double held = copysign(cap / kt, spring);
        out->heat += kt * (s->spring + held) / 2.0 * (spring - held);
        spring = held;
    }
    s->spring = spring;
    out->fdt = -ct * vt;
    if (!s->linked)
        out->fdt = fmin(fmax(out->fdt, -cap + kt * spring), cap + kt * spring);
    out->ft = -kt * spring + out->fdt;
    out->elastic = kt * spring * spring / 2.0;
    out->heat_damped -= out->fdt * vt * dt_kick;
    out->arm_i = p->r / r0 * p->radius_i;
    out->arm_j = p->r / r0 * p->radius_j;
}

/* --- pairs --- */

static struct pair_law some_law(bool uniform_kinds, double ri, double rj, double m_eff)
{
    struct pair_law law = {.potential = (enum potential_kind)(int)between(0.0, 2.9999),
                           .scope = chance(0.9) ? SCOPE_LINKED : SCOPE_ALL,
                           .near = true,
                           .k = between(0.5, 2.0),
                           .shape = between(2.0, 5.0),
                           .cn = chance(0.8) ? between(0.02, 0.6) : 0.0,
                           .ct = chance(0.6) ? between(0.02, 0.3) : 0.0,
                           .a_p = between(-1.0, 1.0),
                           .a_t = between(-0.004, 0.004),
                           .t0_mean = between(200.0, 400.0),
                           .kt_link = chance(0.7) ? between(0.1, 0.8) : 0.0,
                           .mu = chance(0.7) ? between(0.1, 0.9) : 0.0,
                           .yield_i = chance(0.3) ? INFINITY : between(0.002, 0.05),
                           .yield_j = chance(0.3) ? INFINITY : between(0.002, 0.05),
                           .tensile_i = chance(0.3) ? INFINITY : between(0.005, 0.3),
                           .tensile_j = chance(0.3) ? INFINITY : between(0.005, 0.3),
                           .link_form = chance(0.5) ? between(0.9, 0.99) : 0.0,
                           .link_break = between(1.03, 1.4),
                           .conduction = chance(0.5) ? 0.1 : 0.0,
                           .cn_mass = -1.0,
                           .ct_mass = -1.0};
    law.kt_contact = chance(0.5) ? law.kt_link : law.kt_link + between(0.1, 0.3);
    law.tangential = law.kt_contact > 0.0 || law.ct > 0.0;
    if (uniform_kinds) {
        law.cn_mass = law.cn * sqrt(m_eff);
        law.ct_mass = law.ct * sqrt(m_eff);
        law.bond = law_bond(&law, ri + rj);
    }
    return law;
}

/* A length within 3 % of one of the thresholds of the law. */
static double some_length(const struct pair_law *law, double r0, double stretch)
{
    const double at[] = {1.0, law->link_form, law->link_break, peak_of(law, r0) / r0 + stretch / r0,
                         between(0.8, 1.5)};
    double chosen = at[(int)between(0.0, 4.9999)];
    return r0 * (chosen > 0.5 && chosen < 2.0 ? chosen : 1.0) * between(0.97, 1.03);
}

static struct pair_view some_view(double ri, double rj)
{
    struct pair_view p = {.radius_i = ri,
                          .radius_j = rj,
                          .vn = between(-0.1, 0.1),
                          .vt = between(-0.1, 0.1),
                          .w_i = between(-1.0, 1.0),
                          .w_j = between(-1.0, 1.0),
                          .mass_i = between(0.01, 0.02),
                          .mass_j = between(0.01, 0.02),
                          .soft_i = chance(0.2) ? 0.0 : uniform(),
                          .soft_j = chance(0.2) ? 1.0 : uniform(),
                          .t_i = between(100.0, 900.0),
                          .t_j = between(100.0, 900.0),
                          .p_i = between(-1.0, 1.0),
                          .p_j = between(-1.0, 1.0),
                          .held_i = chance(0.2),
                          .held_j = chance(0.2)};
    p.walls = p.held_i && p.held_j && chance(0.5);
    return p;
}

#define NEAR(field, scale) CHECK_NEAR(got.field, want.field, 2e-11 * (scale))

TEST(the_law_is_its_equations)
{
    for (int n = 0; n < 30000; n++) {
        double ri = between(0.015, 0.025), rj = between(0.015, 0.025), r0 = ri + rj;
        struct pair_view p = some_view(ri, rj);
        struct pair_law law = some_law(n % 2 == 0, ri, rj, p.mass_i * p.mass_j / (p.mass_i + p.mass_j));
        struct pair_state s = {.linked = chance(0.6), .spring = chance(0.7) ? between(-0.003, 0.003) : 0.0},
                          t;
        s.stretch = s.linked && chance(0.5) ? between(0.0, 0.1) * r0 : 0.0;
        p.r = some_length(&law, r0, s.stretch);
        p.over_r = 1.0 / p.r;
        double dt = chance(0.1) ? 0.0 : between(0.001, 0.02), kick = between(0.5, 1.0) * 0.02;
        struct pair_effect got, want;
        t = s;
        pair_interact(&law, &p, kick, dt, &s, &got);
        interact(&law, &p, kick, dt, &t, &want);
        double force = fabs(want.fn) + law.k * r0, energy = force * r0;
        CHECK(got.contacting == want.contacting && s.linked == t.linked);
        CHECK_NEAR(s.stretch, t.stretch, 1e-11 * r0);
        CHECK_NEAR(s.spring, t.spring, 1e-11 * r0);
        NEAR(fn, force);
        NEAR(fdn, force);
        NEAR(heat, energy);
        NEAR(heat_damped, energy);
        NEAR(exchange, 1.0);
        NEAR(potential, energy);
        NEAR(ft, force);
        NEAR(fdt, force);
        NEAR(elastic, energy);
        if (law.tangential && want.arm_i > 0.0) {
            NEAR(arm_i, r0);
            NEAR(arm_j, r0);
        }
        if (check_failures > 20)
            return;
    }
}

TEST(touching_has_its_tolerance)
{
    CHECK_SAME_BITS(law_touch_length(1.0), 1.0 + 0x1p-26);
    CHECK(law_touches(0x1.0000004p0, 1.0) && !law_touches(0x1.00000041p0, 1.0));
    CHECK(law_far_apart(1.03, 1.0) && !law_far_apart(law_touch_length(1.0) * law_touch_length(1.0), 1.0));
    struct pair_law law = {.k = 1.0, .link_break = 1.25, .link_form = 0.75};
    struct bond b = law_bond(&law, 2.0);
    CHECK_SAME_BITS(b.touch, 2.0 + 0x1p-25);
    CHECK_SAME_BITS(b.breaks, 1.25 * (2.0 + 0x1p-25));
    CHECK_SAME_BITS(b.forms, 1.5);
    CHECK_SAME_BITS(law_lesser(1.0, 1.01), 1.0);
    CHECK_SAME_BITS(law_lesser(1.01, 1.0), 1.0);
    CHECK_SAME_BITS(law_weaker(1.01, 1.0), 1.0);
    CHECK_SAME_BITS(law_weaker((double)NAN, 1.0), 1.0);
    CHECK_SAME_BITS(law_weaker(1.0, (double)NAN), 1.0);
}

TEST_MAIN(CASE(the_law_is_its_equations), CASE(touching_has_its_tolerance))
