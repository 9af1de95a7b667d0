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

/* Flattens a source without loads. */
static void flatten(const struct deck_source *source, struct bytes_writer *out)
{
    static const struct config none = {0};
    struct dm2_error err = {0};
    CHECK_EQ_INT(deck_source_flatten(source, &none, out, &err), DM2_OK);
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
    const struct deck_source source = {
        .texts = texts, .n_texts = 3, .defines = defines, .n_defines = 3, .steps = 400};
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

TEST(tables_stand_as_points)
{
    static char loaded_text[] =
        "domain { size = 3 cm, 1 cm; r_c = 0.25 cm; delta_r = 0.02 cm }\n"
        "time { dt = 0.02 us; steps = 4 }\n"
        "material M { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5 }\n"
        "body b { shape = rectangle 0, 0, 0.2, 0.5; spacing = 0.1 cm; material = M; motion = driven }\n"
        "load push { file = \"gauge.csv\" # of the gauge\n body = b; repeat = no }\n";
    static char table[] = "time [ns],velocity_y [m/s],velocity_x [cm/us]\n"
                          "0.1,-0.3,1\n0.2,7,2\n0.3,7,3\n0.4,7,4\n0.5,7,5\n0.6,7,6\n0.7,7,7\n"
                          "0.8,7,8\n0.9,1e-3,9\n";
    struct deck_text both[] = {{(char *)"main", loaded_text, sizeof loaded_text - 1},
                               {(char *)"gauge.csv", table, sizeof table - 1}};
    const struct deck_source source = {.texts = both, .n_texts = 2, .steps = -1};
    struct config config;
    struct deck_report report;
    struct bytes_writer out = {0};
    struct dm2_error err = {0};
    CHECK_EQ_INT(deck_load(&source, &config, &report), DM2_OK);
    CHECK_STR(report.text, "");
    CHECK_EQ_INT(deck_source_flatten(&source, &config, &out, &err), DM2_OK);
    bytes_put_u8(&out, 0);
    const char *text = (const char *)out.data;
    CHECK_CONTAINS(text, "load push { # begin \"gauge.csv\"\nvelocity_x = 0.0001 1, ");
    CHECK_CONTAINS(text, "\n# end \"gauge.csv\"\n # of the gauge\n body = b");
    check_stable(text);
    struct loaded flat = load_text(text, NULL, -1);
    CHECK_EQ_INT(flat.status, DM2_OK);
    CHECK_EQ_INT(flat.config.n_loads, config.n_loads);
    for (size_t k = 0; k < config.n_loads; k++) {
        const struct load_config *a = &config.loads[k], *b = &flat.config.loads[k];
        CHECK_EQ_INT(a->n, 9);
        CHECK_EQ_INT(b->n, 9);
        CHECK(a->quantity == b->quantity && memcmp(a->time, b->time, 9 * sizeof *a->time) == 0 &&
              memcmp(a->value, b->value, 9 * sizeof *a->value) == 0);
    }
    deck_report_free(&report);
    config_free(&config);
    deck_report_free(&flat.report);
    config_free(&flat.config);
    bytes_free(&out);
}

/* Writes a table of the most points, each of the most tokens. Returns its length. */
static size_t put_table(char *table)
{
    size_t at = (size_t)sprintf(table, "time,velocity_x,velocity_y\n");
    for (int k = 0; k < LOAD_POINTS_MAX; k++)
        at += (size_t)sprintf(table + at, "%d,%.17g,-%.17g\n", k - LOAD_POINTS_MAX, -1e-3 / (k + 3),
                              0.7 / (k + 1));
    return at;
}

/* Loads a deck whose `n` bodies move by the same table, and flattens it into *out. */
static enum dm2_status load_tables(int n, char *table, size_t length, struct bytes_writer *out,
                                   struct deck_report *report)
{
    char deck[2000];
    struct config config;
    struct dm2_error err = {0};
    size_t used = (size_t)snprintf(deck, sizeof deck,
                                   "domain { size = 4 4; r_c = 0.16; delta_r = 0.02 }\n"
                                   "time { dt = 0.02; steps = 100 }\n"
                                   "material cu { rho0 = 8.93; c0 = 0.394; s = 1.489 }\n");
    for (int k = 0; k < n; k++)
        used += (size_t)snprintf(deck + used, sizeof deck - used,
                                 "body b%d { shape = rectangle %d 0 %d.5 1; spacing = 0.1; material = cu; "
                                 "motion = driven }\nload l%d { body = b%d; file = \"t.csv\" }\n",
                                 k, k, k, k, k);
    struct deck_text parts[] = {{(char *)"deck.dm2", deck, used}, {(char *)"t.csv", table, length}};
    const struct deck_source source = {.texts = parts, .n_texts = 2, .steps = -1};
    enum dm2_status status = deck_load(&source, &config, report);
    if (status == DM2_OK) {
        CHECK_EQ_INT(deck_source_flatten(&source, &config, out, &err), DM2_OK);
        config_free(&config);
    }
    return status;
}

/* The text of a deck with many points reads as a deck; points beyond what a deck may have are refused at
 * their table. */
TEST(a_deck_of_many_points)
{
    char *table = malloc((size_t)60 * LOAD_POINTS_MAX);
    size_t length = put_table(table);
    struct bytes_writer out = {0};
    struct deck_report report;
    CHECK_EQ_INT(load_tables(2, table, length, &out, &report), DM2_OK);
    deck_report_free(&report);
    bytes_put_u8(&out, 0);
    struct loaded flat = load_text((const char *)out.data, NULL, -1);
    CHECK_REPORT(flat.status == DM2_OK, "%s", flat.report.text);
    CHECK_EQ_INT(flat.config.n_loads, 4);
    loaded_free(&flat);
    CHECK_EQ_INT(load_tables(4, table, length, &out, &report), DM2_DECK);
    CHECK_CONTAINS(report.text, "the tables of all loads have at most 6");
    deck_report_free(&report);
    bytes_free(&out);
    free(table);
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
          CASE(tables_stand_as_points), CASE(a_deck_of_many_points), CASE(missing_steps_are_added))
