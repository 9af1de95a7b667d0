/* One text of a deck, which a run leaves beside its results.
 *
 * The texts are copied byte for byte, comments included, but for five places, found by their tokens: an
 * include becomes the included text between two comments; the file of a load becomes its points; the value of
 * a let that -D overrides, and of `steps` where --steps is given, becomes the new value, with the old one in
 * a comment up to the end of the line; a missing `steps` is added. A text of these rules copies to itself. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/deck/deck.h"
#include "lex.h"
#include "schema.h"
#include "source.h"

struct flattening {
    const struct deck_source *source;
    const struct config *config;
    struct findings *findings; /* of the lexer: a deck that has loaded gives none */
    struct bytes_writer *out;
    size_t budget;
    bool *done; /* which texts are copied */
    bool no_memory;
};

/* A text that is being copied: the bytes up to `at` are done. */
struct copying {
    struct flattening *all;
    const struct deck_text *text;
    size_t index; /* of the text in the source */
    struct tokens tokens;
    size_t at;
};

static void copy_text(struct flattening *f, size_t index);

static void put(struct bytes_writer *w, const char *text)
{
    bytes_put_raw(w, text, strlen(text));
}

static void copy_to(struct copying *c, size_t offset)
{
    bytes_put_raw(c->all->out, c->text->text + c->at, offset - c->at);
    c->at = offset;
}

static bool token_is(const struct copying *c, size_t i, int kind, const char *word)
{
    const struct token *t = &c->tokens.items[i];
    struct deck_place place = {(int)c->index, t->offset, t->length};
    return t->kind == kind && (word == NULL || place_is(c->all->source, place, word));
}

/* Whether the line has nothing but blanks from `offset` on. */
static bool line_is_blank(const struct deck_text *t, size_t offset)
{
    while (offset < t->length && strchr(" \t\r", t->text[offset]) != NULL)
        offset++;
    return offset >= t->length || t->text[offset] == '\n';
}

/* The index of the token that ends the statement at token i: an end of a line outside parentheses, a
 * semicolon, a brace, the end of the text. */
static size_t statement_end(const struct copying *c, size_t i)
{
    int parens = 0;
    for (;; i++) {
        int kind = c->tokens.items[i].kind;
        parens += kind == '(' ? 1 : kind == ')' ? -1 : 0;
        if (kind == TOKEN_END || kind == '}' || kind == ';' || (kind == TOKEN_NEWLINE && parens <= 0))
            return i;
    }
}

/* Ends a line that an inserted comment began, where more of the statement's line follows. */
static void end_comment(struct copying *c)
{
    if (!line_is_blank(c->text, c->at))
        put(c->all->out, "\n");
}

/* Replaces the value whose first token is `first` by `value`; `option`: where the new value comes from. */
static void replace_value(struct copying *c, size_t first, const char *value, const char *option)
{
    size_t end = statement_end(c, first);
    if (end == first)
        return;
    const struct token *last = &c->tokens.items[end - 1];
    struct bytes_writer *w = c->all->out;
    copy_to(c, c->tokens.items[first].offset);
    put(w, value);
    put(w, " # ");
    put(w, option);
    put(w, ", was ");
    size_t from = w->length;
    copy_to(c, last->offset + last->length);
    for (size_t k = from; k < w->length && !w->failed; k++)
        if (w->data[k] == '\n')
            w->data[k] = ' ';
    end_comment(c);
}

/* The value that the last -D of a name gives, NULL: none. The place is that of the name in its let. */
static const char *defined_value(const struct copying *c, const struct token *name)
{
    const struct deck_source *s = c->all->source;
    for (size_t k = s->n_defines; k-- > 0;) {
        const char *define = s->defines[k], *equals = strchr(define, '=');
        const char *from = define + strspn(define, " \t");
        if (equals == NULL)
            continue;
        size_t length = strcspn(from, " \t=");
        if (length == name->length && memcmp(from, c->text->text + name->offset, length) == 0)
            return equals + 1 + strspn(equals + 1, " \t");
    }
    return NULL;
}

/* Token i is `let`. */
static void copy_let(struct copying *c, size_t i)
{
    if (!token_is(c, i + 1, TOKEN_WORD, NULL) || !token_is(c, i + 2, '=', NULL))
        return;
    const char *value = defined_value(c, &c->tokens.items[i + 1]);
    if (value != NULL)
        replace_value(c, i + 3, value, "-D");
}

/* Token i is `time`, and the brace of its block follows. */
static void copy_time(struct copying *c, size_t i)
{
    char value[32];
    if (c->all->source->steps < 0)
        return;
    (void)snprintf(value, sizeof value, "%" PRId64, c->all->source->steps);
    while (!token_is(c, i, '{', NULL))
        if (c->tokens.items[i++].kind == TOKEN_END)
            return;
    for (size_t k = i + 1; !token_is(c, k, '}', NULL) && !token_is(c, k, TOKEN_END, NULL); k++)
        if (token_is(c, k, TOKEN_WORD, "steps") && token_is(c, k + 1, '=', NULL)) {
            replace_value(c, k + 2, value, "--steps");
            return;
        }
    copy_to(c, c->tokens.items[i].offset + 1);
    put(c->all->out, " steps = ");
    put(c->all->out, value);
    put(c->all->out, " # --steps");
    end_comment(c);
}

/* Token i is `include`, a string follows. */
static void copy_include(struct copying *c, size_t i)
{
    const struct token *path = &c->tokens.items[i + 1];
    const char *name = c->text->text + path->offset; /* with its quotes */
    struct bytes_writer *w = c->all->out;
    bool valid;
    int found = deck_source_find(c->all->source, c->index, name + 1, path->length - 2, &valid);
    if (found < 0)
        return;
    copy_to(c, c->tokens.items[i].offset);
    if (c->all->done[found]) {
        put(w, "# above: ");
        copy_to(c, path->offset + path->length);
        end_comment(c);
        return;
    }
    put(w, "# begin ");
    bytes_put_raw(w, name, path->length);
    put(w, "\n");
    copy_text(c->all, (size_t)found);
    if (!w->failed && w->length > 0 && w->data[w->length - 1] != '\n')
        put(w, "\n");
    put(w, "# end ");
    bytes_put_raw(w, name, path->length);
    c->at = path->offset + path->length;
    end_comment(c);
}

/* Writes the points of a load in base units, eight in a line. */
static void put_points(struct bytes_writer *w, const struct load_config *load)
{
    put(w, schema_block(BLOCK_LOAD)->keys[load->quantity].name);
    put(w, " =");
    for (size_t k = 0; k < load->n; k++) {
        char time[NUMBER_TEXT_MAX], value[NUMBER_TEXT_MAX];
        size_t n_time = number_format(load->time[k], time), n_value = number_format(load->value[k], value);
        put(w, k == 0 ? " " : k % 8 == 0 ? ",\n        " : ", ");
        bytes_put_raw(w, time, n_time);
        put(w, " ");
        bytes_put_raw(w, value, n_value);
    }
    put(w, "\n");
}

/* Token i is `file` of the load whose name is the token `name`; a string follows. */
static void copy_file(struct copying *c, size_t i, size_t name)
{
    const struct token *path = &c->tokens.items[i + 2];
    const struct config *config = c->all->config;
    struct bytes_writer *w = c->all->out;
    copy_to(c, c->tokens.items[i].offset);
    for (int end = 0; end < 2; end++) {
        put(w, end == 0 ? "# begin " : "# end ");
        bytes_put_raw(w, c->text->text + path->offset, path->length);
        if (end == 0)
            put(w, "\n");
        for (size_t k = 0; k < config->n_loads && end == 0; k++)
            if (token_is(c, name, TOKEN_WORD, config->loads[k].name))
                put_points(w, &config->loads[k]);
    }
    c->at = path->offset + path->length;
    end_comment(c);
}

static void copy_statements(struct copying *c)
{
    int open = 0;
    bool begins = true;
    size_t load = 0; /* the name of the load that the block is of; 0: none */
    for (size_t i = 0; i + 1 < c->tokens.n; i++) {
        int kind = c->tokens.items[i].kind;
        if (begins && open == 0)
            load = token_is(c, i, TOKEN_WORD, "load") ? i + 1 : 0;
        if (begins && open == 1 && load > 0 && token_is(c, i, TOKEN_WORD, "file") &&
            token_is(c, i + 1, '=', NULL) && token_is(c, i + 2, TOKEN_STRING, NULL))
            copy_file(c, i, load);
        else if (begins && open == 0 && token_is(c, i, TOKEN_WORD, "include") &&
                 token_is(c, i + 1, TOKEN_STRING, NULL))
            copy_include(c, i);
        else if (begins && open == 0 && token_is(c, i, TOKEN_WORD, "let"))
            copy_let(c, i);
        else if (begins && open == 0 && token_is(c, i, TOKEN_WORD, "time"))
            copy_time(c, i);
        open += kind == '{' ? 1 : kind == '}' && open > 0 ? -1 : 0;
        begins = kind == TOKEN_NEWLINE || kind == ';' || kind == '}' || kind == '{';
    }
    copy_to(c, c->text->length);
}

static void copy_text(struct flattening *f, size_t index)
{
    struct copying c = {.all = f, .text = &f->source->texts[index], .index = index};
    f->done[index] = true;
    if (deck_lex(c.text->text, c.text->length, (int)index, &f->budget, &c.tokens, f->findings))
        copy_statements(&c);
    else
        f->no_memory = true;
    free(c.tokens.items);
}

enum dm2_status deck_source_flatten(const struct deck_source *source, const struct config *config,
                                    struct bytes_writer *out, struct dm2_error *err)
{
    struct flattening f = {.source = source,
                           .config = config,
                           .findings = mem_zalloc(1, sizeof *f.findings),
                           .out = out,
                           .budget = DECK_MAX_TOKENS,
                           .done = mem_zalloc(source->n_texts, sizeof *f.done)};
    bytes_clear(out);
    f.no_memory = f.findings == NULL || f.done == NULL;
    if (!f.no_memory) {
        findings_start(f.findings, source);
        copy_text(&f, 0);
    }
    free(f.findings);
    free(f.done);
    return f.no_memory || out->failed ? dm2_fail(err, DM2_MEMORY, "no memory for the deck as one text")
                                      : DM2_OK;
}
