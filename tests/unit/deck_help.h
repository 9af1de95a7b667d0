/* Helpers for tests of the deck: loading a deck from a text in memory or from a file. */
#ifndef DM2_TESTS_DECK_HELP_H
#define DM2_TESTS_DECK_HELP_H

#include <unistd.h>

#include "dm2/deck/deck.h"
#include "check.h"

struct loaded {
    enum dm2_status status;
    struct config config;
    struct deck_report report;
};

/* Changes to the source tree, in which docs, input and tests/decks are: DM2_SRC, or the working directory
 * where DM2_SRC is not set. */
static inline void enter_source_tree(void)
{
    const char *tree = getenv("DM2_SRC");
    if (tree != NULL && chdir(tree) != 0)
        SKIP("there is no folder DM2_SRC");
}

/* Loads one text named "deck" with the given -D definitions (a list that ends in NULL, or NULL) and
 * --steps. */
static inline struct loaded load_text(const char *text, const char *const *defines, int64_t steps)
{
    struct loaded out;
    struct deck_text one = {(char *)"deck", (char *)text, strlen(text)};
    struct deck_source source = {.texts = &one, .n_texts = 1, .defines = (char **)defines, .steps = steps};
    while (defines != NULL && defines[source.n_defines] != NULL)
        source.n_defines++;
    out.status = deck_load(&source, &out.config, &out.report);
    return out;
}

/* Loads a file and the files that it includes. A file that cannot be read ends the test. */
static inline struct loaded load_path(const char *path, const char *const *defines, int64_t steps)
{
    struct loaded out;
    struct deck_source source;
    struct dm2_error err = {0};
    if (deck_source_read(path, NULL, &source, &err) != DM2_OK) {
        printf("%s\n", err.text);
        exit(1);
    }
    source.defines = (char **)defines;
    while (defines != NULL && defines[source.n_defines] != NULL)
        source.n_defines++;
    source.steps = steps;
    out.status = deck_load(&source, &out.config, &out.report);
    source.defines = NULL; /* owned by the caller */
    source.n_defines = 0;
    deck_source_free(&source);
    return out;
}

static inline void loaded_free(struct loaded *l)
{
    config_free(&l->config);
    deck_report_free(&l->report);
}

#endif
