/* A deck whose run begins from a state: what is bound, what its meaning says, which text about a state is
 * none. tests/e2e/stages.sh has the runs and the mistakes that need a file. */
#include "check.h"
#include "deck_help.h"

#include <stdlib.h>

#include "dm2/deck/meaning.h"
#include "dm2/base/mem.h"
#include "dm2/base/text.h"
#include "dm2/deck/start.h"

static const char first_deck[] =
    "domain { size = 10 10; r_c = 1.3; delta_r = 0.2 }\n"
    "time { dt = 0.01; steps = 1 }\n"
    "material tin { rho0 = 7; c0 = 0.25; s = 1.4; cp = 2e-6 }\nmaterial ash { rho0 = 2; c0 = 0.3; s = 1.4 }\n"
    "interaction { mu = 0.25 }\n"
    "body lid { shape = rectangle 2 7 8 8; spacing = 1; material = ash; motion = driven; velocity = 0 -0.5 "
    "}\n"
    "body sand { shape = disc 5 4 2; spacing = 1; mix = tin 0.5, ash 0.5; seed = 3 }\n"
    "wall floor { line = 0 0.5 10 0.5; rigid = yes }\n";

static const char digest[] = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

static const struct body_start lid_start = {0, 7, 0, 1, {5, 7}, {1.5, 6.5}, {8.5, 7.5}, 11, 0.5, 1.5},
                               sand_start = {7, 20, 1, 2, {5, 4}, {2.5, 1.5}, {7.5, 6.5}, 60, 0.5, 1.5};

/* The text about a state of step 30 of the deck above. */
static void write_text(struct bytes_writer *w, const struct start_wall *floor)
{
    struct loaded l = load_text(first_deck, NULL, -1);
    struct deck_meaning meaning;
    CHECK_EQ_INT(l.status, DM2_OK);
    CHECK_EQ_INT(meaning_build(&l.config, 1u << PART_MEANING, &meaning, NULL), DM2_OK);
    struct body_start bodies[] = {lid_start, sand_start};
    struct start_wall walls[] = {*floor};
    bool kinds[] = {false, true, true, true};
    struct start_source s = {.step = 30,
                             .time = 0.3,
                             .dt_before = 0.01,
                             .next_id = 20,
                             .next_grain = 2,
                             .before = l.config,
                             .bodies = bodies,
                             .walls = walls,
                             .kinds = kinds};
    memcpy(s.digest, digest, sizeof s.digest);
    start_put(w, &s, meaning.text, meaning.length);
    meaning_free(&meaning);
    loaded_free(&l);
}

/* Loads a deck of common blocks and `rest`, with the text about the state. */
static struct loaded load_stage(const char *rest, const struct start_wall *floor)
{
    char text[3000];
    struct bytes_writer w = {0};
    struct loaded out;
    (void)snprintf(text, sizeof text,
                   "domain { size = 12 10; r_c = 1.3; delta_r = 0.2 }\ntime { dt = 0.01; steps = 100 }\n"
                   "material ash { rho0 = 2; c0 = 0.3; s = 1.5 }\n"
                   "material tin { rho0 = 7; c0 = 0.35; s = 1.4; cp = 2e-6 }\n"
                   "interaction { mu = 0.5 }\n%s\n",
                   rest);
    struct deck_source source = {.texts = mem_zalloc(1, sizeof *source.texts), .n_texts = 1, .steps = -1};
    source.texts[0] = (struct deck_text){text_join("deck", "", ""), text_join(text, "", ""), strlen(text)};
    write_text(&w, floor);
    CHECK_EQ_INT(deck_source_begin(&source, (const char *)w.data, w.length, NULL), DM2_OK);
    CHECK(deck_source_start(&source) != NULL);
    out.status = deck_load(&source, &out.config, &out.report);
    bytes_free(&w);
    deck_source_free(&source);
    return out;
}

static const struct start_wall still = {{0, 0}, 0};

#define TAKEN                                                                                                \
    "body sand { from = state }\nbody lid { from = state }\nwall floor { line = 0 0.5 10 0.5; rigid = yes "  \
    "}\n"

TEST(bodies_are_taken_by_name)
{
    struct loaded l = load_stage("start { time = keep }\n" TAKEN, &still);
    CHECK_REPORT(l.status == DM2_OK, "%s", l.report.text);
    const struct config *c = &l.config;
    CHECK(c->start.on && c->start.next_id == 20 && c->start.next_grain == 2);
    CHECK_EQ_INT(strcmp(c->start.state, digest), 0);
    CHECK_EQ_INT(c->n_start, 30);
    CHECK_SAME_BITS(c->t_start, 0.3);
    CHECK_SAME_BITS(c->dt_before, 0.01);
    CHECK_EQ_INT(strcmp(c->bodies[0].name, "sand"), 0);
    CHECK(c->bodies[0].from_state && c->bodies[0].start.id_first == 7 && c->bodies[0].start.id_end == 20);
    CHECK_EQ_INT(c->bodies[0].mix_material[0], 1); /* tin, which is the second material now */
    CHECK_EQ_INT(c->bodies[0].seed, 3);
    CHECK_EQ_INT(c->bodies[1].motion, MOTION_DRIVEN);
    CHECK_SAME_BITS(c->bodies[1].velocity[1], -0.5);
    loaded_free(&l);
}

TEST(a_body_changes_its_motion)
{
    struct loaded l = load_stage("start { velocity = zero; links = none; without = floor }\n"
                                 "body sand { from = state; velocity = 0.1 0.2 }\n"
                                 "body lid { from = state; motion = fixed }\n",
                                 &still);
    CHECK_REPORT(l.status == DM2_OK, "%s", l.report.text);
    const struct config *c = &l.config;
    CHECK_EQ_INT(c->n_start, 0);
    CHECK_SAME_BITS(c->dt_before, 0.0);
    CHECK_EQ_INT(c->start.links, START_WITHOUT_LINKS);
    CHECK(c->bodies[0].pushed && !c->bodies[1].pushed);
    CHECK_SAME_BITS(c->bodies[0].velocity[1], 0.2);
    CHECK_EQ_INT(c->bodies[1].motion, MOTION_FIXED);
    CHECK_SAME_BITS(c->bodies[1].velocity[1], 0.0);
    loaded_free(&l);
}

/* A meaning of such a deck reads back without the state, to the same text; each keyword of `start`, and
 * `from`, changes the meaning. */
TEST(a_meaning_has_its_state)
{
    static const char *const decks[][2] = {
        {"start {}\n" TAKEN, NULL},
        {"start { velocity = zero }\n" TAKEN, "`velocity` of start was keep, is zero"},
        {"start { time = keep }\n" TAKEN, "`time` of start was zero, is keep"},
        {"start { links = none }\n" TAKEN, "`links` of start was keep, is none"},
        {"start { links = form }\n" TAKEN, "`links` of start was keep, is form"},
        {"start { without = floor }\nbody sand { from = state }\nbody lid { from = state }\n",
         "`without` of start was not given, is floor"},
        {"start { without = lid }\nbody sand { from = state }\nbody lid { shape = rectangle 2 7 8 8; spacing "
         "= 1; "
         "material = ash; motion = driven; velocity = 0 -0.5 }\n"
         "wall floor { line = 0 0.5 10 0.5; rigid = yes }\n",
         "`without` of start was not given, is lid"}};
    struct deck_meaning want = {.text = NULL};
    for (size_t k = 0; k < sizeof decks / sizeof decks[0]; k++) {
        struct loaded l = load_stage(decks[k][0], &still);
        struct deck_meaning got, again;
        struct config back;
        struct dm2_error err;
        char difference[MEANING_DIFFERENCE];
        CHECK_REPORT(l.status == DM2_OK, "%s", l.report.text);
        CHECK_EQ_INT(meaning_build(&l.config, 1u << PART_MEANING, &got, NULL), DM2_OK);
        CHECK(strstr(got.text, "start: state sha256_0123456789abcdef") != NULL);
        CHECK(strstr(got.text, "body sand: from state\n") != NULL);
        CHECK_REPORT(meaning_load(got.text, got.length, &back, &err) == DM2_OK, "%s", err.text);
        CHECK_EQ_INT(meaning_build(&back, 1u << PART_MEANING, &again, NULL), DM2_OK);
        CHECK_EQ_INT(strcmp(again.text, got.text), 0);
        config_free(&back);
        meaning_free(&again);
        if (k > 0) {
            CHECK(meaning_difference(want.text, want.length, got.text, got.length, difference));
            CHECK_CONTAINS(difference, decks[k][1]);
            meaning_free(&got);
        } else {
            want = got;
        }
        loaded_free(&l);
    }
    meaning_free(&want);
}

static void check_refused(const char *rest, const struct start_wall *floor, const char *text)
{
    struct loaded l = load_stage(rest, floor);
    CHECK_EQ_INT(l.status, DM2_DECK);
    CHECK_CONTAINS(l.report.text, text);
    loaded_free(&l);
}

TEST(mistakes_are_told)
{
    static const struct start_wall moved = {{0.25, 0}, 0};
    check_refused("start { without = lid }\n" TAKEN, &still,
                  "the body 'lid' of the state is taken, and left out by 'without'");
    check_refused("start {}\n" TAKEN, &moved, "the wall 'floor' has moved by (0.25, 0) cm");
    check_refused("start {}\nbody sand { from = state; spin = 1 }\nbody lid { from = state }\n", &still,
                  "a free body keeps its spin");
    check_refused("start {}\nbody sand { from = state }\nbody lid { from = state }\n", &still,
                  "the state has wall floor: give it in a block");
    check_refused("start { state = file }\n" TAKEN, &still, "'state' is the name of one file in quotes");
    check_refused(
        "reaction burn { reactants = tin ash; product = ash; masses = 1 1; k0 = 1; ea = 0; heat = 1 }\n"
        "start {}\n" TAKEN,
        &still, "the elements of the state hold the reactants of its reaction");
}

/* No cut and no changed byte of a text about a state crashes or leaks; most are refused. */
TEST(texts_of_any_bytes)
{
    struct bytes_writer w = {0};
    write_text(&w, &still);
    size_t refused = 0, tried = 0;
    for (size_t k = 0; k < 400 && k < w.length; k++)
        for (int cut = 0; cut < 2; cut++) {
            struct start_source s;
            unsigned char kept = w.data[k];
            if (cut == 0)
                w.data[k] = (unsigned char)(kept ^ 0x15);
            enum dm2_status status = start_get((const char *)w.data, cut ? k : w.length, &s, NULL);
            CHECK(status == DM2_OK || status == DM2_PROTOCOL);
            refused += status != DM2_OK;
            tried++;
            start_free(&s);
            w.data[k] = kept;
        }
    CHECK(refused > tried / 2);
    bytes_free(&w);
}

TEST_MAIN(CASE(bodies_are_taken_by_name), CASE(a_body_changes_its_motion), CASE(a_meaning_has_its_state),
          CASE(mistakes_are_told), CASE(texts_of_any_bytes))
