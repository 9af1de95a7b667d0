/* The equation of a body under a force, against the cubic of its difference equation, its stability limits,
 * its overshoot, and free motion. */
#include "check.h"
#include "engine/force_control.h"

static const double k = 0.7, m = 3.0;

/* A body of omega dt = w on one contact, without an offset. */
static struct control_constants on_spring(double w, double zeta)
{
    return (struct control_constants){.dt = w * sqrt(m / k),
                                      .mass = m,
                                      .stiffness = k,
                                      .zeta = zeta,
                                      .fastest = INFINITY,
                                      .reset = INFINITY};
}

/* A kick and a drift. */
static void step(const struct control_constants *c, double load, double weight,
                 const struct control_response *r, struct control_state *s)
{
    control_kick(c, load, weight, r, s);
    control_drift(c, s);
}

enum { STEPS = 4000 };

/* x[n], cm: from rest at x[0] under the constant load P, pushed back by k x of two steps before. */
static void let_go(const struct control_constants *c, double load, double start, double *x)
{
    struct control_state s = {.shift = start};
    x[0] = start;
    for (int n = 0; n + 1 < STEPS; n++) {
        struct control_response r = {.force = -k * x[n < 2 ? 0 : n - 2], .contacts = 1.0};
        step(c, load, 0.0, &r, &s);
        x[n + 1] = s.shift;
    }
}

/* z^3 - (2 - g) z^2 + (1 - g) z + a = 0, a = (omega dt)^2, g = c dt/M. */
TEST(motion_follows_the_cubic)
{
    static double x[STEPS];
    for (double w = 0.05; w < 0.65; w += 0.1) {
        struct control_constants c = on_spring(w, 0.7);
        double a = w * w, g = control_damping(&c, 1.0) * c.dt / m;
        CHECK_NEAR_REL(g, 2.0 * (0.7 + w) * w, 1e-14);
        let_go(&c, 0.0, 1.0, x);
        for (int n = 2; n < 100; n++)
            CHECK_NEAR(x[n + 1], (2.0 - g) * x[n] - (1.0 - g) * x[n - 1] - a * x[n - 2], 1e-14);
    }
}

static double largest_late(const double *x)
{
    double most = 0.0;
    for (int n = STEPS - 500; n < STEPS; n++)
        most = fmax(most, fabs(x[n]));
    return most;
}

/* Stable where g > a (2 + a)/(1 + a) and 4 - 2 g - a > 0. */
TEST(limits_of_stability)
{
    static double x[STEPS];
    for (double w = 0.1; w < 0.65; w += 0.1) {
        double a = w * w, low = a * (2.0 + a) / (1.0 + a), high = 0.5 * (4.0 - a);
        for (int side = -1; side <= 1; side += 2) {
            struct control_constants c = on_spring(w, 0.5 * low * (1.0 + 0.05 * side) / w - w);
            let_go(&c, 0.0, 1.0, x);
            CHECK(side < 0 ? largest_late(x) > 1.0 : largest_late(x) < 1.0);
            c = on_spring(w, 0.5 * high * (1.0 - 0.02 * side) / w - w);
            let_go(&c, 0.0, 1.0, x);
            CHECK(side < 0 ? !(largest_late(x) < 1.0) : largest_late(x) < 1e-3);
        }
    }
}

/* Zeta 0.7 overshoots by 3.8 % at omega dt 0.1 and by 2.9 % at 0.3. */
TEST(overshoot_of_a_step)
{
    static double x[STEPS];
    const double expected[2] = {0.038, 0.029};
    for (int i = 0; i < 2; i++) {
        struct control_constants c = on_spring(i == 0 ? 0.1 : 0.3, 0.7);
        let_go(&c, k, 0.0, x);
        double most = 0.0;
        for (int n = 0; n < STEPS; n++)
            most = fmax(most, x[n]);
        CHECK_NEAR(most - 1.0, expected[i], 5e-4);
        CHECK_NEAR(x[STEPS - 1], 1.0, 1e-12);
    }
}

/* F t^2/2M, to the rounding of its sum: velocities are those of half steps. */
TEST(free_motion)
{
    struct control_constants c = on_spring(0.1, 0.7);
    struct control_state s = {.shift = 0.0};
    const struct control_response nothing = {.force = 0.0};
    const double load = 0.02, weight = -0.005;
    int n = 10000;
    for (int i = 0; i < n; i++) {
        s.velocity = i == 0 ? 0.5 * (load + weight) / m * c.dt - (load + weight) / m * c.dt : s.velocity;
        step(&c, load, weight, &nothing, &s);
    }
    double t = n * c.dt;
    CHECK_NEAR_REL(s.shift, (load + weight) * t * t / (2.0 * m), 1e-12);
    CHECK(s.offset == 0.0);
    c.fastest = 1e-3;
    s = (struct control_state){.shift = 0.0};
    for (int i = 0; i < n; i++)
        step(&c, -load, 0.0, &nothing, &s);
    CHECK_SAME_BITS(s.velocity, -1e-3);
}

/* The offset integrates what the contacts lack, within 3 % of the load, and only where there are contacts. */
TEST(offset_of_the_force)
{
    struct control_constants c = on_spring(0.1, 0.7);
    c.reset = 100.0 * c.dt;
    c.fastest = 0.0;
    struct control_state s = {.shift = 0.0};
    struct control_response r = {.force = 0.9, .contacts = 4.0};
    for (int i = 0; i < 10; i++)
        step(&c, -1.0, 0.0, &r, &s);
    CHECK_NEAR_REL(s.offset, -10.0 * 0.1 / 100.0, 1e-13);
    for (int i = 0; i < 100; i++)
        step(&c, -1.0, 0.0, &r, &s);
    CHECK_SAME_BITS(s.offset, -0.03);
    r = (struct control_response){.force = 0.0};
    step(&c, 1.0, 0.0, &r, &s);
    CHECK_SAME_BITS(s.offset, -0.03);
}

/* On ground that recedes at the speed u the body follows at 0.9 u where the force is as asked. */
TEST(body_follows_its_ground)
{
    struct control_constants c = on_spring(0.2, 0.7);
    struct control_state s = {.shift = 0.0};
    struct control_response r = {.force = 1.0, .speed = -0.01, .contacts = 5.0};
    for (int i = 0; i < 1000; i++)
        step(&c, -1.0, 0.0, &r, &s);
    CHECK_NEAR_REL(s.velocity, -0.009, 1e-12);
}

TEST_MAIN(CASE(motion_follows_the_cubic), CASE(limits_of_stability), CASE(overshoot_of_a_step),
          CASE(free_motion), CASE(offset_of_the_force), CASE(body_follows_its_ground))
