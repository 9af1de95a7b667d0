/* Measures of four pairs at a time have the bits of the plain loop. */
#include "engine_help.h"

/* A sheet of atoms; SPECIES is one material, which lanes can compute, or a mix of two equal materials,
 * which lanes cannot. */
static const char sheet[] = "domain { size = 24 24; r_c = 2.5; delta_r = 0.25; boundary = SIDES }\n"
                            "time { dt = 0.005; steps = 100 }\n"
                            "material a { mass = 1 }\n"
                            "interaction { potential = lennard-jones; scope = all; epsilon = 1; sigma = 0.9; "
                            "cutoff = 2.5; linked = no }\n"
                            "body block { shape = rectangle 0 0 24 24; spacing = 1; origin = 0.25 0.3; "
                            "SPECIES; jitter = 0.8; seed = 3 }\n";

static void start(struct engine *g, const char *sides, const char *species, const char *more, int ranks)
{
    char text[sizeof sheet + 100];
    const char *at_sides = strstr(sheet, "SIDES"), *at_species = strstr(sheet, "SPECIES");
    snprintf(text, sizeof text, "%.*s%s%.*s%s%s%s", (int)(at_sides - sheet), sheet, sides,
             (int)(at_species - at_sides - 5), at_sides + 5, species, at_species + 7, more);
    engine_start(g, text, NULL, ranks);
}

static void compare(const char *sides, int ranks)
{
    struct engine lanes, plain;
    struct measures got, want;
    start(&lanes, sides, "material = a", "", ranks);
    start(&plain, sides, "mix = a 0.5, b 0.5", "material b { mass = 1 }\n", 1);
    for (int step = 0; step < 40; step++) {
        bool measure = step % 13 == 0;
        engine_step(&lanes, measure ? &got : NULL);
        engine_step(&plain, measure ? &want : NULL);
        if (measure) {
            CHECK(got.potential.hi == want.potential.hi && got.potential.lo == want.potential.lo);
            CHECK_SAME_BITS(got.p_min, want.p_min);
            CHECK_SAME_BITS(got.p_max, want.p_max);
        }
    }
    engine_must(&lanes, engine_forces(&lanes, true));
    engine_must(&plain, engine_forces(&plain, true));
    struct engine_state a = engine_collect(&lanes, true), b = engine_collect(&plain, true);
    CHECK(a.n == b.n && a.n > 500);
    for (size_t i = 0; i < a.n; i++)
        for (int c = 0; c < 3; c++)
            CHECK_SAME_BITS(a.m[i].stress[c], b.m[i].stress[c]);
    engine_state_free(&a);
    engine_state_free(&b);
    engine_stop(&lanes);
    engine_stop(&plain);
}

TEST(free_sides)
{
    compare("free free", 1);
}

TEST(periodic_sides)
{
    compare("periodic periodic", 1);
}

TEST(on_several_ranks)
{
    compare("free free", 4);
}

TEST_MAIN(CASE(free_sides), CASE(periodic_sides), CASE(on_several_ranks))
