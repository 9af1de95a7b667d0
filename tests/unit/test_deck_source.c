/* Reading of decks from disk: included files, files that cannot be read, and limits on sources that come from
 * a socket. */
#include "dm2/base/words.h"
#include "deck/findings.h"
#include "deck/source.h"
#include "check.h"
#include "deck_help.h"
#include "scratch.h"

TEST(included_files_are_read_once)
{
    scratch_begin();
    (void)mkdir(scratch_path("sub"), 0777);
    scratch_write("main",
                  "include \"a\"\ndomain { x = include \"no\" }\n# include \"no\"\nlet x = 1; include "
                  "\"sub/b\" ; include \"a\"\n"
                  "include \"../no\"\ninclude \"/no\"\ninclude no\n");
    scratch_write("a", "include \"main\"\n");
    scratch_write("sub/b", "include \"c\"");
    scratch_write("sub/c", "include \"./c\"");
    struct deck_source s;
    struct dm2_error err = {0};
    CHECK_EQ_INT(deck_source_read(scratch_path("main"), NULL, &s, &err), DM2_OK);
    CHECK_STR(err.text, "");
    CHECK_EQ_INT(s.n_texts, 4);
    if (s.n_texts == 4) {
        CHECK_STR(s.texts[1].name, scratch_path("a"));
        CHECK_STR(s.texts[2].name, scratch_path("sub/b"));
        CHECK_STR(s.texts[3].name, scratch_path("sub/c"));
        CHECK_EQ_INT(s.texts[3].length, 13);
    }
    CHECK_EQ_INT(s.steps, -1);
    deck_source_free(&s);
    scratch_end();
}

TEST(what_cannot_be_read)
{
    struct deck_source s;
    struct dm2_error err;
    scratch_begin();
    CHECK_EQ_INT(deck_source_read(scratch_path("absent"), NULL, &s, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "No such file");
    CHECK_EQ_INT(deck_source_read(scratch_directory, NULL, &s, &err), DM2_IO);
    CHECK_CONTAINS(err.text, scratch_directory);
    CHECK_EQ_INT(mkfifo(scratch_path("pipe"), 0600), 0);
    CHECK_EQ_INT(deck_source_read(scratch_path("pipe"), NULL, &s, &err), DM2_IO);
    scratch_write("main", "\n\ninclude \"pipe\"\n");
    CHECK_EQ_INT(deck_source_read(scratch_path("main"), NULL, &s, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "main:3: ");
    CHECK_EQ_INT(s.n_texts, 0);
    /* A sparse file of 49 MiB. */
    scratch_write("large", "#");
    CHECK_EQ_INT(truncate(scratch_path("large"), 49 << 20), 0);
    CHECK_EQ_INT(deck_source_read(scratch_path("large"), NULL, &s, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "50331648");
    scratch_end();
}

TEST(too_many_files)
{
    struct deck_source s;
    struct dm2_error err;
    char name[20], text[60];
    scratch_begin();
    for (int i = 0; i < 70; i++) {
        (void)snprintf(name, sizeof name, "f%d", i);
        (void)snprintf(text, sizeof text, "include \"f%d\"\n", i + 1);
        scratch_write(name, text);
    }
    CHECK_EQ_INT(deck_source_read(scratch_path("f0"), NULL, &s, &err), DM2_DECK);
    CHECK_CONTAINS(err.text, "more than 63 files");
    scratch_end();
}

static void check_name(const char *includer, const char *path, const char *want)
{
    char *name = deck_source_include(includer, path, strlen(path));
    CHECK_STR(name == NULL ? "(none)" : name, want);
    free(name);
}

TEST(names_of_included_files)
{
    check_name("main.dm2", "a.dm2", "a.dm2");
    check_name("dir/main.dm2", "a.dm2", "dir/a.dm2");
    check_name("/x/y/main", "sub/a", "/x/y/sub/a");
    check_name("main", "././a", "a");
    check_name("main", "a..b/..c", "a..b/..c");
    check_name("main", "", "(none)");
    check_name("main", "/a", "(none)");
    check_name("main", "..", "(none)");
    check_name("main", "a/../b", "(none)");
    check_name("main", "./..", "(none)");
    check_name("main", "a\tb", "(none)");
    /* A file has one name, and no spelling leads out of the folder. */
    check_name("main", "x//y/./z", "x/y/z");
    check_name("d/main", ".//etc/x", "(none)");
    check_name("main", "././/etc/x", "(none)");
    check_name("main", ".///etc/x", "(none)");
    check_name("main", "x/.//etc/y", "x/etc/y");
    check_name("main", "./", "(none)");
    check_name("main", ".", "(none)");
}

/* deck_load checks every limit of a source, because a source may come from a socket. */
TEST(sources_from_elsewhere)
{
    struct loaded l;
    struct deck_source empty = {.steps = -1};
    l.status = deck_load(&empty, &l.config, &l.report);
    CHECK_EQ_INT(l.status, DM2_DECK);
    CHECK_EQ_INT(l.report.n_errors, 1);
    loaded_free(&l);

    size_t n = (48 << 20) + 1;
    char *text = malloc(n + 1);
    memset(text, '\n', n);
    text[n] = '\0';
    l = load_text(text, NULL, -1);
    CHECK_CONTAINS(l.report.text, "larger than 48 MiB");
    loaded_free(&l);
    /* Above the limit of tokens. */
    memset(text, ';', n);
    text[4000001] = '\0';
    l = load_text(text, NULL, -1);
    CHECK_CONTAINS(l.report.text, "more than 4000000 tokens");
    loaded_free(&l);
    for (size_t i = 0; i < 900000; i++)
        text[i] = "a{b=1}"[i % 6];
    text[900000] = '\0';
    l = load_text(text, NULL, -1);
    CHECK_CONTAINS(l.report.text, "too many errors");
    loaded_free(&l);
    free(text);
    l = load_text("include \"elsewhere\"\n", NULL, -1);
    CHECK_CONTAINS(l.report.text, "is not among the deck's texts");
    CHECK_EQ_INT(l.report.n_errors, 1);
    loaded_free(&l);
}

/* Many valid bodies and lets: the time of loading does not grow with the square of their number. */
TEST(a_large_deck)
{
    size_t cap = 16 << 20, used = 0;
    char *text = malloc(cap);
    used += (size_t)snprintf(
        text, cap,
        "domain { size = 1000 1000; r_c = 0.11; delta_r = 0.01 }\ntime { dt = 1; steps = 1 }\n"
        "material M { rho0 = 1; c0 = 1; s = 1 }\n");
    for (int i = 0; i < 9000; i++)
        used += (size_t)snprintf(text + used, cap - used, "let x%d_ = %d\n", i, i % 900);
    for (int i = 0; i < 9000; i++)
        used += (size_t)snprintf(
            text + used, cap - used,
            "body b%d { shape = disc x%d_ + 0.5, %d.5, 0.4; spacing = 0.1; material = M }\n", i, i, i / 900);
    struct loaded l = load_text(text, NULL, -1);
    CHECK_STR(l.report.text, "");
    CHECK_EQ_INT(l.config.n_bodies, 9000);
    loaded_free(&l);
    free(text);
}

static const char *fruit_at(const void *context, size_t i)
{
    return ((const char *const *)context)[i];
}

TEST(nearest_words)
{
    static const char *const fruit[] = {"apple", "banana", "s", "c0"};
    struct word_list known = {fruit_at, fruit, 4};
    struct word_hint hint;
    CHECK_STR(words_hint(&known, "aple", 4, &hint), "; did you mean 'apple'?");
    CHECK_STR(words_hint(&known, "APPLE", 5, &hint), "; did you mean 'apple'?");
    CHECK_STR(words_hint(&known, "banaan", 6, &hint), "; did you mean 'banana'?");
    CHECK_STR(words_hint(&known, "C0", 2, &hint), "; did you mean 'c0'?");
    CHECK_STR(words_hint(&known, "S", 1, &hint), "; did you mean 's'?");
    CHECK_STR(words_hint(&known, "x", 1, &hint), "; known: apple, banana, s, c0");
    CHECK_STR(words_hint(&known, "cherry", 6, &hint), "; known: apple, banana, s, c0");
    known.n = 0;
    CHECK_STR(words_hint(&known, "x", 1, &hint), "");
    CHECK_EQ_INT(words_distance("abc", 3, "acb", 3), WORDS_LETTER);
    CHECK_EQ_INT(words_distance("abc", 3, "", 0), 3 * WORDS_LETTER);
}

/* Carets below tabs and below characters of several bytes, windows in long lines, and reports without control
 * bytes for a terminal. */
TEST(reports_are_printable)
{
    struct loaded l = load_text("#\n\ttime { dt = \"\xc3\xa9\" x } # \x1b[0m\xc2\x9b\xff", NULL, -1);
    CHECK_CONTAINS(l.report.text, "deck:2:18: error");
    CHECK_CONTAINS(l.report.text, "\n    \ttime { dt = \"\xc3\xa9\" x } # ?[0m??");
    CHECK_CONTAINS(l.report.text, "\n    \t                ^\n");
    for (const char *c = l.report.text; *c != '\0'; c++)
        CHECK(*c == '\n' || *c == '\t' || (unsigned char)*c >= 0x20);
    CHECK(strstr(l.report.text, "\xc2\x9b") == NULL && strstr(l.report.text, "\xff") == NULL);
    loaded_free(&l);
}

TEST_MAIN(CASE(included_files_are_read_once), CASE(what_cannot_be_read), CASE(too_many_files),
          CASE(names_of_included_files), CASE(sources_from_elsewhere), CASE(a_large_deck),
          CASE(nearest_words), CASE(reports_are_printable))
