/* Two texts of meaning_build, compared line by line: "HEAD: KEYWORD VALUES". The first lines that differ tell
 * one of five things: another value, a keyword that one text lacks, a block that one text lacks, another
 * order of blocks. */
#include "dm2/deck/meaning.h"

#include <stdio.h>
#include <string.h>

#include "schema.h"

struct span {
    const char *text;
    size_t length;
};

struct line {
    struct span head, key, value; /* "body lid", "velocity", "0 -0.01" */
};

struct cursor {
    const char *text;
    size_t length, at;
};

static struct span span_until(const char *text, size_t length, const char *stop)
{
    size_t n = strlen(stop);
    for (size_t k = 0; k + n <= length; k++)
        if (memcmp(text + k, stop, n) == 0)
            return (struct span){text, k};
    return (struct span){text, length};
}

/* The next line; false at the end. */
static bool next_line(struct cursor *r, struct line *out)
{
    if (r->at >= r->length)
        return false;
    struct span line = span_until(r->text + r->at, r->length - r->at, "\n");
    r->at += line.length + 1;
    out->head = span_until(line.text, line.length, ": ");
    size_t at = out->head.length + 2 < line.length ? out->head.length + 2 : line.length;
    out->key = span_until(line.text + at, line.length - at, " ");
    at = at + out->key.length + 1 < line.length ? at + out->key.length + 1 : line.length;
    out->value = (struct span){line.text + at, line.length - at};
    return true;
}

static bool same(struct span a, struct span b)
{
    return a.length == b.length && memcmp(a.text, b.text, a.length) == 0;
}

/* Is a line of the head there, with the keyword where `key` is not NULL? */
static bool has_line(struct cursor r, struct span head, const struct span *key)
{
    struct line line;
    r.at = 0;
    while (next_line(&r, &line))
        if (same(line.head, head) && (key == NULL || same(line.key, *key)))
            return true;
    return false;
}

/* The printable beginning of a span. */
struct shown {
    char text[72];
};

static const char *show(struct span s, struct shown *out)
{
    size_t most = sizeof out->text - 4, n = s.length < most ? s.length : most;
    for (size_t k = 0; k < n; k++)
        out->text[k] = (char)(s.text[k] >= ' ' && s.text[k] < 0x7f ? s.text[k] : '?');
    memcpy(out->text + n, n < s.length ? "..." : "", n < s.length ? 4 : 1);
    return out->text;
}

static struct span block_word(struct span head)
{
    return span_until(head.text, head.length, " ");
}

/* " cm/us", or nothing. */
static void show_unit(const struct line *line, char *out, size_t size)
{
    struct span word = block_word(line->head);
    enum block_kind kind = schema_find_block(word.text, word.length);
    int key =
        kind == BLOCK_COUNT ? -1 : schema_find_key(schema_block(kind), line->key.text, line->key.length);
    struct dimension_text unit;
    out[0] = '\0';
    if (key >= 0 && !dimension_is_plain(schema_block(kind)->keys[key].dim))
        (void)snprintf(out, size, " %s", dimension_unit(schema_block(kind)->keys[key].dim, &unit));
}

static void tell_value(const struct line *was, const struct line *is, char out[MEANING_DIFFERENCE])
{
    struct shown key, head, before, now;
    char unit[40];
    show_unit(is, unit, sizeof unit);
    (void)snprintf(out, MEANING_DIFFERENCE, "`%s` of %s was %s, is %s%s", show(is->key, &key),
                   show(is->head, &head), show(was->value, &before), show(is->value, &now), unit);
}

/* A line that only one of the texts has. */
static void tell_alone(const struct line *line, bool is_new, bool head_known, char out[MEANING_DIFFERENCE])
{
    struct shown key, head, value;
    char unit[40];
    show_unit(line, unit, sizeof unit);
    (void)show(line->head, &head);
    if (!head_known)
        (void)snprintf(out, MEANING_DIFFERENCE,
                       is_new ? "`%s` is there, and was not" : "`%s` was there, and is not", head.text);
    else
        (void)snprintf(out, MEANING_DIFFERENCE,
                       is_new ? "`%s` of %s was not given, is %s%s" : "`%s` of %s was %s%s, is not given",
                       show(line->key, &key), head.text, show(line->value, &value), unit);
}

/* Writes the names of the blocks with this word, in their order. */
static void list_names(struct cursor r, struct span word, char *out, size_t size)
{
    struct line line;
    struct span before = {"", 0};
    size_t n = 0;
    r.at = 0;
    out[0] = '\0';
    while (next_line(&r, &line) && n + 1 < size) {
        struct shown name;
        if (!same(block_word(line.head), word) || same(line.head, before) || line.head.length == word.length)
            continue;
        before = line.head;
        struct span rest = {line.head.text + word.length + 1, line.head.length - word.length - 1};
        int more = snprintf(out + n, size - n, "%s%s", n == 0 ? "" : ", ", show(rest, &name));
        n += more > 0 ? (size_t)more : 0;
    }
}

static void tell_order(struct cursor was, struct cursor is, const struct line *line,
                       char out[MEANING_DIFFERENCE])
{
    struct span word = block_word(line->head);
    struct shown shown;
    char before[120], now[120];
    list_names(was, word, before, sizeof before);
    list_names(is, word, now, sizeof now);
    (void)snprintf(out, MEANING_DIFFERENCE, "blocks `%s` were %s, are %s: their order numbers them",
                   show(word, &shown), before, now);
}

bool meaning_difference(const char *was, size_t was_length, const char *is, size_t is_length,
                        char out[MEANING_DIFFERENCE])
{
    struct cursor before = {was, was_length, 0}, now = {is, is_length, 0};
    struct line a, b;
    for (;;) {
        bool has_a = next_line(&before, &a), has_b = next_line(&now, &b);
        if (!has_a && !has_b)
            return false;
        bool same_key = has_a && has_b && same(a.head, b.head) && same(a.key, b.key);
        if (same_key && same(a.value, b.value))
            continue;
        if (same_key)
            tell_value(&a, &b, out);
        else if (has_a && !has_line(now, a.head, &a.key))
            tell_alone(&a, false, has_line(now, a.head, NULL), out);
        else if (has_b && !has_line(before, b.head, &b.key))
            tell_alone(&b, true, has_line(before, b.head, NULL), out);
        else
            tell_order(before, now, has_a ? &a : &b, out);
        return true;
    }
}
