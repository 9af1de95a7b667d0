/* Evaluation of expressions. Every operation checks the dimensions of its operands and that its result is
 * finite; a finding is at the operator. A let is evaluated when its value is first needed, so that the order
 * of lets does not matter. A let whose value is needed during its own evaluation refers to itself.
 *
 * Arithmetic is + - * / and sqrt on doubles, because these give the same bits on every machine. A power is a
 * repeated multiplication. */
#include <math.h>
#include <string.h>

#include "expr.h"
#include "functions.h"

/* EVAL_MAX_DEPTH bounds the recursion over the nodes of an expression and of all lets that are under
 * evaluation. */
enum { EVAL_MAX_DEPTH = 2000, POWER_MAX = 1000 };

#define PI 3.14159265358979323846

struct evaluation {
    const struct deck_tree *tree;
    struct findings *findings;
    int depth;
};

static bool eval_subtree(struct evaluation *e, int32_t index, struct quantity *out);

static bool fail_dimensions(struct evaluation *e, const struct deck_node *node, const char *what,
                            struct quantity a, struct quantity b)
{
    struct dimension_text left, right;
    findings_error(e->findings, node->op_place, "cannot %s %s and %s", what, dimension_name(a.dim, &left),
                   dimension_name(b.dim, &right));
    return false;
}

static bool check_finite(struct evaluation *e, const struct deck_node *node, double value)
{
    if (isfinite(value))
        return true;
    findings_error(e->findings, node->op_place, "the result is too large for the arithmetic");
    return false;
}

static double raise_to_power(double base, int n)
{
    double product = 1;
    for (int i = 0; i < (n < 0 ? -n : n); i++)
        product *= base;
    return n < 0 ? 1 / product : product;
}

static bool eval_power(struct evaluation *e, const struct deck_node *node, struct quantity a,
                       struct quantity b, struct quantity *out)
{
    if (!dimension_is_plain(b.dim) || b.value != floor(b.value) || fabs(b.value) > POWER_MAX) {
        findings_error(e->findings, node->op_place,
                       "a power is a whole number from -%d to %d; for a root there is sqrt", POWER_MAX,
                       POWER_MAX);
        return false;
    }
    int n = (int)b.value;
    if (a.value == 0 && n < 0) {
        findings_error(e->findings, node->op_place, "division by zero: a negative power of 0");
        return false;
    }
    struct dimension none = {0, 0, 0, 0, 0};
    if (!dimension_times(none, a.dim, n, &out->dim)) {
        findings_error(e->findings, node->op_place, "the dimension of the result is out of range");
        return false;
    }
    out->value = raise_to_power(a.value, n);
    return check_finite(e, node, out->value);
}

static bool eval_binary(struct evaluation *e, const struct deck_node *node, struct quantity *out)
{
    struct quantity a, b;
    /* Both operands are evaluated, so that the errors of both are found. */
    bool ok = eval_subtree(e, node->a, &a);
    ok = eval_subtree(e, node->b, &b) && ok;
    if (!ok)
        return false;
    *out = a;
    switch (node->op) {
    case '^':
        return eval_power(e, node, a, b, out);
    case '+':
    case '-':
        if (!dimension_equal(a.dim, b.dim))
            return fail_dimensions(e, node, node->op == '+' ? "add" : "subtract", a, b);
        out->value = node->op == '+' ? a.value + b.value : a.value - b.value;
        break;
    default:
        if (node->op == '/' && b.value == 0) {
            findings_error(e->findings, node->op_place, "division by zero");
            return false;
        }
        if (!dimension_times(a.dim, b.dim, node->op == '*' ? 1 : -1, &out->dim)) {
            findings_error(e->findings, node->op_place, "the dimension of the result is out of range");
            return false;
        }
        out->value = node->op == '*' ? a.value * b.value : a.value / b.value;
    }
    return check_finite(e, node, out->value);
}

static bool eval_sqrt(struct evaluation *e, const struct deck_node *node, struct quantity *x)
{
    struct dimension_text text;
    struct dimension d = x->dim;
    if (x->value < 0) {
        findings_error(e->findings, node->op_place, "square root of the negative number %g", x->value);
        return false;
    }
    if (d.length % 2 != 0 || d.mass % 2 != 0 || d.time % 2 != 0 || d.temperature % 2 != 0 ||
        d.amount % 2 != 0) {
        findings_error(e->findings, node->op_place, "the square root of %s has no unit",
                       dimension_name(d, &text));
        return false;
    }
    x->dim =
        (struct dimension){(signed char)(d.length / 2), (signed char)(d.mass / 2), (signed char)(d.time / 2),
                           (signed char)(d.temperature / 2), (signed char)(d.amount / 2)};
    x->value = sqrt(x->value);
    return true;
}

static bool eval_call(struct evaluation *e, const struct deck_node *node, struct quantity *out)
{
    if (!eval_subtree(e, node->a, out))
        return false;
    struct dimension_text text;
    struct quantity other;
    switch ((enum deck_function)node->op) {
    case FUNCTION_SQRT:
        return eval_sqrt(e, node, out);
    case FUNCTION_ABS:
        out->value = fabs(out->value);
        return true;
    case FUNCTION_MIN:
    case FUNCTION_MAX:
        for (int32_t i = e->tree->nodes[node->a].next; i >= 0; i = e->tree->nodes[i].next) {
            if (!eval_subtree(e, i, &other))
                return false;
            if (!dimension_equal(out->dim, other.dim))
                return fail_dimensions(e, node, "compare", *out, other);
            if (node->op == FUNCTION_MIN ? other.value < out->value : other.value > out->value)
                out->value = other.value;
        }
        return true;
    case FUNCTION_FLOOR:
    case FUNCTION_CEIL:
    case FUNCTION_ROUND:
        if (!dimension_is_plain(out->dim)) {
            findings_error(e->findings, node->op_place,
                           "%s takes a plain number, this is %s: divide by a unit first",
                           function_name(node->op), dimension_name(out->dim, &text));
            return false;
        }
        out->value = node->op == FUNCTION_FLOOR  ? floor(out->value)
                     : node->op == FUNCTION_CEIL ? ceil(out->value)
                                                 : round(out->value);
        return true;
    }
    return false;
}

static bool eval_let(struct evaluation *e, struct deck_let *let, struct quantity *out)
{
    if (let->state == LET_UNSEEN) {
        let->state = LET_UNDER_WAY;
        let->state = eval_subtree(e, let->node, &let->value) ? LET_DONE : LET_FAILED;
    }
    *out = let->value;
    return let->state == LET_DONE;
}

static bool eval_word(struct evaluation *e, const struct deck_node *node, struct quantity *out)
{
    const char *word = place_bytes(e->tree->source, node->op_place);
    struct unit unit;
    struct deck_let *let = deck_tree_let(e->tree, word, node->op_place.length);
    if (let != NULL) {
        let->used = true;
        if (let->state == LET_UNDER_WAY) {
            findings_error(e->findings, node->op_place, "the let '%s' is defined by itself", let->name);
            return false;
        }
        return eval_let(e, let, out);
    }
    if (place_is(e->tree->source, node->op_place, "pi")) {
        *out = (struct quantity){.value = PI};
        return true;
    }
    if (unit_find(word, node->op_place.length, &unit)) {
        *out = (struct quantity){unit_value("1", 1, unit), unit.dim};
        return true;
    }
    struct word_list known = deck_tree_let_names(e->tree);
    struct word_hint hint;
    struct place_text text;
    findings_error(e->findings, node->op_place, "'%s' is neither a let nor a unit%s",
                   place_text(e->tree->source, node->op_place, &text),
                   words_hint(&known, word, node->op_place.length, &hint));
    return false;
}

static bool eval_node(struct evaluation *e, const struct deck_node *node, struct quantity *out)
{
    switch (node->kind) {
    case NODE_BAD:
        return false;
    case NODE_NUMBER:
        *out = node->number;
        return true;
    case NODE_WORD:
        return eval_word(e, node, out);
    case NODE_STRING:
        findings_error(e->findings, node->place, "expected a number, found a string");
        return false;
    case NODE_NEGATE:
        if (!eval_subtree(e, node->a, out))
            return false;
        out->value = -out->value;
        return true;
    case NODE_BINARY:
        return eval_binary(e, node, out);
    case NODE_CALL:
        return eval_call(e, node, out);
    }
    return false;
}

static bool eval_subtree(struct evaluation *e, int32_t index, struct quantity *out)
{
    const struct deck_node *node = &e->tree->nodes[index];
    *out = (struct quantity){.value = 0};
    if (e->depth >= EVAL_MAX_DEPTH) {
        findings_error(e->findings, node->place, "the lets refer to one another too deeply");
        return false;
    }
    e->depth++;
    bool ok = eval_node(e, node, out);
    e->depth--;
    return ok;
}

bool expr_eval(const struct deck_tree *tree, int32_t node, struct findings *findings, struct quantity *out)
{
    struct evaluation e = {tree, findings, 0};
    return eval_subtree(&e, node, out);
}

bool expr_eval_let(const struct deck_tree *tree, struct deck_let *let, struct findings *findings,
                   struct quantity *out)
{
    struct evaluation e = {tree, findings, 0};
    return eval_let(&e, let, out);
}

bool expr_reserved(const char *word, size_t length, const char **why)
{
    struct unit unit;
    if (unit_find(word, length, &unit))
        *why = "a unit";
    else if (function_find(word, length) >= 0)
        *why = "a function";
    else if (length == 2 && memcmp(word, "pi", 2) == 0)
        *why = "a constant";
    else
        return false;
    return true;
}
