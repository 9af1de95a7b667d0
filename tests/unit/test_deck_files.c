/* Decks as files. Every deck of tests/decks/bad gives the report in the file beside the deck, byte for byte;
 * a deck there that loads must fail in model_build, with the place. The decks of tests/decks/good and input/
 * load, the good ones with the warnings in the file beside them, if any. No mutation of these decks makes the
 * reader crash.
 *
 * A first line `#: -D a=1 --steps 3` in a deck has the options of the command line. DM2_REWRITE=1 writes the
 * reports instead of comparing them; check the difference before a commit. */
#include <dirent.h>
#include <unistd.h>

#include "dm2/base/mem.h"
#include "dm2/deck/deck.h"
#include "dm2/engine/model.h"
#include "check.h"
#include "deck_help.h"

enum { MANY = 512 };

static char *copy(const char *text, size_t n)
{
    char *out = malloc(n + 1);
    memcpy(out, text, n);
    out[n] = '\0';
    return out;
}

/* Takes the options in the first line of the deck. */
static void take_options(struct deck_source *source)
{
    const char *at = source->texts[0].text;
    const char *end = strchr(at, '\n');
    if (strncmp(at, "#:", 2) != 0 || end == NULL)
        return;
    source->defines = mem_zalloc(16, sizeof(char *));
    for (at += 2; at < end;) {
        at += strspn(at, " ");
        size_t n = strcspn(at, " \n");
        if (strncmp(at, "--steps", n) == 0) {
            source->steps = strtoll(at + n, NULL, 10);
        } else if (strncmp(at, "-D", n) != 0 && at[0] != '\n' && strchr("0123456789", at[0]) == NULL) {
            source->defines[source->n_defines++] = copy(at, n);
        }
        at += n;
    }
}

static char *read_all(const char *path)
{
    FILE *f = fopen(path, "rb");
    if (f == NULL)
        return NULL;
    char *text = malloc(1 << 16);
    size_t n = fread(text, 1, (1 << 16) - 1, f);
    text[n] = '\0';
    fclose(f);
    return text;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* The sorted names of the decks in a folder. */
static size_t list_decks(const char *folder, char **names)
{
    enter_source_tree();
    DIR *dir = opendir(folder);
    size_t n = 0;
    CHECK(dir != NULL);
    for (struct dirent *e; dir != NULL && n < MANY && (e = readdir(dir)) != NULL;) {
        size_t length = strlen(e->d_name);
        if (length > 4 && strcmp(e->d_name + length - 4, ".dm2") == 0)
            names[n++] = copy(e->d_name, length);
    }
    if (dir != NULL)
        closedir(dir);
    qsort(names, n, sizeof names[0], compare_names);
    return n;
}

static const char *reports = ""; /* the folder of the expected reports, as seen from the decks */

static void check_report(const char *name, const char *text, const char *suffix)
{
    char path[300];
    (void)snprintf(path, sizeof path, "%s%.*s%s", reports, (int)strlen(name) - 4, name, suffix);
    if (getenv("DM2_REWRITE") != NULL && text[0] != '\0') {
        FILE *f = fopen(path, "wb");
        CHECK(f != NULL && fputs(text, f) >= 0 && fclose(f) == 0);
        return;
    }
    char *expected = read_all(path);
    CHECK_REPORT(strcmp(text, expected == NULL ? "" : expected) == 0, "%s gives\n%sexpected (%s)\n%s", name,
                 text, path, expected == NULL ? "(no such file)\n" : expected);
    free(expected);
}

/* Builds the model of a deck that loads, for errors that model_build alone finds: packing, time steps. */
static enum dm2_status build(const struct config *config, struct dm2_error *err)
{
    struct model *model = NULL;
    enum dm2_status status = model_build(config, &model, err);
    model_free(model);
    return status;
}

static void run_deck(const char *name, int good)
{
    struct deck_source source;
    struct deck_report report;
    struct config config;
    struct dm2_error err = {0};
    enum dm2_status status = deck_source_read(name, NULL, &source, &err);
    if (status != DM2_OK) {
        CHECK(!good);
        (void)strcat(err.text, "\n");
        check_report(name, err.text, ".err");
        return;
    }
    take_options(&source);
    status = deck_load(&source, &config, &report);
    if (!good && status == DM2_OK) {
        CHECK_EQ_INT(build(&config, &err), DM2_DECK);
        (void)strcat(err.text, "\n");
        check_report(name, err.text, ".err");
    } else {
        CHECK_REPORT(status == (good ? DM2_OK : DM2_DECK), "%s: status %d\n%s", name, (int)status,
                     report.text);
        check_report(name, report.text, good ? ".warn" : ".err");
    }
    config_free(&config);
    deck_report_free(&report);
    deck_source_free(&source);
}

/* Runs all decks of a folder, with the folder as working directory, so that messages have names without
 * folders. Returns the number of decks. */
static size_t run_folder(const char *folder, int good)
{
    char *names[MANY], back[4096];
    size_t n = list_decks(folder, names);
    CHECK(getcwd(back, sizeof back) != NULL);
    CHECK(chdir(folder) == 0);
    for (size_t i = 0; i < n; i++) {
        run_deck(names[i], good);
        free(names[i]);
    }
    CHECK(chdir(back) == 0);
    return n;
}

TEST(bad_decks_give_their_report)
{
    size_t n = run_folder("tests/decks/bad", 0);
    CHECK(n >= 50);
}

TEST(good_decks_load)
{
    CHECK(run_folder("tests/decks/good", 1) >= 3);
}

TEST(input_decks_load_as_expected)
{
    reports = "../tests/decks/input/"; /* no report: no warning */
    CHECK(run_folder("input", 1) >= 3);
    reports = "";
}

/* --- mutation --- */

static uint64_t next_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

/* Makes one to eight changes: a byte is replaced, or a range is removed, doubled, or overwritten by another
 * range. */
static void mutate(char *text, size_t *length, size_t cap, uint64_t *random)
{
    static const char alphabet[] = "{}()=,;+-*/^#\"\n\t .0123456789eE_azm\\\x00\xff\xc2\x9b";
    for (uint64_t changes = 1 + next_random(random) % 8; changes > 0 && *length > 4; changes--) {
        size_t at = next_random(random) % *length, span = 1 + next_random(random) % 40;
        if (span > *length - at)
            span = *length - at;
        switch (next_random(random) % 4) {
        case 0:
            text[at] = alphabet[next_random(random) % (sizeof alphabet - 1)];
            break;
        case 1:
            memmove(text + at, text + at + span, *length - at - span);
            *length -= span;
            break;
        case 2:
            if (*length + span < cap) {
                memmove(text + at + span, text + at, *length - at);
                *length += span;
            }
            break;
        default:
            memmove(text + at, text + next_random(random) % (*length - span + 1), span);
        }
    }
    text[*length] = '\0';
}

static void mutate_deck(const char *path, int times, uint64_t *random)
{
    char *original = read_all(path);
    CHECK(original != NULL);
    if (original == NULL)
        return;
    size_t cap = 2 * strlen(original) + 1000;
    char *text = malloc(cap + 1);
    for (int i = 0; i < times; i++) {
        struct deck_text one = {(char *)"mutant", text, strlen(original)};
        struct deck_source source = {.texts = &one, .n_texts = 1, .steps = -1};
        struct deck_report report;
        struct config config;
        memcpy(text, original, one.length + 1);
        mutate(text, &one.length, cap, random);
        enum dm2_status status = deck_load(&source, &config, &report);
        CHECK(status == DM2_OK || status == DM2_DECK);
        CHECK((status == DM2_DECK) == (report.n_errors > 0));
        CHECK(report.n_errors <= 20 && report.n_warnings <= 20);
        config_free(&config);
        deck_report_free(&report);
    }
    free(text);
    free(original);
}

TEST(no_mutation_crashes)
{
    char *names[MANY], path[400];
    static const char *const folders[] = {"input", "tests/decks/good", "tests/decks/bad"};
    uint64_t random = 0x9e3779b97f4a7c15u;
    for (size_t f = 0; f < 3; f++) {
        size_t n = list_decks(folders[f], names);
        for (size_t i = 0; i < n; i++) {
            (void)snprintf(path, sizeof path, "%s/%s", folders[f], names[i]);
            mutate_deck(path, f < 2 ? 600 : 20, &random);
            free(names[i]);
        }
    }
}

TEST_MAIN(CASE(bad_decks_give_their_report), CASE(good_decks_load), CASE(input_decks_load_as_expected),
          CASE(no_mutation_crashes))
