/* The engine's search, sums and exchange against the plainest program for the same model: all pairs, a full
 * matrix of pair memories, sums in floating point; and any number of ranks against one, bit for bit. The
 * random states have elements outside the grid, on cell edges, with coincident coordinates in one axis, in
 * domains one cell wide, and across periodic sides. */
#include "engine_help.h"

#include "dm2/base/random.h"
#include "engine/lists.h"
#include "engine/particles.h"
#include "engine/periodic.h"
#include "engine/tables.h"

/* Discs of two sizes that collide, weld, slide, yield, warm up and conduct. Units are arbitrary. */
static const char near_deck[] =
    "let w = 8; let h = 8\n"
    "domain { size = w h; r_c = 1.3; delta_r = 0.3; PERIODIC search = SEARCH }\n"
    "time { dt = 0.02; steps = 100 }\n"
    "material A { mass = 1; tm = 900; cp = 0.01; kappa = 0.1; yield = 2; tensile = 3 }\n"
    "material B { mass = 2; tm = 700; cp = 0.02; kappa = 0.2; yield = 1; tensile = 4 }\n"
    "interaction { potential = morse; k = 40; shape = 3; zeta = 0.1; ct_ratio = 0.02; kt_ratio = 0.3; mu = "
    "0.4\n"
    "              link_form = 0.92; link_break = 1.1; a_p = 0.1; a_t = 0.0001 }\n"
    "interaction A B { potential = quadratic; zeta = 0.05 }\n"
    "body a { shape = rectangle 0 0 1 1; spacing = 0.9; origin = 0.1 0.1; material = A }\n"
    "body b { shape = rectangle 1 1 1.6 1.6; spacing = 1.1; origin = 1.2 1.2; material = B }\n";

/* Lennard-Jones atoms, every pair within the cutoff. */
static const char far_deck[] =
    "let w = 20; let h = 20\n"
    "domain { size = w h; r_c = 2.5; delta_r = 0.3; PERIODIC search = SEARCH }\n"
    "time { dt = 0.004; steps = 100 }\n"
    "material A { mass = 1 }\n"
    "interaction { potential = lennard-jones; scope = all; epsilon = 1; sigma = 0.9; cutoff = 2.5; linked = "
    "no }\n"
    "body a { shape = rectangle 0 0 1 1; spacing = 1; origin = 0.1 0.1; material = A }\n";

static void replace(char *text, size_t size, const char *word, const char *by)
{
    char *at = strstr(text, word);
    size_t length = strlen(text), cut = strlen(word), put = strlen(by);
    if (at == NULL || length - cut + put >= size)
        exit(1);
    memmove(at + put, at + cut, length - (size_t)(at - text) - cut + 1);
    memcpy(at, by, put);
}

struct shape_case {
    const char *name, *w, *h, *periodic;
    int ranks_max; /* at most the number of cells */
};

static const struct shape_case near_shapes[] = {
    {"square", "w=8", "h=8", "", 9},
    {"one cell wide", "w=1.7", "h=30", "", 9},
    {"one cell high", "w=30", "h=1.7", "", 9},
    {"one cell", "w=1.7", "h=1.7", "", 1},
    {"periodic", "w=8", "h=8", "boundary = periodic periodic;", 9},
    {"periodic in y, one cell wide", "w=1.7", "h=24", "boundary = free periodic;", 9},
    {"with an inside", "w=26", "h=14", "boundary = free periodic;", 9},
    {"three cells around", "w=4.9", "h=16.1", "boundary = periodic free;", 9},
};

static void load(struct engine *g, const char *deck, const struct shape_case *shape, const char *search,
                 int ranks)
{
    char text[2000];
    const char *defines[] = {shape->w, shape->h, NULL};
    snprintf(text, sizeof text, "%s", deck);
    replace(text, sizeof text, "PERIODIC", shape->periodic);
    replace(text, sizeof text, "SEARCH", search);
    engine_load(g, text, defines, ranks);
}

static double uniform(uint64_t seed, uint64_t id, uint64_t what)
{
    return random_uniform(seed, id, 1000 + what);
}

/* Random elements, about `density` per square length; a tenth each lies on a cell edge, on the line of the
 * element before, and (where the side is open) outside the grid. No two are closer than `apart`. */
static struct engine_state random_state(const struct engine *g, uint64_t seed, double density, double apart,
                                        double speed)
{
    const struct grid *grid = &g->parts.grid;
    const struct config *c = &g->deck.config;
    struct engine_state s = {0};
    size_t wanted = (size_t)(density * grid->size[0] * grid->size[1]) + 10, tries = 0;
    s.e = calloc(wanted, sizeof *s.e);
    while (s.n < wanted && tries++ < 100 * wanted) {
        size_t body = c->n_bodies > 1 && uniform(seed, tries, 0) < 0.5 ? 1 : 0;
        struct element e = {.id = (uint32_t)s.n,
                            .body = (uint16_t)body,
                            .grain = (uint32_t)body,
                            .kind = (uint16_t)(c->n_materials > 1 && uniform(seed, tries, 1) < 0.5 ? 1 : 0),
                            .radius = c->bodies[body].radius};
        e.mass = c->materials[e.kind].mass;
        e.heat = uniform(seed, tries, 11) * 0.01;
        for (int a = 0; a < 2; a++) {
            double low = grid->periodic[a] ? 0.0 : -0.1,
                   u = low + (1.0 - 2.0 * low) * uniform(seed, tries, 2 + (uint64_t)a);
            double edge = a == 0 ? grid->lx : grid->ly, what = uniform(seed, tries, 4 + (uint64_t)a);
            e.r[a] = grid->origin[a] + u * grid->size[a];
            if (what < 0.1)
                e.r[a] = grid->origin[a] + floor(u * grid->size[a] / edge) * edge;
            else if (what < 0.2 && s.n > 0)
                e.r[a] = s.e[s.n - 1].r[a];
            if (grid->periodic[a] && (e.r[a] < grid->origin[a] || e.r[a] >= grid->origin[a] + grid->size[a]))
                e.r[a] = grid->origin[a];
            e.v[a] = speed * (2.0 * uniform(seed, tries, 6 + (uint64_t)a) - 1.0);
        }
        e.w = 0.2 * (uniform(seed, tries, 9) - 0.5);
        bool free = true;
        for (size_t k = 0; k < s.n && free; k++) {
            double d[2];
            for (int a = 0; a < 2; a++)
                d[a] = period_nearest(e.r[a] - s.e[k].r[a], grid->periodic[a] ? grid->size[a] : 0.0,
                                      grid->periodic[a] ? 0.5 * grid->size[a] : INFINITY);
            free = d[0] * d[0] + d[1] * d[1] > apart * apart;
        }
        if (free)
            s.e[s.n++] = e;
    }
    return s;
}

/* --- the plain program --- */

struct plain {
    const struct model *m;
    size_t n;
    struct element *e;
    struct pair_state *pair; /* [n][n], i < j */
    double (*sum)[7];        /* force, damping force, torque and its damping part, heat */
    uint32_t *contacts, *links;
    double *virial;      /* [n][3] */
    double (*around)[4]; /* sum of r (x) r over touching and linked pairs, and their number */
    int64_t step;
};

static void plain_start(struct plain *p, const struct engine *g, const struct engine_state *s)
{
    *p = (struct plain){.m = g->model, .n = s->n};
    p->e = malloc(s->n * sizeof *p->e);
    memcpy(p->e, s->e, s->n * sizeof *p->e);
    p->pair = calloc(s->n * s->n, sizeof *p->pair);
    p->sum = calloc(s->n, sizeof *p->sum);
    p->contacts = calloc(s->n, sizeof *p->contacts);
    p->links = calloc(s->n, sizeof *p->links);
    p->virial = calloc(3 * s->n, sizeof *p->virial);
    p->around = calloc(s->n, sizeof *p->around);
}

static void plain_free(struct plain *p)
{
    free(p->e);
    free(p->pair);
    free(p->sum);
    free(p->contacts);
    free(p->links);
    free(p->virial);
    free(p->around);
}

static double plain_temperature(const struct plain *p, const struct element *e)
{
    const struct kind *kind = &p->m->kinds[e->kind];
    return isfinite(kind->cp) ? kind->t0 + e->heat / (e->mass * kind->cp) : kind->t0;
}

static void plain_add(struct plain *p, size_t i, const double f[2], const double d[2], double torque,
                      double damped, double heat)
{
    const double all[7] = {f[0], f[1], d[0], d[1], torque, damped, heat};
    for (int k = 0; k < 7; k++)
        p->sum[i][k] += all[k];
}

/* f = 24 eps/r (2 (s/r)^12 - (s/r)^6) with eps = 1, s = 0.9 */
static void plain_far_pair(struct plain *p, size_t i, size_t j, double r, const double n[2])
{
    double q = pow(0.9 / r, 6.0), force = r <= 2.5 ? 24.0 / r * (2.0 * q * q - q) : 0.0, f[2];
    for (int k = 0; k < 2; k++)
        f[k] = force * n[k];
    plain_add(p, i, f, (double[2]){0.0, 0.0}, 0.0, 0.0, 0.0);
    f[0] = -f[0];
    f[1] = -f[1];
    plain_add(p, j, f, (double[2]){0.0, 0.0}, 0.0, 0.0, 0.0);
}

static void plain_pair(struct plain *p, size_t i, size_t j, double dt_kick, double dt_path)
{
    const struct element *a = &p->e[i], *b = &p->e[j];
    const struct grid *grid = &p->m->grid;
    double d[2], f[2], damp[2];
    for (int k = 0; k < 2; k++)
        d[k] = period_nearest(a->r[k] - b->r[k], grid->periodic[k] ? grid->size[k] : 0.0,
                              grid->periodic[k] ? 0.5 * grid->size[k] : INFINITY);
    const struct pair_law *law =
        model_law(p->m, a->kind, b->kind, relation_of(a->body, a->grain, b->body, b->grain));
    double r = sqrt(d[0] * d[0] + d[1] * d[1]), n[2] = {d[0] / r, d[1] / r};
    if (law->scope == SCOPE_ALL) {
        plain_far_pair(p, i, j, r, n);
        return;
    }
    struct pair_view view = {.r = r,
                             .over_r = 1.0 / r,
                             .radius_i = a->radius,
                             .radius_j = b->radius,
                             .vn = (a->v[0] - b->v[0]) * n[0] + (a->v[1] - b->v[1]) * n[1],
                             .vt = (a->v[1] - b->v[1]) * n[0] - (a->v[0] - b->v[0]) * n[1],
                             .w_i = a->w,
                             .w_j = b->w,
                             .mass_i = a->mass,
                             .mass_j = b->mass,
                             .t_i = plain_temperature(p, a),
                             .t_j = plain_temperature(p, b),
                             .p_i = a->p,
                             .p_j = b->p};
    view.soft_i = particles_softening(&p->m->kinds[a->kind], view.t_i);
    view.soft_j = particles_softening(&p->m->kinds[b->kind], view.t_j);
    struct pair_effect e;
    struct pair_state *s = &p->pair[i * p->n + j];
    pair_interact(law, &view, dt_kick, dt_path, s, &e);
    p->contacts[i] += e.contacting;
    p->contacts[j] += e.contacting;
    p->links[i] += s->linked;
    p->links[j] += s->linked;
    for (int side = 0; side < 2; side++) {
        double sign = side == 0 ? 1.0 : -1.0, arm = side == 0 ? e.arm_i : e.arm_j;
        f[0] = sign * (e.fn * n[0] - e.ft * n[1]);
        f[1] = sign * (e.fn * n[1] + e.ft * n[0]);
        damp[0] = sign * (e.fdn * n[0] - e.fdt * n[1]);
        damp[1] = sign * (e.fdn * n[1] + e.fdt * n[0]);
        plain_add(p, side == 0 ? i : j, f, damp, -arm * e.ft, -arm * e.fdt,
                  0.5 * (e.heat + e.heat_damped) + sign * e.exchange);
        double *v = p->virial + 3 * (side == 0 ? i : j);
        v[0] += sign * d[0] * f[0];
        v[1] += sign * d[1] * f[1];
        v[2] += sign * 0.5 * (d[0] * f[1] + d[1] * f[0]);
        const double around[4] = {d[0] * d[0], d[1] * d[1], d[0] * d[1], 1.0};
        for (int k = 0; k < 4 && (s->linked || e.contacting); k++)
            p->around[side == 0 ? i : j][k] += around[k];
    }
}

static void plain_forces(struct plain *p)
{
    double dt = p->m->config->dt, dt_kick = p->step == 0 ? 0.5 * dt : dt, dt_path = p->step == 0 ? 0.0 : dt;
    memset(p->sum, 0, p->n * sizeof *p->sum);
    memset(p->contacts, 0, p->n * sizeof *p->contacts);
    memset(p->links, 0, p->n * sizeof *p->links);
    memset(p->virial, 0, 3 * p->n * sizeof *p->virial);
    memset(p->around, 0, p->n * sizeof *p->around);
    for (size_t i = 0; i < p->n; i++)
        for (size_t j = i + 1; j < p->n; j++)
            plain_pair(p, i, j, dt_kick, dt_path);
}

static void plain_move(struct plain *p)
{
    double dt = p->m->config->dt, kick = p->step == 0 ? 0.5 * dt : dt;
    const struct grid *g = &p->m->grid;
    for (size_t i = 0; i < p->n; i++) {
        struct element *e = &p->e[i];
        const double *s = p->sum[i];
        double dv[2] = {s[0] / e->mass * kick, s[1] / e->mass * kick};
        double dw = s[4] / (0.5 * e->mass * e->radius * e->radius) * kick;
        const double *m = p->around[i]; /* six neighbours strain the hexagonal cell */
        double area =
            m[3] == 6.0 ? sqrt((m[0] * m[1] - m[2] * m[2]) / 12.0) : 2.0 * sqrt(3.0) * e->radius * e->radius;
        if (p->m->has_pressure)
            e->p = 0.25 * (p->virial[3 * i] + p->virial[3 * i + 1]) / area;
        e->heat += s[6] - 0.5 * kick * (s[2] * dv[0] + s[3] * dv[1] + s[5] * dw);
        e->w += p->m->has_spin ? dw : 0.0;
        for (int a = 0; a < 2; a++) {
            e->v[a] += dv[a];
            e->r[a] += e->v[a] * dt;
            if (g->periodic[a] && e->r[a] >= g->origin[a] + g->size[a])
                e->r[a] -= g->size[a];
            if (g->periodic[a] && e->r[a] < g->origin[a])
                e->r[a] += g->size[a];
        }
    }
    p->step++;
}

static void compare(struct engine *g, const struct plain *p, const char *what)
{
    struct engine_state s = engine_collect(g, true);
    size_t wrong = 0, links = 0;
    double worst = 0.0;
    CHECK_EQ_INT(s.n, p->n);
    for (size_t i = 0; i < s.n; i++) {
        wrong += s.m[i].contacts != p->contacts[i] || s.m[i].links != p->links[i];
        links += p->links[i];
        for (int a = 0; a < 2; a++) {
            double apart = fabs(period_nearest(
                s.e[i].r[a] - p->e[i].r[a], g->parts.grid.periodic[a] ? g->parts.grid.size[a] : 0.0,
                g->parts.grid.periodic[a] ? 0.5 * g->parts.grid.size[a] : INFINITY));
            worst = apart > worst ? apart : worst;
        }
        double off =
            fabs(s.e[i].w - p->e[i].w) + fabs(s.e[i].heat - p->e[i].heat) + fabs(s.e[i].v[0] - p->e[i].v[0]);
        worst = off > worst ? off : worst;
    }
    CHECK_REPORT(wrong == 0, "%s, step %lld: contacts or links of %zu elements differ", what,
                 (long long)p->step, wrong);
    CHECK_REPORT(worst < 1e-9, "%s, step %lld: state off by %g", what, (long long)p->step, worst);
    if (p->m->has_near)
        CHECK_REPORT(s.n_pairs >= links / 2, "%s: %zu pairs with memory, %zu linked", what, s.n_pairs,
                     links / 2);
    engine_state_free(&s);
}

static void against_plain(const char *deck, const struct shape_case *shape, const char *search, int ranks,
                          double density, double apart, double speed)
{
    struct engine g;
    struct plain p;
    char what[100];
    snprintf(what, sizeof what, "%s, %s, %d ranks", shape->name, search, ranks);
    load(&g, deck, shape, search, ranks);
    struct engine_state s = random_state(&g, 7, density, apart, speed);
    engine_restore(&g, 0, &s);
    plain_start(&p, &g, &s);
    for (int step = 0; step < 25; step++) {
        plain_forces(&p);
        engine_must(&g, engine_forces(&g, true));
        compare(&g, &p, what);
        plain_move(&p);
        g.ahead = g.ahead_measures = ranks > 1;
        engine_must(&g, engine_move(&g, NULL));
    }
    CHECK(g.rebuilds >= 2);
    plain_free(&p);
    engine_state_free(&s);
    engine_stop(&g);
}

TEST(near_pairs_as_all_pairs_find_them)
{
    for (size_t k = 0; k < sizeof near_shapes / sizeof near_shapes[0]; k++) {
        against_plain(near_deck, &near_shapes[k], "cells+lists", 1, 1.2, 0.75, 1.5);
        against_plain(near_deck, &near_shapes[k], "lists", 1, 1.2, 0.75, 1.5);
        against_plain(near_deck, &near_shapes[k], "cells", near_shapes[k].ranks_max > 2 ? 3 : 1, 1.2, 0.75,
                      1.5);
        against_plain(near_deck, &near_shapes[k], "cells+lists", near_shapes[k].ranks_max > 2 ? 2 : 1, 1.2,
                      0.75, 1.5);
    }
}

TEST(far_pairs_as_all_pairs_find_them)
{
    static const struct shape_case shapes[] = {
        {"square", "w=11.5", "h=14.3", "", 9},
        {"periodic", "w=11.5", "h=14.3", "boundary = periodic periodic;", 9},
        {"one cell wide", "w=3", "h=30", "", 9}};
    for (size_t k = 0; k < sizeof shapes / sizeof shapes[0]; k++) {
        against_plain(far_deck, &shapes[k], "cells+lists", 1, 0.7, 0.85, 3.0);
        against_plain(far_deck, &shapes[k], "cells+lists", 4, 0.7, 0.85, 3.0);
        against_plain(far_deck, &shapes[k], "lists", 1, 0.7, 0.85, 3.0);
    }
}

/* --- one rank against many --- */

static void ranks_agree(const char *deck, const struct shape_case *shape, double density, double apart,
                        double speed)
{
    static const int counts[] = {2, 3, 5, 8, 9};
    struct engine one;
    load(&one, deck, shape, "cells+lists", 1);
    struct engine_state start = random_state(&one, 11, density, apart, speed), want;
    engine_restore(&one, 0, &start);
    engine_run(&one, 90);
    want = engine_collect(&one, false);
    for (size_t c = 0; c < 5 && counts[c] <= shape->ranks_max; c++) {
        struct engine many;
        char what[100];
        snprintf(what, sizeof what, "%s, %d ranks", shape->name, counts[c]);
        load(&many, deck, shape, "cells+lists", counts[c]);
        engine_restore(&many, 0, &start);
        many.ahead = counts[c] != 5;
        engine_run(&many, 90);
        struct engine_state got = engine_collect(&many, false);
        engine_check_same(&got, &want, what);
        CHECK_REPORT(many.migrants >= (counts[c] < 5 ? 3 : 10), "%s: %zu elements migrated", what,
                     many.migrants);
        /* a survey sees mirrors a step late, so more ranks may rebuild sooner or later */
        CHECK_REPORT(many.rebuilds + 2 >= one.rebuilds && many.rebuilds <= one.rebuilds + 2,
                     "%s: %zu rebuilds, one rank: %zu", what, many.rebuilds, one.rebuilds);
        engine_state_free(&got);
        engine_stop(&many);
    }
    engine_state_free(&start);
    engine_state_free(&want);
    engine_stop(&one);
}

TEST(any_number_of_ranks_gives_the_same_bits)
{
    for (size_t k = 0; k < sizeof near_shapes / sizeof near_shapes[0]; k++)
        ranks_agree(near_deck, &near_shapes[k], 1.2, 0.75, 2.5);
    static const struct shape_case far = {"far, periodic", "w=14.3", "h=14.3",
                                          "boundary = periodic periodic;", 9};
    ranks_agree(far_deck, &far, 0.7, 0.85, 10.0);
}

/* --- memory of pairs --- */

/* Elements with a common velocity never approach each other: their flight over any distance and through any
 * boundary needs no rebuild, and an element in their way is found. */
TEST(motion_as_a_whole_needs_no_rebuild)
{
    static const struct shape_case shape = {"periodic", "w=14.3", "h=14.3", "boundary = periodic periodic;",
                                            9};
    for (int ranks = 1; ranks <= 9; ranks += 8) {
        struct engine g;
        load(&g, far_deck, &shape, "cells+lists", ranks);
        double radius = g.deck.config.bodies[0].radius, dt = g.deck.config.dt;
        struct element e[3] = {
            {.id = 0, .radius = radius, .mass = 1, .r = {1, 2}, .v = {0.0203 / dt, 0.016 / dt}},
            {.id = 1, .radius = radius, .mass = 1, .r = {9, 2}, .v = {0.0203 / dt, 0.016 / dt}},
            {.id = 2, .radius = radius, .mass = 1, .r = {5, 9}, .v = {0.0203 / dt, 0.016 / dt}}};
        struct engine_state s = {.e = e, .n = 3};
        engine_restore(&g, 1, &s);
        engine_run(&g, 500); /* 10 cm */
        CHECK_EQ_INT(g.rebuilds, 0);
        e[2].v[0] = -e[2].v[0];
        engine_restore(&g, 1, &s);
        engine_run(&g, 60); /* 2.4 cm apart: 8 times dR */
        CHECK_REPORT(g.rebuilds >= 7, "%zu rebuilds", g.rebuilds);
        CHECK_REPORT(g.rebuilds <= 8, "%zu rebuilds", g.rebuilds);
        engine_stop(&g);
    }
}

/* Two linked elements whose pair has a stretch and a spring fly through every rank: the pair keeps its
 * memory. Far beyond the reach of contact the link alone keeps the pair. */
TEST(pair_memory_travels_with_migrants)
{
    struct engine g;
    static const struct shape_case shape = {"square", "w=8", "h=8", "", 9};
    char text[2000];
    snprintf(text, sizeof text, "%s", near_deck);
    replace(text, sizeof text, "PERIODIC", "");
    replace(text, sizeof text, "SEARCH", "cells+lists");
    replace(text, sizeof text, "k = 40;", "k = 1e-9;"); /* too soft to act in this time */
    replace(text, sizeof text, "link_break = 1.1", "link_break = 1.4");
    replace(text, sizeof text, "r_c = 1.3", "r_c = 1.6");
    replace(text, sizeof text, "delta_r = 0.3",
            "delta_r = 0.3; rebuild_every = 3"); /* their common motion alone asks for no rebuild */
    const char *defines[] = {shape.w, shape.h, NULL};
    engine_load(&g, text, defines, 9);
    double radius = g.deck.config.bodies[0].radius;
    struct element e[2] = {{.id = 0, .radius = radius, .mass = 1, .r = {0.1, 0.2}, .v = {3.0, 2.9}},
                           {.id = 1, .radius = radius, .mass = 1, .r = {1.33, 0.2}, .v = {3.0, 2.9}}};
    struct pair_record pair = {.id_a = 0, .id_b = 1, .linked = 1, .stretch = 0.375, .spring = -0.125};
    struct engine_state s = {.e = e, .n = 2, .pair = &pair, .n_pairs = 1};
    engine_restore(&g, 1, &s);
    bool apart = false; /* were the two elements ever owned by different ranks? */
    for (int step = 0; step < 120; step++) {
        engine_step(&g, NULL);
        struct engine_state now = engine_collect(&g, false);
        int owners = 0;
        for (int r = 0; r < 9; r++)
            owners += subdomain_owned(g.sd[r]) > 0;
        apart |= owners == 2;
        CHECK_EQ_INT(now.n_pairs, 1);
        if (now.n_pairs == 1) {
            CHECK_EQ_INT(now.pair[0].linked, 1);
            CHECK_NEAR(now.pair[0].stretch, 0.375, 1e-6);
            CHECK_NEAR(now.pair[0].spring, -0.125, 1e-6);
        }
        engine_state_free(&now);
    }
    CHECK(apart);
    CHECK(g.migrants >= 6);
    CHECK(g.migrants >= 6 && subdomain_owned(g.sd[8]) == 2);
    engine_stop(&g);
}

/* --- the range of the sums --- */

TEST(a_force_out_of_range_names_the_elements_and_the_step)
{
    struct engine g;
    static const struct shape_case shape = {"square", "w=20", "h=20", "", 9};
    load(&g, far_deck, &shape, "cells+lists", 1);
    struct element e[2] = {{.id = 0, .radius = 0.5, .mass = 1, .r = {5.0, 5.0}},
                           {.id = 1, .radius = 0.5, .mass = 1, .r = {5.0, 5.001}}};
    struct engine_state s = {.e = e, .n = 2};
    engine_restore(&g, 17, &s);
    CHECK_EQ_INT(engine_forces(&g, false), DM2_NUMERIC);
    CHECK_CONTAINS(g.err.text, "step 17: ");
    CHECK_CONTAINS(g.err.text, "out of range");
    engine_stop(&g);

    load(&g, near_deck, &shape, "cells+lists", 1);
    struct element n[2] = {{.id = 4, .radius = 0.45, .mass = 1, .r = {5.0, 5.0}, .v = {1e7, 0.0}},
                           {.id = 9, .radius = 0.45, .mass = 1, .r = {5.5, 5.0}}};
    s = (struct engine_state){.e = n, .n = 2};
    engine_restore(&g, 23, &s);
    CHECK_EQ_INT(engine_forces(&g, false), DM2_NUMERIC);
    CHECK_CONTAINS(g.err.text, "step 23: ");
    CHECK_CONTAINS(g.err.text, "elements 4 and 9");
    engine_stop(&g);

    load(&g, near_deck, &shape, "cells+lists", 1); /* faster than a cell per step */
    s.n = 1;
    engine_restore(&g, 5, &s);
    engine_must(&g, engine_forces(&g, false));
    CHECK_EQ_INT(engine_move(&g, NULL), DM2_NUMERIC);
    CHECK_CONTAINS(g.err.text, "step 5: element 4 at (5, 5) cm");
    engine_stop(&g);
}

TEST_MAIN(CASE(near_pairs_as_all_pairs_find_them), CASE(far_pairs_as_all_pairs_find_them),
          CASE(any_number_of_ranks_gives_the_same_bits), CASE(motion_as_a_whole_needs_no_rebuild),
          CASE(pair_memory_travels_with_migrants), CASE(a_force_out_of_range_names_the_elements_and_the_step))
