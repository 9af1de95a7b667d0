/* A disc that is set spinning on a plane slides, then rolls, at a speed that friction does not enter. */
#include "engine_help.h"

/* The spin is clockwise so that friction drives the disc along +x. About the foot the angular momentum stays:
 * m v R + m R^2/2 (v/R) = m R^2/2 omega, so v = omega R/3, after omega R/(3 mu g). The foot is nearer to the
 * centre than R by m g/k. */
static void roll(double mu, const char *plane, double speed[2], double *rim)
{
    const double g = 1e-4, R = 0.5, omega = 0.02, dt = 0.1, slides = omega * R / (3.0 * mu * g);
    char text[1000];
    snprintf(text, sizeof text,
             "domain { size = 20 4; r_c = 1.1; delta_r = 0.2; gravity = 0 %.17g }\n"
             "time { dt = %.17g; steps = 100000 }\n"
             "material a { mass = 1 }\n"
             "interaction { potential = quadratic; k = 1; linked = no; zeta = 0.5; kt_ratio = 0.5\n"
             "              ct_ratio = 0.2; mu = %.17g }\n"
             "body disc { shape = rectangle 1.9 1 2.1 2; lattice = square; spacing = 1; origin = 2 %.17g\n"
             "            radius = 0.5; material = a; spin = %.17g }\n"
             "%s\n",
             -g, dt, mu, 1.0 + R - g, -omega, plane);
    struct engine e;
    engine_start(&e, text, NULL, 1);
    for (int k = 0; k < 2; k++) {
        engine_run(&e, (int)((k == 0 ? 0.5 : 1.0) * slides / dt) + 500 * k);
        struct engine_state state = engine_collect(&e, false);
        speed[k] = state.e[0].v[0];
        *rim = -state.e[0].w * R;
        engine_state_free(&state);
    }
    engine_stop(&e);
}

TEST(a_spinning_disc_ends_rolling)
{
    static const double mu[] = {0.05, 0.2, 0.8};
    for (int k = 0; k < 3; k++) {
        double v[2], rim, rolling = 0.02 * 0.5 / 3.0;
        roll(mu[k], "wall floor { line = 0 1 20 1; material = a }", v, &rim);
        CHECK_NEAR_REL(v[0], 0.5 * rolling, 0.02);
        CHECK_NEAR_REL(v[1], rolling, 1e-3);
        CHECK_NEAR_REL(rim, rolling, 1e-3);
    }
}

TEST_MAIN(CASE(a_spinning_disc_ends_rolling))
