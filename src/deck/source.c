/* Reads a deck and the files that it includes; afterwards the deck is a list of texts that can be sent.
 *
 * An include is found by its tokens: the word `include` at the beginning of a statement outside braces, and a
 * string after it. deck_load reports an invalid include, with its place; deck_source_read reports only files
 * that cannot be read, and too many files. A file that is included twice is read once, so that a cycle
 * ends. */
#include "source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/deck/deck.h"
#include "lex.h"

void deck_source_free(struct deck_source *source)
{
    for (size_t i = 0; i < source->n_texts; i++) {
        free(source->texts[i].name);
        free(source->texts[i].text);
    }
    for (size_t i = 0; i < source->n_defines; i++)
        free(source->defines[i]);
    free(source->texts);
    free(source->defines);
    *source = (struct deck_source){.steps = -1};
}

static bool path_is_acceptable(const char *path, size_t length)
{
    if (length == 0 || path[0] == '/')
        return false;
    for (size_t from = 0, i = 0; i <= length; i++) {
        if (i < length && (unsigned char)path[i] < 0x20)
            return false;
        if (i < length && path[i] != '/')
            continue;
        if (i - from == 2 && path[from] == '.' && path[from + 1] == '.')
            return false;
        from = i + 1;
    }
    return true;
}

char *deck_source_include(const char *includer, const char *path, size_t length)
{
    const char *slash = strrchr(includer, '/');
    size_t folder = slash == NULL ? 0 : (size_t)(slash - includer) + 1;
    if (!path_is_acceptable(path, length))
        return NULL;
    /* `./a` and `a` are the same file. */
    while (length > 2 && path[0] == '.' && path[1] == '/') {
        path += 2;
        length -= 2;
    }
    char *name = malloc(folder + length + 1);
    if (name != NULL) {
        memcpy(name, includer, folder);
        memcpy(name + folder, path, length);
        name[folder + length] = '\0';
    }
    return name;
}

static bool has_text(const struct deck_source *source, const char *name)
{
    for (size_t i = 0; i < source->n_texts; i++)
        if (strcmp(source->texts[i].name, name) == 0)
            return true;
    return false;
}

/* The state of reading a deck. */
struct reading {
    struct deck_source *source;
    size_t room, budget;                          /* bytes and tokens that the deck may still have */
    bool (*may)(void *context, const char *name); /* NULL: every file may be read */
    void *context;
};

/* Reads a file and appends its text to the source. The source owns `name` afterwards, also on failure. `by`
 * begins the message of a failure: the place of the include. */
static enum dm2_status add_file(struct reading *reading, char *name, const char *by, struct dm2_error *err)
{
    struct deck_source *source = reading->source;
    struct deck_text text = {name, NULL, 0};
    struct deck_text *texts =
        name == NULL ? NULL : realloc(source->texts, (source->n_texts + 1) * sizeof *source->texts);
    if (texts == NULL) {
        free(name);
        return dm2_fail(err, DM2_MEMORY, "no memory to read the deck");
    }
    source->texts = texts;
    unsigned char *bytes = NULL;
    enum dm2_status status = file_read(name, reading->room, &bytes, &text.length, err);
    text.text = (char *)bytes;
    if (status != DM2_OK && err != NULL && by[0] != '\0') {
        struct dm2_error why = *err;
        (void)dm2_fail(err, status, "%s%s", by, why.text);
    }
    reading->room -= text.length < reading->room ? text.length : reading->room;
    source->texts[source->n_texts++] = text;
    return status;
}

static enum dm2_status read_included(struct reading *reading, size_t includer, const struct tokens *tokens,
                                     size_t at, struct dm2_error *err)
{
    const struct deck_source *source = reading->source;
    const struct deck_text text = source->texts[includer];
    const struct token *path = &tokens->items[at];
    char *name = deck_source_include(text.name, text.text + path->offset + 1, path->length - 2);
    if (name == NULL || has_text(source, name)) {
        free(name);
        return DM2_OK;
    }
    unsigned long line = 1;
    for (size_t i = 0; i < path->offset; i++)
        line += text.text[i] == '\n';
    char by[300];
    (void)snprintf(by, sizeof by, "%.200s:%lu: ", text.name, line);
    if (source->n_texts >= DECK_MAX_TEXTS) {
        free(name);
        return dm2_fail(err, DM2_DECK, "%sthe deck includes more than %d files", by, DECK_MAX_TEXTS - 1);
    }
    if (reading->may != NULL && !reading->may(reading->context, name)) {
        (void)dm2_fail(err, DM2_IO, "%s%s: not to be read here", by, name);
        free(name);
        return DM2_IO;
    }
    return add_file(reading, name, by, err);
}

static enum dm2_status read_includes(struct reading *reading, size_t text, struct dm2_error *err)
{
    const struct deck_source *source = reading->source;
    struct findings *ignored = mem_zalloc(1, sizeof *ignored);
    struct tokens tokens = {0};
    enum dm2_status status = DM2_OK;
    if (ignored == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory to read the deck");
    findings_start(ignored, source);
    (void)deck_lex(source->texts[text].text, source->texts[text].length, (int)text, &reading->budget, &tokens,
                   ignored);
    int open = 0;
    bool begins = true;
    for (size_t i = 0; status == DM2_OK && i + 1 < tokens.n; i++) {
        int kind = tokens.items[i].kind;
        struct deck_place place = {(int)text, tokens.items[i].offset, tokens.items[i].length};
        if (begins && open == 0 && kind == TOKEN_WORD && place_is(source, place, "include") &&
            tokens.items[i + 1].kind == TOKEN_STRING)
            status = read_included(reading, text, &tokens, i + 1, err);
        open += kind == '{' ? 1 : kind == '}' && open > 0 ? -1 : 0;
        begins = kind == TOKEN_NEWLINE || kind == ';' || kind == '}';
    }
    free(tokens.items);
    free(ignored);
    return status;
}

enum dm2_status deck_source_read(const char *path, struct deck_source *out, struct dm2_error *err)
{
    return deck_source_read_some(path, NULL, NULL, out, err);
}

enum dm2_status deck_source_read_some(const char *path, bool (*may)(void *context, const char *name),
                                      void *context, struct deck_source *out, struct dm2_error *err)
{
    struct reading reading = {
        .source = out, .room = DECK_MAX_BYTES, .budget = DECK_MAX_TOKENS, .may = may, .context = context};
    size_t length = strlen(path) + 1;
    *out = (struct deck_source){.steps = -1};
    char *name = malloc(length);
    if (name != NULL)
        memcpy(name, path, length);
    enum dm2_status status = add_file(&reading, name, "", err);
    /* n_texts grows during the loop, because files include further files. */
    for (size_t i = 0; status == DM2_OK && i < out->n_texts; i++)
        status = read_includes(&reading, i, err);
    if (status != DM2_OK)
        deck_source_free(out);
    return status;
}
