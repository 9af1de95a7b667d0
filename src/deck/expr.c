/* Parsing of expressions by precedence climbing over + - * / ^, unary minus, calls, and numbers with units.
 *
 * A unit binds to the number before it more tightly than any operator, so that `a/400 m/s` is a/(400 m/s). A
 * unit continues as long as * or / is followed by another unit. Every failure, lack of memory included, gives
 * node 0, the bad node, so that every node that a caller gets has a valid index. Depth is bounded during
 * parsing (recursion) and in the nodes (a long chain of additions is a deep tree), so that the evaluation
 * cannot exhaust the stack. */
#include "expr.h"

#include <math.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "functions.h"

const struct token *parser_peek(struct deck_parser *p)
{
    while (p->parens > 0 && p->tokens->items[p->at].kind == TOKEN_NEWLINE) {
        if (p->line_end == 0)
            p->line_end = p->at;
        p->at++;
    }
    return &p->tokens->items[p->at];
}

struct deck_place parser_place(const struct deck_parser *p, const struct token *t)
{
    return (struct deck_place){p->text, t->offset, t->length};
}

const char *parser_found(const struct deck_parser *p, const struct token *t, struct place_text *out)
{
    if (t->kind == TOKEN_END)
        return "the end of the text";
    if (t->kind == TOKEN_NEWLINE)
        return "the end of the line";
    struct place_text word;
    (void)place_text(p->findings->source, parser_place(p, t), &word);
    if (t->kind == TOKEN_STRING)
        return place_text(p->findings->source, parser_place(p, t), out);
    size_t n = strlen(word.text);
    n = n > sizeof out->text - 3 ? sizeof out->text - 3 : n;
    out->text[0] = '\'';
    memcpy(out->text + 1, word.text, n);
    memcpy(out->text + 1 + n, "'", 2);
    return out->text;
}

static const struct token *take_token(struct deck_parser *p)
{
    const struct token *t = parser_peek(p);
    if (t->kind != TOKEN_END)
        p->at++;
    return t;
}

static int32_t add_node(struct deck_parser *p, struct deck_node node)
{
    struct deck_tree *tree = p->tree;
    struct deck_node *grown =
        mem_grown(tree->nodes, &tree->cap_nodes, tree->n_nodes, tree->n_nodes + 1, sizeof *grown);
    if (grown == NULL) {
        p->findings->no_memory = true;
        return 0;
    }
    tree->nodes = grown;
    tree->nodes[tree->n_nodes] = node;
    return (int32_t)tree->n_nodes++;
}

/* Adds a leaf with this number; the same errors as add_node. */
static int32_t add_number(struct deck_parser *p, struct deck_place place, struct quantity number)
{
    return add_node(p, (struct deck_node){.kind = NODE_NUMBER,
                                          .depth = 1,
                                          .a = -1,
                                          .b = -1,
                                          .next = -1,
                                          .place = place,
                                          .op_place = place,
                                          .number = number});
}

static int32_t fail_too_deep(struct deck_parser *p, struct deck_place place)
{
    findings_error(p->findings, place, "this expression is nested more than %d deep; split it with let",
                   DECK_MAX_DEPTH);
    return 0;
}

/* Adds the node of an operator with one operand (b = -1) or two. */
static int32_t add_operation(struct deck_parser *p, enum node_kind kind, int op, struct deck_place op_place,
                             int32_t a, int32_t b)
{
    const struct deck_node *nodes = p->tree->nodes;
    if (a == 0 || b == 0)
        return 0;
    int depth = nodes[a].depth;
    if (b > 0 && nodes[b].depth > depth)
        depth = nodes[b].depth;
    if (depth >= DECK_MAX_DEPTH)
        return fail_too_deep(p, op_place);
    struct deck_place place =
        b > 0 ? place_span(nodes[a].place, nodes[b].place) : place_span(op_place, nodes[a].place);
    return add_node(p, (struct deck_node){.kind = kind,
                                          .op = op,
                                          .depth = depth + 1,
                                          .a = a,
                                          .b = b,
                                          .next = -1,
                                          .place = place,
                                          .op_place = op_place});
}

static bool find_token_unit(const struct deck_parser *p, const struct token *t, struct unit *out)
{
    return t->kind == TOKEN_WORD &&
           unit_find(place_bytes(p->findings->source, parser_place(p, t)), t->length, out);
}

/* Parses the power after a unit, `^2` or `^-1`; 1 where there is none. False: the power does not read. */
static bool parse_unit_power(struct deck_parser *p, int *power)
{
    *power = 1;
    if (parser_peek(p)->kind != '^')
        return true;
    (void)take_token(p);
    bool negative = parser_peek(p)->kind == '-';
    if (negative)
        (void)take_token(p);
    const struct token *t = parser_peek(p);
    const char *digits = place_bytes(p->findings->source, parser_place(p, t));
    if (t->kind == TOKEN_NUMBER && t->length == 1 && digits[0] >= '0' && digits[0] <= '9') {
        (void)take_token(p);
        *power = negative ? -(digits[0] - '0') : digits[0] - '0';
        return true;
    }
    if (t->kind != TOKEN_BAD)
        findings_error(p->findings, parser_place(p, t), "the power of a unit is a whole number from 0 to 9");
    return false;
}

/* Parses the unit at the current token, if there is one (*given). *last is the last token of the unit. False:
 * the unit does not read. */
static bool parse_unit(struct deck_parser *p, struct unit *unit, const struct token **last, bool *given)
{
    struct unit symbol;
    int sign = 1, power;
    *unit = (struct unit){.factor = 1};
    *given = false;
    const struct token *t = parser_peek(p);
    while (find_token_unit(p, t, &symbol)) {
        struct deck_place at = parser_place(p, t);
        *given = true;
        (void)take_token(p);
        if (!parse_unit_power(p, &power))
            return false;
        *last = &p->tokens->items[p->at - 1];
        if (!unit_times(*unit, symbol, sign * power, unit)) {
            findings_error(p->findings, at, "this unit is out of range");
            return false;
        }
        t = parser_peek(p);
        struct unit next;
        if ((t->kind != '*' && t->kind != '/') || !find_token_unit(p, &p->tokens->items[p->at + 1], &next))
            return true;
        sign = t->kind == '*' ? 1 : -1;
        (void)take_token(p);
        t = parser_peek(p);
    }
    return true;
}

static int32_t parse_number(struct deck_parser *p)
{
    const struct token *t = take_token(p), *last = t;
    struct unit unit;
    bool with_unit;
    if (!parse_unit(p, &unit, &last, &with_unit))
        return 0;
    struct deck_place digits = parser_place(p, t), place = place_span(digits, parser_place(p, last));
    const char *text = place_bytes(p->findings->source, digits);
    struct quantity number = {unit_value(text, t->length, unit), unit.dim};
    bool zero = true;
    for (size_t i = 0; i < t->length && text[i] != 'e' && text[i] != 'E'; i++)
        zero = zero && !(text[i] >= '1' && text[i] <= '9');
    if (!isfinite(number.value) || (number.value == 0 && !zero)) {
        findings_error(p->findings, place, "this number is too %s for the arithmetic",
                       number.value == 0 ? "small" : "large");
        return 0;
    }
    return add_number(p, place, number);
}

static int32_t parse_leaf(struct deck_parser *p, enum node_kind kind)
{
    struct deck_place place = parser_place(p, take_token(p));
    return add_node(
        p, (struct deck_node){
               .kind = kind, .depth = 1, .a = -1, .b = -1, .next = -1, .place = place, .op_place = place});
}

static int32_t parse_sum(struct deck_parser *p);

/* Moves past ')'. False: another token is there, and a finding was added. */
static bool close_paren(struct deck_parser *p, const char *expected)
{
    const struct token *t = parser_peek(p);
    struct place_text found;
    if (t->kind == ')') {
        p->at++;
        p->parens--;
        return true;
    }
    if (t->kind != TOKEN_BAD)
        findings_error(p->findings, parser_place(p, t), "expected %s, found %s", expected,
                       parser_found(p, t, &found));
    return false;
}

/* Multiplies node a by the unit after its ')', if there is one. */
static int32_t multiply_by_unit(struct deck_parser *p, int32_t a)
{
    struct unit unit;
    bool given;
    const struct token *first = &p->tokens->items[p->at], *last = first;
    if (!parse_unit(p, &unit, &last, &given) || a == 0)
        return 0;
    if (!given)
        return a;
    struct deck_place place = place_span(parser_place(p, first), parser_place(p, last));
    struct quantity number = {unit_value("1", 1, unit), unit.dim};
    int32_t b = add_number(p, place, number);
    return add_operation(p, NODE_BINARY, '*', place, a, b);
}

static int32_t parse_parentheses(struct deck_parser *p)
{
    struct deck_place open = parser_place(p, take_token(p));
    p->parens++;
    int32_t inner = parse_sum(p);
    if (inner == 0 || !close_paren(p, "')' or an operator"))
        return 0;
    p->tree->nodes[inner].place = place_span(open, parser_place(p, &p->tokens->items[p->at - 1]));
    return multiply_by_unit(p, inner);
}

static int32_t parse_call(struct deck_parser *p)
{
    struct deck_place name = parser_place(p, take_token(p));
    int function = function_find(place_bytes(p->findings->source, name), name.length);
    if (function < 0) {
        struct word_list known = function_names();
        struct word_hint hint;
        struct place_text text;
        findings_error(p->findings, name, "there is no function '%s'%s",
                       place_text(p->findings->source, name, &text),
                       words_hint(&known, place_bytes(p->findings->source, name), name.length, &hint));
        return 0;
    }
    (void)take_token(p);
    p->parens++;
    int32_t first = -1, last = -1;
    int n = 0, depth = 0;
    do {
        if (n > 0)
            (void)take_token(p);
        int32_t argument = parse_sum(p);
        if (argument == 0)
            return 0;
        struct deck_node *nodes = p->tree->nodes;
        if (first < 0)
            first = argument;
        else
            nodes[last].next = argument;
        last = argument;
        depth = nodes[argument].depth > depth ? nodes[argument].depth : depth;
        n++;
    } while (parser_peek(p)->kind == ',');
    if (!close_paren(p, "',', ')' or an operator"))
        return 0;
    if (n < function_arguments(function) || (n > 1 && function_arguments(function) == 1)) {
        struct place_text text;
        findings_error(p->findings, name, "%s takes %s, found %d",
                       place_text(p->findings->source, name, &text),
                       function_arguments(function) == 1 ? "one value" : "two values or more", n);
        return 0;
    }
    if (depth >= DECK_MAX_DEPTH)
        return fail_too_deep(p, name);
    struct deck_place all = place_span(name, parser_place(p, &p->tokens->items[p->at - 1]));
    int32_t call = add_node(p, (struct deck_node){.kind = NODE_CALL,
                                                  .op = function,
                                                  .depth = depth + 1,
                                                  .a = first,
                                                  .b = -1,
                                                  .next = -1,
                                                  .place = all,
                                                  .op_place = name});
    return multiply_by_unit(p, call);
}

static int32_t parse_primary(struct deck_parser *p)
{
    const struct token *t = parser_peek(p);
    struct place_text found;
    switch (t->kind) {
    case TOKEN_NUMBER:
        return parse_number(p);
    case TOKEN_STRING:
        return parse_leaf(p, NODE_STRING);
    case '(':
        return parse_parentheses(p);
    case TOKEN_WORD: {
        const struct token *next = t + 1;
        bool call = next->kind == '(' &&
                    (!next->spaced ||
                     function_find(place_bytes(p->findings->source, parser_place(p, t)), t->length) >= 0);
        return call ? parse_call(p) : parse_leaf(p, NODE_WORD);
    }
    case TOKEN_BAD:
        return 0;
    default:
        findings_error(p->findings, parser_place(p, t), "expected a value, found %s",
                       parser_found(p, t, &found));
        return 0;
    }
}

static int32_t parse_unary(struct deck_parser *p);

static int32_t parse_power(struct deck_parser *p)
{
    int32_t base = parse_primary(p);
    if (base == 0 || parser_peek(p)->kind != '^')
        return base;
    struct deck_place op = parser_place(p, take_token(p));
    return add_operation(p, NODE_BINARY, '^', op, base, parse_unary(p));
}

/* Every recursion of the parser passes through parse_unary, which bounds the depth. */
static int32_t parse_unary(struct deck_parser *p)
{
    const struct token *t = parser_peek(p);
    struct deck_place op = parser_place(p, t);
    if (p->depth >= DECK_MAX_DEPTH)
        return fail_too_deep(p, op);
    p->depth++;
    int32_t node;
    if (t->kind == '-') {
        (void)take_token(p);
        node = add_operation(p, NODE_NEGATE, '-', op, parse_unary(p), -1);
    } else {
        node = parse_power(p);
    }
    p->depth--;
    return node;
}

static int32_t parse_product(struct deck_parser *p)
{
    int32_t left = parse_unary(p);
    while (left != 0 && (parser_peek(p)->kind == '*' || parser_peek(p)->kind == '/')) {
        const struct token *t = take_token(p);
        left = add_operation(p, NODE_BINARY, t->kind, parser_place(p, t), left, parse_unary(p));
    }
    return left;
}

/* True at a minus that begins the next value of a list: a blank is before the minus and none after it. */
static bool begins_next_value(const struct deck_parser *p, const struct token *t)
{
    return p->parens == 0 && t->kind == '-' && t->spaced && !(t + 1)->spaced;
}

static int32_t parse_sum(struct deck_parser *p)
{
    int32_t left = parse_product(p);
    while (left != 0) {
        const struct token *t = parser_peek(p);
        if ((t->kind != '+' && t->kind != '-') || begins_next_value(p, t))
            break;
        (void)take_token(p);
        left = add_operation(p, NODE_BINARY, t->kind, parser_place(p, t), left, parse_product(p));
    }
    return left;
}

int32_t expr_parse(struct deck_parser *p)
{
    p->parens = 0;
    p->depth = 0;
    p->line_end = 0;
    int32_t node = parse_sum(p);
    /* After a failure inside parentheses the next line is a statement of its own. */
    if (node == 0 && p->parens > 0 && p->line_end > 0)
        p->at = p->line_end;
    p->parens = 0;
    return node;
}
