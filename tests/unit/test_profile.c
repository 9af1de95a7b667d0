/* Profiles and probes of real states: bins, known means, conservation, the same sums on any number of
 * ranks. */
#include "engine_help.h"

#include <math.h>

/* Two slabs, one flying up into the other, in a domain with a profile of its rows. Row k lies at 0.02 + k
 * row. */
static const char SLABS[] =
    "let row = 0.04 * sqrt(3)/2\n"
    "domain { size = 0.8 0.6; r_c = 0.1; delta_r = 0.02; boundary = periodic free }\n"
    "time { dt = 0.01; steps = 40 }\n"
    "material heavy { rho0 = 8; c0 = 0.4; s = 1.4; cp = 4e-6 }\n"
    "material light { rho0 = 2; c0 = 0.5; s = 1.3; cp = 9e-6 }\n"
    "interaction { zeta = 0.1 }\n"
    "body low { shape = rectangle 0 0.01 0.8 0.02 + 5.5*row; spacing = 0.04; origin = 0.01 0.02; material = "
    "heavy;\n"
    "  velocity = 0.01 0.04 }\n"
    "body high { shape = rectangle 0 0.02 + 5.5*row 0.8 0.02 + 10.5*row; spacing = 0.04; origin = 0.01 "
    "0.02;\n"
    "  material = light; temperature = 400 }\n"
    "profile rows { axis = y; bins = 13; range = 0.02 - row/2, 0.02 + 12.5*row; every = 10 }\n"
    "profile all { axis = x; bins = 1 }\n"
    "probe surface { region = 0 0.02 + 9.5*row 0.8 0.6 }\n";

static struct profile_bin *sums(struct engine *g, size_t which)
{
    size_t n = (size_t)g->deck.config.profiles[which].bins;
    struct profile_bin *bins = calloc(n, sizeof *bins), *part = calloc(n, sizeof *part);
    for (int r = 0; r < g->map.ranks; r++) {
        memset(part, 0, n * sizeof *part);
        engine_must(g, subdomain_profile(g->sd[r], which, part, &g->err));
        profile_merge(bins, part, n);
    }
    free(part);
    return bins;
}

static struct profile_means means(const struct engine *g, size_t which, const struct profile_bin *bin)
{
    struct measure_scales scales = model_scales(g->model);
    return profile_means(bin, &g->deck.config.profiles[which], &g->deck.config, &scales);
}

TEST(rows_at_the_start)
{
    struct engine g;
    engine_start(&g, SLABS, NULL, 1);
    engine_must(&g, engine_forces(&g, true));
    struct profile_bin *rows = sums(&g, 0);
    const struct profile_config *c = &g.deck.config.profiles[0];
    CHECK_NEAR(profile_centre(c, 3), 0.02 + 3 * 0.04 * sqrt(3) / 2, 1e-15);
    for (size_t k = 0; k < 13; k++) {
        struct profile_means m = means(&g, 0, &rows[k]);
        CHECK_EQ_INT(rows[k].elements, k < 11 ? 20 : 0);
        if (k >= 11) {
            CHECK(m.density == 0 && m.porosity == 1 && isnan(m.velocity[0]) && isnan(m.stress[1]) &&
                  isnan(m.temperature));
            continue;
        }
        CHECK_NEAR(m.density, k < 6 ? 8 : 2, 1e-12);
        CHECK_NEAR(m.porosity, 1 - acos(-1) / (2 * sqrt(3)), 1e-12); /* of a hexagonal lattice */
        CHECK_NEAR(m.velocity[0], k < 6 ? 0.01 : 0, 1e-15);
        CHECK_NEAR(m.velocity[1], k < 6 ? 0.04 : 0, 1e-15);
        CHECK_NEAR(m.temperature, k < 6 ? 300 : 400, 1e-10);
        if (k != 5 && k != 6) /* the lattice is free of stress except where damping acts between the bodies */
            CHECK(fabs(m.stress[0]) < 1e-9 && fabs(m.stress[1]) < 1e-9);
    }
    free(rows);
    engine_stop(&g);
}

/* After some steps: a profile of one bin over the domain holds the momentum of the history and the mean
 * stress of all elements, and the probe the mean velocity of its elements. */
TEST(one_bin_is_the_whole)
{
    struct engine g;
    struct measures m;
    engine_start(&g, SLABS, NULL, 2);
    engine_run(&g, 30);
    engine_must(&g, engine_forces(&g, true));
    struct profile_bin *all = sums(&g, 1);
    struct engine_state s = engine_collect(&g, true);
    struct profile_means mean = means(&g, 1, all);
    double stress = 0, v = 0;
    size_t on_top = 0;
    for (size_t i = 0; i < s.n; i++) {
        stress += s.m[i].stress[1];
        on_top += s.e[i].probes & 1;
        v += s.e[i].probes & 1 ? s.m[i].velocity[1] : 0;
    }
    CHECK_EQ_INT(all[0].elements, s.n);
    CHECK_NEAR(mean.stress[1], stress / (double)s.n, 1e-12 * fabs(stress));
    printf("mean stress yy %.6g Mbar\n", mean.stress[1]);
    CHECK(mean.stress[1] < -1e-3);
    engine_must(&g, engine_move(&g, &m));
    int shift = model_scales(g.model).momentum, velocity = model_scales(g.model).velocity;
    for (int a = 0; a < 2; a++)
        CHECK_SAME_BITS(exact_value(&all[0].momentum[a], shift), exact_value(&m.momentum[a], shift));
    CHECK_EQ_INT(m.probe[0].count, 20);
    CHECK_EQ_INT(on_top, 20);
    CHECK_NEAR(exact_value(&m.probe[0].sum[PROBE_VY], velocity) / 20, v / 20, 1e-14);
    free(all);
    engine_state_free(&s);
    engine_stop(&g);
}

TEST(the_same_sums_on_any_number_of_ranks)
{
    struct engine one;
    engine_start(&one, SLABS, NULL, 1);
    engine_run(&one, 30);
    engine_must(&one, engine_forces(&one, true));
    struct profile_bin *want = sums(&one, 0);
    for (int ranks = 2; ranks <= 6; ranks += 2) {
        struct engine many;
        engine_start(&many, SLABS, NULL, ranks);
        engine_run(&many, 30);
        engine_must(&many, engine_forces(&many, true));
        struct profile_bin *got = sums(&many, 0);
        CHECK_EQ_INT(memcmp(got, want, 13 * sizeof *got), 0);
        free(got);
        engine_stop(&many);
    }
    free(want);
    engine_stop(&one);
}

TEST(bins)
{
    struct profile_config c = {.axis = AXIS_X, .bins = 3, .range = {-0.1, 0.2}};
    CHECK_EQ_INT(profile_bin_of(&c, -0.1), 0);
    CHECK_EQ_INT(profile_bin_of(&c, -0.1 - 1e-12), -1);
    CHECK_EQ_INT(profile_bin_of(&c, 0.2), -1);
    CHECK_EQ_INT(profile_bin_of(&c, 0.2 - 1e-16), 2);
    CHECK_EQ_INT(profile_bin_of(&c, 0.05), 1);
    CHECK_EQ_INT(profile_bin_of(&c, NAN), -1);
}

static void refused(const char *block, const char *text)
{
    char deck[2000];
    (void)snprintf(deck, sizeof deck,
                   "domain { size = 1 1; r_c = 0.1; delta_r = 0.02 }\ntime { dt = 0.01; steps = 40 }\n"
                   "material m { rho0 = 8; c0 = 0.4; s = 1.4 }\n"
                   "body b { shape = rectangle 0.1 0.1 0.9 0.9; spacing = 0.04; material = m }\n%s\n",
                   block);
    struct loaded l = load_text(deck, NULL, -1);
    CHECK_EQ_INT(l.status, DM2_DECK);
    CHECK_REPORT(l.report.n_errors == 1, "%s gives\n%s", block, l.report.text);
    CHECK_CONTAINS(l.report.text, text);
    loaded_free(&l);
}

TEST(bad_blocks)
{
    refused("profile p { axis = z; bins = 5 }", "'z' is no value of 'axis'");
    refused("profile p { bins = 5 }", "the block 'profile' lacks 'axis': the axis that is cut into bins");
    refused("profile p { axis = x }", "lacks 'bins'");
    refused("profile p { axis = x; bins = 0 }", "'bins' must be at least 1 and at most 10000, but is 0");
    refused("profile p { axis = x; bins = 2.5 }", "'bins' is a whole number");
    refused("profile p { axis = x; bins = 5; range = 0.5 0.5 }",
            "goes from a smaller to a larger coordinate, not from 0.5 to 0.5 cm");
    refused("profile p { axis = x; bins = 5; range = 1 us 2 cm }", "'range' is a length");
    refused("profile p { axis = x; bins = 5; every = 0 }", "'every' must be at least 1");
    refused("profile { axis = x; bins = 5 }", "between 'profile' and '{' belongs a name");
    refused("profile p { axis = x; bins = 5 } profile p { axis = y; bins = 5 }",
            "there is a profile 'p' before");
    refused("profile p { axes = x; bins = 5 }", "'axes' is no keyword of 'profile'");
    refused("output { strain = maybe }", "'maybe' is no value of 'strain'");
}

TEST(defaults)
{
    struct loaded l =
        load_text("domain { size = 2 1; origin = 0.5 -1; r_c = 0.1; delta_r = 0.02 }\n"
                  "time { dt = 0.01; steps = 400 }\nmaterial m { rho0 = 8; c0 = 0.4; s = 1.4 }\n"
                  "body b { shape = rectangle 1 -0.9 2 -0.1; spacing = 0.04; material = m }\n"
                  "profile p { axis = y; bins = 5 }\n",
                  NULL, -1);
    CHECK_EQ_INT(l.status, DM2_OK);
    CHECK_EQ_INT(l.config.n_profiles, 1);
    CHECK_SAME_BITS(l.config.profiles[0].range[0], -1);
    CHECK_SAME_BITS(l.config.profiles[0].range[1], 0);
    CHECK_EQ_INT(l.config.profiles[0].every, 20);
    CHECK(!l.config.output.strain);
    loaded_free(&l);
}

TEST_MAIN(CASE(rows_at_the_start), CASE(one_bin_is_the_whole), CASE(the_same_sums_on_any_number_of_ranks),
          CASE(bins), CASE(bad_blocks), CASE(defaults))
