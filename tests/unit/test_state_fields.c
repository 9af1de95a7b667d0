/* Records against the deck: every record that a run makes is valid at every step, and the readers of messages
 * refuse what the deck cannot have made. */
#include "check.h"
#include "engine_help.h"

#include "dm2/cluster/wire.h"

/* Reactants of two sizes of grains that also melt, round a periodic side, with a driven wall. */
static const char deck[] =
    "let d = 0.04\n"
    "domain { size = 1 1; boundary = periodic free; r_c = 2.5*d; delta_r = 0.25*d }\n"
    "time { dt = 0.004; steps = 60 }\n"
    "material A { rho0 = 5; c0 = 0.4; s = 1.5; cp = 5e-6; shear = 0.2; yield = 0.001 }\n"
    "material B { rho0 = 5; c0 = 0.4; s = 1.5; cp = 5e-6 }\n"
    "material C { rho0 = 5; c0 = 0.4; s = 1.5; cp = 5e-6 }\n"
    "phase A hot { transition = temperature; t_line = 320; latent = 1e-5; rho0 = 4.8 }\n"
    "reaction burn { reactants = A B; product = C; kind = non-stoichiometric; k0 = 100; ea = 0; heat = 0.01 "
    "}\n"
    "interaction { zeta = 0.1 }\n"
    "body a { shape = rectangle 0 0.2 1 0.4; spacing = d; origin = 0 0.22; material = A; velocity = 0.1 0 }\n"
    "body b { shape = rectangle 0 0.42 1 0.6; spacing = d; origin = 0 0.43; material = B; velocity = -0.05 "
    "-0.05 }\n"
    "body wall { shape = rectangle 0 0 1 0.08; spacing = d; origin = 0 0.02; material = B; motion = driven;\n"
    "            velocity = 0 0.05 }\n";

static void check_all(struct engine *g, const struct record_limits *limits, int step)
{
    struct engine_state s = engine_collect(g, false);
    char text[RECORD_FAULT_TEXT] = "";
    for (size_t k = 0; k < s.n; k++) {
        const struct element_field *fault = record_fault(&s.e[k], limits);
        if (fault != NULL)
            record_describe_fault(fault, &s.e[k], limits, text);
        CHECK_REPORT(fault == NULL, "step %d: element %zu %s", step, k, text);
    }
    for (size_t k = 0; k < s.n_pairs; k++) {
        const struct pair_record *p = &s.pair[k];
        CHECK_REPORT(record_pair_valid(p, limits, text) &&
                         record_pair_reaches(&s.e[p->id_a], &s.e[p->id_b], limits, text),
                     "step %d: pair %u-%u %s", step, p->id_a, p->id_b, text);
    }
    engine_state_free(&s);
}

TEST(every_record_of_a_run_is_valid)
{
    for (int ranks = 1; ranks <= 3; ranks++) {
        struct engine g;
        engine_start(&g, deck, NULL, ranks);
        const struct record_limits limits = record_limits_of(g.model);
        check_all(&g, &limits, 0);
        for (int step = 1; step <= 60; step++) {
            engine_step(&g, NULL);
            check_all(&g, &limits, step);
        }
        struct engine_state s = engine_collect(&g, false);
        size_t changed = 0, turned = 0;
        for (size_t k = 0; k < s.n; k++) {
            changed += s.e[k].kind > 1;
            turned += s.e[k].image[0] != 0;
        }
        CHECK(changed > 0 && turned > 0); /* else the run shows nothing */
        engine_state_free(&s);
        engine_stop(&g);
    }
}

/* Does the message of this element decode? */
static bool decodes(const struct element *e, const struct record_limits *limits, bool mirror)
{
    struct bytes_writer w = {0};
    struct element got;
    (mirror ? wire_put_mirror : wire_put_element)(&w, e);
    struct bytes_reader r = bytes_reader_of(w.data, w.length);
    (mirror ? wire_get_mirror : wire_get_element)(&r, limits, &got);
    bool failed = r.failed;
    bytes_free(&w);
    return !failed;
}

TEST(messages_are_compared_with_the_deck)
{
    struct engine g;
    engine_start(&g, deck, NULL, 1);
    const struct record_limits limits = record_limits_of(g.model);
    struct engine_state s = engine_collect(&g, false);
    struct element wrong[10];
    for (int k = 0; k < 10; k++)
        wrong[k] = s.e[0];
    wrong[0].flags = ELEMENT_FIXED_MOTION;
    wrong[1].kind = 1;
    wrong[2].was = 1;
    wrong[3].body = 1;
    wrong[4].grain = 1;
    wrong[5].mass *= 1.0 + 1e-15;
    wrong[6].radius *= 1.1;
    wrong[7].r[0] = 1.0;
    wrong[8].share[1] = 1e-9;
    wrong[9].v[1] = 1e4;
    for (int mirror = 0; mirror < 2; mirror++) {
        CHECK(decodes(&s.e[0], &limits, mirror != 0));
        for (int k = 0; k < 10; k++)
            CHECK_REPORT(!decodes(&wrong[k], &limits, mirror != 0), "element %d is taken", k);
    }
    engine_state_free(&s);
    engine_stop(&g);
}

TEST_MAIN(CASE(every_record_of_a_run_is_valid), CASE(messages_are_compared_with_the_deck))
