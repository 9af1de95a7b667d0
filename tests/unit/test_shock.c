/* Shocks in the metals of the plate impact against known results: Us(up) of the LASL fits, the stress of
 * impedance matching, and the spall strength from the free-surface velocity. */
#include "engine_help.h"

#define METALS                                                                                               \
    "material Ni { rho0 = 8.874; c0 = 0.4602; s = 1.437; shear = 0.855; yield = 0.0014; tensile = "          \
    "STRENGTH\n"                                                                                             \
    "              tm = 1728; cp = 4.4e-6; kappa = 9.09e-12 }\n"                                             \
    "material Al { rho0 = 2.703; c0 = 0.5350; s = 1.340; shear = 0.276; yield = 0.0029; tensile = "          \
    "STRENGTH\n"                                                                                             \
    "              tm = 925; cp = 8.97e-6; kappa = 1.67e-11 }\n"                                             \
    "material Cu { rho0 = 8.930; c0 = 0.3940; s = 1.489; shear = 0.477; yield = 0.0012; tensile = "          \
    "STRENGTH\n"                                                                                             \
    "              tm = 1356; cp = 3.83e-6; kappa = 4.01e-11 }\n"

struct metal {
    const char *name;
    double rho0, c0, s;
};
static const struct metal metals[] = {
    {"Ni", 8.874, 0.4602, 1.437}, {"Al", 2.703, 0.5350, 1.340}, {"Cu", 8.930, 0.3940, 1.489}};

/* A flyer hits a target along the rows (x) or normal to them (y), periodic across. Probes are one row
 * distance wide. */
static const char along_deck[] =
    "let d = 0.04; let row = sqrt(3)/2*d; let v = 0.1; let strength = 1; let cells = 6*row\n"
    "let n = FLYER; let k = TARGET; let first = (n + 20)*d; let last = (n + k)*d\n"
    "domain { size = (n + k)*d cells; boundary = free periodic; r_c = 1.1*d; delta_r = 0.1*d }\n"
    "time { dt = STEP; steps = 1 }\n" METALS
    "interaction { potential = morse; zeta = 0.1; ct_ratio = 0.02; link_break = 1.05 }\n"
    "body flyer { shape = rectangle 0 0 n*d cells; spacing = d; origin = d/8 row/2; material = ONE; velocity "
    "= v 0 }\n"
    "body target { shape = rectangle n*d 0 last cells; spacing = d; origin = d/8 row/2; material = TWO }\n"
    "probe near { region = first 0 first + d cells }\n"
    "probe far { region = first + 30*d 0 first + 31*d cells }\n"
    "probe surface { region = last - d 0 last cells }\n"
    "probe middle { region = first + 5*d 0 first + 15*d cells }\n";

static const char normal_deck[] =
    "let d = 0.04; let row = sqrt(3)/2*d; let v = 0.1; let strength = 1; let cells = 6*d\n"
    "let n = FLYER; let k = TARGET; let first = (n + 20)*row; let last = (n + k)*row\n"
    "domain { size = cells (n + k)*row; boundary = periodic free; r_c = 1.1*d; delta_r = 0.1*d }\n"
    "time { dt = STEP; steps = 1 }\n" METALS
    "interaction { potential = morse; zeta = 0.1; ct_ratio = 0.02; link_break = 1.05 }\n"
    "body flyer { shape = rectangle 0 0 cells n*row; spacing = d; origin = d/8 row/2; material = ONE; "
    "velocity = 0 v }\n"
    "body target { shape = rectangle 0 n*row cells last; spacing = d; origin = d/8 row/2; material = TWO }\n"
    "probe near { region = 0 first cells first + row }\n"
    "probe far { region = 0 first + 30*row cells first + 31*row }\n"
    "probe surface { region = 0 last - row cells last }\n"
    "probe middle { region = 0 first + 5*row cells first + 15*row }\n";

static void put(char *text, size_t size, const char *word, const char *by)
{
    char rest[3000], *at;
    while ((at = strstr(text, word)) != NULL) {
        snprintf(rest, sizeof rest, "%s", at + strlen(word));
        snprintf(at, size - (size_t)(at - text), "%s%s", by, rest);
    }
}

struct impact {
    int axis; /* 0: along the rows, 1: normal to them */
    const char *flyer, *target, *strength, *dt;
    const char *rows[2]; /* of the flyer and of the target */
    double v;
};

static void impact_start(struct engine *g, const struct impact *k)
{
    char text[3000], v[40];
    const char *defines[] = {v, NULL};
    snprintf(text, sizeof text, "%s", k->axis == 0 ? along_deck : normal_deck);
    put(text, sizeof text, "ONE", k->flyer);
    put(text, sizeof text, "TWO", k->target);
    put(text, sizeof text, "STRENGTH", k->strength);
    put(text, sizeof text, "FLYER", k->rows[0]);
    put(text, sizeof text, "TARGET", k->rows[1]);
    put(text, sizeof text, "STEP", k->dt);
    snprintf(v, sizeof v, "v=%.17g", k->v);
    engine_start(g, text, defines, 1);
}

static double probe_v(const struct engine *g, const struct measures *m, int probe, int axis)
{
    return exact_value(&m->probe[probe].sum[PROBE_VX + axis], model_scales(g->model).velocity) /
           (double)m->probe[probe].count;
}

/* Speed of the shock between two probes 30 row distances apart, from the times when each has half the
 * particle velocity. */
static double shock_speed(const struct impact *k)
{
    struct engine g;
    impact_start(&g, k);
    double up = 0.5 * k->v, before[2] = {0.0, 0.0}, at[2] = {-1.0, -1.0}, dt = g.deck.config.dt;
    for (int step = 0; at[1] < 0.0 && step < 3000; step++) {
        struct measures m;
        engine_step(&g, &m);
        for (int p = 0; p < 2; p++) {
            double v = probe_v(&g, &m, p, k->axis);
            if (at[p] < 0.0 && v >= 0.5 * up)
                at[p] = (step - 1 + (0.5 * up - before[p]) / (v - before[p])) * dt;
            before[p] = v;
        }
    }
    engine_stop(&g);
    return 30.0 * 0.04 * (k->axis == 0 ? 1.0 : 0.5 * sqrt(3.0)) / (at[1] - at[0]);
}

TEST(shocks_travel_as_the_lasl_fits_say)
{
    static const double ups[] = {0.02, 0.04, 0.07, 0.10};
    for (int metal = 0; metal < 3; metal++) {
        for (int axis = 0; axis < 2; axis++) {
            for (int u = 0; u < 4; u++) {
                const struct metal *m = &metals[metal];
                struct impact k = {.axis = axis,
                                   .flyer = m->name,
                                   .target = m->name,
                                   .strength = "0.012",
                                   .dt = "0.01",
                                   .rows = {"30", "60"},
                                   .v = 2.0 * ups[u]};
                double fit = m->c0 + m->s * ups[u], us = shock_speed(&k);
                printf("%s, %s rows, up %.2f cm/us: Us %.4f, LASL's fit %.4f, ratio %.4f\n", m->name,
                       axis == 0 ? "along" : "normal to", ups[u], us, fit, us / fit);
                CHECK_NEAR_REL(us, fit, 0.06);
            }
        }
    }
}

/* Mean velocity and mean axial stress of the elements in a probe. */
struct behind {
    double velocity, stress;
};

static struct behind behind_shock(const struct impact *k, int steps)
{
    struct engine g;
    struct behind out = {0};
    impact_start(&g, k);
    engine_run(&g, steps);
    engine_must(&g, engine_forces(&g, true));
    struct engine_state s = engine_collect(&g, true);
    size_t n = 0;
    for (size_t i = 0; i < s.n; i++) {
        if (!(s.e[i].probes & 8))
            continue;
        out.velocity += s.m[i].velocity[k->axis];
        out.stress -= s.m[i].stress[k->axis];
        n++;
    }
    out.velocity /= (double)n;
    out.stress /= (double)n;
    engine_state_free(&s);
    engine_stop(&g);
    return out;
}

TEST(nickel_on_aluminium_meets_the_matched_impedances)
{
    static const double speeds[] = {0.04, 0.10};
    for (int axis = 0; axis < 2; axis++) {
        for (int u = 0; u < 2; u++) {
            struct impact k = {.axis = axis,
                               .flyer = "Ni",
                               .target = "Al",
                               .strength = "0.012",
                               .dt = "0.01",
                               .rows = {"40", "60"},
                               .v = speeds[u]};
            const struct metal *a = &metals[0], *b = &metals[1];
            double low = 0.0, high = k.v;
            for (int n = 0; n < 60; n++) { /* the velocity at which both Hugoniots have the same pressure */
                double up = 0.5 * (low + high), w = k.v - up;
                if (b->rho0 * (b->c0 + b->s * up) * up < a->rho0 * (a->c0 + a->s * w) * w)
                    low = up;
                else
                    high = up;
            }
            double pressure = b->rho0 * (b->c0 + b->s * low) * low;
            struct behind found = behind_shock(&k, 300);
            printf("Ni on Al at %.2f cm/us, %s rows: %.5f cm/us and %.5f Mbar, matched %.5f and %.5f\n", k.v,
                   axis == 0 ? "along" : "normal to", found.velocity, found.stress, low, pressure);
            CHECK_NEAR_REL(found.velocity, low, 0.05);
            CHECK_NEAR_REL(found.stress, pressure, 0.05);
        }
    }
}

/* Pull-back of the free surface: its velocity rises, then falls until the target tears. 1/2 rho c0 du is
 * the strength. */
static double pull_back(int axis, const char *strength)
{
    struct impact k = {.axis = axis,
                       .flyer = "Ni",
                       .target = "Ni",
                       .strength = strength,
                       .dt = "0.015",
                       .rows = {"30", "70"},
                       .v = 0.04};
    struct engine g;
    double peak = 0.0, least = 1.0;
    size_t links = 0;
    impact_start(&g, &k);
    for (int step = 0; step < 900; step++) {
        struct measures m;
        engine_step(&g, &m);
        double v = probe_v(&g, &m, 2, axis);
        if (v > peak)
            peak = least = v;
        least = v < least ? v : least;
        links = step == 0 ? m.links : links;
        if (step == 899)
            CHECK_REPORT(m.links < links, "nickel at %s Mbar did not spall", strength);
    }
    engine_stop(&g);
    return 0.5 * metals[0].rho0 * metals[0].c0 * (peak - least);
}

/* Normal to the rows the stress of yielding bonds is Yt; the excess comes from the damping of rows that are
 * torn apart and does not depend on Yt, so its share grows as Yt falls. Along the rows the links of a row,
 * 2/3 of the strength, yield first, and Yt decides how much the links at 60 degrees add until a crack
 * opens. */
TEST(pull_back_of_the_free_surface_tells_the_strength)
{
    static const struct {
        const char *text;
        double value;
    } strengths[] = {{"0.010", 0.010}, {"0.015", 0.015}, {"0.020", 0.020}, {"0.030", 0.030}};
    for (int y = 0; y < 4; y++) {
        double yt = strengths[y].value;
        double normal = pull_back(1, strengths[y].text) / yt, along = pull_back(0, strengths[y].text) / yt;
        printf("Yt %.3f Mbar: spall strength %.3f Yt normal to the rows, %.3f Yt along them\n", yt, normal,
               along);
        CHECK_NEAR(normal, 1.0, 0.10);
        CHECK(along > 0.7 && along < 1.15);
    }
}

/* The metals of these tests equal those of input/materials/, except the tensile strength, which each test
 * chooses. */
TEST(metals_are_those_of_the_library)
{
    static const char *const decks[] = {"input/plate-impact.dm2", "input/plate-impact.dm2",
                                        "input/heat-rod.dm2"};
    struct impact k = {
        .flyer = "Ni", .target = "Al", .strength = "0.012", .dt = "0.01", .rows = {"30", "60"}, .v = 0.02};
    struct engine g;
    enter_source_tree();
    impact_start(&g, &k);
    for (size_t i = 0; i < 3; i++) {
        struct loaded library = load_path(decks[i], NULL, -1);
        const struct material_config *own = &g.deck.config.materials[i], *other = NULL;
        CHECK_EQ_INT(library.status, DM2_OK);
        for (size_t j = 0; j < library.config.n_materials; j++)
            if (strcmp(library.config.materials[j].name, own->name) == 0)
                other = &library.config.materials[j];
        CHECK_REPORT(other != NULL, "%s does not have %s", decks[i], own->name);
        if (other != NULL) {
            CHECK_REPORT(strcmp(own->name, metals[i].name) == 0, "%s is not %s", own->name, metals[i].name);
            CHECK_NEAR_REL(metals[i].rho0, other->rho0, 1e-12);
            CHECK_NEAR_REL(metals[i].c0, other->c0, 1e-12);
            CHECK_NEAR_REL(metals[i].s, other->s, 1e-12);
            CHECK_NEAR_REL(own->rho0, other->rho0, 1e-12);
            CHECK_NEAR_REL(own->c0, other->c0, 1e-12);
            CHECK_NEAR_REL(own->s, other->s, 1e-12);
            CHECK_NEAR_REL(own->shear, other->shear, 1e-12);
            CHECK_NEAR_REL(own->yield, other->yield, 1e-12);
            CHECK_NEAR_REL(own->tm, other->tm, 1e-12);
            CHECK_NEAR_REL(own->cp, other->cp, 1e-12);
            CHECK_NEAR_REL(own->kappa, other->kappa, 1e-12);
        }
        loaded_free(&library);
    }
    engine_stop(&g);
}

TEST_MAIN(CASE(metals_are_those_of_the_library), CASE(shocks_travel_as_the_lasl_fits_say),
          CASE(nickel_on_aluminium_meets_the_matched_impedances),
          CASE(pull_back_of_the_free_surface_tells_the_strength))
