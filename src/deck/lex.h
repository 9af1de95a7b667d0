/* A deck's text as tokens. */
#ifndef DM2_DECK_LEX_H
#define DM2_DECK_LEX_H

#include <stdbool.h>
#include <stddef.h>

#include "findings.h"

/* Punctuation is its own character: { } ( ) = , ; + - * / ^ */
enum token_kind {
    TOKEN_END = 0,
    TOKEN_NEWLINE = '\n',
    TOKEN_WORD = 256, /* a letter or _, then letters, digits, _ */
    TOKEN_NUMBER,     /* digits with point and exponent; reads to its end */
    TOKEN_STRING,     /* with its quotes */
    TOKEN_BAD         /* something that was reported: no further finding should come from it */
};

struct token {
    int kind;
    bool spaced; /* a blank or a line's beginning is before it */
    size_t offset, length;
};

struct tokens {
    struct token *items; /* the last one is TOKEN_END */
    size_t n, cap;
};

/* No deck has more tokens, no number more characters. */
enum { DECK_MAX_TOKENS = 1000000, DECK_MAX_NUMBER = 100 };

/* Appends the tokens of one text. What does not read is a finding and a TOKEN_BAD. `budget` is the number of
 * tokens that the whole deck may still have; it is lowered. False: no memory (noted in the findings) or the
 * budget was used up (a finding); the tokens then end early. */
bool deck_lex(const char *text, size_t length, int text_index, size_t *budget, struct tokens *out,
              struct findings *findings);

#endif
