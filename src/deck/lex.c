/* The lexer reads the bytes once. A byte outside comments and strings must be ASCII. The list of tokens ends
 * in TOKEN_END for any text.
 *
 * A number must read to its end: `1.2.3`, `0x10` and `1e` are errors, never the number that a prefix of them
 * would be. A unit may follow without a blank (`3cm`), so the lexer looks up the word after the digits as a
 * unit. The lexer uses no other meaning of words. */
#include "lex.h"

#include <string.h>

#include "dm2/base/mem.h"
#include "units.h"

struct lexer {
    const char *text;
    size_t length, at;
    int text_index;
    bool spaced;
    bool bad_byte_reported; /* a byte that no text may have was found; only the first is a finding */
    size_t *budget;
    struct tokens *out;
    struct findings *findings;
};

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/* The byte at `at`; NUL after the end. */
static char byte_at(const struct lexer *lex, size_t at)
{
    return at < lex->length ? lex->text[at] : '\0';
}

static struct deck_place place_of(const struct lexer *lex, size_t from, size_t to)
{
    return (struct deck_place){lex->text_index, from, to - from};
}

static bool push_token(struct lexer *lex, int kind, size_t from, size_t to)
{
    struct tokens *out = lex->out;
    struct token *grown = mem_grown(out->items, &out->cap, out->n, out->n + 2, sizeof *grown);
    if (grown == NULL) {
        lex->findings->no_memory = true;
        return false;
    }
    out->items = grown;
    if (kind != TOKEN_END && *lex->budget == 0) {
        findings_error(lex->findings, place_of(lex, from, to), "the deck has more than %d tokens",
                       DECK_MAX_TOKENS);
        return false;
    }
    if (kind != TOKEN_END)
        --*lex->budget;
    out->items[out->n++] = (struct token){kind, lex->spaced, from, to - from};
    lex->spaced = false;
    lex->at = to;
    return true;
}

static size_t word_end(const struct lexer *lex, size_t at)
{
    while (is_letter(byte_at(lex, at)) || is_digit(byte_at(lex, at)))
        at++;
    return at;
}

static size_t digits_end(const struct lexer *lex, size_t at)
{
    while (is_digit(byte_at(lex, at)))
        at++;
    return at;
}

/* The end of the bytes that look like parts of an invalid number. */
static size_t broken_number_end(const struct lexer *lex, size_t at)
{
    for (;; at++) {
        char c = byte_at(lex, at), before = at > 0 ? lex->text[at - 1] : '\0';
        bool sign =
            (c == '+' || c == '-') && (before == 'e' || before == 'E') && is_digit(byte_at(lex, at + 1));
        if (!is_letter(c) && !is_digit(c) && c != '.' && !sign)
            return at;
    }
}

static bool lex_number(struct lexer *lex)
{
    size_t from = lex->at, to = digits_end(lex, from);
    if (byte_at(lex, to) == '.')
        to = digits_end(lex, to + 1);
    bool has_digit = to - from > 1 || is_digit(lex->text[from]);
    char e = byte_at(lex, to), sign = byte_at(lex, to + 1);
    if (has_digit && (e == 'e' || e == 'E')) {
        size_t digits = to + (sign == '+' || sign == '-' ? 2u : 1u);
        if (is_digit(byte_at(lex, digits)))
            to = digits_end(lex, digits);
    }
    struct unit unit;
    size_t suffix = word_end(lex, to);
    bool reads =
        has_digit && byte_at(lex, suffix) != '.' &&
        (suffix == to || (is_letter(byte_at(lex, to)) && unit_find(lex->text + to, suffix - to, &unit)));
    if (reads && to - from <= DECK_MAX_NUMBER)
        return push_token(lex, TOKEN_NUMBER, from, to);
    if (reads) {
        findings_error(lex->findings, place_of(lex, from, to), "this number has more than %d characters",
                       DECK_MAX_NUMBER);
        return push_token(lex, TOKEN_BAD, from, to);
    }
    struct place_text number;
    size_t end = broken_number_end(lex, to);
    struct deck_place all = place_of(lex, from, end > from ? end : from + 1);
    findings_error(lex->findings, all, "'%s' does not read to its end as a number, nor as one with a unit",
                   place_text(lex->findings->source, all, &number));
    return push_token(lex, TOKEN_BAD, from, from + all.length);
}

static bool lex_string(struct lexer *lex)
{
    size_t from = lex->at, to = from + 1;
    while (to < lex->length && lex->text[to] != '"' && lex->text[to] != '\n')
        to++;
    if (byte_at(lex, to) == '"')
        return push_token(lex, TOKEN_STRING, from, to + 1);
    findings_error(lex->findings, place_of(lex, from, from + 1),
                   "this string has no closing '\"' on its line");
    return push_token(lex, TOKEN_BAD, from, to);
}

static bool lex_bad_byte(struct lexer *lex)
{
    size_t from = lex->at, to = from + 1;
    unsigned char c = (unsigned char)lex->text[from];
    while (to < lex->length && ((unsigned char)lex->text[to] & 0xc0u) == 0x80u && c >= 0x80)
        to++;
    struct place_text text;
    struct deck_place all = place_of(lex, from, to);
    if (lex->bad_byte_reported)
        return push_token(lex, TOKEN_BAD, from, to);
    lex->bad_byte_reported = c < 0x20 || c >= 0x7f;
    if (c == 0)
        findings_error(lex->findings, all, "a NUL byte is no part of a deck: is this a binary file?");
    else if (c < 0x20 || c == 0x7f)
        findings_error(lex->findings, all, "a control character (code %d) is no part of a deck", c);
    else if (c >= 0x80)
        findings_error(lex->findings, all, "outside comments and strings a deck is plain ASCII, without '%s'",
                       place_text(lex->findings->source, all, &text));
    else
        findings_error(lex->findings, all, "'%c' has no meaning in a deck", c);
    return push_token(lex, TOKEN_BAD, from, to);
}

static bool lex_token(struct lexer *lex)
{
    char c = lex->text[lex->at];
    if (is_letter(c))
        return push_token(lex, TOKEN_WORD, lex->at, word_end(lex, lex->at));
    if (is_digit(c) || c == '.')
        return lex_number(lex);
    if (c == '"')
        return lex_string(lex);
    if (c == '\n') {
        bool ok = push_token(lex, TOKEN_NEWLINE, lex->at, lex->at + 1);
        lex->spaced = true;
        return ok;
    }
    if (c != '\0' && strchr("{}()=,;+-*/^", c) != NULL)
        return push_token(lex, c, lex->at, lex->at + 1);
    return lex_bad_byte(lex);
}

bool deck_lex(const char *text, size_t length, int text_index, size_t *budget, struct tokens *out,
              struct findings *findings)
{
    struct lexer lex = {.text = text,
                        .length = length,
                        .text_index = text_index,
                        .spaced = true,
                        .budget = budget,
                        .out = out,
                        .findings = findings};
    bool ok = true;
    while (ok && lex.at < length) {
        char c = text[lex.at];
        if (c == ' ' || c == '\t' || c == '\r') {
            lex.at++;
            lex.spaced = true;
        } else if (c == '#') {
            while (lex.at < length && text[lex.at] != '\n')
                lex.at++;
        } else {
            ok = lex_token(&lex);
        }
    }
    return push_token(&lex, TOKEN_END, lex.at, lex.at) && ok;
}
