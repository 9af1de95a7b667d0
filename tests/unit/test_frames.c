/* Mechanics in a moving, a shifted and a mirrored frame is the same motion: for a small collision and for
 * the decks of applications. */
#include "engine_help.h"

/* Two blocks of one metal collide off centre, with every term of the pair law. */
static const char frame_deck[] =
    "let d = 0.04; let shift = 0; let sign = 1\n"
    "domain { origin = -2 -2; size = 4 4; r_c = 1.2*d; delta_r = 0.2*d }\n"
    "time { dt = 0.02; steps = 1 }\n"
    "material Cu { rho0 = 8.93; c0 = 0.394; s = 1.489; shear = 0.477; yield = 0.0012; tensile = 0.015; tm = "
    "1356\n"
    "              cp = 3.83e-6; kappa = 4.01e-11 }\n"
    "interaction { potential = morse; zeta = 0.1; ct_ratio = 0.03; mu = 0.3 }\n"
    "body one { shape = rectangle -0.5 -0.15 -0.05 0.15; spacing = d; origin = -0.4 0.01; material = Cu\n"
    "           velocity = 0.03 0.004 }\n"
    "body two { shape = rectangle 0.05 -0.3 0.4 0.1; spacing = d; angle = 17 deg; origin = 0.2 0; material = "
    "Cu\n"
    "           velocity = -0.02 0 }\n";

struct frame {
    const char *name;
    double mirror; /* factor of x: 1 or -1 */
    double shift[2], boost[2];
};

/* Transforms the state into the frame at time t; on periodic sides, into the domain. */
static void in_frame(const struct engine *g, struct engine_state *s, const struct frame *f, double t)
{
    const struct config *c = &g->deck.config;
    for (size_t i = 0; i < s->n; i++) {
        for (int a = 0; a < 2; a++) {
            double sign = a == 0 ? f->mirror : 1.0;
            s->e[i].r[a] = sign * s->e[i].r[a] + f->shift[a] + f->boost[a] * t;
            if (c->periodic[a])
                s->e[i].r[a] -= c->size[a] * floor((s->e[i].r[a] - c->origin[a]) / c->size[a]);
            s->e[i].v[a] = sign * s->e[i].v[a] + f->boost[a];
        }
        s->e[i].w *= f->mirror;
    }
    for (size_t p = 0; p < s->n_pairs; p++)
        s->pair[p].spring *= f->mirror;
}

/* Runs `steps` steps from g's state at step `at`, transforms the end into the frame, and compares with the
 * same steps from the transformed start. */
static void frames_agree(struct engine *g, int64_t at, int steps, const struct frame *f, double tolerance)
{
    const struct config *c = &g->deck.config;
    struct engine_state start = engine_collect(g, false), still, moving;
    engine_restore(g, at, &start);
    engine_run(g, steps);
    still = engine_collect(g, false);
    struct engine_state other = {.e = malloc(start.n * sizeof *other.e),
                                 .pair = malloc((start.n_pairs + 1) * sizeof *other.pair),
                                 .n = start.n,
                                 .n_pairs = start.n_pairs};
    memcpy(other.e, start.e, start.n * sizeof *other.e);
    memcpy(other.pair, start.pair, start.n_pairs * sizeof *other.pair);
    in_frame(g, &other, f, 0.0);
    engine_restore(g, at, &other);
    engine_run(g, steps);
    moving = engine_collect(g, false);
    in_frame(g, &still, f, steps * c->dt);
    double r = 0.0, v = 0.0, heat = 0.0, hottest = 0.0, share = 0.0;
    size_t links = 0, changed = 0;
    for (size_t i = 0; i < still.n; i++) {
        const struct element *a = &still.e[i], *b = &moving.e[i];
        for (int k = 0; k < 2; k++) {
            double apart = a->r[k] - b->r[k];
            if (c->periodic[k])
                apart -= c->size[k] * floor(apart / c->size[k] + 0.5);
            r = fmax(r, fabs(apart));
            v = fmax(v, fabs(a->v[k] - b->v[k]));
            share = fmax(share, fabs(a->share[k] - b->share[k]));
        }
        v = fmax(v, a->radius * fabs(a->w - b->w));
        heat = fmax(heat, fabs(a->heat - b->heat));
        hottest = fmax(hottest, fabs(a->heat));
        CHECK_EQ_INT(b->kind, a->kind);
        changed += a->kind != start.e[i].kind;
    }
    for (size_t p = 0; p < still.n_pairs; p++)
        links += still.pair[p].linked;
    printf("%s: r off by %.2g cm, v by %.2g cm/us, heat by %.2g of the largest, shares by %.2g; %zu links of "
           "%zu, %zu changed\n",
           f->name, r, v, heat / hottest, share, links, start.n_pairs, changed);
    CHECK(hottest > 0.0);
    CHECK(r < tolerance && v < tolerance && heat < tolerance * hottest && share < tolerance);
    CHECK_EQ_INT(moving.n_pairs, still.n_pairs);
    CHECK(links < start.n_pairs);
    engine_restore(g, at, &start);
    engine_state_free(&start);
    engine_state_free(&still);
    engine_state_free(&moving);
    engine_state_free(&other);
}

TEST(moving_and_mirrored_frames)
{
    static const struct frame frames[] = {{"moving", 1.0, {0.0, 0.0}, {0.05, -0.02}},
                                          {"shifted", 1.0, {0.337, 0.0}, {0.0, 0.0}},
                                          {"mirrored", -1.0, {0.0, 0.0}, {0.0, 0.0}}};
    struct engine g;
    engine_start(&g, frame_deck, NULL, 1);
    for (int k = 0; k < 3; k++)
        frames_agree(&g, 0, 300, &frames[k], 1e-11);
    engine_stop(&g);
}

/* Decks of applications: the plate impact until it has spalled; polycrystal and shear band, whose walls are
 * driven along, with motion and mirror across their periodic seam. The shear band runs from step 30 on,
 * because its lattice starts with r = r0, where rounding decides which pairs touch and react. */
TEST(decks_in_moving_and_mirrored_frames)
{
    static const struct {
        const char *path;
        const char *defines[3];
        int at, steps;
        struct frame frame[3];
    } decks[] = {
        {"input/plate-impact.dm2",
         {"scale=0.5", NULL},
         0,
         200,
         {{"plate impact, moving", 1.0, {0.0, 0.0}, {0.03, -0.02}},
          {"plate impact, shifted", 1.0, {0.337, 0.1}, {0.0, 0.0}},
          {"plate impact, mirrored", -1.0, {1.1, 0.0}, {0.0, 0.0}}}},
        {"input/cu-polycrystal.dm2",
         {"scale=0.4", NULL},
         0,
         100,
         {{"polycrystal, moving", 1.0, {0.0, 0.0}, {0.1, 0.0}},
          {"polycrystal, shifted", 1.0, {0.123, 0.0}, {0.0, 0.0}},
          {"polycrystal, mirrored", -1.0, {0.05, 0.0}, {0.0, 0.0}}}},
        {"input/shear-band.dm2",
         {"scale=0.5", "start=900 K", NULL},
         30,
         300,
         {{"shear band, moving", 1.0, {0.0, 0.0}, {0.05, 0.01}},
          {"shear band, shifted", 1.0, {0.123, 0.0}, {0.0, 0.0}},
          {"shear band, mirrored", -1.0, {0.05, 0.0}, {0.0, 0.0}}}},
    };
    enter_source_tree();
    for (int d = 0; d < 3; d++) {
        struct engine g;
        engine_start_file(&g, decks[d].path, decks[d].defines, 1);
        engine_run(&g, decks[d].at);
        for (int k = 0; k < 3; k++)
            frames_agree(&g, decks[d].at, decks[d].steps, &decks[d].frame[k], 1e-9);
        engine_stop(&g);
    }
}

TEST_MAIN(CASE(moving_and_mirrored_frames), CASE(decks_in_moving_and_mirrored_frames))
