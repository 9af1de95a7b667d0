/* From texts to a config in four passes: parse, evaluate, bind, check. Every pass continues after a mistake,
 * and all passes add to the same findings. The config is given to the caller only where there is no error. */
#include "dm2/deck/deck.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "check.h"
#include "expr.h"
#include "source.h"

void deck_report_free(struct deck_report *report)
{
    free(report->owned);
    *report = (struct deck_report){0};
}

/* Checks the sizes of a source before anything is read. */
static bool check_limits(const struct deck_source *source, struct findings *findings)
{
    size_t bytes = 0;
    struct deck_place start = {0, 0, 0};
    for (size_t i = 0; i < source->n_texts; i++)
        bytes += source->texts[i].length < DECK_MAX_BYTES ? source->texts[i].length : DECK_MAX_BYTES + 1;
    if (bytes > DECK_MAX_BYTES)
        findings_error(findings, start, "the deck is larger than %d MiB; is this the right file?",
                       DECK_MAX_BYTES >> 20);
    if (source->n_texts > DECK_MAX_TEXTS)
        findings_error(findings, start, "the deck includes more than %d files", DECK_MAX_TEXTS - 1);
    if (source->n_defines > DECK_MAX_DEFINES)
        findings_error(findings, start, "more than %d definitions with -D", DECK_MAX_DEFINES);
    return findings->n_errors == 0;
}

/* Evaluates all lets, for the errors of those that no value used, and warns of each unused let in a deck
 * without errors. */
static void check_lets(const struct deck_tree *tree, struct findings *findings)
{
    struct quantity ignored;
    for (size_t i = 0; i < tree->n_lets; i++)
        (void)expr_eval_let(tree, &tree->lets[i], findings, &ignored);
    for (size_t i = 0; i < tree->n_lets && findings->n_errors == 0; i++)
        if (!tree->lets[i].used)
            findings_warn(findings, tree->lets[i].place, "the let '%s' is not used", tree->lets[i].name);
}

static bool read_deck(const struct deck_source *source, struct config *out, struct findings *findings)
{
    struct deck_tree tree = {0};
    struct deck_binding binding = {.tree = &tree, .findings = findings, .config = out};
    size_t bytes = 0;
    for (size_t i = 0; i < source->n_texts; i++)
        bytes += source->texts[i].length;
    tree.room_bytes = DECK_MAX_BYTES - bytes;
    bool ok = deck_parse(&tree, findings) && deck_bind(&binding, source->steps) && deck_check(&binding);
    if (ok)
        check_lets(&tree, findings);
    deck_binding_free(&binding);
    deck_tree_free(&tree);
    return ok && !findings->no_memory;
}

enum dm2_status deck_load(const struct deck_source *source, struct config *out, struct deck_report *report)
{
    memset(out, 0, sizeof *out);
    *report = (struct deck_report){.text = "the deck has no text\n", .n_errors = 1};
    if (source->n_texts == 0)
        return DM2_DECK;
    report->text = "no memory to read the deck\n";
    struct findings *findings = mem_zalloc(1, sizeof *findings);
    if (findings == NULL)
        return DM2_MEMORY;
    findings_start(findings, source);
    bool ok = true;
    if (check_limits(source, findings))
        ok = read_deck(source, out, findings);
    char *text = ok ? findings_render(findings) : NULL;
    enum dm2_status status = text == NULL ? DM2_MEMORY : findings->n_errors > 0 ? DM2_DECK : DM2_OK;
    if (text != NULL)
        *report = (struct deck_report){text, text, findings->n_errors, findings->n_warnings};
    free(findings);
    if (status != DM2_OK)
        config_free(out);
    return status;
}
