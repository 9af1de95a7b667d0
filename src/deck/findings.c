/* Findings are kept in a fixed array in the order in which they were added, and sorted by place when they are
 * rendered, because a reader goes through the deck from top to bottom.
 *
 * The texts come from files and sockets, and a report may go to a terminal. A report therefore has printable
 * ASCII and well-formed UTF-8 only; any other byte is shown as '?'. Columns count characters, not bytes. The
 * blanks before the caret repeat the tabs of the line above, so that the caret is in the right column at any
 * tab width. */
#include "findings.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/text.h"

/* A line of more than LINE_SHOWN bytes is shown from LINE_BEFORE bytes before the caret on. */
enum { LINE_SHOWN = 160, LINE_BEFORE = 80 };

void findings_start(struct findings *f, const struct deck_source *source)
{
    memset(f, 0, sizeof *f);
    f->source = source;
}

static const char *text_name(const struct deck_source *source, int text)
{
    return (size_t)text < source->n_texts ? source->texts[text].name : "-D";
}

static const char *text_bytes(const struct deck_source *source, int text, size_t *length)
{
    if ((size_t)text < source->n_texts) {
        *length = source->texts[text].length;
        return source->texts[text].text;
    }
    const char *define = source->defines[(size_t)text - source->n_texts];
    *length = strlen(define);
    return define;
}

const char *place_bytes(const struct deck_source *source, struct deck_place place)
{
    size_t length;
    return text_bytes(source, place.text, &length) + place.offset;
}

bool place_is(const struct deck_source *source, struct deck_place place, const char *word)
{
    return strlen(word) == place.length && memcmp(place_bytes(source, place), word, place.length) == 0;
}

const char *place_text(const struct deck_source *source, struct deck_place place, struct place_text *out)
{
    size_t shown = place.length <= 40 ? place.length : 37;
    memcpy(out->text, place_bytes(source, place), shown);
    if (shown < place.length) {
        memcpy(out->text + shown, "...", 3);
        shown += 3;
    }
    out->text[shown] = '\0';
    return out->text;
}

struct deck_place place_span(struct deck_place a, struct deck_place b)
{
    a.length = b.offset + b.length - a.offset;
    return a;
}

static void add_finding(struct findings *f, bool is_error, struct deck_place place, const char *format,
                        va_list args)
{
    if ((is_error ? f->n_errors : f->n_warnings) >= FINDINGS_MAX) {
        f->more_errors |= is_error;
        return;
    }
    struct finding *item = &f->items[f->n];
    item->is_error = is_error;
    item->place = place;
    (void)vsnprintf(item->message, sizeof item->message, format, args);
    for (size_t i = 0; i < f->n; i++) {
        const struct finding *other = &f->items[i];
        if (other->place.text == place.text && other->place.offset == place.offset &&
            strcmp(other->message, item->message) == 0)
            return;
    }
    f->n++;
    if (is_error)
        f->n_errors++;
    else
        f->n_warnings++;
}

void findings_error(struct findings *f, struct deck_place place, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add_finding(f, true, place, format, args);
    va_end(args);
}

void findings_warn(struct findings *f, struct deck_place place, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add_finding(f, false, place, format, args);
    va_end(args);
}

/* --- rendering --- */

struct rendering {
    char *text;
    size_t used, cap;
    bool failed;
};

static void put_bytes(struct rendering *out, const char *bytes, size_t n)
{
    char *grown = out->failed ? NULL : mem_grown(out->text, &out->cap, out->used, out->used + n + 1, 1);
    if (grown == NULL) {
        out->failed = true;
        return;
    }
    out->text = grown;
    memcpy(out->text + out->used, bytes, n);
    out->used += n;
    out->text[out->used] = '\0';
}

static void put_text(struct rendering *out, const char *text)
{
    put_bytes(out, text, strlen(text));
}

static bool is_continuation(char c)
{
    return ((unsigned char)c & 0xc0u) == 0x80u;
}

static void put_printable(struct rendering *out, const char *s, size_t n, bool keep_tabs)
{
    for (size_t i = 0; i < n;) {
        size_t step = text_printable(s + i, n - i);
        if (step > 0)
            put_bytes(out, s + i, step);
        else if (s[i] == '\t' && keep_tabs)
            put_text(out, "\t");
        else
            put_text(out, s[i] == '\t' ? " " : "?");
        i += step > 0 ? step : 1;
    }
}

/* Puts the caret line: blanks as wide as the bytes from `from` to `at`, then ^, then ~ up to `to`. */
static void put_caret(struct rendering *out, const char *line, size_t from, size_t at, size_t to)
{
    for (size_t i = from; i < at;) {
        size_t step = text_printable(line + i, at - i);
        put_text(out, line[i] == '\t' ? "\t" : " ");
        i += step > 0 ? step : 1;
    }
    put_text(out, "^");
    for (size_t i = at + 1; i < to; i++)
        if (!is_continuation(line[i]))
            put_text(out, "~");
    put_text(out, "\n");
}

static void put_line(struct rendering *out, const char *text, size_t length, size_t start,
                     struct deck_place place)
{
    size_t end = start;
    while (end < length && text[end] != '\n')
        end++;
    if (end > start && text[end - 1] == '\r')
        end--;
    if (end == start)
        return;
    size_t from = start, at = place.offset < end ? place.offset : end;
    if (at - start > LINE_BEFORE && end - start > LINE_SHOWN)
        from = at - LINE_BEFORE;
    while (from < at && from > start && is_continuation(text[from]))
        from++;
    if (end - from > LINE_SHOWN)
        end = from + LINE_SHOWN;
    size_t to = place.offset + place.length < end ? place.offset + place.length : end;
    put_text(out, "    ");
    put_printable(out, text + from, end - from, true);
    put_text(out, "\n    ");
    put_caret(out, text, from, at, to);
}

/* Puts "file:line:column" of a place. Returns the offset at which the line of the place begins. */
static size_t put_where(struct rendering *out, const struct findings *f, struct deck_place place)
{
    size_t length, start = 0, column = 1;
    const char *text = text_bytes(f->source, place.text, &length);
    unsigned long line = 1;
    for (size_t i = 0; i < place.offset; i++) {
        if (text[i] == '\n') {
            line++;
            start = i + 1;
        }
    }
    for (size_t i = start; i < place.offset; i++)
        column += is_continuation(text[i]) ? 0u : 1u;
    const char *name = text_name(f->source, place.text);
    char where[60];
    (void)snprintf(where, sizeof where, ":%lu:%zu", line, column);
    put_printable(out, name, strlen(name), false);
    put_text(out, where);
    return start;
}

static void put_finding(struct rendering *out, const struct findings *f, const struct finding *item)
{
    size_t length, start = put_where(out, f, item->place);
    const char *text = text_bytes(f->source, item->place.text, &length);
    put_text(out, item->is_error ? ": error: " : ": warning: ");
    put_printable(out, item->message, strlen(item->message), false);
    put_text(out, "\n");
    put_line(out, text, length, start, item->place);
}

char *findings_place(const struct findings *f, struct deck_place place)
{
    struct rendering out = {0};
    size_t length, start = put_where(&out, f, place);
    const char *text = text_bytes(f->source, place.text, &length);
    put_text(&out, "\n");
    put_line(&out, text, length, start, place);
    if (out.failed) {
        free(out.text);
        return NULL;
    }
    out.text[out.used - 1] = '\0'; /* the last newline */
    return out.text;
}

static bool comes_after(const struct finding *a, const struct finding *b)
{
    if (a->place.text != b->place.text)
        return a->place.text > b->place.text;
    return a->place.offset > b->place.offset;
}

char *findings_render(struct findings *f)
{
    struct rendering out = {0};
    put_text(&out, "");
    /* An insertion sort, because there are few items and the findings of one place keep their order. */
    for (size_t i = 1; i < f->n; i++) {
        struct finding item = f->items[i];
        size_t j = i;
        for (; j > 0 && comes_after(&f->items[j - 1], &item); j--)
            f->items[j] = f->items[j - 1];
        f->items[j] = item;
    }
    for (size_t i = 0; i < f->n; i++)
        put_finding(&out, f, &f->items[i]);
    if (f->more_errors)
        put_text(&out, "too many errors\n");
    if (out.failed) {
        free(out.text);
        return NULL;
    }
    return out.text;
}
