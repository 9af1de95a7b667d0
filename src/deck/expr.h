/* Expressions: from tokens to nodes (expr.c), from nodes to quantities (eval.c). */
#ifndef DM2_DECK_EXPR_H
#define DM2_DECK_EXPR_H

#include "lex.h"
#include "tree.h"

/* A position in the tokens of one text. */
struct deck_parser {
    struct deck_tree *tree;
    struct findings *findings;
    const struct tokens *tokens;
    size_t at;
    int text;
    int parens;      /* open parentheses; inside them an end of a line is no token */
    size_t line_end; /* index of the first end of a line skipped inside parentheses; 0: none */
    int depth;
};

/* parser_peek: the next token, without moving past it. parser_place: the place of any token. */
const struct token *parser_peek(struct deck_parser *p);
struct deck_place parser_place(const struct deck_parser *p, const struct token *t);

/* The token as messages of the form "found ..." name it. Returns a constant or `out->text`. */
const char *parser_found(const struct deck_parser *p, const struct token *t, struct place_text *out);

/* Reads one expression and gives its node. Node 0: the expression does not read, a finding was added, and the
 * caller skips to the end of its statement. In a list of values an expression ends before a minus that has a
 * blank before it and none after it: `a -b` is two values. */
int32_t expr_parse(struct deck_parser *p);

/* Evaluates a node. False: the node has no value; a finding is there already or was added. */
bool expr_eval(const struct deck_tree *tree, int32_t node, struct findings *findings, struct quantity *out);

/* Evaluates a let, at the first call only. False as for expr_eval. */
bool expr_eval_let(const struct deck_tree *tree, struct deck_let *let, struct findings *findings,
                   struct quantity *out);

/* True if a let cannot have this name, because the word is a unit, a function or a constant; *why says
 * which. */
bool expr_reserved(const char *word, size_t length, const char **why);

#endif
