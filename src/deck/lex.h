/* A deck's text as tokens. */
#ifndef DM2_DECK_LEX_H
#define DM2_DECK_LEX_H

#include <stdbool.h>
#include <stddef.h>

#include "findings.h"

/* The kind of punctuation is its character: { } ( ) = , ; + - * / ^ */
enum token_kind {
    TOKEN_END = 0,
    TOKEN_NEWLINE = '\n',
    TOKEN_WORD = 256, /* a letter or _, then letters, digits, _ */
    TOKEN_NUMBER,     /* digits with point and exponent, valid to the end */
    TOKEN_STRING,     /* including the quotes */
    TOKEN_BAD         /* an invalid text, reported already: no further finding may come from this token */
};

struct token {
    int kind;
    bool spaced; /* a blank or the beginning of a line is before the token */
    size_t offset, length;
};

struct tokens {
    struct token *items; /* the last token is TOKEN_END */
    size_t n, cap;
};

/* The most tokens of a deck, the most characters of a number. */
enum { DECK_MAX_TOKENS = 4000000, DECK_MAX_NUMBER = 100 };

/* Appends the tokens of one text to *out. A text that does not read gives a finding and a TOKEN_BAD. *budget
 * is the number of tokens that the whole deck may still have, and is lowered. False: no memory (noted in the
 * findings), or *budget is used up (a finding); the tokens then end early. The caller frees out->items in
 * both cases. */
bool deck_lex(const char *text, size_t length, int text_index, size_t *budget, struct tokens *out,
              struct findings *findings);

/* Is texts[text] of findings->source plain ASCII? False: a finding names its first character that is not. */
bool lex_check_ascii(struct findings *findings, int text);

#endif
