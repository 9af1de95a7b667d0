/* Helpers for tests of the meaning of a deck. */
#ifndef DM2_TESTS_MEANING_HELP_H
#define DM2_TESTS_MEANING_HELP_H

#include "deck_help.h"

#include "dm2/deck/meaning.h"

/* The meaning of a text; the caller frees it. */
static inline struct deck_meaning meaning_of(const char *text, unsigned parts)
{
    struct deck_meaning m = {.text = NULL};
    struct dm2_error err = {0};
    struct loaded l = load_text(text, NULL, -1);
    CHECK_REPORT(l.status == DM2_OK, "%s", l.report.text);
    if (l.status == DM2_OK)
        CHECK_EQ_INT(meaning_build(&l.config, parts, &m, &err), DM2_OK);
    loaded_free(&l);
    if (m.text == NULL)
        m.text = calloc(1, 1);
    return m;
}

/* The meaning, read as a deck, has the same meaning. */
static inline void check_reads_back(const struct config *config, const char *what)
{
    struct deck_meaning m, again = {.text = NULL};
    struct config read;
    struct dm2_error err = {0};
    char difference[MEANING_DIFFERENCE];
    CHECK_EQ_INT(meaning_build(config, 1u << PART_MEANING, &m, &err), DM2_OK);
    enum dm2_status status = meaning_load(m.text, m.length, &read, &err);
    CHECK_REPORT(status == DM2_OK, "%s: %s", what, err.text);
    if (status == DM2_OK) {
        CHECK_EQ_INT(meaning_build(&read, 1u << PART_MEANING, &again, &err), DM2_OK);
        bool differs = meaning_difference(m.text, m.length, again.text, again.length, difference);
        CHECK_REPORT(!differs, "%s: %s", what, difference);
        config_free(&read);
    }
    meaning_free(&m);
    meaning_free(&again);
}

#endif
