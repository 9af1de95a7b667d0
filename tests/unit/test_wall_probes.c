/* Probes of walls: with those of bodies their forces sum to 0 in integers; their columns follow the walls'
 * motion and sums; contacts with walls in `unbalanced`, `coordination` and `fabric`; what walls do not
 * report. */
#include "engine_help.h"

#include "dm2/engine/probe.h"

/* Grains between a floor across a periodic side, a turning corner and a ring, all over the cuts. */
static const char BED[] =
    "domain { size = 12 12; origin = -6 -6; r_c = 0.45; delta_r = 0.05; boundary = periodic free\n"
    "  gravity = 0 -4e-3 }\n"
    "time { dt = 0.02; steps = 2000 }\n"
    "material a { mass = 1e-2; cp = 1; kappa = 1e-4 }\n"
    "interaction { potential = quadratic; k = 1; linked = no; zeta = 0.1; mu = 0.5; kt_ratio = 0.3 }\n"
    "body b { shape = rectangle -6 -3.7 6 -2.5; spacing = 0.3; origin = 0.1 -3.7; radius = 0.145\n"
    "  material = a; jitter = 0.02; velocity = 0.1 0; seed = 3 }\n"
    "body c { shape = rectangle 1.25 2.85 2.75 4.1; spacing = 0.31; radius = 0.15; material = a\n"
    "  jitter = 0.02; seed = 5 }\n"
    "body fixed { shape = rectangle -6 -4.3 6 -4.2; spacing = 0.3; origin = 0.1 -4.25; radius = 0.145\n"
    "  material = a; motion = fixed; temperature = 400 }\n"
    "wall floor { line = -6 -4 -5 -3.95 0 -4.2 3 -4 6 -4; material = a; velocity = 0.03 0\n"
    "  temperature = 350 }\n"
    "wall stirrer { line = -1 -2.4 0 -2.4 0 -1.4 -1 -1.4 -1 -2.4; rigid = yes; velocity = 0 -0.02 }\n"
    "wall ring { circle = 2 3.5 1.2; material = a }\n"
    "load turn { body = ring; spin = 0 0, 40 -0.2 }\n"
    "probe floor { body = floor; report = position, velocity, force, torque, spin, temperature, heat }\n"
    "probe stirrer { body = stirrer }\n"
    "probe ring { body = ring; report = force, spin, position, velocity, torque }\n"
    "probe b { body = b } probe c { body = c } probe fixed { body = fixed }\n"
    "output { snapshot_at = 350 }\n";

enum { PROBES = 6, WALLS = 3 };

static void find_values(const struct engine *g, const struct measures *m,
                        double values[PROBES][PROBE_COLUMNS])
{
    struct measure_scales scales = model_scales(g->model);
    for (size_t p = 0; p < PROBES; p++)
        probe_values(&g->deck.config.probes[p], &scales, &m->probe[p], values[p]);
}

TEST(forces_of_bodies_and_walls_sum_to_zero)
{
    struct measures want[3];
    for (int ranks = 1; ranks <= 5; ranks++) {
        struct engine g;
        bool ring = false;
        engine_start(&g, BED, NULL, ranks);
        for (int row = 0; row < 3; row++) {
            struct measures m;
            double v[PROBES][PROBE_COLUMNS];
            engine_run(&g, 299);
            engine_step(&g, &m);
            if (ranks == 1)
                want[row] = m;
            CHECK(measures_match(&m, &g.deck.config));
            CHECK(memcmp(m.probe, want[row].probe, m.n_probes * sizeof m.probe[0]) == 0);
            CHECK_EQ_INT(m.wall_contacts, want[row].wall_contacts);
            CHECK(m.wall_contacts > 10 && m.wall_contacts < m.contacts);
            CHECK_EQ_INT(measures_coordination(&m) == measures_coordination(&want[row]), 1);
            find_values(&g, &m, v);
            for (int a = 0; a < 2; a++) {
                struct exact_sum sum = {0};
                double column = 0.0;
                for (size_t p = 0; p < PROBES; p++) {
                    exact_merge(&sum, &m.probe[p].sum[PROBE_FX + a]);
                    column += v[p][4 + a];
                }
                CHECK_REPORT(sum.hi == 0 && sum.lo == 0, "forces along %d sum to %lld, %llu quanta", a,
                             (long long)sum.hi, (unsigned long long)sum.lo);
                CHECK_NEAR(column, 0.0, 0.0);
            }
            CHECK_REPORT(fabs(v[0][5]) > 1e-4 && v[3][5] != 0.0, "%g %g", v[0][5], v[3][5]);
            ring |= v[2][5] != 0.0;
        }
        CHECK(ring);
        engine_stop(&g);
    }
}

TEST(columns_follow_the_motion_of_a_wall)
{
    struct engine g;
    struct measures m;
    double v[PROBES][PROBE_COLUMNS];
    engine_start(&g, BED, NULL, 3);
    for (int step = 0; step < 300; step++) {
        engine_must(&g, engine_forces(&g, true));
        struct wall_load load = {{0}, 0, 0};
        for (int r = 0; r < 3; r++) {
            struct wall_load part = subdomain_wall_load(g.model, &subdomain_wall_sums(g.sd[r])[0]);
            load.force[0] += part.force[0];
            load.torque += part.torque;
            load.heat += part.heat;
        }
        engine_must(&g, engine_move(&g, &m));
        if (step % 60 != 0)
            continue;
        double t = 0.02 * step, off = 0.0;
        find_values(&g, &m, v);
        CHECK_NEAR(v[0][0], -2.0 + 0.03 * t, 1e-14); /* the mean of the points but the last */
        CHECK_NEAR(v[0][1], -4.0375, 1e-14);
        CHECK_NEAR(v[0][2], 0.03, 1e-15);
        CHECK_NEAR(v[0][4], load.force[0], 1e-15);
        CHECK_NEAR(v[0][6], load.torque, 1e-12);
        CHECK_NEAR(v[0][7], 0.0, 0.0);
        CHECK_NEAR(v[0][11], 350.0, 1e-12);
        CHECK_NEAR(v[0][14], load.heat, 1e-12);
        CHECK(fabs(load.heat) > 1e-4);
        CHECK_NEAR(v[1][1], -1.9 - 0.02 * t, 1e-14);
        CHECK_NEAR(v[1][3], -0.02, 1e-15);
        /* The mean of two half steps is exact where the table is a line; at the start there is one. */
        off = step == 0 ? 0.0 : 1e-14;
        CHECK_NEAR(v[2][7], -0.2 * t / 40, off);
        CHECK_NEAR(v[2][0], 2.0, 1e-14);
    }
    engine_stop(&g);
}

/* A column of two discs at rest on a wall: one contact with the wall, one pair. */
TEST(contacts_with_walls_are_in_the_means)
{
    struct engine g;
    struct measures m;
    double fabric[3];
    engine_start(&g,
                 "domain { size = 20 20; origin = -10 -10; r_c = 1.1; delta_r = 0.2; gravity = 0 -1e-3 }\n"
                 "time { dt = 0.01; steps = 10 }\n"
                 "material a { mass = 1 }\n"
                 "interaction { potential = quadratic; k = 1; linked = no }\n"
                 "body d { shape = rectangle -0.1 0.4 0.1 1.6; lattice = square; spacing = 0.999\n"
                 "  row_spacing = 0.999; origin = 0 0.498; radius = 0.5; material = a }\n"
                 "body held { shape = rectangle 2.9 0.4 3.1 0.6; lattice = square; spacing = 1\n"
                 "  origin = 3 0.4; radius = 0.5; material = a; motion = fixed }\n"
                 "wall w { line = -4 0 4 0; material = a }\n"
                 "probe w { body = w; report = force }\n",
                 NULL, 1);
    engine_step(&g, &m);
    struct measure_scales scales = model_scales(g.model);
    CHECK_EQ_INT(m.contacts, 3);
    CHECK_EQ_INT(m.wall_contacts, 2);
    CHECK_EQ_INT(m.pairs, 1);
    CHECK_EQ_INT(m.loaded_pairs, 2);
    CHECK_NEAR(measures_coordination(&m), (2.0 * 1 + 2) / 3, 1e-15);
    measures_fabric(&m, fabric);
    CHECK_NEAR(fabric[1], 1.0, 1e-12);
    CHECK_NEAR(fabric[0] + fabric[1], 1.0, 1e-15);
    /* At rest under two and one weights; the fixed disc bears no force. */
    CHECK_NEAR(exact_value(&m.magnitudes, scales.force), 3e-3, 1e-9);
    CHECK_NEAR(measures_unbalanced(&m, &scales), 0.0, 1e-9);
    engine_stop(&g);
}

static void check_refused(const char *wall, const char *probe, const char *message)
{
    char text[2000];
    snprintf(text, sizeof text,
             "domain { size = 20 20; origin = -10 -10; r_c = 1.1; delta_r = 0.2 }\n"
             "time { dt = 0.01; steps = 10 }\nmaterial a { mass = 1; cp = 1; kappa = 1 }\n"
             "interaction { potential = quadratic; k = 1; linked = no }\n"
             "body d { shape = rectangle -0.1 0.4 0.1 0.6; spacing = 1; origin = 0 0.5; material = a }\n"
             "wall w { line = -4 0 4 0; material = a%s }\n%s\n",
             wall, probe);
    struct loaded l = load_text(text, NULL, -1);
    if (message == NULL) {
        CHECK_REPORT(l.status == DM2_OK, "%s", l.report.text);
    } else {
        CHECK_EQ_INT(l.status, DM2_DECK);
        CHECK_CONTAINS(l.report.text, message);
    }
    loaded_free(&l);
}

TEST(what_walls_do_not_report_is_refused)
{
    check_refused("", "probe p { body = w; report = force, stress }",
                  "'stress' is of elements, and the probe 'p' is of the wall 'w'");
    check_refused("", "probe p { body = w; report = kinetic }", "'kinetic' is of elements");
    check_refused("", "probe p { body = w; report = porosity }", "'porosity' is of elements");
    check_refused("", "probe p { body = w; report = temperature }",
                  "the wall 'w' of the probe 'p' has no temp");
    check_refused("; temperature = 300", "probe p { body = w; report = temperature }", NULL);
    check_refused(
        "", "probe p { body = w; report = temperature }\nload l { body = w; temperature = 0 1, 9 2 }", NULL);
    check_refused("", "probe p { body = d; report = heat }", "'heat' is of a wall");
    check_refused("", "probe p { region = 0 0 1 1; report = heat }", "'heat' is of a wall");
    check_refused("", "probe p { body = v }", "'v'");
    check_refused("", "probe p { body = w }\nstop { probe = p torque above 1 }", "does not report 'torque'");
    check_refused("", "probe p { body = w; report = heat }\nstop { probe = p heat above 1 }", NULL);
    check_refused("", "probe p { body = w }\nstop { probe = p fy below -1 }", NULL);
}

TEST_MAIN(CASE(forces_of_bodies_and_walls_sum_to_zero), CASE(columns_follow_the_motion_of_a_wall),
          CASE(contacts_with_walls_are_in_the_means), CASE(what_walls_do_not_report_is_refused))
