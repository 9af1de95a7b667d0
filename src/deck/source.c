/* Reads a deck and the files that it includes; afterwards the deck is a list of texts that can be sent.
 *
 * An include is found by its tokens: the word `include` at the beginning of a statement outside braces, and a
 * string after it; the table of a load likewise, by `file = "x"` in a block `load`. deck_load reports an
 * invalid include, with its place; deck_source_read reports only files that cannot be read, and too many
 * files. A file that is included twice is read once, so that a cycle ends. */
#include "source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dm2/base/file.h"
#include "dm2/base/mem.h"
#include "dm2/base/text.h"
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
    free(source->state);
    *source = (struct deck_source){.steps = -1};
}

static bool path_is_acceptable(const char *path, size_t length)
{
    size_t start = 0;
    while (start + 1 < length && path[start] == '.' && path[start + 1] == '/')
        start += 2;
    if (start >= length || path[start] == '/')
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

/* Appends `path` without its empty components and those that are '.' to `to`, and a NUL. */
static void append_path(char *to, const char *path, size_t length)
{
    bool first = true;
    for (size_t from = 0, i = 0; i <= length; i++) {
        if (i < length && path[i] != '/')
            continue;
        if (i - from > 1 || (i - from == 1 && path[from] != '.')) {
            if (!first)
                *to++ = '/';
            memcpy(to, path + from, i - from);
            to += i - from;
            first = false;
        }
        from = i + 1;
    }
    *to = '\0';
}

/* `folder`, then `separator`, then `path` as append_path leaves it. malloc'd; NULL: no memory. */
static char *join_path(const char *folder, size_t n, const char *separator, const char *path, size_t length)
{
    size_t between = strlen(separator);
    char *name = mem_alloc(n + between + length + 1, 1);
    if (name == NULL)
        return NULL;
    memcpy(name, folder, n);
    memcpy(name + n, separator, between);
    append_path(name + n + between, path, length);
    return name;
}

char *deck_source_include(const char *includer, const char *path, size_t length)
{
    const char *slash = strrchr(includer, '/');
    size_t folder = slash == NULL ? 0 : (size_t)(slash - includer) + 1;
    if (!path_is_acceptable(path, length))
        return NULL;
    char *name = join_path(includer, folder, "", path, length);
    if (name != NULL && name[folder] == '\0') { /* the path has components '.' alone */
        free(name);
        name = NULL;
    }
    return name;
}

static int find_name(const struct deck_source *source, const char *name)
{
    for (size_t i = 0; i < source->n_texts; i++)
        if (strcmp(source->texts[i].name, name) == 0)
            return (int)i;
    return -1;
}

/* The text that was found by `path` in a directory of struct deck_roots: its name is the directory, ROOT_MARK
 * and the path. */
static const char ROOT_MARK[] = "//";

static int find_in_roots(const struct deck_source *source, const char *path, size_t length)
{
    char *end = join_path("", 0, ROOT_MARK, path, length);
    size_t n = end == NULL ? 0 : strlen(end);
    int found = -1;
    for (size_t i = 0; n > 0 && found < 0 && i < source->n_texts; i++) {
        size_t all = strlen(source->texts[i].name);
        if (all > n && strcmp(source->texts[i].name + all - n, end) == 0)
            found = (int)i;
    }
    free(end);
    return found;
}

int deck_source_find(const struct deck_source *source, size_t includer, const char *path, size_t length,
                     bool *valid)
{
    char *name = deck_source_include(source->texts[includer].name, path, length);
    *valid = name != NULL;
    if (name == NULL)
        return -1;
    int found = find_name(source, name);
    free(name);
    return found >= 0 ? found : find_in_roots(source, path, length);
}

/* The state of reading a deck. */
struct reading {
    struct deck_source *source;
    size_t room, budget;                          /* bytes and tokens that the deck may still have */
    bool (*may)(void *context, const char *name); /* NULL: every file may be read */
    void *context;
    const struct deck_roots *roots; /* NULL: files are looked for beside the including file alone */
    bool table[DECK_MAX_TEXTS];     /* of each text: is it the table of a load, which includes nothing? */
};

static bool begins_with(const struct deck_text *t, const char *bytes, size_t n)
{
    return t->length >= n && memcmp(t->text, bytes, n) == 0;
}

/* The encoding of a text that is not UTF-8, found by its byte order mark or by NUL in every second of its
 * first bytes; NULL: none. */
static const char *foreign_encoding(const struct deck_text *t)
{
    if (begins_with(t, "\xff\xfe\0", 4) || begins_with(t, "\0\0\xfe\xff", 4))
        return "UTF-32";
    if (begins_with(t, "\xff\xfe", 2) || begins_with(t, "\xfe\xff", 2))
        return "UTF-16";
    bool first = t->length >= 4 && t->text[0] == '\0' && t->text[2] == '\0',
         second = t->length >= 4 && t->text[1] == '\0' && t->text[3] == '\0';
    return first != second ? "UTF-16" : NULL;
}

/* Takes the byte order mark of UTF-8 off, and turns a CR that no LF follows into the LF which it stands for,
 * so that comments end and lines count as in an editor. */
static void clean_text(struct deck_text *t)
{
    size_t mark = text_mark(t->text, t->length);
    t->length -= mark;
    memmove(t->text, t->text + mark, t->length + 1);
    for (size_t i = 0; i < t->length; i++)
        if (t->text[i] == '\r' && t->text[i + 1] != '\n')
            t->text[i] = '\n';
}

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
    const char *encoding = status == DM2_OK ? foreign_encoding(&text) : NULL;
    if (encoding != NULL)
        status = dm2_fail(err, DM2_DECK, "%s: the file is %s: save it as plain text, UTF-8", name, encoding);
    else if (status == DM2_OK)
        clean_text(&text);
    if (status != DM2_OK && err != NULL && by[0] != '\0') {
        struct dm2_error why = *err;
        (void)dm2_fail(err, status, "%s%s", by, why.text);
    }
    reading->room -= text.length < reading->room ? text.length : reading->room;
    source->texts[source->n_texts++] = text;
    return status;
}

/* Looks for `path` in the roots. Returns its name there, malloc'd; NULL: in none, with *err, or no memory. */
static char *find_on_disk(const struct deck_roots *roots, const char *path, size_t length, const char *by,
                          const char *beside, struct dm2_error *err)
{
    char places[400] = "";
    size_t used = 0;
    for (size_t k = 0; k < roots->n; k++) {
        const char *root = roots->items[k];
        size_t n = strlen(root);
        while (n > 1 && root[n - 1] == '/')
            n--;
        char *name = join_path(root, n, ROOT_MARK, path, length);
        if (name == NULL || !file_is_absent(name))
            return name;
        free(name);
        if (used < sizeof places)
            used += (size_t)snprintf(places + used, sizeof places - used, ", %.*s", (int)n, root);
    }
    (void)dm2_fail(
        err, DM2_IO,
        "%s%s: cannot open: No such file or directory; looked there%s; the variable DM2_PATH names "
        "further directories",
        by, beside, places);
    return NULL;
}

/* Fails where links lead from `name` out of the directory of the deck and out of all roots. */
static enum dm2_status check_place(const struct reading *reading, const char *name, const char *by,
                                   struct dm2_error *err)
{
    const char *deck = reading->source->texts[0].name;
    char *folder = strchr(deck, '/') == NULL ? text_join("./", "", "") : text_join(deck, "", "");
    if (folder == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory to read the deck");
    strrchr(folder, '/')[1] = '\0';
    bool inside = file_lies_below(name, folder);
    for (size_t k = 0; reading->roots != NULL && k < reading->roots->n && !inside; k++)
        inside = file_lies_below(name, reading->roots->items[k]);
    free(folder);
    if (inside)
        return DM2_OK;
    return dm2_fail(err, DM2_DECK,
                    "%s%s: symbolic links lead to a file outside the deck's folder: copy the file into the "
                    "folder, or name its own folder in the variable DM2_PATH",
                    by, name);
}

static enum dm2_status read_included(struct reading *reading, size_t includer, const struct tokens *tokens,
                                     size_t at, struct dm2_error *err)
{
    const struct deck_source *source = reading->source;
    const struct deck_text text = source->texts[includer];
    const struct token *token = &tokens->items[at];
    const char *path = text.text + token->offset + 1;
    size_t length = token->length - 2;
    char *name = deck_source_include(text.name, path, length);
    if (name == NULL || find_name(source, name) >= 0) {
        free(name);
        return DM2_OK;
    }
    unsigned long line = 1;
    for (size_t i = 0; i < token->offset; i++)
        line += text.text[i] == '\n';
    char by[300];
    (void)snprintf(by, sizeof by, "%.200s:%lu: ", text.name, line);
    if (reading->roots != NULL && file_is_absent(name)) {
        char *beside = name;
        name = find_in_roots(source, path, length) >= 0
                   ? NULL
                   : find_on_disk(reading->roots, path, length, by, beside, err);
        free(beside);
        if (name == NULL)
            return find_in_roots(source, path, length) >= 0 ? DM2_OK : DM2_IO;
    }
    if (source->n_texts >= DECK_MAX_TEXTS) {
        free(name);
        return dm2_fail(err, DM2_DECK, "%sthe deck includes more than %d files", by, DECK_MAX_TEXTS - 1);
    }
    if (reading->may != NULL && !reading->may(reading->context, name)) {
        (void)dm2_fail(err, DM2_IO, "%s%s: not to be read here", by, name);
        free(name);
        return DM2_IO;
    }
    enum dm2_status status =
        reading->may != NULL || file_is_absent(name) ? DM2_OK : check_place(reading, name, by, err);
    if (status == DM2_OK)
        return add_file(reading, name, by, err);
    free(name);
    return status;
}

/* Reads the file that the string token `at` names: an included text, or a table. */
static enum dm2_status read_named(struct reading *reading, size_t text, const struct tokens *tokens,
                                  size_t at, bool table, struct dm2_error *err)
{
    size_t before = reading->source->n_texts;
    enum dm2_status status = read_included(reading, text, tokens, at, err);
    if (table && reading->source->n_texts > before)
        reading->table[before] = true;
    return status;
}

/* Notes the file that the string token `at` names as the state that the run begins from. */
static void note_state(struct reading *reading, size_t text, const struct tokens *tokens, size_t at)
{
    const struct deck_text *t = &reading->source->texts[text];
    const struct token *token = &tokens->items[at];
    if (reading->source->state == NULL)
        reading->source->state = deck_source_include(t->name, t->text + token->offset + 1, token->length - 2);
}

/* Reads what the statement that begins at token `at` names: `include "x"` outside braces, `file = "x"` in a
 * block `load`; notes `state = "x"` in a block `start`. */
static enum dm2_status read_statement(struct reading *reading, size_t text, const struct tokens *tokens,
                                      size_t at, int open, const char *in, struct dm2_error *err)
{
    const struct token *t = &tokens->items[at];
    struct deck_place place = {(int)text, t->offset, t->length};
    if (t->kind != TOKEN_WORD)
        return DM2_OK;
    if (open == 0 && t[1].kind == TOKEN_STRING && place_is(reading->source, place, "include"))
        return read_named(reading, text, tokens, at + 1, false, err);
    if (open != 1 || at + 2 >= tokens->n || t[1].kind != '=' || t[2].kind != TOKEN_STRING)
        return DM2_OK;
    if (strcmp(in, "load") == 0 && place_is(reading->source, place, "file"))
        return read_named(reading, text, tokens, at + 2, true, err);
    if (strcmp(in, "start") == 0 && place_is(reading->source, place, "state"))
        note_state(reading, text, tokens, at + 2);
    return DM2_OK;
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
    if (ignored->no_memory)
        status = dm2_fail(err, DM2_MEMORY, "no memory to read the deck");
    int open = 0;
    bool begins = true;
    const char *in = ""; /* the block under way, of those that name files */
    for (size_t i = 0; status == DM2_OK && i + 1 < tokens.n; i++) {
        int kind = tokens.items[i].kind;
        struct deck_place place = {(int)text, tokens.items[i].offset, tokens.items[i].length};
        if (begins && open == 0 && kind == TOKEN_WORD)
            in = place_is(source, place, "load") ? "load" : place_is(source, place, "start") ? "start" : "";
        if (begins)
            status = read_statement(reading, text, &tokens, i, open, in, err);
        open += kind == '{' ? 1 : kind == '}' && open > 0 ? -1 : 0;
        begins = kind == TOKEN_NEWLINE || kind == ';' || kind == '}' || kind == '{';
    }
    free(tokens.items);
    free(ignored);
    return status;
}

/* Leaves one slash of each row of slashes, because ROOT_MARK is in no other name. */
static void single_slashes(char *name)
{
    char *to = name;
    for (const char *from = name; *from != '\0'; from++)
        if (from[0] != '/' || from[1] != '/')
            *to++ = *from;
    *to = '\0';
}

static enum dm2_status read_deck(const char *path, struct reading *reading, struct dm2_error *err)
{
    struct deck_source *out = reading->source;
    size_t length = strlen(path) + 1;
    *out = (struct deck_source){.steps = -1};
    char *name = malloc(length);
    if (name != NULL)
        memcpy(name, path, length);
    if (name != NULL && reading->roots != NULL)
        single_slashes(name);
    enum dm2_status status = add_file(reading, name, "", err);
    /* n_texts grows during the loop, because files include further files. */
    for (size_t i = 0; status == DM2_OK && i < out->n_texts; i++)
        status = reading->table[i] ? DM2_OK : read_includes(reading, i, err);
    if (status != DM2_OK)
        deck_source_free(out);
    return status;
}

enum dm2_status deck_source_read(const char *path, const struct deck_roots *roots, struct deck_source *out,
                                 struct dm2_error *err)
{
    struct reading reading = {
        .source = out, .room = DECK_MAX_BYTES, .budget = DECK_MAX_TOKENS, .roots = roots};
    return read_deck(path, &reading, err);
}

enum dm2_status deck_source_read_some(const char *path, bool (*may)(void *context, const char *name),
                                      void *context, struct deck_source *out, struct dm2_error *err)
{
    struct reading reading = {
        .source = out, .room = DECK_MAX_BYTES, .budget = DECK_MAX_TOKENS, .may = may, .context = context};
    return read_deck(path, &reading, err);
}
