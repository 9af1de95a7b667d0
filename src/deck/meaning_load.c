/* A meaning as a deck: the lines of one head become a block. What a meaning leaves out and a deck needs, the
 * margin of the lists and the number of steps, gets any valid value. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/bytes.h"
#include "dm2/base/mem.h"
#include "dm2/deck/deck.h"
#include "dm2/deck/meaning.h"
#include "schema.h"

/* Is the text at `at` the beginning `word`? */
static bool begins(const char *text, size_t length, const char *word)
{
    size_t n = strlen(word);
    return length >= n && memcmp(text, word, n) == 0;
}

/* Is the value the keyword's default? Many a default means nothing beside other values, and a deck must not
 * give it. In a rule for some pairs it holds against a less specific rule. */
static bool is_default(const char *head, size_t head_length, const char *key, size_t key_length,
                       const char *value, size_t length)
{
    const char *space = memchr(head, ' ', head_length);
    size_t word = space == NULL ? head_length : (size_t)(space - head);
    enum block_kind kind = schema_find_block(head, word);
    if (kind == BLOCK_COUNT || kind == BLOCK_INTERFACE || (kind == BLOCK_INTERACTION && space != NULL))
        return false;
    int k = schema_find_key(schema_block(kind), key, key_length);
    const char *initial = k < 0 ? NULL : schema_block(kind)->keys[k].initial;
    return initial != NULL && strlen(initial) == length && memcmp(initial, value, length) == 0;
}

/* Appends one line, "HEAD: KEY VALUES", as an entry; the head opens a block where it differs from the line
 * before. False: the line is none of a meaning. */
static bool put_line(struct bytes_writer *w, const char *line, size_t length, const char **head,
                     size_t *head_length)
{
    const char *colon = memchr(line, ':', length);
    size_t n = colon == NULL ? 0 : (size_t)(colon - line), at = n + 2;
    if (n == 0 || at >= length || colon[1] != ' ' || memchr(line, '"', length) != NULL)
        return false;
    const char *key = line + at, *space = memchr(key, ' ', length - at);
    if (space == NULL)
        return false;
    if (*head == NULL || *head_length != n || memcmp(*head, line, n) != 0) {
        if (*head != NULL)
            bytes_put_raw(w, "}\n", 2);
        bytes_put_raw(w, line, n);
        bytes_put_raw(w, " {\n", 3);
        if (n == 4 && begins(line, n, "time"))
            bytes_put_raw(w, "steps = 1\n", 10);
        *head = line;
        *head_length = n;
    }
    size_t key_length = (size_t)(space - key), values = length - at - key_length - 1;
    if (is_default(line, n, key, key_length, space + 1, values))
        return true;
    bytes_put_raw(w, key, key_length);
    bytes_put_raw(w, " = ", 3);
    bytes_put_raw(w, space + 1, values);
    bytes_put_raw(w, "\n", 1);
    if (n == 6 && begins(line, n, "domain") && key_length == 3 && begins(key, 3, "r_c")) {
        bytes_put_raw(w, "delta_r = 0.1*", 14);
        bytes_put_raw(w, space + 1, values);
        bytes_put_raw(w, "\n", 1);
    }
    return true;
}

static bool put_lines(struct bytes_writer *w, const char *text, size_t length)
{
    const char *head = NULL;
    size_t head_length = 0;
    for (size_t at = 0; at < length;) {
        const char *end = memchr(text + at, '\n', length - at);
        if (end == NULL || !put_line(w, text + at, (size_t)(end - text) - at, &head, &head_length))
            return false;
        at = (size_t)(end - text) + 1;
    }
    bytes_put_raw(w, "}\n", head == NULL ? 0 : 2);
    return true;
}

enum dm2_status meaning_load(const char *text, size_t length, struct config *out, struct dm2_error *err)
{
    struct bytes_writer w = {0};
    static char name[] = "the text of the state";
    struct deck_report report = {.text = NULL};
    bool whole = put_lines(&w, text, length);
    bytes_put_u8(&w, 0);
    enum dm2_status status = w.failed ? DM2_MEMORY : whole ? DM2_OK : DM2_PROTOCOL;
    if (status == DM2_OK) {
        struct deck_text one = {name, (char *)w.data, w.length - 1};
        const struct deck_source source = {.texts = &one, .n_texts = 1, .steps = -1, .meaning = true};
        status = deck_load(&source, out, &report);
    }
    if (status == DM2_MEMORY)
        (void)dm2_fail(err, status, "no memory for the deck of a state");
    else if (status != DM2_OK)
        status = dm2_fail(err, DM2_PROTOCOL, "the text of the state is no meaning of a deck: %.400s",
                          report.text == NULL ? "a line is not HEAD: KEYWORD VALUES" : report.text);
    deck_report_free(&report);
    bytes_free(&w);
    return status;
}
