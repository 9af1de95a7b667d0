/* Expressions: tokens to nodes, nodes to quantities. */
#ifndef DM2_DECK_EXPR_H
#define DM2_DECK_EXPR_H

#include "lex.h"
#include "tree.h"

/* Where the parser stands in the tokens of one text. */
struct deck_parser {
    struct deck_tree *tree;
    struct findings *findings;
    const struct tokens *tokens;
    size_t at;
    int text;
    int parens;      /* open ones: line ends do not count inside */
    size_t line_end; /* the first line end that was passed over since; 0: none */
    int depth;
};

/* The next token, which the parser does not move past; the place of any token. */
const struct token *parser_peek(struct deck_parser *p);
struct deck_place parser_place(const struct deck_parser *p, const struct token *t);

/* "found ..." for messages. */
const char *parser_found(const struct deck_parser *p, const struct token *t, struct place_text *out);

/* Reads one expression and gives its node. Node 0 is the bad one: it was reported, and the caller skips to
 * the end of its statement. In a list of values, `a -b` ends before the minus (a blank before it and none
 * behind). */
int32_t expr_parse(struct deck_parser *p);

/* Evaluates. False: a finding was added, or was before. */
bool expr_eval(const struct deck_tree *tree, int32_t node, struct findings *findings, struct quantity *out);

/* Evaluates a let (once). */
bool expr_eval_let(const struct deck_tree *tree, struct deck_let *let, struct findings *findings,
                   struct quantity *out);

/* A word that a let cannot take: unit, function, constant. Says which in *why. */
bool expr_reserved(const char *word, size_t length, const char **why);

#endif
