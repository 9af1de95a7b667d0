/* The restitution that zeta means, over the moments at which an impact begins between two steps: the damping
 * of contacts is right to second order in the time step (docs/physics.md, section 5), and against something
 * held it is the damping of the mass that moves. */
#include "check.h"

#include "engine/law.h"

enum { MOMENTS = 24 };

static const double r0 = 0.04, mass = 0.03, k = 1.3;

static struct pair_law contact_law(double zeta, double ct_ratio)
{
    return (struct pair_law){.potential = POTENTIAL_QUADRATIC,
                             .scope = SCOPE_LINKED,
                             .near = true,
                             .tangential = ct_ratio > 0.0,
                             .k = k,
                             .link_break = 1.3,
                             .mu = 1e6,
                             .yield_i = INFINITY,
                             .yield_j = INFINITY,
                             .tensile_i = INFINITY,
                             .tensile_j = INFINITY,
                             .cn = zeta * 2.0 * sqrt(k),
                             .ct = ct_ratio * 2.0 * sqrt(k),
                             .cn_mass = -1.0,
                             .ct_mass = -1.0};
}

/* The limit of the time step of six neighbours of this law, us (docs/physics.md, section 7). */
static double stable_step(double zeta)
{
    double o = 6.0 * k / mass, g = 6.0 * zeta * 2.0 * sqrt(k * mass / 2.0) / mass;
    return (sqrt(g * g + 4.0 * o) - g) / o;
}

/* The restitution of m x'' = -k x - c x' that never pulls (Schwager and Poeschel, Granular Matter 9 (2007)
 * 465). */
static double exact_restitution(double zeta)
{
    double root = sqrt(1.0 - zeta * zeta);
    return exp(-zeta / root * (3.14159265358979324 - atan(2.0 * zeta * root / (1.0 - 2.0 * zeta * zeta))));
}

/* Speed after over speed before of two elements that meet head on, `moment` steps (0 to 1) after a step. */
static double bounce(double zeta, double dt, double moment, bool held, double wall_mass)
{
    const struct pair_law law = contact_law(zeta, 0.0);
    struct pair_state state = {.linked = false};
    double start = -1e-4, v = start, moving = held ? mass : 0.5 * mass, r = r0 - start * dt * (1.0 + moment);
    for (int step = 0; step < 1000 && (step < 4 || r < r0 || v < 0.0); step++) {
        struct pair_view view = {.r = r,
                                 .over_r = 1.0 / r,
                                 .radius_i = 0.5 * r0,
                                 .radius_j = 0.5 * r0,
                                 .vn = v,
                                 .mass_i = mass,
                                 .mass_j = held ? wall_mass : mass,
                                 .soft_i = 1.0,
                                 .soft_j = 1.0,
                                 .held_j = held};
        struct pair_effect effect;
        pair_interact(&law, &view, dt, dt, &state, &effect);
        v += effect.fn / moving * dt;
        r += v * dt;
    }
    return -v / start;
}

/* Greatest and least deviation from the exact restitution over the moments, and the mean deviation. */
static void deviate(double zeta, double share, double *least, double *most, double *mean)
{
    double exact = exact_restitution(zeta), dt = share * stable_step(zeta);
    *least = INFINITY;
    *most = -INFINITY;
    *mean = 0.0;
    for (int i = 0; i < MOMENTS; i++) {
        double off = bounce(zeta, dt, (i + 0.5) / MOMENTS, false, mass) / exact - 1.0;
        *least = off < *least ? off : *least;
        *most = off > *most ? off : *most;
        *mean += off / MOMENTS;
    }
    printf("zeta %g, dt %g of the limit: %+.2f to %+.2f %%, mean %+.2f %%\n", zeta, share, 100.0 * *least,
           100.0 * *most, 100.0 * *mean);
}

TEST(restitution_over_the_moments_of_touching)
{
    static const struct {
        double zeta, share, each, mean;
    } bound[] = {{0.3, 0.8, 0.10, 0.03},  {0.3, 0.4, 0.01, 0.01},   {0.3, 0.2, 0.005, 0.005},
                 {0.3, 0.05, 5e-4, 5e-4}, {0.1, 0.4, 0.024, 0.024}, {0.1, 0.2, 0.005, 0.005}};
    for (size_t b = 0; b < sizeof bound / sizeof *bound; b++) {
        double least, most, mean;
        deviate(bound[b].zeta, bound[b].share, &least, &most, &mean);
        CHECK(fabs(mean) <= bound[b].mean);
        CHECK(least >= -bound[b].each && most <= bound[b].each);
    }
}

TEST(restitution_against_something_held)
{
    double exact = exact_restitution(0.3), dt = 0.1 * stable_step(0.3);
    for (double heavy = 1e-6; heavy < 1e7; heavy *= 10.0) {
        CHECK_NEAR_REL(bounce(0.3, dt, 0.5, true, heavy * mass), exact, 2e-3);
        CHECK_SAME_BITS(bounce(0.3, dt, 0.5, true, heavy * mass), bounce(0.3, dt, 0.5, true, mass));
    }
}

/* Two neighbours of an unstrained lattice touch before they approach each other, whether a rounding put them
 * inside of the contact distance or beyond it: nothing is left out of their first force, nothing is added. */
TEST(neighbours_at_the_contact_distance_have_touched_before)
{
    static const double beyond[] = {-1e-9, -1e-15, 0.0, 1e-15, 1e-9};
    const struct pair_law law = contact_law(0.3, 0.0);
    double dt = 0.4 * stable_step(0.3), v = -1e-4, c = law.cn * sqrt(0.5 * mass);
    for (int i = 0; i < 5; i++) {
        double r = r0 * (1.0 + beyond[i]) + v * dt;
        struct pair_view view = {.r = r,
                                 .over_r = 1.0 / r,
                                 .radius_i = 0.5 * r0,
                                 .radius_j = 0.5 * r0,
                                 .vn = v,
                                 .mass_i = mass,
                                 .mass_j = mass,
                                 .soft_i = 1.0,
                                 .soft_j = 1.0};
        struct pair_state state = {.linked = false};
        struct pair_effect effect;
        pair_interact(&law, &view, dt, dt, &state, &effect);
        CHECK_NEAR_REL(effect.fdn, -c * v / (1.0 + 0.25 * c * dt / (0.5 * mass)), 1e-12);
    }
}

TEST_MAIN(CASE(restitution_over_the_moments_of_touching), CASE(restitution_against_something_held),
          CASE(neighbours_at_the_contact_distance_have_touched_before))
