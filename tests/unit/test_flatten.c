/* A deck as one text: what changes, what stays, and that the text says the same as its source. */
#include "dm2/deck/deck.h"

#include <string.h>

#include "check.h"
#include "deck_help.h"

static const char main_text[] = "# first\n"
                                "let d = 0.1 cm; let push = (0.01 +\n 0.02) # of the lid\r\n"
                                "include \"sub/m.dm2\" # materials\n"
                                "include \"sub/m.dm2\"; include \"./sub/m.dm2\"\n"
                                "domain { size = 3*d, 1 cm; r_c = 0.25 cm; delta_r = 0.02 cm }\n"
                                "time { dt = 0.02 us; steps = 40 } # the end\n"
                                "body b { shape = rectangle 0, 0, 0.2, 0.5; spacing = d; material = M; "
                                "motion = driven; velocity = push, 0 }";
static const char other_text[] = "include \"n.dm2\"\nmaterial M { rho0 = rho; c0 = 4 km/s; s = 1.5 }";
static const char last_text[] = "let rho = 8 g/cm3";

static struct deck_text texts[] = {{(char *)"dir/main", (char *)main_text, sizeof main_text - 1},
                                   {(char *)"dir/sub/m.dm2", (char *)other_text, sizeof other_text - 1},
                                   {(char *)"dir/sub/n.dm2", (char *)last_text, sizeof last_text - 1}};

static void flatten(const struct deck_source *source, struct bytes_writer *out)
{
    struct dm2_error err = {0};
    CHECK_EQ_INT(deck_source_flatten(source, out, &err), DM2_OK);
    bytes_put_u8(out, 0); /* the end of a string */
}

/* Flattens the text once more: it copies to itself. */
static void check_stable(const char *text)
{
    struct deck_text one = {(char *)"deck.dm2", (char *)text, strlen(text)};
    const struct deck_source source = {.texts = &one, .n_texts = 1, .steps = -1};
    struct bytes_writer again = {0};
    flatten(&source, &again);
    CHECK_STR((const char *)again.data, text);
    bytes_free(&again);
}

TEST(includes_stand_in_their_places)
{
    const struct deck_source source = {.texts = texts, .n_texts = 3, .steps = -1};
    struct bytes_writer out = {0};
    flatten(&source, &out);
    const char *text = (const char *)out.data;
    CHECK_CONTAINS(text, "# of the lid\r\n# begin \"sub/m.dm2\"\n# begin \"n.dm2\"\nlet rho = 8 g/cm3\n"
                         "# end \"n.dm2\"\nmaterial M {");
    CHECK_CONTAINS(text, "s = 1.5 }\n# end \"sub/m.dm2\"\n # materials\n"
                         "# above: include \"sub/m.dm2\"\n; # above: include \"./sub/m.dm2\"\ndomain");
    CHECK(strncmp(text, main_text, strstr(main_text, "include") - main_text) == 0);
    check_stable(text);
    bytes_free(&out);
}

TEST(options_stand_in_their_places)
{
    char *defines[] = {(char *)"push=1", (char *)" push = 3*rho/rho*0.01", (char *)"rho=7 g/cm3"};
    const struct deck_source source = {texts, 3, defines, 3, 400};
    struct bytes_writer out = {0};
    flatten(&source, &out);
    const char *text = (const char *)out.data;
    CHECK_CONTAINS(text, "let push = 3*rho/rho*0.01 # -D, was (0.01 +  0.02)\n # of the lid\r\n");
    CHECK_CONTAINS(text, "let rho = 7 g/cm3 # -D, was 8 g/cm3\n# end");
    CHECK_CONTAINS(text, "steps = 400 # --steps, was 40\n } # the end\n");
    check_stable(text);
    struct loaded flat = load_text(text, NULL, -1);
    struct config config;
    struct deck_report report;
    CHECK_EQ_INT(deck_load(&source, &config, &report), DM2_OK);
    CHECK_EQ_INT(flat.status, DM2_OK);
    CHECK_EQ_INT(flat.config.steps, 400);
    CHECK_EQ_INT(flat.config.output.history_every, config.output.history_every);
    CHECK(flat.config.materials[0].rho0 == config.materials[0].rho0 && config.materials[0].rho0 == 7);
    CHECK(flat.config.bodies[0].velocity[0] == config.bodies[0].velocity[0]);
    deck_report_free(&report);
    config_free(&config);
    deck_report_free(&flat.report);
    config_free(&flat.config);
    bytes_free(&out);
}

TEST(missing_steps_are_added)
{
    static const char text[] = "time\n{\n dt = 1 us }\nbody time { spacing = 1 }\n";
    struct deck_text one = {(char *)"deck.dm2", (char *)text, sizeof text - 1};
    const struct deck_source source = {.texts = &one, .n_texts = 1, .steps = 7};
    struct bytes_writer out = {0};
    flatten(&source, &out);
    CHECK_STR((const char *)out.data,
              "time\n{ steps = 7 # --steps\n dt = 1 us }\nbody time { spacing = 1 }\n");
    bytes_free(&out);
}

TEST_MAIN(CASE(includes_stand_in_their_places), CASE(options_stand_in_their_places),
          CASE(missing_steps_are_added))
