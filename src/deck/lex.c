/* The lexer reads the bytes once. A byte outside comments and strings must be ASCII. The list of tokens ends
 * in TOKEN_END for any text.
 *
 * A number must read to its end: `1.2.3`, `0x10` and `1e` are errors, never the number that a prefix of them
 * would be. A unit may follow without a blank (`3cm`), so the lexer looks up the word after the digits as a
 * unit. The lexer uses no other meaning of words. */
#include "lex.h"

#include <stdint.h>
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

/* Characters of web pages and text processors that stand for one of ASCII, or are not seen. */
static const struct lookalike {
    uint32_t code;
    const char *name, *remedy;
} lookalikes[] = {
    {0x00a0, "a no-break space", "put an ordinary blank"},
    {0x00ad, "a soft hyphen", "take it out"},
    {0x00b2, "a superscript two", "put ^2"},
    {0x00b3, "a superscript three", "put ^3"},
    {0x00b5, "a micro sign", "put u, as in us"},
    {0x00b7, "a middle dot", "put *"},
    {0x00d7, "a multiplication sign", "put *"},
    {0x03bc, "a Greek mu", "put u, as in us"},
    {0x2010, "a hyphen", "put an ordinary -"},
    {0x2011, "a no-break hyphen", "put an ordinary -"},
    {0x2012, "a figure dash", "put an ordinary -"},
    {0x2013, "an en dash", "put an ordinary -"},
    {0x2014, "an em dash", "put an ordinary -"},
    {0x2018, "a typographic quote", "put an ordinary \""},
    {0x2019, "a typographic quote", "put an ordinary \""},
    {0x201a, "a typographic quote", "put an ordinary \""},
    {0x201c, "a typographic quote", "put an ordinary \""},
    {0x201d, "a typographic quote", "put an ordinary \""},
    {0x201e, "a typographic quote", "put an ordinary \""},
    {0x00ab, "a typographic quote", "put an ordinary \""},
    {0x00bb, "a typographic quote", "put an ordinary \""},
    {0x200b, "a zero-width space", "take it out"},
    {0x200c, "a zero-width character", "take it out"},
    {0x200d, "a zero-width character", "take it out"},
    {0x2028, "a line separator", "put an ordinary line end"},
    {0x2029, "a paragraph separator", "put an ordinary line end"},
    {0x202f, "a narrow no-break space", "put an ordinary blank"},
    {0x2060, "a word joiner", "take it out"},
    {0x2212, "a minus sign", "put an ordinary -"},
    {0x3000, "an ideographic space", "put an ordinary blank"},
    {0xfeff, "a byte order mark", "take it out"},
};

/* The code point of `n` bytes of UTF-8; 0 where they are none. */
static uint32_t code_point(const char *text, size_t n)
{
    static const unsigned char lead[] = {0, 0, 0xc0, 0xe0, 0xf0};
    unsigned char c = (unsigned char)text[0];
    if (n < 2 || n > 4 || (c & (0xff00u >> (n + 1)) & 0xff) != lead[n])
        return 0;
    uint32_t code = c & (0xffu >> (n + 1));
    for (size_t i = 1; i < n; i++)
        code = code << 6 | ((unsigned char)text[i] & 0x3fu);
    return code;
}

/* Reports a character outside ASCII: by name where a lookalike of ASCII is known, else as such. */
static void report_character(struct findings *findings, struct deck_place all)
{
    const char *bytes = findings->source->texts[all.text].text + all.offset;
    uint32_t code = code_point(bytes, all.length);
    struct place_text text;
    for (size_t k = 0; k < sizeof lookalikes / sizeof lookalikes[0]; k++)
        if (lookalikes[k].code == code) {
            findings_error(findings, all, "%s (U+%04X) is no part of a deck: %s", lookalikes[k].name,
                           (unsigned)code, lookalikes[k].remedy);
            return;
        }
    if (code >= 0x2000 && code <= 0x200a)
        findings_error(findings, all, "a typographic space (U+%04X): put an ordinary blank", (unsigned)code);
    else if (code == 0)
        findings_error(findings, all,
                       "a byte %02X (hexadecimal) that is no UTF-8: save the file as plain text, UTF-8",
                       (unsigned char)bytes[0]);
    else
        findings_error(findings, all,
                       "outside comments and strings a deck is plain ASCII, without '%s' (U+%04X)",
                       place_text(findings->source, all, &text), (unsigned)code);
}

/* The end of the character at text[from]: behind the bytes of UTF-8 that continue it. */
static size_t character_end(const char *text, size_t length, size_t from)
{
    size_t to = from + 1;
    unsigned char c = (unsigned char)text[from];
    while (to < length && to < from + 4 && ((unsigned char)text[to] & 0xc0u) == 0x80u && c >= 0xc0)
        to++;
    return to;
}

bool lex_check_ascii(struct findings *findings, int text)
{
    const struct deck_text *t = &findings->source->texts[text];
    size_t from = 0;
    while (from < t->length && (unsigned char)t->text[from] < 0x80)
        from++;
    if (from == t->length)
        return true;
    size_t to = character_end(t->text, t->length, from);
    report_character(findings, (struct deck_place){text, from, to - from});
    return false;
}

static bool lex_bad_byte(struct lexer *lex)
{
    size_t from = lex->at, to = character_end(lex->text, lex->length, from);
    unsigned char c = (unsigned char)lex->text[from];
    struct deck_place all = place_of(lex, from, to);
    if (lex->bad_byte_reported)
        return push_token(lex, TOKEN_BAD, from, to);
    lex->bad_byte_reported = c < 0x20 || c >= 0x7f;
    if (c == 0)
        findings_error(lex->findings, all, "a NUL byte is no part of a deck: is this a binary file?");
    else if (c < 0x20 || c == 0x7f)
        findings_error(lex->findings, all, "a control character (code %d) is no part of a deck", c);
    else if (c >= 0x80)
        report_character(lex->findings, all);
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
