/* Parsing of statements: let, include, blocks and their entries. After a mistake the parser continues at the
 * end of the statement (end of line or semicolon) or of the block, so that one mistake is one finding and the
 * next mistake is still found. An entry whose values do not read is kept and marked bad, so that it is not a
 * missing entry as well.
 *
 * An included text is parsed where its `include` stands, and only at the first `include` that names it. An
 * include of a text that is being parsed is a cycle. The reader of files and the parser name texts by the
 * same function, deck_source_find. */
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "expr.h"
#include "schema.h"
#include "source.h"
#include "tree.h"

enum text_state { TEXT_UNSEEN, TEXT_UNDER_WAY, TEXT_DONE };

struct parse {
    struct deck_tree *tree;
    struct findings *findings;
    size_t budget;
    unsigned char *state; /* of each text, an enum text_state */
};

static bool parse_text(struct parse *parse, int text);

/* Appends one zeroed item to an array of the tree and returns the item. NULL: no memory. */
static void *append_item(struct findings *f, void *array, size_t *n, size_t *cap, size_t size)
{
    void *items;
    memcpy(&items, array, sizeof items);
    items = mem_grown(items, cap, *n, *n + 1, size);
    if (items == NULL) {
        f->no_memory = true;
        return NULL;
    }
    memcpy(array, &items, sizeof items);
    void *item = (char *)items + *n * size;
    memset(item, 0, size);
    ++*n;
    return item;
}
#define APPEND(f, tree, array)                                                                               \
    append_item(f, &(tree)->array, &(tree)->n_##array, &(tree)->cap_##array, sizeof *(tree)->array)

static const struct token *current_token(const struct deck_parser *p)
{
    return &p->tokens->items[p->at];
}

static bool ends_statement(int kind)
{
    return kind == TOKEN_NEWLINE || kind == ';' || kind == TOKEN_END || kind == '}';
}

/* Moves past the rest of a statement that was reported. A block that begins in the rest is skipped whole. */
static void skip_statement(struct deck_parser *p)
{
    int open = 0;
    for (;; p->at++) {
        int kind = current_token(p)->kind;
        if (kind == TOKEN_END || (open == 0 && ends_statement(kind)))
            return;
        if (kind == '{')
            open++;
        else if (kind == '}' && --open == 0) {
            p->at++;
            return;
        }
    }
}

static void report_expected(struct deck_parser *p, const char *expected)
{
    struct place_text found;
    const struct token *t = current_token(p);
    if (t->kind != TOKEN_BAD)
        findings_error(p->findings, parser_place(p, t), "expected %s, found %s", expected,
                       parser_found(p, t, &found));
}

static bool expect_token(struct deck_parser *p, int kind, const char *expected)
{
    if (current_token(p)->kind == kind) {
        p->at++;
        return true;
    }
    report_expected(p, expected);
    return false;
}

/* Checks that the statement ends here. */
static void finish_statement(struct deck_parser *p)
{
    if (ends_statement(current_token(p)->kind))
        return;
    report_expected(p, "the end of the line or ';'");
    skip_statement(p);
}

static void copy_name(const struct findings *f, struct deck_place place, char out[NAME_MAX_LENGTH + 1])
{
    memcpy(out, place_bytes(f->source, place), place.length);
    out[place.length] = '\0';
}

/* --- let and -D --- */

static void parse_let(struct deck_parser *p)
{
    struct deck_tree *tree = p->tree;
    const char *why;
    struct place_text text;
    if (current_token(p)->kind != TOKEN_WORD) {
        report_expected(p, "a name after 'let'");
        skip_statement(p);
        return;
    }
    struct deck_place name = parser_place(p, current_token(p));
    p->at++;
    bool ok = true;
    if (expr_reserved(place_bytes(p->findings->source, name), name.length, &why)) {
        findings_error(p->findings, name, "'%s' is %s; a let needs another name",
                       place_text(p->findings->source, name, &text), why);
        ok = false;
    } else if (name.length > NAME_MAX_LENGTH) {
        findings_error(p->findings, name, "a name has at most %d characters", NAME_MAX_LENGTH);
        ok = false;
    } else if (tree->n_lets >= DECK_MAX_LETS) {
        findings_error(p->findings, name, "the deck has more than %d lets", DECK_MAX_LETS);
        ok = false;
    }
    int32_t node = expect_token(p, '=', "'=' after the name") ? expr_parse(p) : 0;
    if (ok) {
        struct deck_let *let = APPEND(p->findings, tree, lets);
        if (let != NULL) {
            copy_name(p->findings, name, let->name);
            let->place = name;
            let->node = node;
        }
    }
    if (node == 0)
        skip_statement(p);
    else
        finish_statement(p);
}

/* Parses one -D: the let of this name gets the expression of the definition. */
static void parse_define(struct deck_parser *p)
{
    struct deck_place name = parser_place(p, current_token(p));
    if (current_token(p)->kind != TOKEN_WORD || p->tokens->items[1].kind != '=') {
        findings_error(p->findings, name, "expected name=value");
        return;
    }
    p->at = 2;
    int32_t node = expr_parse(p);
    if (node != 0 && current_token(p)->kind != TOKEN_END) {
        report_expected(p, "the end of the definition");
        return;
    }
    const char *word = place_bytes(p->findings->source, name);
    struct deck_let *let = deck_tree_let(p->tree, word, name.length);
    if (let == NULL) {
        struct word_list known = deck_tree_let_names(p->tree);
        struct word_hint hint;
        struct place_text text;
        findings_error(p->findings, name, "the deck has no let '%s' to override%s",
                       place_text(p->findings->source, name, &text),
                       words_hint(&known, word, name.length, &hint));
        return;
    }
    let->node = node;
}

static bool parse_defines(struct parse *parse)
{
    const struct deck_source *source = parse->findings->source;
    bool ok = true;
    for (size_t i = 0; ok && i < source->n_defines; i++) {
        struct tokens tokens = {0};
        int text = (int)(source->n_texts + i);
        ok = deck_lex(source->defines[i], strlen(source->defines[i]), text, &parse->budget, &tokens,
                      parse->findings);
        struct deck_parser p = {
            .tree = parse->tree, .findings = parse->findings, .tokens = &tokens, .text = text};
        if (ok)
            parse_define(&p);
        free(tokens.items);
    }
    return ok;
}

/* --- blocks --- */

/* Parses the values of an entry up to the end of the statement. */
static void parse_values(struct deck_parser *p, size_t entry)
{
    struct deck_tree *tree = p->tree;
    bool after_comma = false;
    while (after_comma || !ends_statement(current_token(p)->kind)) {
        /* After a comma a list may continue in the next line. */
        while (after_comma && current_token(p)->kind == TOKEN_NEWLINE)
            p->at++;
        if (current_token(p)->kind == TOKEN_WORD && (current_token(p) + 1)->kind == '=') {
            /* The next entry begins here; its own parsing follows, so that this is one mistake. */
            report_expected(p,
                            tree->entries[entry].n == 0 ? "a value after '='" : "the end of the line or ';'");
            tree->entries[entry].bad |= tree->entries[entry].n == 0;
            return;
        }
        int32_t node = expr_parse(p);
        int32_t *value = APPEND(p->findings, tree, values);
        if (node == 0 || value == NULL) {
            tree->entries[entry].bad = true;
            skip_statement(p);
            return;
        }
        *value = node;
        tree->entries[entry].n++;
        after_comma = current_token(p)->kind == ',';
        if (after_comma)
            p->at++;
    }
    if (tree->entries[entry].n == 0) {
        report_expected(p, "a value after '='");
        tree->entries[entry].bad = true;
    }
}

static void parse_entry(struct deck_parser *p, size_t block)
{
    struct deck_tree *tree = p->tree;
    struct deck_place key = parser_place(p, current_token(p));
    struct place_text text, found;
    if (current_token(p)->kind != TOKEN_WORD) {
        report_expected(p, "a keyword or '}'");
        p->at += current_token(p)->kind == TOKEN_END ? 0u : 1u;
        skip_statement(p);
        return;
    }
    if (place_is(p->findings->source, key, "let") || place_is(p->findings->source, key, "include")) {
        findings_error(p->findings, key, "'%s' stands outside of blocks",
                       place_text(p->findings->source, key, &text));
        skip_statement(p);
        return;
    }
    p->at++;
    if (current_token(p)->kind != '=') {
        findings_error(p->findings, parser_place(p, current_token(p)), "expected '=' after '%s', found %s",
                       place_text(p->findings->source, key, &text),
                       parser_found(p, current_token(p), &found));
        skip_statement(p);
    }
    struct deck_entry *entry = APPEND(p->findings, tree, entries);
    if (entry == NULL)
        return;
    entry->key = key;
    entry->first = tree->n_values;
    tree->blocks[block].n_entries++;
    if (current_token(p)->kind != '=') {
        entry->bad = true;
        return;
    }
    p->at++;
    parse_values(p, tree->n_entries - 1);
}

/* True inside a block at the begin of another block, because the closing brace was forgotten. */
static bool block_begins(const struct deck_parser *p)
{
    const struct token *t = current_token(p);
    if (t->kind != TOKEN_WORD)
        return false;
    while (t->kind == TOKEN_WORD || t->kind == TOKEN_STRING)
        t++;
    return t->kind == '{';
}

/* Parses the entries of a block, from after the opening brace to after the closing brace. */
static void parse_body(struct deck_parser *p, size_t block)
{
    struct deck_place word = p->tree->blocks[block].word;
    struct place_text text;
    for (;;) {
        int kind = current_token(p)->kind;
        if (kind == TOKEN_END || block_begins(p)) {
            findings_error(p->findings, word, "the block '%s' is not closed: expected '}' before %s",
                           place_text(p->findings->source, word, &text),
                           kind == TOKEN_END ? "the end of the text" : "the next block");
            return;
        }
        if (kind == '}') {
            p->at++;
            return;
        }
        if (kind == TOKEN_NEWLINE || kind == ';')
            p->at++;
        else
            parse_entry(p, block);
        if (p->findings->no_memory)
            return;
    }
}

/* Reports `key = ...` outside any block. */
static void report_stray_entry(struct deck_parser *p)
{
    struct deck_place key = parser_place(p, current_token(p));
    struct place_text text;
    const char *block = schema_block_of_key(place_bytes(p->findings->source, key), key.length);
    findings_error(p->findings, key,
                   block != NULL ? "'%s' stands outside a block; it belongs into '%s { ... }'"
                                 : "'%s' stands outside a block; for a name of your own write let",
                   place_text(p->findings->source, key, &text), block);
    skip_statement(p);
}

static void parse_block(struct deck_parser *p)
{
    struct deck_tree *tree = p->tree;
    struct deck_place word = parser_place(p, current_token(p));
    if ((current_token(p) + 1)->kind == '=') {
        report_stray_entry(p);
        return;
    }
    p->at++;
    struct deck_block *block = APPEND(p->findings, tree, blocks);
    if (block == NULL)
        return;
    block->word = word;
    block->first_name = tree->n_names;
    block->first_entry = tree->n_entries;
    while (current_token(p)->kind == TOKEN_WORD || current_token(p)->kind == TOKEN_STRING) {
        struct deck_place *name = APPEND(p->findings, tree, names);
        if (name == NULL)
            return;
        *name = parser_place(p, current_token(p));
        block->n_names++;
        p->at++;
    }
    size_t brace = p->at;
    while (p->tokens->items[brace].kind == TOKEN_NEWLINE)
        brace++;
    if (p->tokens->items[brace].kind == '{')
        p->at = brace;
    struct place_text text, found;
    if (current_token(p)->kind != '{') {
        if (current_token(p)->kind != TOKEN_BAD)
            findings_error(p->findings, parser_place(p, current_token(p)),
                           "expected '{' to open the block '%s', found %s",
                           place_text(p->findings->source, word, &text),
                           parser_found(p, current_token(p), &found));
        block->bad = true;
        skip_statement(p);
        return;
    }
    p->at++;
    parse_body(p, tree->n_blocks - 1);
}

/* --- texts --- */

static void parse_include(struct parse *parse, struct deck_parser *p)
{
    const struct deck_source *source = parse->findings->source;
    struct deck_place path = parser_place(p, current_token(p));
    if (current_token(p)->kind != TOKEN_STRING) {
        report_expected(p, "a file name in quotes after 'include'");
        p->tree->incomplete = true;
        skip_statement(p);
        return;
    }
    p->at++;
    bool valid;
    int text =
        deck_source_find(source, (size_t)p->text, place_bytes(source, path) + 1, path.length - 2, &valid);
    struct place_text shown;
    if (!valid)
        findings_error(p->findings, path,
                       "an included file lies beside the including one or below: "
                       "neither an absolute path nor '..'");
    else if (text < 0)
        findings_error(p->findings, path, "the included file %s is not among the deck's texts",
                       place_text(source, path, &shown));
    else if (parse->state[text] == TEXT_UNDER_WAY)
        findings_error(p->findings, path, "%s includes itself, directly or through another file",
                       place_text(source, path, &shown));
    else if (parse->state[text] == TEXT_UNSEEN)
        (void)parse_text(parse, text);
    if (text < 0)
        p->tree->incomplete = true;
    finish_statement(p);
}

static void parse_statement(struct parse *parse, struct deck_parser *p)
{
    struct place_text found;
    const struct token *t = current_token(p);
    if (t->kind == TOKEN_NEWLINE || t->kind == ';') {
        p->at++;
    } else if (t->kind == '}') {
        findings_error(p->findings, parser_place(p, t), "this '}' closes no block");
        p->at++;
    } else if (t->kind != TOKEN_WORD) {
        if (t->kind != TOKEN_BAD)
            findings_error(p->findings, parser_place(p, t), "expected let, include or a block, found %s",
                           parser_found(p, t, &found));
        p->at++;
        skip_statement(p);
    } else if (place_is(p->findings->source, parser_place(p, t), "let")) {
        p->at++;
        parse_let(p);
    } else if (place_is(p->findings->source, parser_place(p, t), "include")) {
        p->at++;
        parse_include(parse, p);
    } else {
        parse_block(p);
    }
}

static bool parse_text(struct parse *parse, int text)
{
    const struct deck_text *t = &parse->findings->source->texts[text];
    struct tokens tokens = {0};
    parse->state[text] = TEXT_UNDER_WAY;
    bool ok = deck_lex(t->text, t->length, text, &parse->budget, &tokens, parse->findings);
    struct deck_parser p = {
        .tree = parse->tree, .findings = parse->findings, .tokens = &tokens, .text = text};
    p.tree->incomplete |= !ok;
    while (ok && !parse->findings->no_memory && current_token(&p)->kind != TOKEN_END)
        parse_statement(parse, &p);
    free(tokens.items);
    parse->state[text] = TEXT_DONE;
    return ok;
}

bool deck_parse(struct deck_tree *tree, struct findings *findings)
{
    const struct deck_source *source = findings->source;
    struct parse parse = {tree, findings, DECK_MAX_TOKENS, mem_zalloc(source->n_texts, 1)};
    tree->source = source;
    /* Node 0 is the bad node. */
    struct deck_node *bad = APPEND(findings, tree, nodes);
    if (parse.state == NULL || bad == NULL) {
        findings->no_memory = true;
    } else {
        *bad = (struct deck_node){.kind = NODE_BAD, .depth = 1, .a = -1, .b = -1, .next = -1};
        tree->end = (struct deck_place){0, source->texts[0].length, 0};
        if (parse_text(&parse, 0)) {
            deck_tree_sort_lets(tree, findings);
            (void)parse_defines(&parse);
        }
        tree->room_tokens = parse.budget;
    }
    free(parse.state);
    return !findings->no_memory;
}
