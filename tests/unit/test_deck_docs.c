/* docs/deck.md has every keyword of the schema, in the section of its block, with the values, default and
 * meaning of the schema, and has no other keyword. */
#include "deck/schema.h"
#include "check.h"
#include "deck_help.h"

static void value_text(const struct deck_key *key, char *out, size_t size)
{
    struct dimension_text unit;
    const char *u = dimension_is_plain(key->dim) ? "number" : dimension_unit(key->dim, &unit);
    char words[400] = "";
    for (const char *c = key->choices; c != NULL && *c != '\0';) {
        size_t n = strcspn(c, "|");
        (void)snprintf(words + strlen(words), sizeof words - strlen(words), "%s`%.*s`", words[0] ? ", " : "",
                       (int)n, c);
        c += n + (c[n] == '|');
    }
    char times[20] = "";
    if (key->count > 1)
        (void)snprintf(times, sizeof times, "%d x ", key->count);
    switch (key->type) {
    case VALUE_REAL:
        (void)snprintf(out, size, "%s%s", times, u);
        break;
    case VALUE_WHOLE:
    case VALUE_STEPS:
        (void)snprintf(out, size, key->type == VALUE_STEPS ? "whole numbers" : "whole number");
        break;
    case VALUE_CHOICE:
    case VALUE_FLAG:
    case VALUE_FORMATS:
    case VALUE_SET:
        (void)snprintf(out, size, "%s%s", times, words);
        break;
    case VALUE_SHAPE:
        (void)snprintf(out, size, "word and numbers, cm");
        break;
    case VALUE_MATERIAL:
    case VALUE_BODY:
    case VALUE_MOVER:
    case VALUE_MATERIALS:
    case VALUE_NAME:
    case VALUE_MOVERS:
        (void)snprintf(out, size, key->count > 1 ? "names" : "name");
        break;
    case VALUE_BODIES:
    case VALUE_NAMES:
        (void)snprintf(out, size, "names");
        break;
    case VALUE_STATE:
    case VALUE_FILE:
        (void)snprintf(out, size, "file name");
        break;
    case VALUE_POINTS:
        (void)snprintf(out, size, "points: time, us, then %s", u);
        break;
    case VALUE_MIX:
        (void)snprintf(out, size, "names and numbers");
        break;
    case VALUE_LIMIT:
        (void)snprintf(out, size, "names, `above` or `below`, number");
        break;
    case VALUE_LINE:
        (void)snprintf(out, size, "numbers, cm");
    }
}

static char *read_text(const char *path)
{
    enter_source_tree();
    FILE *f = fopen(path, "rb");
    char *text = malloc(1 << 18);
    CHECK(f != NULL);
    if (f == NULL)
        exit(1);
    size_t n = fread(text, 1, (1 << 18) - 1, f);
    text[n] = '\0';
    fclose(f);
    return text;
}

/* The section of a block, from its heading to the next heading. The caller frees the text. */
static char *section(const char *manual, const char *block)
{
    char heading[60];
    (void)snprintf(heading, sizeof heading, "\n### `%s", block);
    const char *at = strstr(manual, heading);
    CHECK_REPORT(at != NULL, "docs/deck.md has no section '%s'", heading + 1);
    if (at == NULL)
        return calloc(1, 1);
    const char *end = strstr(at + 1, "\n#");
    size_t n = end == NULL ? strlen(at) : (size_t)(end - at) + 1;
    char *out = calloc(n + 1, 1);
    memcpy(out, at, n);
    return out;
}

TEST(every_keyword_is_in_the_manual)
{
    char *manual = read_text("docs/deck.md");
    for (int kind = 0; kind < BLOCK_COUNT; kind++) {
        const struct block_schema *block = schema_block((enum block_kind)kind);
        if (kind == BLOCK_INTERFACE)
            continue;
        char *part = section(manual, block->name), row[1000], value[420];
        for (size_t i = 0; i < block->n_keys; i++) {
            const struct deck_key *key = &block->keys[i];
            value_text(key, value, sizeof value);
            (void)snprintf(row, sizeof row, "\n| `%s` | %s | %s | %s |\n", key->name, value,
                           key->required ? "**required**" : key->initial, key->meaning);
            CHECK_REPORT(strstr(part, row) != NULL, "the section of '%s' lacks the row%s", block->name, row);
            CHECK((key->initial == NULL) == key->required);
        }
        free(part);
    }
    free(manual);
}

TEST(the_manual_has_no_other_keyword)
{
    char *manual = read_text("docs/deck.md");
    for (int kind = 0; kind < BLOCK_COUNT; kind++) {
        const struct block_schema *block = schema_block((enum block_kind)kind);
        char *part = section(manual, block->name);
        size_t rows = 0;
        for (const char *at = part; (at = strstr(at, "\n| `")) != NULL; rows++) {
            at += 4;
            size_t n = strcspn(at, "`");
            CHECK_REPORT(schema_find_key(block, at, n) >= 0, "the manual's '%.*s' is no keyword of '%s'",
                         (int)n, at, block->name);
        }
        CHECK_EQ_INT(rows, kind == BLOCK_INTERFACE ? 0 : block->n_keys);
        free(part);
    }
    free(manual);
}

TEST(the_example_is_the_deck_of_input)
{
    char *manual = read_text("docs/deck.md"), *deck = read_text("input/collision.dm2");
    CHECK(strstr(manual, deck) != NULL);
    free(manual);
    free(deck);
}

TEST_MAIN(CASE(every_keyword_is_in_the_manual), CASE(the_example_is_the_deck_of_input),
          CASE(the_manual_has_no_other_keyword))
