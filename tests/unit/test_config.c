/* Resolution of interactions: the defaults, and a specific rule before a general one. */
#include "check.h"
#include "deck_help.h"

static const char base[] =
    "domain { size = 1 1; r_c = 0.1; delta_r = 0.01 }\ntime { dt = 0.01; steps = 10 }\n"
    "material A { rho0 = 1; c0 = 1; s = 1 }\nmaterial B { rho0 = 1; c0 = 1; s = 1 }\n"
    "body b { shape = rectangle 0 0 0.5 1; spacing = 0.04; mix = A 0.5, B 0.5 }\n";

/* Loads the base with these rules; the rules may have keywords that others take the meaning from. */
static struct config load_warned(const char *rules, bool warned)
{
    char text[3000];
    (void)snprintf(text, sizeof text, "%s%s", base, rules);
    struct loaded l = load_text(text, NULL, -1);
    CHECK_EQ_INT(l.status, DM2_OK);
    CHECK((l.report.text[0] != '\0') == warned);
    deck_report_free(&l.report);
    return l.config;
}

static struct config load(const char *rules)
{
    return load_warned(rules, false);
}

TEST(defaults)
{
    struct config c = load("");
    for (int r = 0; r < RELATION_COUNT; r++) {
        struct interaction_config i = config_interaction(&c, 0, 1, (enum relation)r);
        CHECK_EQ_INT(i.potential, POTENTIAL_MORSE);
        CHECK_EQ_INT(i.calibration, CALIBRATION_UNIAXIAL);
        CHECK_EQ_INT(i.scope, SCOPE_LINKED);
        CHECK(isnan(i.k) && isnan(i.shape) && isnan(i.epsilon) && isnan(i.sigma) && isnan(i.cutoff));
        CHECK(isnan(i.kt_ratio) && isnan(i.yield) && isnan(i.tensile));
        CHECK(i.zeta == 0 && i.a_p == 0 && i.a_t == 0 && i.ct_ratio == 0 && i.mu == 0 && i.conductance == 1);
        CHECK_SAME_BITS(i.link_form, 0.0);
        CHECK_SAME_BITS(i.link_break, 1.05);
        CHECK_EQ_INT(i.linked, r == RELATION_SAME_GRAIN);
    }
    config_free(&c);
}

TEST(special_before_general)
{
    /* The order of the rules in the deck does not matter. */
    struct config c = load("interface body B A { mu = 0.4 }\ninteraction A B { mu = 0.3; zeta = 0.3 }\n"
                           "interface body { mu = 0.2; zeta = 0.2; a_p = 0.2; linked = yes }\n"
                           "interface grain A A { linked = yes }\n"
                           "interaction { mu = 0.1; zeta = 0.1; a_p = 0.1; a_t = 0.1 }\n");
    struct interaction_config i = config_interaction(&c, 0, 1, RELATION_OTHER_BODY);
    CHECK_SAME_BITS(i.mu, 0.4);
    CHECK_SAME_BITS(i.zeta, 0.3);
    CHECK_SAME_BITS(i.a_p, 0.2);
    CHECK_SAME_BITS(i.a_t, 0.1);
    CHECK(i.linked);
    i = config_interaction(&c, 1, 0, RELATION_SAME_GRAIN);
    CHECK_SAME_BITS(i.mu, 0.3);
    CHECK_SAME_BITS(i.a_p, 0.1);
    CHECK(i.linked);
    i = config_interaction(&c, 1, 1, RELATION_OTHER_BODY);
    CHECK_SAME_BITS(i.mu, 0.2);
    i = config_interaction(&c, 0, 0, RELATION_OTHER_GRAIN);
    CHECK_SAME_BITS(i.mu, 0.1);
    CHECK(i.linked);
    CHECK(!config_interaction(&c, 0, 1, RELATION_OTHER_GRAIN).linked);
    config_free(&c);
}

TEST(every_field_arrives)
{
    struct config c = load_warned(
        "interaction A A { potential = lennard-jones; calibration = bulk; scope = all; k = 2; "
        "epsilon = 3; sigma = 0.04; cutoff = 0.09; a_p = 4; a_t = 5; ct_ratio = 6; kt_ratio = 7; "
        "yield = 8; tensile = 9; link_form = 0.5; link_break = 1.5; linked = no; conductance = 10; "
        "zeta = 0.25; mu = 11 }\ninteraction B B { shape = 12; potential = morse }",
        true);
    struct interaction_config i = config_interaction(&c, 0, 0, RELATION_SAME_GRAIN);
    CHECK_EQ_INT(i.potential, POTENTIAL_LENNARD_JONES);
    CHECK_EQ_INT(i.calibration, CALIBRATION_BULK);
    CHECK_EQ_INT(i.scope, SCOPE_ALL);
    CHECK(i.k == 2 && i.epsilon == 3 && i.sigma == 0.04 && i.cutoff == 0.09 && i.a_p == 4 && i.a_t == 5);
    CHECK(i.ct_ratio == 6 && i.kt_ratio == 7 && i.yield == 8 && i.tensile == 9 && i.mu == 11 &&
          i.zeta == 0.25);
    CHECK(i.link_form == 0.5 && i.link_break == 1.5 && !i.linked && i.conductance == 10);
    CHECK_SAME_BITS(config_interaction(&c, 1, 1, RELATION_SAME_GRAIN).shape, 12);
    config_free(&c);
}

TEST(bodies_and_defaults)
{
    struct config c =
        load("output { snapshot_at = 7 3 3 0; format = xyz }\n"
             "body s { shape = disc 0.8 0.5 0.1; lattice = square; spacing = 0.08; material = B; "
             "seed = 9007199254740991; radius = 0.03 }\n");
    const struct body_config *b = &c.bodies[0], *s = &c.bodies[1];
    CHECK_STR(b->name, "b");
    CHECK_EQ_INT(b->n_mix, 2);
    CHECK_EQ_INT(b->mix_material[1], 1);
    CHECK_SAME_BITS(b->radius, 0.02);
    CHECK_NEAR(b->row_spacing, 0.04 * sqrt(3) / 2, 1e-16);
    CHECK_SAME_BITS(b->temperature, 300);
    CHECK_EQ_INT(s->shape.kind, SHAPE_DISC);
    CHECK_SAME_BITS(s->row_spacing, 0.08);
    CHECK_SAME_BITS(s->radius, 0.03);
    CHECK(s->seed == 9007199254740991u);
    CHECK_EQ_INT(c.output.n_snapshot_at, 3);
    CHECK(c.output.snapshot_at[0] == 0 && c.output.snapshot_at[1] == 3 && c.output.snapshot_at[2] == 7);
    CHECK(c.output.xyz && !c.output.vtp);
    CHECK_EQ_INT(c.output.history_every, 150);
    CHECK_EQ_INT(c.output.snapshot_every, 0);
    CHECK_EQ_INT(c.search, SEARCH_CELLS_AND_LISTS);
    CHECK_EQ_INT(c.balance, BALANCE_SPACE);
    CHECK(!c.periodic[0] && !c.periodic[1] && c.gravity[0] == 0 && c.gravity[1] == 0);
    const struct material_config *m = &c.materials[0];
    CHECK(isnan(m->mass) && isnan(m->shear) && isnan(m->yield) && isnan(m->tensile) && isnan(m->tm) &&
          isnan(m->cp));
    CHECK(m->softening == 1 && m->t0 == 300 && m->kappa == 0);
    config_free(&c);
}

TEST_MAIN(CASE(defaults), CASE(special_before_general), CASE(every_field_arrives), CASE(bodies_and_defaults))
