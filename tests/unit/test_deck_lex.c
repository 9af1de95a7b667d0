/* Tokens: kinds and extents. The tokens of any text end in TOKEN_END. */
#include "deck/lex.h"
#include "check.h"

struct lexed {
    struct tokens tokens;
    struct findings findings;
    size_t budget;
    int ok;
};

static void lex(const char *text, size_t length, struct lexed *out)
{
    static struct deck_text one = {(char *)"deck", NULL, 0};
    static struct deck_source source;
    one.text = (char *)text;
    one.length = length;
    source = (struct deck_source){.texts = &one, .n_texts = 1, .steps = -1};
    memset(out, 0, sizeof *out);
    out->budget = 1000;
    findings_start(&out->findings, &source);
    out->ok = deck_lex(text, length, 0, &out->budget, &out->tokens, &out->findings);
    CHECK(out->tokens.n > 0 && out->tokens.items[out->tokens.n - 1].kind == TOKEN_END);
}

/* The kinds of the tokens, one letter for each. */
static const char *kinds(const struct lexed *l, char *out)
{
    size_t n = 0;
    for (; n < l->tokens.n && n < 60; n++) {
        int kind = l->tokens.items[n].kind;
        out[n] = kind == TOKEN_WORD     ? 'w'
                 : kind == TOKEN_NUMBER ? 'n'
                 : kind == TOKEN_STRING ? 's'
                 : kind == TOKEN_BAD    ? '!'
                 : kind == TOKEN_END    ? '.'
                 : kind == '\n'         ? '/'
                                        : (char)kind;
    }
    out[n] = '\0';
    return out;
}

static void check_kinds(const char *text, const char *want, int errors)
{
    struct lexed l;
    char got[64];
    lex(text, strlen(text), &l);
    CHECK_REPORT(strcmp(kinds(&l, got), want) == 0, "'%s' is '%s', expected '%s'", text, got, want);
    CHECK_EQ_INT(l.findings.n_errors, errors);
    free(l.tokens.items);
}

TEST(kinds_of_tokens)
{
    check_kinds("", ".", 0);
    check_kinds("let a = 3 # b = 4\n", "ww=n/.", 0);
    check_kinds("domain{size=2.2*scale 1;}", "w{w=n*wn;}.", 0);
    check_kinds("include \"a b\"", "ws.", 0);
    check_kinds("1e5 1e-5 1.e5 .5E+5", "nnnn.", 0);
    check_kinds("3cm 25ns/2 8.874g/cm3 2eV", "nwnw/nnw/wnw.", 0);
    check_kinds("a-b -b", "w-w-w.", 0);
}

TEST(broken_numbers)
{
    check_kinds("1.2.3", "!.", 1);
    check_kinds("0x10", "!.", 1);
    check_kinds("1e", "!.", 1);
    check_kinds("1e+", "!+.", 1);
    check_kinds("1..2", "!.", 1);
    check_kinds(".", "!.", 1);
    check_kinds("1_000", "!.", 1);
    check_kinds("12abc+3", "!+n.", 1);
    check_kinds("1m.5", "!.", 1);
    check_kinds("1e5.2 7", "!n.", 1);
}

TEST(strangers)
{
    struct lexed l;
    char got[64];
    check_kinds("a $ b", "w!w.", 1);
    check_kinds("\xc2\xb5s", "!w.", 1);
    check_kinds("\"open\nb", "!/w.", 1);
    lex("a\0b\0c", 5, &l);
    CHECK_STR(kinds(&l, got), "w!w!w.");
    CHECK_EQ_INT(l.findings.n_errors, 1);
    free(l.tokens.items);
}

TEST(blanks_are_noted)
{
    struct lexed l;
    lex("a -b - c-d", 10, &l);
    static const int spaced[] = {1, 1, 0, 1, 1, 0, 0};
    for (size_t i = 0; i < 7; i++)
        CHECK_EQ_INT(l.tokens.items[i].spaced, spaced[i]);
    free(l.tokens.items);
}

TEST(the_budget_ends)
{
    struct lexed l;
    char text[4000];
    memset(text, '+', sizeof text);
    lex(text, sizeof text, &l);
    CHECK(!l.ok);
    CHECK_EQ_INT(l.tokens.n, 1001);
    CHECK_EQ_INT(l.findings.n_errors, 1);
    free(l.tokens.items);
}

TEST_MAIN(CASE(kinds_of_tokens), CASE(broken_numbers), CASE(strangers), CASE(blanks_are_noted),
          CASE(the_budget_ends))
