/* Records of bodies under force and of wall contacts, beside the deck: what a run writes is taken, and each
 * number that no run can have is refused with its field. */
#include <math.h>

#include "engine/subdomain_parts.h"
#include "engine_help.h"

static const char DECK[] =
    "domain { size = 2 1; r_c = 0.13; delta_r = 0.02 }\n"
    "time { dt = 0.001; steps = 20 }\n"
    "material m { mass = 2 }\n"
    "interaction { potential = quadratic; k = 3; linked = no }\n"
    "wall floor { line = 0 0.35 2 0.35; material = m }\n"
    "body grains { shape = rectangle 0.4 0.4 1.6 0.41; origin = 0.45 0.4; spacing = 0.1; material = m }\n"
    "body lid { shape = rectangle 0.4 0.49 1.6 0.51; origin = 0.45 0.5; spacing = 0.1; material = m;\n"
    "  motion = driven }\n"
    "load press { body = lid; force_y = 0 -0.01, 1 -0.01 }\n";

struct change {
    double *at; /* the field */
    double value;
    const char *text;
};

static void check_refused(const struct record_limits *limits, enum section which, const void *record,
                          const char *want)
{
    char text[RECORD_FAULT_TEXT] = "";
    CHECK_REPORT(!section_kinds[which].valid(record, limits, text), "taken, without: %s", want);
    CHECK_CONTAINS(text, want);
}

TEST(bodies_under_force)
{
    struct engine g;
    struct section_array bodies = {.n = 0};
    engine_start(&g, DECK, NULL, 1);
    for (int n = 0; n < 10; n++)
        engine_step(&g, NULL);
    const struct record_limits limits = record_limits_of(g.model);
    CHECK(loading_collect(subdomain_loading(g.sd[0]), &bodies));
    const struct body_record whole = *(const struct body_record *)section_record(SECTION_BODY, &bodies, 0);
    CHECK(section_kinds[SECTION_BODY].valid(&whole, &limits, NULL));
    CHECK(whole.velocity[1] < 0.0);
    struct body_record b = whole;
    const struct change changes[] = {
        {&b.displacement[0], 1e-9, "has displacement 1e-09 cm along x for body or wall 1"},
        {&b.displacement[1], 1e300, "has displacement 1e+300 cm along y"},
        {&b.velocity[0], -1e-9, "has velocity -1e-09 cm/us along x"},
        {&b.velocity[1], 1e300, "has velocity 1e+300 cm/us along y"},
        {&b.velocity[1], NAN, "that is not finite"},
        {&b.integral[0], 1e-9, "has integral 1e-09 along x for body or wall 1, which has no load"},
        {&b.centroid[1], 1e300, "has centroid 1 1e+300 cm for body or wall 1, 1 0.5"},
        {&b.angle, 3.0, "has angle 3, spin 0 for body or wall 1, which does not turn"},
        {&b.spin, 3.0, "has angle 0, spin 3"}};
    for (size_t k = 0; k < sizeof changes / sizeof changes[0]; k++) {
        b = whole;
        *changes[k].at = changes[k].value;
        check_refused(&limits, SECTION_BODY, &b, changes[k].text);
    }
    b = whole;
    b.contacts[1] = 4000000000u;
    check_refused(&limits, SECTION_BODY, &b,
                  "has 4000000000 contacts for body or wall 1, at most 64 per element");
    b = whole;
    b.mover = 0;
    check_refused(&limits, SECTION_BODY, &b, "names body or wall 0, which no force moves");
    free(bodies.records);
    engine_stop(&g);
}

TEST(springs_at_walls)
{
    struct engine g;
    char text[RECORD_FAULT_TEXT];
    engine_start(&g, DECK, NULL, 1);
    const struct record_limits limits = record_limits_of(g.model);
    struct wall_contact c = {.id = 3, .feature = 0, .sign = 1, .spring = 1e7};
    CHECK(section_kinds[SECTION_WCON].valid(&c, &limits, text));
    c.spring = -1e300;
    check_refused(&limits, SECTION_WCON, &c, "has spring -1e+300 cm for element 3, below 2^30 r_c");
    engine_stop(&g);
}

TEST_MAIN(CASE(bodies_under_force), CASE(springs_at_walls))
