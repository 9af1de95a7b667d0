/* Lifetime of lists: with margins and surveys no pair within reach is missed. */
#include "engine_help.h"

/* Two blocks fly through each other and through a cloud of loose elements, with contacts from all sides. */
static const char crowd[] =
    "domain { size = 2.4 1.2; r_c = 0.12; delta_r = 0.01; boundary = periodic free }\n"
    "time { dt = 0.02; steps = 1000 }\n"
    "material Ni { rho0 = 8.9; c0 = 0.46; s = 1.4; shear = 0.76; yield = 0.005; tensile = 0.02 }\n"
    "interaction { zeta = 0.2; ct_ratio = 0.05; mu = 0.2 }\n"
    "body left { shape = rectangle 0.2 0.2 0.8 0.7; spacing = 0.04; material = Ni; velocity = 0.05 0.01; "
    "jitter = 0.02 }\n"
    "body right { shape = rectangle 1.1 0.4 1.7 0.9; spacing = 0.04; material = Ni; velocity = -0.05 0; "
    "jitter = 0.02 }\n"
    "body cloud { shape = rectangle 1.8 0.1 2.3 1.1; spacing = 0.07; radius = 0.016; material = Ni; velocity "
    "= 0.03 0;\n"
    "  jitter = 0.08 }\n";

/* A solid flies towards another. */
#define FLYER(other)                                                                                         \
    "domain { size = 6 1.2; r_c = 0.12; delta_r = 0.01 }\n"                                                  \
    "time { dt = 0.02; steps = 1000 }\n"                                                                     \
    "material Ni { rho0 = 8.9; c0 = 0.46; s = 1.4; shear = 0.76; yield = 0.005 }\n"                          \
    "interaction { zeta = 0.2; ct_ratio = 0.05; mu = 0.2 }\n"                                                \
    "body one { shape = rectangle 0.2 0.2 1.8 1; spacing = 0.04; material = Ni; velocity = 0.06 0 }\n"       \
    "body other { shape = rectangle " other "; spacing = 0.04; material = Ni }\n"

/* The solid of `flyer` meets the other near the end; the solid of `passenger` never comes near the
 * other. */
static const char flyer[] = FLYER("2.1 0.2 3.7 1"), passenger[] = FLYER("2.5 0.2 4.1 1");

enum { STEPS = 240 };

/* The state after STEPS with these margins, or with the model's where margins is NULL; *rebuilds counts the
 * rebuilds. The state has no elements where a step failed, as may happen when two elements meet unseen,
 * because the energy of their contact exceeds the range of the sums. */
static struct engine_state run(const char *deck, int ranks, const struct margins *margins, int64_t every,
                               size_t *rebuilds)
{
    struct engine g;
    engine_start(&g, deck, NULL, ranks);
    if (margins != NULL)
        g.plan.margins = *margins;
    g.plan.every = every;
    enum dm2_status status = DM2_OK;
    for (int k = 0; k < STEPS && status == DM2_OK; k++) {
        status = engine_forces(&g, false);
        if (status == DM2_OK)
            status = engine_move(&g, NULL);
    }
    struct engine_state s = {0};
    if (status == DM2_OK)
        s = engine_collect(&g, false);
    else
        CHECK_EQ_INT(status, DM2_NUMERIC);
    *rebuilds = g.rebuilds;
    engine_stop(&g);
    return s;
}

static bool same(const struct engine_state *a, const struct engine_state *b)
{
    bool equal = a->n == b->n && a->n_pairs == b->n_pairs;
    for (size_t k = 0; equal && k < a->n; k++)
        equal = engine_same_element(&a->e[k], &b->e[k]);
    return equal;
}

TEST(no_contact_is_missed)
{
    for (int ranks = 1; ranks <= 5; ranks += 2) {
        size_t always, seldom;
        struct engine_state want = run(crowd, ranks, NULL, 1, &always),
                            got = run(crowd, ranks, NULL, 0, &seldom);
        CHECK_EQ_INT(always, STEPS);
        CHECK_REPORT(seldom > 4 && seldom < STEPS / 3, "%zu rebuilds", seldom);
        CHECK(want.n > 500);
        engine_check_same(&got, &want, "a rebuild where the margins ask for one, and at every step");
        engine_state_free(&want);
        engine_state_free(&got);
    }
}

/* The test above finds missed pairs: with too large a close margin the crowd loses contacts, with too large
 * a wide margin the two solids miss each other. */
TEST(either_margin_is_needed)
{
    const char *const decks[] = {crowd, flyer};
    const struct margins margins[] = {{.close = 0.08, .wide = 0.09}, {.close = 0.024, .wide = 1.0}};
    for (size_t k = 0; k < 2; k++) {
        size_t count;
        struct engine_state want = run(decks[k], 1, NULL, 1, &count),
                            got = run(decks[k], 1, &margins[k], 0, &count);
        CHECK_REPORT(!same(&got, &want), "deck %zu: nothing is missed, with %zu rebuilds", k, count);
        engine_state_free(&got);
        engine_state_free(&want);
    }
}

TEST(the_margins_follow_from_the_deck)
{
    struct engine g;
    engine_start(&g, crowd, NULL, 1);
    struct margins of = model_margins(g.model);
    double touch = 0.04 * (1.0 + 0x1p-26);
    CHECK_NEAR(of.close, 0.6 * touch, 1e-15); /* more than dR */
    CHECK_NEAR(of.wide, 0.13 - touch, 1e-15); /* R_c + dR less the distance of touching */
    engine_stop(&g);
    engine_start(&g,
                 "domain { size = 20 20; r_c = 2.5; delta_r = 0.25 }\n"
                 "time { dt = 0.005; steps = 10 }\n"
                 "material atom { mass = 1 }\n"
                 "interaction { potential = lennard-jones; scope = all; epsilon = 1; sigma = 0.9; cutoff = "
                 "2.5; linked = no }\n"
                 "body block { shape = rectangle 0 0 20 20; spacing = 1; material = atom }\n",
                 NULL, 1);
    of = model_margins(g.model);
    CHECK_SAME_BITS(of.close, 0.25);
    CHECK_SAME_BITS(of.wide, 0.25);
    engine_stop(&g);
}

/* Two blocks on either side of the cut, each at rest within its own rank: only the mirrored elements, which
 * a survey sees a step late, show that the blocks approach. */
TEST(a_survey_sees_what_comes_from_another_part)
{
    struct engine g;
    engine_start(
        &g,
        "domain { size = 2.4 1.2; r_c = 0.12; delta_r = 0.01 }\ntime { dt = 0.02; steps = 10 }\n"
        "material Ni { rho0 = 8.9; c0 = 0.46; s = 1.4 }\n"
        "body one { shape = rectangle 1.02 0.2 1.14 1; spacing = 0.04; material = Ni; velocity = 0.05 0 }\n"
        "body other { shape = rectangle 1.26 0.2 1.38 1; spacing = 0.04; material = Ni; velocity = -0.05 0 "
        "}\n",
        NULL, 2);
    const double each = 0.05 * 0.02;
    for (int k = 1; k <= 4; k++) {
        engine_must(&g, engine_forces(&g, false));
        for (int r = 0; r < 2; r++) {
            double dmax;
            struct spread own;
            engine_must(&g, subdomain_move(g.sd[r], &dmax, NULL, &g.err));
            subdomain_survey(g.sd[r], &own);
            CHECK_NEAR(dmax, each, 1e-9);
            CHECK_NEAR(spread_approach(&own), 0.0, 1e-9);
            CHECK_NEAR(own.close + dmax, 2 * k * each, 1e-9);
        }
        engine_update(&g);
    }
    engine_stop(&g);
}

/* The blocks use up the wide margin alone. */
TEST(bodies_that_move_as_wholes_rebuild_seldom)
{
    for (int ranks = 1; ranks <= 4; ranks += 3) {
        const struct margins narrow = {.close = 0.024, .wide = 0.024};
        size_t wide, without;
        struct engine_state got = run(passenger, ranks, NULL, 0, &wide),
                            want = run(passenger, ranks, &narrow, 0, &without);
        engine_check_same(&got, &want, "wide and narrow margins");
        CHECK_REPORT(wide == 3 && without == 12, "%zu rebuilds, %zu with a narrow margin for all", wide,
                     without);
        engine_state_free(&got);
        engine_state_free(&want);
    }
}

TEST_MAIN(CASE(no_contact_is_missed), CASE(either_margin_is_needed), CASE(the_margins_follow_from_the_deck),
          CASE(a_survey_sees_what_comes_from_another_part), CASE(bodies_that_move_as_wholes_rebuild_seldom))
