/* Walls in snapshots: the feet of contacts and the walls are points and lines behind those of elements; the
 * forces of a snapshot sum to those of the probes on any number of ranks; outlines follow the walls; states
 * have no forces of walls. */
#include "engine_help.h"
#include "fake_state.h"
#include "scratch.h"

#include "dm2/engine/wall_outline.h"
#include "dm2/output/results.h"
#include "dm2/output/state.h"
#include "dm2/plot/vtp_reader.h"
#include "output/snapshot.h"

/* --- the file --- */

static struct wall_force feet[] = {
    {2, 0, 0, {0.1, -0.02}, {1e-3, 2e-3}, 2e-3, -1e-3},
    {2, 1, 0, {0.12, -0.01}, {-1e-4, 5e-4}, 5e-4, 1e-4},
    {7, 3, 1, {0.2, 0.3}, {3e-3, 0.0}, 3e-3, 0.0},
};
static double points[][2] = {{0, 0}, {0.1, -0.02}, {0.24, 0}, {0.2, 0.3}, {0.3, 0.3}};
static size_t starts[] = {0, 3, 5};

static struct snapshot make_snapshot(struct fake *f, struct snapshot_walls *walls)
{
    static struct wall_config configs[2] = {{.name = "floor"}, {.name = "lid"}};
    fake_make(f, 6, 4);
    f->config.walls = configs;
    f->config.n_walls = 2;
    *walls = (struct snapshot_walls){.forces = {feet, 3, 3}, .outlines = {2, starts, points}};
    return (struct snapshot){&f->config, 200,       f->elements, f->measured, f->n,
                             f->pairs,   f->forces, f->n_pairs,  NULL,        walls};
}

static void read_back(const struct snapshot *s, struct vtp *out)
{
    struct dm2_error err = {0};
    scratch_begin();
    CHECK_EQ_INT(snapshot_write_vtp(scratch_path("w.vtp"), s, &err), DM2_OK);
    enum dm2_status status = vtp_read(scratch_path("w.vtp"), out, &err);
    CHECK_REPORT(status == DM2_OK, "%s", err.text);
    if (status != DM2_OK)
        exit(1);
}

static const double *values_of(const struct vtp *vtp, const char *section, const char *name, size_t n)
{
    const struct vtp_array *a = vtp_find(vtp, section, name);
    CHECK_REPORT(a != NULL && a->n_tuples == n, "%s: %zu tuples, expected %zu", name,
                 a != NULL ? a->n_tuples : 0, n);
    if (a == NULL || a->n_tuples != n)
        exit(1);
    return a->values;
}

TEST(walls_are_behind_the_elements)
{
    struct fake f;
    struct snapshot_walls walls;
    struct vtp vtp;
    struct snapshot s = make_snapshot(&f, &walls);
    read_back(&s, &vtp);
    const size_t n = f.n, pairs = f.n_pairs, cells = n + pairs + 3 + 2;
    CHECK_EQ_INT(vtp.n_points, n);
    CHECK_EQ_INT(vtp.walls.n, 2);
    CHECK_STR(vtp.walls.name[1], "lid");
    const double *id = values_of(&vtp, "PointData", "id", n + 3 + 5),
                 *radius = values_of(&vtp, "PointData", "radius", n + 3 + 5),
                 *a = values_of(&vtp, "CellData", "id_a", cells),
                 *b = values_of(&vtp, "CellData", "id_b", cells),
                 *wall = values_of(&vtp, "CellData", "wall", cells),
                 *fx = values_of(&vtp, "CellData", "force_x", cells),
                 *tangential = values_of(&vtp, "CellData", "tangential", cells);
    for (size_t k = 0; k < 8; k++) {
        const double *place = k < 3 ? feet[k].foot : points[k - 3];
        CHECK_SAME_BITS(vtp.position[3 * (n + k)], place[0]);
        CHECK_SAME_BITS(vtp.position[3 * (n + k) + 1], place[1] + 0.0);
        CHECK(id[n + k] == 4294967295.0 && radius[n + k] == 0.0);
    }
    CHECK(wall[0] == 65535.0 && wall[n + pairs - 1] == 65535.0);
    for (size_t k = 0; k < 5; k++) {
        size_t at = n + pairs + k;
        CHECK_EQ_INT((int)wall[at], k < 3 ? feet[k].wall : (int)k - 3);
        CHECK(a[at] == (k < 3 ? feet[k].id : 4294967295.0) && b[at] == 4294967295.0);
        CHECK_SAME_BITS(fx[at], k < 3 ? feet[k].force[0] : 0.0);
        CHECK_SAME_BITS(tangential[at], k < 3 ? feet[k].tangential + 0.0 : 0.0);
    }
    /* The lines of the second contact and of the second wall. */
    const double *ends = vtp.outline;
    CHECK(ends[2 * (pairs + 1)] == 2.0 && ends[2 * (pairs + 1) + 1] == (double)n + 1);
    CHECK_EQ_INT(vtp.outline_start, 2 * (pairs + 3));
    CHECK(vtp.outline_end[0] == (double)vtp.outline_start + 3);
    CHECK(ends[vtp.outline_start + 3] == (double)n + 3 + 3 && ends[vtp.outline_start + 4] == (double)n + 7);
    vtp_free(&vtp);
    fake_free(&f);
}

/* Of an element that is not shown the force stays, on a line without length; without pairs walls are lines
 * alone. */
TEST(walls_of_what_is_not_shown)
{
    struct fake f;
    struct snapshot_walls walls;
    struct vtp vtp;
    bool bodies[2] = {false, true};
    struct snapshot s = make_snapshot(&f, &walls);
    f.config.output.bodies = bodies;
    read_back(&s, &vtp);
    size_t n = vtp.n_points, before = vtp.outline_start - 6; /* elements 2, 7 are in rows 0, 1: bodies 0, 1 */
    CHECK_EQ_INT(n, f.n / 2);
    CHECK(vtp.outline[before] == (double)n && vtp.outline[before + 1] == (double)n);
    CHECK(vtp.outline[before + 4] == 1.0 && vtp.outline[before + 5] == (double)n + 2);
    vtp_free(&vtp);
    f.config.output.bodies = NULL;
    f.config.output.fields = 1;
    read_back(&s, &vtp);
    CHECK(vtp_find(&vtp, "CellData", "id_a") == NULL);
    (void)values_of(&vtp, "CellData", "wall", f.n + 2);
    CHECK_EQ_INT(vtp.outline_start, 0);
    vtp_free(&vtp);
    fake_free(&f);
}

/* --- the engine --- */

static const char DRUM[] =
    "domain { size = 12 12; origin = -6 -6; r_c = 0.45; delta_r = 0.05; boundary = periodic free\n"
    "  gravity = 0 -4e-3 }\n"
    "time { dt = 0.02; steps = 1000 }\n"
    "material a { mass = 1e-2 }\n"
    "interaction { potential = quadratic; k = 1; linked = no; zeta = 0.1; mu = 0.5; kt_ratio = 0.3 }\n"
    "body b { shape = rectangle -6 -3.7 6 -2.5; spacing = 0.3; origin = 0.1 -3.7; radius = 0.145\n"
    "  material = a; jitter = 0.02; velocity = 0.1 0; seed = 3 }\n"
    "wall floor { line = -6 -4 0 -4.2 6 -4; material = a; velocity = 0.03 0 }\n"
    "wall edge { line = 4 -1.9 5 -0.8 5.5 -2.2; rigid = yes; velocity = 0 -0.06; spin = 0.02 }\n"
    "probe floor { body = floor } probe edge { body = edge }\n"
    "output { snapshot_at = 900 }\n";

TEST(forces_of_a_snapshot_sum_to_the_probes)
{
    struct section_array first = {.n = 0};
    for (int ranks = 1; ranks <= 4; ranks += 3) {
        struct engine g;
        struct measures m;
        struct section_array all = {.n = 0};
        double sum[2][2] = {{0}}, v[PROBE_COLUMNS];
        engine_start(&g, DRUM, NULL, ranks);
        engine_run(&g, 900);
        engine_must(&g, engine_forces(&g, true));
        for (int r = 0; r < ranks; r++)
            engine_must(&g, subdomain_collect_wall_forces(g.sd[r], &all, &g.err));
        engine_must(&g, section_sort(SECTION_WFOR, &all, &g.err));
        engine_must(&g, engine_move(&g, &m));
        for (size_t k = 0; k < all.n; k++) {
            const struct wall_force *f = section_record(SECTION_WFOR, &all, k);
            for (int c = 0; c < 2; c++)
                sum[f->wall][c] -= f->force[c];
        }
        for (size_t w = 0; w < 2; w++) {
            struct measure_scales scales = model_scales(g.model);
            probe_values(&g.deck.config.probes[w], &scales, &m.probe[w], v);
            CHECK_SAME_BITS(sum[w][0] + 0.0, v[4]);
            CHECK_SAME_BITS(sum[w][1] + 0.0, v[5]);
            CHECK(v[5] != 0.0);
        }
        CHECK_REPORT(all.n > 8, "%zu contacts", all.n);
        if (ranks == 1)
            first = all;
        else
            CHECK(all.n == first.n && memcmp(all.records, first.records, all.n * sizeof feet[0]) == 0);
        if (ranks != 1)
            free(all.records);
        engine_stop(&g);
    }
    free(first.records);
}

TEST(outlines_follow_the_walls)
{
    struct engine g;
    struct wall_outlines o;
    engine_start(&g, DRUM, NULL, 1);
    engine_must(&g, wall_outlines_find(g.model, NULL, 50000, &o, &g.err));
    CHECK(o.n_walls == 2 && o.start[1] == 3 && o.start[2] == 6);
    /* The floor has moved by 30 of 12 cm: its centre, (-3, -4.1) cm at the start, is in the domain. */
    CHECK_NEAR(o.point[0][0], -6 + 30 - 24, 1e-12);
    CHECK_NEAR(o.point[2][0] - o.point[0][0], 12, 1e-12);
    double centre[2] = {(4 + 5 + 5.5) / 3, (-1.9 - 0.8 - 2.2) / 3}, c = cos(20.0), s = sin(20.0);
    double x = 5 - centre[0], y = -0.8 - centre[1];
    CHECK_NEAR(o.point[4][0], centre[0] + c * x - s * y, 1e-12);
    CHECK_NEAR(o.point[4][1], centre[1] + s * x + c * y - 60, 1e-11);
    wall_outlines_free(&o);
    engine_stop(&g);
    engine_start(&g,
                 "domain { size = 9 9; r_c = 1.1; delta_r = 0.1 }\ntime { dt = 0.1; steps = 1 }\n"
                 "material M { mass = 1 }\ninteraction { potential = quadratic; k = 1; linked = no }\n"
                 "body b { shape = rectangle 2 2 4 4; spacing = 1; material = M }\n"
                 "wall w { circle = 4 5 3; material = M }\n",
                 NULL, 1);
    engine_must(&g, wall_outlines_find(g.model, NULL, 0, &o, &g.err));
    CHECK_EQ_INT(o.start[1], 129);
    for (size_t k = 0; k < 129; k++)
        CHECK_NEAR(hypot(o.point[k][0] - 4, o.point[k][1] - 5), 3.0, 1e-14);
    CHECK(o.point[0][0] == o.point[128][0] && o.point[0][1] == o.point[128][1]);
    wall_outlines_free(&o);
    engine_stop(&g);
}

/* A state file or a final state with the section is refused, because the deck's states have none. */
TEST(states_have_no_forces_of_walls)
{
    struct engine g;
    struct dm2_error err = {0};
    engine_start(&g, DRUM, NULL, 1);
    struct engine_state s = engine_collect(&g, false);
    struct record_limits limits = record_limits_of(g.model);
    struct section_array forces = {feet, 1, 1};
    CHECK_EQ_INT(section_check(SECTION_WFOR, &forces, &limits, s.e, s.n, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "section WFOR is there, and the deck has nothing for it");
    limits.sections = section_in_snapshot(&g.deck.config);
    CHECK_EQ_INT(section_check(SECTION_WFOR, &forces, &limits, s.e, s.n, &err), DM2_OK);
    struct wall_force wrong = feet[0];
    forces.records = &wrong;
    wrong.wall = 2;
    CHECK_EQ_INT(section_check(SECTION_WFOR, &forces, &limits, s.e, s.n, &err), DM2_PROTOCOL);
    wrong = feet[0];
    wrong.feature = 1000;
    CHECK_EQ_INT(section_check(SECTION_WFOR, &forces, &limits, s.e, s.n, &err), DM2_PROTOCOL);
    wrong = feet[0];
    wrong.foot[1] = INFINITY;
    CHECK_EQ_INT(section_check(SECTION_WFOR, &forces, &limits, s.e, s.n, &err), DM2_PROTOCOL);
    engine_state_free(&s);
    engine_stop(&g);
}

TEST_MAIN(CASE(walls_are_behind_the_elements), CASE(walls_of_what_is_not_shown),
          CASE(forces_of_a_snapshot_sum_to_the_probes), CASE(outlines_follow_the_walls),
          CASE(states_have_no_forces_of_walls))
