/* Probes of bodies and regions: forces that sum to 0 in integers, columns against sums over the elements, the
 * same bits on any number of ranks. */
#include "engine_help.h"

#include <math.h>

#include "dm2/engine/probe.h"

/* Two slabs that hit a driven one between them. */
#define ALL "position, velocity, force, torque, spin, stress, temperature, kinetic"
static const char SLABS[] =
    "domain { size = 0.8 0.6; r_c = 0.1; delta_r = 0.02; boundary = periodic free; gravity = 1e-5 -1e-5 }\n"
    "time { dt = 0.01; steps = 40 }\n"
    "material heavy { rho0 = 8; c0 = 0.4; s = 1.4; cp = 4e-6; yield = 2e-3; tensile = 4e-3; shear = 0.2 }\n"
    "material light { rho0 = 2; c0 = 0.5; s = 1.3; cp = 9e-6; shear = 0.1 }\n"
    "interaction { zeta = 0.1; mu = 0.3 }\n"
    "body low { shape = rectangle 0 0.01 0.8 0.21; spacing = 0.04; origin = 0.01 0.02;\n"
    "  material = heavy; velocity = 0.01 0.04; jitter = 0.01 }\n"
    "body mid { shape = rectangle 0 0.21 0.8 0.31; spacing = 0.04; origin = 0.01 0.02;\n"
    "  material = heavy; motion = driven; velocity = 0.001 0.01 }\n"
    "body high { shape = rectangle 0 0.31 0.8 0.4; spacing = 0.04; origin = 0.01 0.02;\n"
    "  mix = light 0.5, heavy 0.5; temperature = 400 }\n"
    "probe low { body = low; report = " ALL " }\n"
    "probe mid { body = mid; report = force }\n"
    "probe high { body = high; report = " ALL " }\n"
    "probe part { region = 0 0.1 0.8 0.25; report = " ALL ", porosity }\n"
    "output { snapshot_at = 29 }\n";

static void start(struct engine *g, int ranks)
{
    engine_start(g, SLABS, NULL, ranks);
}

static void check_zero(const struct measures *m, const char *what)
{
    for (int a = 0; a < 2; a++) {
        struct exact_sum sum = {0};
        for (size_t p = 0; p < 3; p++)
            exact_merge(&sum, &m->probe[p].sum[PROBE_FX + a]);
        CHECK_REPORT(sum.hi == 0 && sum.lo == 0, "%s: forces along %d sum to %lld, %llu quanta", what, a,
                     (long long)sum.hi, (unsigned long long)sum.lo);
    }
}

TEST(forces_of_all_bodies_sum_to_zero)
{
    struct engine one, many;
    struct measures want[3], got;
    for (int ranks = 1; ranks <= 5; ranks++) {
        struct engine *g = ranks == 1 ? &one : &many;
        start(g, ranks);
        for (int row = 0; row < 3; row++) {
            engine_run(g, 9);
            engine_step(g, &got);
            if (ranks == 1)
                want[row] = got;
            check_zero(&got, "slabs");
            CHECK(measures_match(&got, &g->deck.config));
            CHECK(memcmp(got.probe, want[row].probe, got.n_probes * sizeof got.probe[0]) == 0);
            double values[3][PROBE_COLUMNS];
            struct measure_scales scales = model_scales(g->model);
            for (size_t p = 0; p < 3; p++)
                probe_values(&g->deck.config.probes[p], &scales, &got.probe[p], values[p]);
            CHECK_NEAR(values[0][5] + values[1][5] + values[2][5], 0, 0);
            CHECK(fabs(values[0][5]) > 1e-6 && fabs(values[2][5]) > 1e-6);
        }
        engine_stop(g);
    }
}

/* The pairs of a snapshot, each with the owner of its lower id, sum to the forces of the bodies; with `ahead`
 * the pairs without mirrored elements are evaluated before the rest. */
static void check_pairs(int ranks, bool ahead)
{
    struct engine g;
    struct measures m;
    double sum[3][2] = {{0}}, v[PROBE_COLUMNS];
    size_t pairs = 0;
    start(&g, ranks);
    g.ahead = ahead;
    engine_run(&g, 28);
    g.ahead_measures = true;
    engine_step(&g, NULL);
    engine_must(&g, engine_forces(&g, true)); /* step 29 has a snapshot */
    struct engine_state s = engine_collect(&g, false);
    for (int r = 0; r < ranks; r++) {
        struct pair_record *pair;
        struct pair_measure *force;
        size_t n;
        engine_must(&g, subdomain_collect_acting(g.sd[r], &pair, &force, &n, &g.err));
        for (size_t k = 0; k < n; k++) {
            for (int a = 0; a < 2; a++) {
                sum[s.e[pair[k].id_a].body][a] += force[k].force[a];
                sum[s.e[pair[k].id_b].body][a] -= force[k].force[a];
            }
        }
        pairs += n;
        free(pair);
        free(force);
    }
    g.ahead = false;
    engine_must(&g, engine_move(&g, &m));
    struct measure_scales scales = model_scales(g.model);
    for (size_t body = 0; body < 3; body++) {
        probe_values(&g.deck.config.probes[body], &scales, &m.probe[body], v);
        CHECK_SAME_BITS(sum[body][0] + 0.0, v[4]);
        CHECK_SAME_BITS(sum[body][1] + 0.0, v[5]);
    }
    CHECK_EQ_INT(pairs, m.pairs);
    engine_state_free(&s);
    engine_stop(&g);
}

TEST(pairs_sum_to_the_forces_of_bodies)
{
    for (int ranks = 1; ranks <= 5; ranks++) {
        check_pairs(ranks, false);
        check_pairs(ranks, ranks > 1);
    }
}

/* A potential of scope `all`, whose sums have another quantum, with damped contacts. */
TEST(far_forces_sum_to_zero)
{
    struct engine g;
    struct measures m;
    engine_start(
        &g,
        "domain { size = 12 12; r_c = 2.5; delta_r = 0.25 }\n"
        "time { dt = 0.005; steps = 100 }\n"
        "material a { mass = 1 }\n"
        "interaction { potential = lennard-jones; scope = all; epsilon = 1; sigma = 0.9; cutoff = 2.5; "
        "linked = no }\n"
        "body b0 { shape = rectangle 0 0 12 4; spacing = 1; origin = 0.25 0.3; material = a;\n"
        "  jitter = 0.8 }\n"
        "body b1 { shape = rectangle 0 4 12 8; spacing = 1; origin = 0.25 0.3; material = a }\n"
        "body b2 { shape = rectangle 0 8 12 12; spacing = 1; origin = 0.25 0.3; material = a;\n"
        "  velocity = 0 -0.5 }\n"
        "probe p0 { body = b0 } probe p1 { body = b1 } probe p2 { body = b2 }\n",
        NULL, 3);
    engine_run(&g, 30);
    engine_step(&g, &m);
    check_zero(&m, "atoms");
    CHECK(m.probe[0].sum[PROBE_FY].lo != 0);
    engine_stop(&g);
}

struct element_sums {
    double count, mass, area, place[2], centre[2], mean[2], velocity[2], spin, inertia, kinetic, temperature,
        stress[3], volume;
};

/* The columns of a body or region from its elements, in plain doubles. */
static struct element_sums sum_elements(const struct engine *g, const struct engine_state *s, size_t probe)
{
    const struct probe_config *p = &g->deck.config.probes[probe];
    struct element_sums sum = {0};
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < s->n; i++) {
            const struct element *e = &s->e[i];
            const struct element_measure *m = &s->m[i];
            double r[2], v[2], volume = sqrt(3) / 2 * 4 * e->radius * e->radius;
            if (p->mover >= 0 ? e->body != p->mover : (e->probes >> p->bit & 1) == 0)
                continue;
            for (int a = 0; a < 2; a++) {
                r[a] = e->r[a] + e->image[a] * g->deck.config.size[a];
                v[a] = m->velocity[a];
                if (pass == 0) {
                    sum.place[a] += r[a];
                    sum.mean[a] += v[a];
                    sum.centre[a] += e->mass * r[a];
                    sum.velocity[a] += e->mass * v[a];
                } else {
                    r[a] -= sum.centre[a] / sum.mass;
                    v[a] -= sum.velocity[a] / sum.mass;
                }
            }
            if (pass == 0) {
                sum.count += 1;
                sum.mass += e->mass;
                sum.temperature += m->temperature;
                sum.volume += volume;
                for (int c = 0; c < 3; c++)
                    sum.stress[c] += volume * m->stress[c];
                continue;
            }
            sum.inertia += e->mass * (r[0] * r[0] + r[1] * r[1] + 0.5 * e->radius * e->radius);
            sum.spin += e->mass * (r[0] * v[1] - r[1] * v[0]);
        }
    }
    return sum;
}

static void check_near(double got, double want, double scale, const char *what)
{
    CHECK_REPORT(fabs(got - want) <= 1e-12 * scale, "%s: %.17g, expected %.17g", what, got, want);
}

static void check_columns(const struct engine *g, const struct engine_state *s, const struct measures *m,
                          size_t probe)
{
    const struct probe_config *p = &g->deck.config.probes[probe];
    struct measure_scales scales = model_scales(g->model);
    struct element_sums sum = sum_elements(g, s, probe);
    double v[PROBE_COLUMNS];
    probe_values(p, &scales, &m->probe[probe], v);
    CHECK_EQ_INT(m->probe[probe].count, sum.count);
    for (int a = 0; a < 2; a++) {
        double place = p->mover < 0 ? sum.place[a] / sum.count : sum.centre[a] / sum.mass;
        double speed = p->mover < 0 ? sum.mean[a] / sum.count : sum.velocity[a] / sum.mass;
        check_near(v[a], place, 1, "place");
        check_near(v[2 + a], speed, 0.05, "velocity");
    }
    check_near(v[7], sum.spin / sum.inertia, 1, "spin");
    for (int c = 0; c < 3; c++)
        check_near(v[8 + c], sum.stress[c] / sum.volume, 0.1, "stress");
    check_near(v[11], sum.temperature / sum.count, 400, "temperature");
}

/* In step 0 no element turns yet. */
TEST(columns_are_sums_over_the_elements)
{
    struct engine g;
    struct measures m;
    start(&g, 2);
    engine_must(&g, engine_forces(&g, true));
    struct engine_state s = engine_collect(&g, true);
    engine_must(&g, engine_move(&g, &m));
    check_columns(&g, &s, &m, 0);
    check_columns(&g, &s, &m, 2);
    check_columns(&g, &s, &m, 3);
    engine_state_free(&s);
    engine_stop(&g);
}

/* A free body by itself: force and torque are the rates of momentum and angular momentum. */
static const char BALL[] =
    "domain { origin = X Y; size = 2 2; r_c = 0.1; delta_r = 0.02 }\n"
    "time { dt = 0.01; steps = 400 }\n"
    "material m { rho0 = 8; c0 = 0.4; s = 1.4; shear = 0.2; cp = 4e-6 }\n"
    "interaction { zeta = 0.1; mu = 0.5 }\n"
    "interface body { zeta = 0; mu = 0.5 }\n"
    "body ball { shape = disc X+1 Y+0.6 0.2; spacing = 0.04; origin = X+1 Y+0.6; material = m;\n"
    "  velocity = VX -0.05 }\n"
    "body wall { shape = rectangle X+0.5 Y+0.2 X+1.5 Y+0.366; spacing = 0.04; origin = X+1 Y+0.36; material "
    "= "
    "m; motion = fixed }\n"
    "probe ball { body = ball; report = position, velocity, force, torque, spin, kinetic }\n";

static void start_ball(struct engine *g, const char *x, const char *y, const char *vx)
{
    char text[2 * sizeof BALL], *out = text;
    for (const char *at = BALL; *at != '\0';) {
        bool is_vx = strncmp(at, "VX", 2) == 0;
        if (is_vx || *at == 'X' || *at == 'Y') {
            out += sprintf(out, "%s", is_vx ? vx : *at == 'X' ? x : y);
            at += is_vx ? 2 : 1;
        } else {
            *out++ = *at++;
        }
    }
    *out = '\0';
    engine_start(g, text, NULL, 1);
}

/* Sets the motion of a rigid body that turns about (x, y) with `spin`. */
static void turn(struct engine *g, double x, double y, double spin)
{
    struct engine_state s = engine_collect(g, false);
    for (size_t i = 0; i < s.n; i++) {
        struct element *e = &s.e[i];
        if (e->body != 0)
            continue;
        e->v[0] = -spin * (e->r[1] - y);
        e->v[1] = spin * (e->r[0] - x);
        e->w = spin;
    }
    engine_restore(g, 0, &s);
    engine_state_free(&s);
}

TEST(a_rigid_body_has_its_spin_wherever_it_is)
{
    static const char *const places[][2] = {{"0", "0"}, {"-700", "900"}};
    for (size_t k = 0; k < 2; k++) {
        struct engine g;
        struct measures m;
        double v[PROBE_COLUMNS], x = k == 0 ? 0 : -700, y = k == 0 ? 0 : 900;
        start_ball(&g, places[k][0], places[k][1], "0");
        turn(&g, x + 1.3, y + 0.1, 0.02); /* about another point: the body also moves */
        engine_step(&g, &m);
        struct measure_scales scales = model_scales(g.model);
        probe_values(&g.deck.config.probes[0], &scales, &m.probe[0], v);
        CHECK_NEAR(v[7], 0.02, 1e-13);
        CHECK_NEAR(v[0], x + 1, k == 0 ? 1e-14 : 1e-12);
        CHECK_NEAR(v[2], -0.02 * 0.5, 1e-13);
        CHECK_NEAR(v[3], 0.02 * -0.3, 1e-13);
        engine_stop(&g);
    }
}

TEST(force_and_torque_change_the_motion)
{
    struct engine g;
    struct measures m;
    double before[PROBE_COLUMNS], after[PROBE_COLUMNS], largest = 0, turned = 0;
    start_ball(&g, "0", "0", "0.05");
    struct measure_scales scales = model_scales(g.model);
    for (int step = 0; step < 60; step++) {
        engine_step(&g, &m);
        probe_values(&g.deck.config.probes[0], &scales, &m.probe[0], after);
        double mass = exact_value(&m.probe[0].sum[PROBE_MASS], scales.mass);
        /* v at the whole step is v(n-1/2) + F dt/2m: two whole steps differ by the mean of their forces */
        for (int a = 0; a < 2 && step > 1; a++)
            CHECK_NEAR(mass * (after[2 + a] - before[2 + a]), 0.01 * 0.5 * (before[4 + a] + after[4 + a]),
                       1e-14);
        largest = fabs(after[5]) > largest ? fabs(after[5]) : largest;
        turned = fabs(after[6]) > turned ? fabs(after[6]) : turned;
        memcpy(before, after, sizeof before);
    }
    printf("largest force %.3g Mbar cm2, torque %.3g Mbar cm3, spin %.3g\n", largest, turned, after[7]);
    CHECK(largest > 1e-6 && turned > 1e-8);
    engine_stop(&g);
}

/* Discs of a square lattice fill pi/4 of their squares, those of a hexagonal one pi/(2 sqrt(3)). */
TEST(porosity_of_a_lattice)
{
    struct engine g;
    struct measures m;
    engine_start(&g,
                 "domain { size = 1 1; r_c = 0.15; delta_r = 0.02; boundary = periodic periodic }\n"
                 "time { dt = 0.001; steps = 10 }\n"
                 "material m { mass = 1 }\n"
                 "interaction { potential = quadratic; k = 1; linked = no }\n"
                 "body b { shape = rectangle 0 0 1 1; lattice = square; spacing = 0.1; origin = 0.05 0.05;\n"
                 "  radius = 0.04; material = m; velocity = 10 0 }\n"
                 "probe half { region = 0 0 0.5 1; report = porosity }\n"
                 "probe seam { region = 0.8 0.2 1.3 0.7; report = porosity, position }\n",
                 NULL, 3);
    struct measure_scales scales = model_scales(g.model);
    for (int step = 0; step < 8; step++) { /* the lattice moves by a tenth of its spacing in a step */
        double v[PROBE_COLUMNS];
        engine_step(&g, &m);
        for (size_t p = 0; p < 2; p++) {
            probe_values(&g.deck.config.probes[p], &scales, &m.probe[p], v);
            CHECK_NEAR(v[13], 1 - acos(-1) * 0.16, 1e-12);
        }
        CHECK_EQ_INT(m.probe[1].count, 25);
    }
    engine_stop(&g);
}

TEST(measures_with_other_probes_do_not_match)
{
    struct engine g;
    struct measures m;
    start(&g, 1);
    engine_step(&g, &m);
    CHECK(measures_match(&m, &g.deck.config));
    m.probe[1].needs ^= 1u << PROBE_MASS;
    CHECK(!measures_match(&m, &g.deck.config));
    m.probe[1].needs ^= 1u << PROBE_MASS;
    m.n_probes--;
    CHECK(!measures_match(&m, &g.deck.config));
    engine_stop(&g);
}

TEST_MAIN(CASE(forces_of_all_bodies_sum_to_zero), CASE(pairs_sum_to_the_forces_of_bodies),
          CASE(far_forces_sum_to_zero), CASE(columns_are_sums_over_the_elements),
          CASE(a_rigid_body_has_its_spin_wherever_it_is), CASE(force_and_torque_change_the_motion),
          CASE(porosity_of_a_lattice), CASE(measures_with_other_probes_do_not_match))
